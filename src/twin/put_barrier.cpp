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

constexpr std::size_t max_openings = 100;

/// Unchanged where the action has none.
Status read_openings(const json& action, const ActionContext& context, params::BarrierSpec& barrier) {
    if (!gives(action, "openings")) return {};
    const json& list = action["openings"];
    if (!list.is_array() || list.size() > max_openings) {
        return Error{fmt::format("openings = {}: must be a list of at most {}", shown(list), max_openings)};
    }
    params::SceneSpec read;
    TALUS_TRY(
        read_live_list(list, "openings", params::live_section("barrier_opening"), read, context.particle_spacing));
    barrier.openings = std::move(read.barrier_openings);
    return {};
}

}  // namespace

Result<terrain::Building> read_barrier(const json& action, const ActionContext& context,
                                       const terrain::Building* existing, const std::string& name) {
    TALUS_TRY(check_keys(action, live_keys("barrier"), {"action", "id", "name", "line", "openings"}));
    TALUS_ASSIGN(auto line, read_points(action, "line", false, 2, max_points));
    if (existing == nullptr && !line) return missing("line", "barrier");
    params::BarrierSpec barrier;
    if (existing != nullptr) barrier = *existing->barrier;
    if (line) barrier.line = std::move(*line);
    TALUS_TRY(read_values(action, barrier));
    TALUS_TRY(read_openings(action, context, barrier));
    TALUS_TRY(check_rules(barrier, context.scene.spec.solver, context.particle_spacing));
    return make_barrier(context.scene.terrain, name, barrier);
}

}  // namespace talus::twin
