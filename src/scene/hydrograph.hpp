#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "terrain/inflow.hpp"
#include "terrain/terrain.hpp"

/// What inflows are made of, read and checked.
namespace talus {

/// Rows that a hydrograph must and may have.
inline constexpr std::size_t fewest_rows = 2, most_rows = 1'000'000;

/// Reads a CSV as inflow.hydrograph has it: its columns are the keys of the hydrograph table. Errors name file, line,
/// column and what is allowed.
[[nodiscard]] Result<std::vector<InflowSample>> read_hydrograph(const InflowSpec& inflow);

/// That it brings debris, and does so before the run ends. Errors begin with `at`.
[[nodiscard]] Status check_hydrograph(const Inflow& inflow, const SolverSpec& solver, const std::string& at);

/// That the line has a length and lies on known ground. Errors begin with `at`.
[[nodiscard]] Status check_line(const Inflow& inflow, const Terrain& terrain, const std::string& at);

}  // namespace talus
