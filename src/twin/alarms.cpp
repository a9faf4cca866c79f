#include "twin/alarms.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "sim/simulation.hpp"
#include "twin/live_run.hpp"

namespace talus::twin {
namespace {

constexpr double look_interval = 0.1;  // s of simulated time between two looks
constexpr double lately = 1;           // s, a front that reached nothing new for so long does not advance

/// The ids of structures by name.
std::map<std::string, std::string> ids_of(const Setup& setup) {
    std::map<std::string, std::string> ids;
    for (const BuildingSetup& building : setup.buildings) ids.emplace(building.body->name, building.id);
    for (const BarrierSetup& barrier : setup.barriers) ids.emplace(barrier.body->name, barrier.id);
    return ids;
}

/// As it is now in the setup; nullptr: it was removed.
const terrain::Building* obstacle_in(const Setup& setup, const std::string& id) {
    if (const BuildingSetup* building = find_id(setup.buildings, id)) return building->body.get();
    if (const BarrierSetup* barrier = find_id(setup.barriers, id)) return barrier->body.get();
    return nullptr;
}

/// m, at a place of the map.
double depth_at(const observe::MapAccumulator& maps, const PlanPoint& p) {
    const GridGeometry& map = maps.geometry();
    const auto present = maps.present();
    const int column = static_cast<int>(std::floor((p.x - map.x_min) / map.cell)) - present.first_column;
    const int row = static_cast<int>(std::floor((p.y - map.y_min) / map.cell)) - present.first_row;
    const GridGeometry& window = present.depth.geometry;
    if (column < 0 || row < 0 || column >= window.columns || row >= window.rows) return 0;
    return static_cast<double>(present.depth.at(column, row));
}

}  // namespace

AlarmWatch::AlarmWatch(const scene::Scene& scene) {
    NextNumbers next;
    scene_ids_ = ids_of(setup_of(scene, next));
}

void AlarmWatch::watch(const Setup& setup) {
    const std::map<std::string, std::string> ids = ids_of(setup);
    // A structure of the scene that has another name in the setup keeps its alarms.
    const auto id_of = [&](const std::string& structure) {
        const auto now = ids.find(structure);
        if (now != ids.end()) return now->second;
        const auto then = scene_ids_.find(structure);
        return then != scene_ids_.end() ? then->second : std::string();
    };
    std::vector<Rule> rules;
    for (const TableSetup& alarm : setup.alarms) {
        Rule* before = find_id(rules_, alarm.id);
        // A rule that has been taken over already has no body any more.
        if (before != nullptr && before->body && *before->body == *alarm.body) {
            rules.push_back(std::move(*before));
            continue;
        }
        params::SceneSpec spec;
        put_entries(spec, TableKind::alarm, {*alarm.body});
        const std::string obstacle = id_of(spec.alarms.front().structure);
        rules.push_back({alarm.id, alarm.body, std::move(spec.alarms.front()), obstacle});
    }
    rules_ = std::move(rules);
    waiting_ = static_cast<std::size_t>(
        std::count_if(rules_.begin(), rules_.end(), [](const Rule& rule) { return !rule.raised; }));
}

AlarmWatch::Front AlarmWatch::front_of(const LiveRun& run) {
    Front front{run.observer().front_chainage(), {}};
    const std::vector<observe::FrontSample> samples = run.observer().front();
    if (samples.empty() || run.summary().time - samples.back().arrival_time > lately) return front;
    if (const double velocity = samples.back().front_velocity; velocity > 0) front.velocity = velocity;
    return front;
}

std::optional<AlarmWatch::Finding> AlarmWatch::approach(const Rule& rule, const LiveRun& run, const Front& front) {
    const params::AlarmSpec& spec = rule.spec;
    std::optional<double> place = spec.chainage;
    std::string name = place ? fmt::format("chainage {:.6g} m", *place) : "";
    if (!spec.structure.empty()) {
        const terrain::Building* obstacle = obstacle_in(run.setup(), rule.obstacle);
        if (obstacle == nullptr) return {};
        place = first_chainage(run.observer().flow_path(), obstacle->footprint);
        name = obstacle->name;
    }
    if (!place || std::isnan(front.chainage)) return {};
    const double distance = std::max(0.0, *place - front.chainage);
    std::optional<double> wait;
    if (distance == 0) wait = 0;
    if (distance > 0 && front.velocity) wait = distance / *front.velocity;
    const bool met = spec.distance ? distance <= *spec.distance : wait && *wait <= *spec.lead_time;
    if (!met) return {};
    Finding found;
    if (wait) found.expected = run.summary().time + *wait;
    found.sentence = distance > 0
                         ? fmt::format("front at chainage {:.0f} m, {:.0f} m before {}", front.chainage, distance, name)
                         : fmt::format("front at {}", name);
    if (distance > 0 && front.velocity) found.sentence += fmt::format(", at {:.1f} m/s", *front.velocity);
    return found;
}

std::optional<AlarmWatch::Finding> AlarmWatch::load(const Rule& rule, const LiveRun& run) {
    const params::AlarmSpec& spec = rule.spec;
    const observe::BuildingImpact* measured = run.measured_on(rule.obstacle);
    if (measured == nullptr) return {};
    if (spec.depth && measured->peak_depth >= *spec.depth) {
        return Finding{fmt::format("debris {:.2f} m deep in front of {}", measured->peak_depth, measured->name),
                       run.summary().time};
    }
    const bool impact = spec.impact_pressure.has_value();
    const bool reached = !spec.depth && (impact ? measured->peak_impact_pressure >= *spec.impact_pressure
                                                : measured->peak_dynamic_pressure >= *spec.dynamic_pressure);
    if (!reached) return {};
    return Finding{
        fmt::format("{} pressure {:.1f} kPa on {}", impact ? "impact" : "dynamic",
                    (impact ? measured->peak_impact_pressure : measured->peak_dynamic_pressure) / 1000, measured->name),
        run.summary().time};
}

std::optional<AlarmWatch::Finding> AlarmWatch::find(const Rule& rule, const LiveRun& run) {
    const params::AlarmSpec& spec = rule.spec;
    if (spec.distance || spec.lead_time) return approach(rule, run, front_of(run));
    if (!spec.structure.empty()) return load(rule, run);
    const double depth = depth_at(run.observer().maps(), {*spec.x, *spec.y});
    if (depth < *spec.depth) return {};
    return Finding{fmt::format("debris {:.2f} m deep at ({:.1f}, {:.1f})", depth, *spec.x, *spec.y),
                   run.summary().time};
}

void AlarmWatch::check(const LiveRun& run) {
    const sim::State& state = run.state();
    if (waiting_ == 0 || state.time < next_look_) return;
    next_look_ = (std::floor(state.time / look_interval) + 1) * look_interval;
    for (Rule& rule : rules_) {
        if (rule.raised) continue;
        const std::optional<Finding> found = find(rule, run);
        if (!found) continue;
        rule.raised = true;
        --waiting_;
        raised_.push_back({rule.spec.name, found->sentence, rule.spec.message, state.time, found->expected, state.step,
                           hash_state(state)});
    }
}

}  // namespace talus::twin
