#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"
#include "terrain/inflow.hpp"
#include "terrain/terrain.hpp"

/// What inflows are made of, read and checked.
namespace talus {

struct HydrographKind {
    bool may_be_still = false;  ///< debris may come in without a velocity: over an area
    bool has_density = false;
};

/// What is wrong with a row, such as "time_s = 3 is refused; it must be above ..."; empty: nothing. `before`: the row
/// before it; nullptr: it is the first.
[[nodiscard]] std::string problem_with_row(const InflowSample& row, const InflowSample* before,
                                           const HydrographKind& kind);

/// Reads a CSV as inflow.hydrograph has it. Errors name file, line, column and what is allowed.
[[nodiscard]] Result<std::vector<InflowSample>> read_hydrograph(const std::string& file, bool may_be_still);

/// That the line has a length and lies on known ground. Errors begin with `at`.
[[nodiscard]] Status check_line(const Inflow& inflow, const Terrain& terrain, const std::string& at);

}  // namespace talus
