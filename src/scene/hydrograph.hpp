#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "terrain/inflow.hpp"
#include "terrain/terrain.hpp"

/// Reads and checks the input of inflows.
namespace talus::scene {

/// Minimum and maximum number of rows of a hydrograph.
inline constexpr std::size_t min_rows = 2, max_rows = 1'000'000;

/// Reads a CSV file given as inflow.hydrograph: its columns are the keys of the hydrograph table. Errors name file,
/// line, column and what is allowed.
[[nodiscard]] Result<std::vector<params::InflowSample>> read_hydrograph(const params::InflowSpec& inflow);

/// Checks that it injects debris before the run ends. Errors begin with `at`.
[[nodiscard]] Status check_hydrograph(const terrain::Inflow& inflow, const params::SolverSpec& solver,
                                      const std::string& at);

/// Checks that the line has a length and lies on known ground. Errors begin with `at`.
[[nodiscard]] Status check_line(const terrain::Inflow& inflow, const terrain::Terrain& terrain, const std::string& at);

}  // namespace talus::scene
