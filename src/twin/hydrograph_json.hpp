#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "terrain/inflow.hpp"

namespace talus::twin {

/// `[{"time_s", "discharge_m3ps", "velocity_mps", "density_kgpm3"}, ...]`; the density is null where there is none.
[[nodiscard]] nlohmann::json to_json(const std::vector<InflowSample>& hydrograph);

/// `may_be_still`: debris may come in without a velocity. Errors name row, key, value and what is allowed.
[[nodiscard]] Result<std::vector<InflowSample>> read_hydrograph_rows(const nlohmann::json& list, bool may_be_still);

}  // namespace talus::twin
