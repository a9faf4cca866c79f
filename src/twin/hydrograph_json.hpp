#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "params/spec.hpp"

namespace talus::twin {

/// A list of rows with the keys of the hydrograph table, as list_json writes it. Errors name row, key, value and what
/// is allowed of such an inflow.
[[nodiscard]] Result<std::vector<params::InflowSample>> read_hydrograph_rows(const nlohmann::json& list,
                                                                             const params::InflowSpec& inflow);

}  // namespace talus::twin
