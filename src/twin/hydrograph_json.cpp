#include "twin/hydrograph_json.hpp"

#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "scene/hydrograph.hpp"
#include "twin/json_keys.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {

Result<std::vector<InflowSample>> read_hydrograph_rows(const nlohmann::json& list, const InflowSpec& inflow) {
    if (!list.is_array() || list.size() < fewest_rows || list.size() > most_rows) {
        return Error{fmt::format("hydrograph = {}: must be a list of {} rows or more", shown(list), fewest_rows)};
    }
    SceneSpec read = scene_with(inflow);
    TALUS_TRY(read_live_list(list, "hydrograph", live_section("hydrograph"), read, 0));
    return std::move(read.hydrograph);
}

}  // namespace talus::twin
