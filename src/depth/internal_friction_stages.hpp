#pragma once

#include "depth/solver.hpp"

namespace talus::depth {

/// What the stages of internal friction share. Pointers as those of Solver::Cells, by cell; what cells without debris
/// have is not used.
struct FrictionData {
    Solver::Cells cells;
    const float* built = nullptr;               ///< 1: a structure stands there
    float *weight = nullptr, *ratio = nullptr;  ///< m3/s2, pressure over the depth, per density; pore-pressure ratio
    float *touch_east = nullptr, *touch_west = nullptr, *touch_north = nullptr,
          *touch_south = nullptr;                ///< 1: the debris touches that neighbour's
    float *half_x = nullptr, *half_y = nullptr;  ///< 1 over how many of both neighbours along an axis it touches; 0
    float *u_east = nullptr, *v_east = nullptr, *u_north = nullptr, *v_north = nullptr;  ///< 1/s, gradients
    /// m3/s2, on the debris of the cell across its eastern and its northern face: along the normal, along the face.
    float *pull_east = nullptr, *drag_east = nullptr, *pull_north = nullptr, *drag_north = nullptr;
    float* faster = nullptr;  ///< see Solver::expect_waves()
    float gravity = 0, inverse_cell = 0;
    float limit = 0;             ///< of the stress' norm, over the pressure, or that of the grains where r_u differs
    float stiffest = 0;          ///< stress over strain rate and depth, m2/s
    float over_mass = 0;         ///< time step over the length of a cell, s/m
    float signal = 0, line = 0;  ///< what is certainly below Solver::signal() and highest_line()
};

/// What was done to a strip.
enum StripChange : std::uint8_t { strip_unchanged = 0, strip_changed = 1, strip_perhaps_faster = 2 };

/// Each is called for strips [first, last), which may be shared out.
struct FrictionStages {
    /// What stays during the passes: neighbours that touch, and pressures of debris under its own weight.
    void (*prepare)(const FrictionData&, const Solver::Strip* first, const Solver::Strip* last);
    void (*find_gradients)(const FrictionData&, const Solver::Strip* first, const Solver::Strip* last);
    /// Across the faces to the east and to the north of a cell.
    void (*find_tractions)(const FrictionData&, const Solver::Strip* first, const Solver::Strip* last);
    /// Velocities of active strips; writes what was done to each.
    void (*take_velocities)(const FrictionData&, const Solver::Strip* first, const Solver::Strip* last,
                            std::uint8_t* changes);
};

/// For the chosen instruction set (simd/dispatch.hpp).
[[nodiscard]] FrictionStages friction_stages();

}  // namespace talus::depth
