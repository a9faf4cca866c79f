#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "depth/solver.hpp"
#include "observe/grid_observer.hpp"
#include "run/fault_record.hpp"

namespace talus::run {

/// The debris of the depth-averaged model at one time: the cells that have any.
struct GridState {
    struct Cell {
        int column = 0, row = 0;
        float depth = 0, u = 0, v = 0;  ///< m, m/s
    };
    double time = 0;  ///< s
    std::uint64_t step = 0;
    std::vector<Cell> cells;  ///< row by row from the south-west

    GridState() = default;
    explicit GridState(const depth::Solver& solver);
};

/// As sim::find_fault() for particles: a speed that no fall explains, with the same margin. Call after a step that was
/// observed.
[[nodiscard]] Status find_grid_fault(const depth::Solver& solver, const observe::GridObserver& observer);

/// As record_fault(): `good` of a few steps earlier, `bad` after the step. `bed`: elevations with structures, m.
[[nodiscard]] FaultRecord record_grid_fault(const Grid<double>& bed, const GridState& good, const depth::Solver& bad,
                                            const std::string& reason);

}  // namespace talus::run
