#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "terrain/barrier.hpp"
#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr std::size_t most_openings = 100;

/// As it is in the barrier, where the action has none.
Status read_openings(const json& action, const ActionContext& context, BarrierSpec& barrier) {
    if (!action.contains("openings") || action["openings"].is_null()) return {};
    const json& list = action["openings"];
    if (!list.is_array() || list.size() > most_openings) {
        return Error{fmt::format("openings = {}: must be a list of at most {}", shown(list), most_openings)};
    }
    barrier.openings.clear();
    for (std::size_t k = 0; k < list.size(); ++k) {
        const json& entry = list[k].is_object() ? list[k] : json::object();
        BarrierOpeningSpec opening;
        Status s = check_keys(entry, live_keys("barrier_opening"), {});
        if (s) s = read_values(entry, opening);
        if (s && !(entry.contains("position_m") && entry.contains("width_m"))) {
            s = Error{
                fmt::format("{}: must have position_m and width_m; sill_height_m may be left out", shown(list[k]))};
        }
        if (s) s = check_rules(opening, context.scene.spec.solver, context.particle_spacing);
        if (!s) return Error{fmt::format("openings[{}]: {}", k, s.error().message)};
        barrier.openings.push_back(std::move(opening));
    }
    return {};
}

}  // namespace

Result<Building> read_barrier(const json& action, const ActionContext& context, const Building* existing,
                              const std::string& name) {
    TALUS_TRY(check_keys(action, live_keys("barrier"), {"action", "id", "name", "line", "openings"}));
    TALUS_ASSIGN(auto line, read_points(action, "line", false, 2, most_points));
    if (existing == nullptr && !line) return missing("line", "barrier");
    BarrierSpec barrier;
    if (existing != nullptr) barrier = *existing->barrier;
    if (line) barrier.line = std::move(*line);
    Status s = read_values(action, barrier);
    if (s) s = read_openings(action, context, barrier);
    if (s) s = check_rules(barrier, context.scene.spec.solver, context.particle_spacing);
    if (!s) return s.error();
    return make_barrier(context.scene.terrain, name, barrier);
}

}  // namespace talus::twin
