#include "twin/hydrograph_json.hpp"

#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "scene/hydrograph.hpp"
#include "twin/json_keys.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {

Result<std::vector<params::InflowSample>> read_hydrograph_rows(const nlohmann::json& list,
                                                               const params::InflowSpec& inflow) {
    if (!list.is_array() || list.size() < scene::min_rows || list.size() > scene::max_rows) {
        return Error{fmt::format("hydrograph = {}: must be a list of {} rows or more", shown(list), scene::min_rows)};
    }
    params::SceneSpec read = scene_with(inflow);
    TALUS_TRY(read_live_list(list, "hydrograph", params::live_section("hydrograph"), read, 0));
    return std::move(read.hydrograph);
}

}  // namespace talus::twin
