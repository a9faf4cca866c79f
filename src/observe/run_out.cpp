#include "observe/run_out.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "observe/front_tracker.hpp"

namespace talus {
namespace {

/// Centre of mass and mean chainage of the particles that `counts`, in double and in sorted order.
template <class Counts>
ReleasedMass measure_mass(const Ground& ground, const State& state, const FlowPath& flow_path, const Counts& counts) {
    ReleasedMass mass;
    double n = 0, on_path = 0, chainage = 0;
    WorldPoint sum;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (!counts(i)) continue;
        const WorldPoint p = ground.terrain.frame().to_world(state.position.at(i));
        if (n == 0 || p.z > mass.crown.z) mass.crown = p;
        n += 1;
        sum = {sum.x + p.x, sum.y + p.y, sum.z + p.z};
        if (const auto at = flow_path.locate({p.x, p.y})) {
            on_path += 1;
            chainage += at->chainage;
        }
    }
    if (n > 0) mass.centre = {sum.x / n, sum.y / n, sum.z / n};
    if (on_path > 0) mass.mean_chainage = chainage / on_path;
    return mass;
}

double plan_distance(const WorldPoint& a, const WorldPoint& b) {
    return std::hypot(a.x - b.x, a.y - b.y);
}

}  // namespace

ReleasedMass measure_release(const Ground& ground, const State& state, const FlowPath& flow_path) {
    return measure_mass(ground, state, flow_path, [](std::uint32_t) { return true; });
}

RunOut measure_run_out(const Ground& ground, const State& state, const FlowPath& flow_path,
                       const ReleasedMass& released, double front_chainage) {
    RunOut run_out;
    run_out.front_chainage = front_chainage;

    const auto crown = flow_path.locate({released.crown.x, released.crown.y});
    std::vector<std::pair<double, std::uint32_t>> reach;  // distance from the crown, particle
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (state.held[i] != 0) continue;
        const WorldPoint p = ground.terrain.frame().to_world(state.position.at(i));
        if (!crown) {
            reach.emplace_back(plan_distance(p, released.crown), i);
        } else if (const auto at = flow_path.locate({p.x, p.y})) {
            reach.emplace_back(at->chainage - crown->chainage, i);
        }
    }
    if (reach.empty()) return run_out;

    const std::size_t n = std::min<std::size_t>(front_particle_count(state), reach.size()) - 1;
    const auto toe = reach.begin() + static_cast<std::ptrdiff_t>(n);
    std::nth_element(reach.begin(), toe, reach.end(), std::greater<>{});
    const WorldPoint toe_position = ground.terrain.frame().to_world(state.position.at(toe->second));
    run_out.horizontal_distance = toe->first;
    run_out.drop = released.crown.z - toe_position.z;
    run_out.runout_angle = std::atan2(run_out.drop, run_out.horizontal_distance);

    const ReleasedMass deposit =
        measure_mass(ground, state, flow_path, [&](std::uint32_t i) { return state.held[i] == 0; });
    double distance = deposit.mean_chainage - released.mean_chainage;
    if (std::isnan(distance)) distance = plan_distance(deposit.centre, released.centre);
    run_out.travel_angle = std::atan2(released.centre.z - deposit.centre.z, distance);
    return run_out;
}

}  // namespace talus
