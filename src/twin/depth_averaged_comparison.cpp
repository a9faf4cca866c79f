// A scenario beside the depth-averaged model of its setup.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "observe/number_names.hpp"
#include "report/number_text.hpp"
#include "run/second_opinion.hpp"
#include "twin/depth_averaged.hpp"
#include "twin/scenario_parts.hpp"
#include "twin/setup_file.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

/// What of a run had happened by a time, s.
observe::Observation until(observe::Observation whole, double time) {
    std::vector<observe::FrontSample>& front = whole.front;
    std::erase_if(front, [&](const observe::FrontSample& sample) { return !(sample.arrival_time <= time); });
    whole.run_out = {};
    for (const observe::FrontSample& sample : front) whole.run_out.front_chainage = sample.chainage;
    const HazardMaps& maps = whole.maps;
    for (std::size_t k = 0; k < maps.peak_depth.values.size(); ++k) {
        if (!(maps.arrival_time.values[k] <= time)) {
            whole.maps.peak_depth.values[k] = std::numeric_limits<float>::quiet_NaN();
        }
    }
    return whole;
}

/// The rows of a comparison.
class Rows {
  public:
    Rows(const observe::Observation& particles, const observe::Observation& then, const observe::Observation& whole)
        : particles_(particles), then_(then), whole_(whole) {}

    template <class Value>
    messages::DepthAveragedRow& add(const std::string& key, const std::string& name, const char* unit, int decimals,
                                    const Value& value) {
        return add(key, name, unit, decimals, value(particles_), value(then_), value(whole_));
    }
    messages::DepthAveragedRow& add(const std::string& key, const std::string& name, const char* unit, int decimals,
                                    double particles, double then, double whole) {
        rows_.push_back({.key = key,
                         .name = name,
                         .unit = unit,
                         .decimals = decimals,
                         .particles = particles,
                         .depth_averaged_by_then = then,
                         .depth_averaged = whole,
                         .observed = {}});
        return rows_.back();
    }
    [[nodiscard]] std::vector<messages::DepthAveragedRow> take() { return std::move(rows_); }

  private:
    const observe::Observation &particles_, &then_, &whole_;
    std::vector<messages::DepthAveragedRow> rows_;
};

messages::DepthAveragedComparison compared(const scene::Scene& scene, const run::RunResult& particles,
                                           const run::RunResult& whole, bool over,
                                           const std::vector<std::string>& differs) {
    run::RunResult then = whole;
    if (!over) then.observation = until(std::move(then.observation), particles.simulated_time);
    const run::AreaAgreement now = second_opinion(scene, particles, then).area;
    const run::AreaAgreement at_end = over ? now : second_opinion(scene, particles, whole).area;

    Rows rows(particles.observation, then.observation, whole.observation);
    std::vector<std::string> told;
    const auto once = [&](const std::string& what) {
        const bool first = std::find(told.begin(), told.end(), what) == told.end();
        if (first) told.push_back(what);
        return first;
    };
    for (const params::ObservationSpec& observed : scene.spec.observations) {
        const std::string at = fmt::format(" at {} m", report::plain(observed.chainage));
        if (once(observed.quantity() + at)) {
            rows.add(observed.key(), observed.quantity() + at, "m/s", 1,
                     [&](const auto& o) { return computed_for(observed, o); })
                .observed = observed.value();
        }
        if (once("Front arrival" + at)) {
            rows.add("front_arrival", "Front arrival" + at, "s", 1,
                     [&](const auto& o) { return front_at(o, observed.chainage).arrival_time; });
        }
    }
    for (const observe::NamedNumber* number : {&observe::front_number, &observe::run_out_number}) {
        rows.add(std::string(number->key), number->title, number->unit, number->decimals, number->value);
    }
    rows.add("affected_area", "Affected area", "m2", 0, now.both + now.only_first, now.both + now.only_second,
             at_end.both + at_end.only_second);
    // Maps of peaks are of whole runs.
    const observe::Peaks seen = observe::measure_peaks(particles.observation.maps),
                         at_last = observe::measure_peaks(whole.observation.maps);
    for (const observe::NamedPeak& peak : observe::peak_numbers) {
        const NamedMap& map = peak.map;
        const double value = peak.value(at_last);
        rows.add(std::string(map.key), map.title, map.unit, map.decimals, peak.value(seen),
                 over ? value : observe::never, value);
    }
    return {.time_s = particles.simulated_time,
            .over = over,
            .rows = rows.take(),
            .least_depth_m = scene.spec.outputs.arrival_depth,
            .area = {.both_m2 = now.both,
                     .particles_only_m2 = now.only_first,
                     .depth_averaged_only_m2 = now.only_second,
                     .intersection_over_union = now.intersection_over_union()},
            .differs = differs};
}

}  // namespace

std::string setup_key(const Scenario& scenario) {
    const LiveRun& run = scenario.run();
    json key = write_setup(run.setup());
    for (const char* beside : {"observations", "triggers", "alarms"}) key.erase(beside);
    key["starts"] = json::array();
    for (const ReleaseSetup& release : run.setup().releases) {
        key["starts"].push_back(number_or_null<json>(run.start_time_of(release.id)));
    }
    return key.dump();
}

std::function<Result<scene::Scene>()> scene_for_depth_averaged(const Scenario& scenario,
                                                               const DepthAveragedLimits& limits) {
    const LiveRun& run = scenario.run();
    std::vector<double> starts;
    for (const ReleaseSetup& release : run.setup().releases) starts.push_back(run.start_time_of(release.id));
    return [scene = scenario.parts().scene, setup = run.setup(), starts = std::move(starts),
            limits]() -> Result<scene::Scene> {
        scene::Scene now = scene_of(*scene, setup);
        for (std::size_t k = 0; k < starts.size(); ++k) now.releases[k].spec.start_time = starts[k];
        // What was changed here counts as given, so that what the model has no use for is named.
        for (const params::Parameter* parameter : live_parameters()) {
            params::SceneSpec before, after;
            before.material = scene->spec.material;
            after.material = setup.material;
            const bool changed =
                params::plain_text(parameter->get(before, 0)) != params::plain_text(parameter->get(after, 0));
            if (changed) now.given_keys.insert("material." + parameter->key);
        }
        return for_depth_averaged(std::move(now), limits);
    };
}

std::function<json()> comparison_with(const Scenario& scenario, std::shared_ptr<const DepthAveragedRun> other) {
    const LiveRun& run = scenario.run();
    run::RunResult particles = run.result();
    // Along the scene's path, as those of the other model: a result may have followed the debris.
    particles.observation.front = run.observer().front();
    particles.observation.run_out.front_chainage = run.observer().front_chainage();
    const bool over = run.phase() == run::RunPhase::at_rest || run.phase() == run::RunPhase::ended;
    std::vector<std::string> differs;
    if (!scenario.parts().changes.empty()) {
        differs.emplace_back(
            "The particles' setup was changed on the way; the depth-averaged model has the present one from its "
            "start.");
    }
    if (!begin_alike(run.setup(), run.begun_with())) {
        differs.emplace_back(
            "Beds, inflows or gauges were changed: the depth-averaged model has them already, the particles after a "
            "restart.");
    }
    return [scene = scenario.parts().scene, particles = std::move(particles), other = std::move(other), over,
            differs = std::move(differs)] { return compared(*scene, particles, other->result, over, differs); };
}

}  // namespace talus::twin
