#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "depth/solver.hpp"

/// The friction inside the debris: stresses in plan that resist its shear and its stretching. docs/depth-averaged.md
/// has the equations.
namespace talus::depth {

/// Acts on a solver after each of its steps. Results have the same bits on any number of threads and any instruction
/// set. Allocates nothing after construction.
class InternalFriction {
  public:
    /// `solver`: one with open edges. `coefficient`: Coulomb's, inside the debris; 0: none.
    InternalFriction(const Solver& solver, double coefficient);

    void resist(Solver& solver);

    /// Cells side by side, as many as lanes.
    struct Group {
        int column = 0, row = 0;  ///< of the first
    };
    /// By cell of the grid and of a margin around it. What cells without debris have is not used.
    struct Fields {
        std::size_t stride = 0;
        std::vector<float> built;          ///< 1: a structure stands there
        std::vector<float> weight, ratio;  ///< m3/s2, pressure summed over the depth, per density; pore-pressure ratio
        std::vector<float> touch_east, touch_west, touch_north,
            touch_south;                                      ///< 1: the debris touches that neighbour's
        std::vector<float> u_east, v_east, u_north, v_north;  ///< 1/s, gradients
        /// m3/s2, on the debris of the cell across its eastern and its northern face: along the normal, along the face.
        std::vector<float> pull_east, drag_east, pull_north, drag_north;
        std::vector<float> u, v;  ///< m/s, after a pass
        [[nodiscard]] auto all() {
            return std::array{&built,       &weight,     &ratio,      &touch_east, &touch_west, &touch_north,
                              &touch_south, &u_east,     &v_east,     &u_north,    &v_north,    &pull_east,
                              &drag_east,   &pull_north, &drag_north, &u,          &v};
        }
        [[nodiscard]] std::size_t index(int column, int row) const {
            return static_cast<std::size_t>(row + 1) * stride + static_cast<std::size_t>(column + 1);
        }
    };

  private:
    double coefficient_;
    Fields fields_;
    std::vector<Group> wet_;  ///< of which some cells hold debris
};

}  // namespace talus::depth
