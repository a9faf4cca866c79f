#pragma once

#include "depth/cell_row.hpp"

namespace talus::observe {

/// Raises the peaks of the cells of a row that are deeper than `thinnest`, m. `depth` and `speed` begin at the row's
/// first cell.
using RaisePeaks = void (*)(const depth::CellRow& row, float thinnest, float* depth, float* speed);

/// For the chosen instruction set (simd/dispatch.hpp).
[[nodiscard]] RaisePeaks raise_peaks_function();

}  // namespace talus::observe
