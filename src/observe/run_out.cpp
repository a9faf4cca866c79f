#include "observe/run_out.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "observe/front_tracker.hpp"
#include "observe/trail.hpp"

namespace talus::observe {
namespace {

/// Highest particle and centre of mass of the particles for which `counts` is true, in double and in sorted order.
template <class Counts>
ReleasedMass measure_mass(const sim::Ground& ground, const sim::State& state, const Counts& counts) {
    ReleasedMass mass;
    double n = 0;
    WorldPoint sum;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (!counts(i)) continue;
        const WorldPoint p = ground.terrain.frame().to_world(state.position.at(i));
        if (n == 0 || p.z > mass.crown.z) mass.crown = p;
        n += 1;
        sum = {sum.x + p.x, sum.y + p.y, sum.z + p.z};
    }
    if (n > 0) mass.centre = {sum.x / n, sum.y / n, sum.z / n};
    return mass;
}

PlanPoint plan(const WorldPoint& p) {
    return {p.x, p.y};
}

double plan_distance(const PlanPoint& a, const PlanPoint& b) {
    return std::hypot(a.x - b.x, a.y - b.y);
}

/// A place that debris reached.
struct Reach {
    double along_flow, straight;  ///< m from the crown
    WorldPoint at;
};

/// The farthest except for `beyond` of them, along the flow and in a straight line.
void set_distances(std::vector<Reach>& reached, std::size_t beyond, const WorldPoint& crown, RunOut& run_out) {
    const auto farthest = reached.begin() + static_cast<std::ptrdiff_t>(std::min(beyond, reached.size() - 1));
    std::nth_element(reached.begin(), farthest, reached.end(),
                     [](const Reach& a, const Reach& b) { return a.straight > b.straight; });
    run_out.straight = farthest->straight;
    std::nth_element(reached.begin(), farthest, reached.end(), [](const Reach& a, const Reach& b) {
        return std::pair(a.along_flow, a.at.z) > std::pair(b.along_flow, b.at.z);
    });
    run_out.along_flow = farthest->along_flow;
    run_out.crown = plan(crown);
    run_out.toe = plan(farthest->at);
    run_out.drop = crown.z - farthest->at.z;
    run_out.runout_angle = std::atan2(run_out.drop, run_out.along_flow);
}

}  // namespace

ReleasedMass measure_release(const sim::Ground& ground, const sim::State& state) {
    return measure_mass(ground, state, [](std::uint32_t) { return true; });
}

RunOut measure_run_out(const sim::Ground& ground, const sim::State& state, const Grid<float>& covered,
                       const ReleasedMass& released, double front_chainage) {
    RunOut run_out;
    run_out.front_chainage = front_chainage;
    const PlanPoint crown = plan(released.crown);
    const TrailDistances ways(covered, crown);
    const auto reach = [&](double along_flow, const WorldPoint& at) {
        const double straight = plan_distance(crown, plan(at));
        return Reach{std::max(along_flow, straight), straight, at};  // may be slightly less by rounding
    };

    const std::uint32_t front = front_particle_count(state);
    run_out.at_least = state.outflow >= front;
    std::vector<Reach> reached;
    bool lies = false;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (state.held[i] != 0) continue;
        lies = true;
        if (run_out.at_least) break;
        const WorldPoint p = ground.terrain.frame().to_world(state.position.at(i));
        reached.push_back(reach(ways.to(plan(p)), p));
    }
    if (run_out.at_least) {
        for (std::size_t k = 0; k < covered.values.size(); ++k) {
            if (std::isnan(ways.at(k))) continue;
            const auto columns = static_cast<std::size_t>(covered.geometry.columns);
            const PlanPoint p = covered.geometry.centre(static_cast<int>(k % columns), static_cast<int>(k / columns));
            const double ground_there = ground.terrain.elevation_at(p);
            // The cells that it left through may have their centres beyond the edge.
            if (!std::isnan(ground_there)) reached.push_back(reach(ways.at(k), {p.x, p.y, ground_there}));
        }
    }
    if (reached.empty()) return run_out;
    set_distances(reached, run_out.at_least ? 0 : front - 1, released.crown, run_out);

    if (!lies) return run_out;
    const ReleasedMass deposit = measure_mass(ground, state, [&](std::uint32_t i) { return state.held[i] == 0; });
    const double travelled = std::max(TrailDistances(covered, plan(released.centre)).to(plan(deposit.centre)),
                                      plan_distance(plan(released.centre), plan(deposit.centre)));
    run_out.travel_angle = std::atan2(released.centre.z - deposit.centre.z, travelled);
    return run_out;
}

}  // namespace talus::observe
