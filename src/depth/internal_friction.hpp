#pragma once

#include <array>
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

    /// By cell of the grid; only those of cells with debris are in use.
    struct Fields {
        std::vector<float> weight;                            ///< m3/s2, pressure summed over the depth, per density
        std::vector<float> u_east, v_east, u_north, v_north;  ///< 1/s, gradients
        std::vector<float> pull_east, drag_east;              ///< m3/s2, across the eastern face: along its normal,
        std::vector<float> pull_north, drag_north;            ///< along the face; and across the northern one
        std::vector<float> u, v;                              ///< m/s, after a pass
        [[nodiscard]] auto all() {
            return std::array{&weight,    &u_east,     &v_east,     &u_north, &v_north, &pull_east,
                              &drag_east, &pull_north, &drag_north, &u,       &v};
        }
    };

  private:
    double coefficient_;
    Fields fields_;
};

}  // namespace talus::depth
