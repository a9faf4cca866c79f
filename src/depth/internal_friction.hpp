#pragma once

#include <vector>

#include "depth/solver.hpp"

/// The friction inside the debris: stresses in plan that resist its shear and its stretching. docs/depth-averaged.md
/// has the equations.
namespace talus::depth {

/// Acts on a solver after each of its steps. Results have the same bits on any number of threads and any instruction
/// set. Allocates nothing after construction.
class InternalFriction {
  public:
    /// `coefficient`: Coulomb's, inside the debris; 0: none.
    InternalFriction(const Solver& solver, double coefficient);

    void resist(Solver& solver);

  private:
    double coefficient_;
    std::vector<float> u_, v_;  ///< m/s, by cell of the grid: after a pass
};

}  // namespace talus::depth
