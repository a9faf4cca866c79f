#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/calibration.hpp"
#include "core/result.hpp"

namespace talus::bench {

/// The speed of the depth-averaged model on one number of threads: medians over the repeats.
struct GridRow {
    int threads = 0;
    std::uint64_t cells = 0;        ///< of the grid
    double cells_per_step = 0;      ///< that a step updates
    double updates_per_second = 0;  ///< of cells, whole steps of Heun's method
    double calibration_rate = 0;    ///< units per second
    double relative_rate = 0;       ///< cell updates per calibration unit
    double bytes_per_cell = 0;
    std::uint64_t hash = 0;  ///< of the state after the last step: the same on any number of threads
    std::string instruction_set;
};

/// Voellmy debris that runs through a valley of 512 x 512 cells of 1 m, measured while it moves. Errors: a step that
/// cannot be trusted.
[[nodiscard]] Result<GridRow> measure_grid(int threads, int repeats, Calibration& calibration);

[[nodiscard]] std::string grid_table_text(const std::vector<GridRow>& rows);
/// One object per row and line, {"event": "row", ...}.
[[nodiscard]] std::string grid_rows_json(const std::vector<GridRow>& rows);

}  // namespace talus::bench
