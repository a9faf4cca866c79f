#pragma once

#include <cstdint>
#include <vector>

#include "depth/internal_friction_stages.hpp"
#include "depth/solver.hpp"

/// The friction inside the debris: stresses in plan that resist its shear and its stretching. docs/depth-averaged.md
/// has the equations.
namespace talus::depth {

/// Acts on a solver after each of its steps. Results have the same bits on any number of threads and any instruction
/// set. Allocates nothing after construction.
class InternalFriction {
  public:
    /// `solver`: one with open edges. `coefficient`: Coulomb's, inside the debris; 0: none.
    InternalFriction(Solver& solver, double coefficient);

    void resist(Solver& solver);

  private:
    double coefficient_;
    FrictionStages stages_;
    FrictionData data_;
    std::vector<std::vector<float>> fields_;  ///< what data_ points to
    std::vector<Solver::Strip> strips_;
    std::vector<std::uint8_t> near_, changes_;  ///< by tile, see Solver::find_strips(); by strip
};

}  // namespace talus::depth
