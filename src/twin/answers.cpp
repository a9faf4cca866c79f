#include "twin/answers.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "core/hash.hpp"
#include "core/number_or_null.hpp"
#include "geo/latitude.hpp"
#include "observe/number_names.hpp"
#include "report/intensity.hpp"
#include "run/verdict.hpp"
#include "scene/viscosity_limit.hpp"
#include "twin/gauges_json.hpp"
#include "twin/journal.hpp"
#include "twin/kinds.hpp"
#include "twin/pore_pressure_map.hpp"
#include "twin/scenario_parts.hpp"
#include "twin/table_entry.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

const char* phase_name(run::RunPhase phase) {
    switch (phase) {
        case run::RunPhase::ready:
            return "ready";
        case run::RunPhase::at_rest:
            return "at_rest";
        case run::RunPhase::ended:
            return "ended";
        case run::RunPhase::fault:
            return "fault";
    }
    return "";
}

/// Keys of the scene that others need, with their values.
std::map<std::string, std::string> settings_of(const scene::Scene& scene) {
    std::map<std::string, std::string> settings;
    for (const params::Section& section : params::live_sections()) {
        for (const params::Parameter& parameter : section.parameters) {
            if (parameter.live.empty() || !parameter.need) continue;
            const std::string& path = parameter.need->key;
            const std::size_t dot = path.find('.');
            settings[path] =
                params::plain_text(params::parameter_of(path.substr(0, dot), path.substr(dot + 1)).get(scene.spec, 0));
        }
    }
    return settings;
}

std::vector<messages::Parameter> parameters_of(const scene::Scene& scene, const sim::Model& model,
                                               const params::MaterialSpec& now) {
    std::vector<messages::Parameter> list;
    list.reserve(live_parameters().size());
    // A scene that gives the kinematic viscosity also determines this one, at its spacing.
    const double scene_viscosity =
        scene.spec.material.kinematic_viscosity && now.kinematic_viscosity ? model.viscosity : 0;
    // In this scene, regardless of the other values.
    const double highest = std::floor(1e4 * scene::highest_viscosity(scene.spec.solver)) / 1e4;
    for (const params::Parameter* parameter : live_parameters()) {
        messages::Parameter& row = list.emplace_back(described(*parameter, "material." + parameter->key));
        row.default_ = value_in_force(scene.spec.material, *parameter, scene_viscosity);
        row.value = value_in_force(now, *parameter, model.viscosity);
        if (parameter->key == "viscosity" && highest < parameter->range.high) {
            row.range.high = highest;
            row.range.high_included = true;
        }
    }
    return list;
}

std::optional<messages::FlowPath> flow_path_of(const scene::Scene& scene) {
    const terrain::FlowPath& path = scene.flow_path;
    if (path.empty()) return {};
    messages::FlowPath told{.points = {},
                            .chainage_m = {},
                            .corridor_width_m = path.corridor_width(),
                            .traced = scene.flow_path_origin != scene::PathOrigin::file};
    double chainage = 0;
    const PlanPoint* before = nullptr;
    for (const PlanPoint& p : path.points()) {
        if (before != nullptr) chainage += std::hypot(p.x - before->x, p.y - before->y);
        told.points.push_back({p.x, p.y, scene.terrain.elevation_at(p)});
        told.chainage_m.push_back(chainage);
        before = &p;
    }
    return told;
}

std::pair<float, float> elevation_range(const terrain::Terrain& terrain) {
    float lowest = INFINITY, highest = -INFINITY;
    for (const float z : terrain.elevation().values) {
        if (z < lowest) lowest = z;
        if (z > highest) highest = z;
    }
    return {lowest, highest};
}

/// A number that comes from a single-precision one as short as it is read back to that: 4.77, not 4.769999980926514.
double short_number(double value) {
    const auto single = static_cast<float>(value);
    if (static_cast<double>(single) != value) return value;
    constexpr std::size_t noticeably = 4;  // digits; a coordinate such as 824347.8125 is left alone
    const std::string text = fmt::format("{}", single);
    return text.size() + noticeably <= fmt::format("{}", value).size() ? std::strtod(text.c_str(), nullptr) : value;
}

const report::IntensityGuideline& guideline_of(const scene::Scene& scene) {
    return report::intensity_guideline(scene.spec.outputs.intensity_guideline);
}

messages::IntensityGuideline intensity_of(const report::IntensityGuideline& guideline) {
    std::vector<messages::IntensityClass> classes;
    classes.reserve(guideline.classes.size());
    for (const report::IntensityClass& c : guideline.classes) {
        classes.push_back({.category = {.name = c.name, .colour = c.colour.hex()}, .criterion = c.criterion});
    }
    return {.guideline = guideline.name,
            .classes = std::move(classes),
            .rule = guideline.name +
                    " of a building, by the peak depth h at its walls and the peak depth-averaged "
                    "speed v within a map cell of them. " +
                    guideline.remark,
            .source = guideline.citation};
}

messages::Impact impact_of(const std::string& id, const observe::BuildingImpact& impact,
                           const report::IntensityGuideline& guideline) {
    const report::IntensityClass* intensity = guideline.class_of(impact);
    return {.id = id,
            .name = impact.name,
            .hit = impact.hit,
            .first_hit_s = impact.first_hit_time,
            .peak_force_kN = impact.peak_force / 1e3,
            .peak_impact_pressure_kPa = impact.peak_impact_pressure / 1e3,
            .peak_depth_m = impact.peak_depth,
            .peak_speed_mps = impact.peak_speed,
            .peak_dynamic_pressure_kPa = impact.peak_dynamic_pressure / 1e3,
            .impulse_kNs = impact.impulse / 1e3,
            .failed_s = impact.failure_time,
            .intensity = intensity != nullptr ? std::optional(intensity->name) : std::nullopt};
}

messages::BarrierImpact barrier_impact_of(const std::string& id, const observe::BuildingImpact& impact,
                                          const report::IntensityGuideline& guideline) {
    return {.impact = impact_of(id, impact, guideline),
            .overtopped_m3 = impact.overtopped_volume,
            .first_overtopped_s = impact.first_overtopping_time,
            .passed_m3 = impact.passed_volume,
            .retained_m3 = impact.retained_volume,
            .peak_filling_height_m = impact.peak_filling_height};
}

messages::RemovedImpact removed_impact_of(const LiveRun::Removed& gone, const report::IntensityGuideline& guideline) {
    messages::BarrierImpact until = barrier_impact_of(gone.id, gone.impact, guideline);
    messages::RemovedImpact row{.impact = std::move(until.impact),
                                .kind = gone.barrier ? "barrier" : "building",
                                .removed_s = gone.impact.removed_time};
    if (!gone.barrier) return row;
    row.overtopped_m3 = until.overtopped_m3;
    row.first_overtopped_s = until.first_overtopped_s;
    row.passed_m3 = until.passed_m3;
    row.retained_m3 = until.retained_m3;
    row.peak_filling_height_m = until.peak_filling_height_m;
    return row;
}

}  // namespace

json with_short_numbers(json measured) {
    if (measured.is_structured()) {
        for (json& child : measured) child = with_short_numbers(std::move(child));
    } else if (measured.is_number_float()) {
        measured = short_number(measured.get<double>());
    }
    return measured;
}

messages::Parameter described(const params::Parameter& parameter, std::string key) {
    const params::Range& range = parameter.range;
    return {.key = std::move(key),
            .label = label_of(parameter),
            .unit = parameter.unit,
            .default_ = {},
            .value = {},
            .range = {.low = range.low,
                      .high = range.high,
                      .low_included = range.low_included,
                      .high_included = range.high_included},
            .help = parameter.help,
            .used_by_depth_averaged = parameter.use != params::KeyUse::particles};
}

json scene_json(const Scenario& scenario) {
    const scene::Scene& scene = scenario.scene();
    const LiveRun& run = scenario.run();
    const sim::Model& model = run.model();
    const WorldPoint origin = run.ground().terrain.frame().origin;
    const Extent e = scene.terrain.elevation().geometry.extent();
    const auto [lowest, highest] = elevation_range(scene.terrain);
    const GridGeometry& map = run.observer().maps().geometry();
    return messages::SceneInfo{
        .title = scene.spec.scene.title,
        .description = scene.spec.scene.description,
        .reconstruction = scene.spec.scene.reconstruction,
        .assumptions = scene.spec.scene.assumptions,
        .sources = scene.spec.scene.sources,
        .crs = scene.crs.epsg != 0 ? fmt::format("EPSG:{}", scene.crs.epsg) : scene.crs.name,
        .crs_name = scene.crs.name,
        .vertical_unit = scene.vertical_unit,
        .latitude_deg = geo::latitude_deg(scene.crs, {0.5 * (e.x_min + e.x_max), 0.5 * (e.y_min + e.y_max)}),
        .origin = {origin.x, origin.y, origin.z},
        .extent_m = {e.x_min, e.y_min, e.x_max, e.y_max},
        .elevation_m = {short_number(lowest), short_number(highest)},
        .map =
            {.x_min_m = map.x_min, .y_min_m = map.y_min, .cell_m = map.cell, .columns = map.columns, .rows = map.rows},
        .orthophoto = !scene.spec.terrain.orthophoto.empty(),
        .particle_spacing_m = model.particle_spacing,
        .end_time_s = scene.spec.solver.end_time,
        .gravity_mps2 = model.gravity,
        .flow_path = flow_path_of(scene),
        .table_sections = table_sections(),
        .gauges = gauge_places(scene.gauges),
        .cross_sections = section_places(scene.cross_sections),
        .parameters = parameters_of(scene, model, run.setup().material),
        .settings = settings_of(scene),
        .intensity = intensity_of(guideline_of(scene))};
}

namespace {

/// Largest speed of the run so far: of the recorded rows and now, so that it is the same whoever asks and when.
double peak_speed(const observe::Observer& observer, const sim::State& state) {
    double peak = state.max_speed;
    for (const observe::TimeSample& row : observer.timeseries()) peak = std::max(peak, row.largest_speed);
    return peak;
}

}  // namespace

messages::RunState state_of(const Scenario& scenario, bool with_hash) {
    const LiveRun& run = scenario.run();
    const sim::State& state = run.state();
    const observe::TimeSample now = run.observer().sample(run.model(), state);
    const std::vector<observe::FrontSample> front = run.observer().front();
    // The front is moving while it reaches new chainages.
    constexpr double lately = 1;  // s
    const bool advances = !front.empty() && state.time - front.back().arrival_time <= lately;
    const std::vector<FramePtr>& frames = run.recording().frames();
    return {.status = phase_name(run.phase()),
            .message = scenario.message(),
            .time_s = state.time,
            .end_time_s = scenario.scene().spec.solver.end_time,
            .expected_end_s = run.expected_end(),
            .wall_remaining_s = run.wall_remaining(),
            .step = state.step,
            .particles = state.count,
            .volume_released_m3 = now.volume_released,
            .volume_entrained_m3 = now.volume_entrained,
            .pore_pressure = knows_pore_pressure(run.model()),
            .volume_held_m3 = now.volume_held,
            .volume_moving_m3 = now.volume_moving,
            .volume_deposited_m3 = now.volume_deposited,
            .volume_left_m3 = now.volume_left,
            .front_chainage_m = now.front_chainage,
            .front_velocity_mps = advances ? front.back().front_velocity : observe::never,
            .largest_speed_mps = state.max_speed,
            .peak_speed_mps = peak_speed(run.observer(), state),
            .mean_compression = state.mean_compression,
            .max_compression = state.max_compression,
            .overcompressed_share = state.overcompressed_share,
            .too_compressed = state.step == 0 ? std::nullopt : std::optional(run.too_compressed()),
            .verdict = state.step == 0 ? json() : json(run::verdict_json(run.verdict())),
            .recording = {.first_s = frames.empty() ? std::nullopt : std::optional(frames.front()->time),
                          .last_s = frames.empty() ? std::nullopt : std::optional(frames.back()->time),
                          .frames = frames.size(),
                          .bytes = run.recording().bytes()},
            .hash = with_hash ? std::optional(to_hex(hash_state(state))) : std::nullopt};
}

json state_json(const Scenario& scenario) {
    return with_short_numbers(state_of(scenario));
}

json verdict_json(const Scenario& scenario) {
    return run::verdict_json(scenario.run().verdict_now());
}

json setup_json(const Scenario& scenario) {
    const Scenario::Parts& p = scenario.parts();
    const Setup& setup = p.setup();
    const Setup& begun_with = p.run->begun_with();
    json parameters = json::object(), changes = json::array();
    for (const params::Parameter* parameter : live_parameters()) {
        parameters["material." + parameter->key] =
            number_or_null<json>(value_in_force(setup.material, *parameter, p.run->model().viscosity));
    }
    for (const Scenario::Parts::ChangeOnTheWay& change : p.changes) {
        changes.push_back(
            messages::ChangeOnTheWay{.time_s = change.time, .by = change.by, .sentence = change.sentence});
    }
    json answer = {{"revision", p.revision},
                   {"changes", changes},
                   {"parameters", parameters},
                   {"pending_restart", !begin_alike(setup, begun_with)},
                   {"undo", p.undo.empty() ? json() : json(p.undo.back().sentence)},
                   {"redo", p.redo.empty() ? json() : json(p.redo.back().sentence)}};
    ZoneBlocks blocks;
    Shown shown{*p.run, p.scene->terrain.elevation().geometry, p.zone_blocks, blocks};
    for_each_kind([&]<class Kind>(Kind) {
        json& list = answer[Kind::list] = json::array();
        for (const auto& entry : setup.*Kind::entries) {
            json row = Kind::body(*entry.body);
            row.update(Kind::more(entry, shown));
            row["id"] = entry.id;
            if (Kind::origin != Origin::none) row["from_scene"] = entry.scene_index >= 0;
            if constexpr (Kind::from_time_0) {
                const auto* begun = find_id(begun_with.*Kind::entries, entry.id);
                row["in_force"] = begun != nullptr && same_shape(begun->body, entry.body);
            }
            list.push_back(std::move(row));
        }
    });
    p.zone_blocks = std::move(blocks);
    return answer;
}

json series_json(const Scenario& scenario) {
    const observe::Observer& observer = scenario.run().observer();
    const std::vector<observe::TimeSample>& rows = observer.timeseries();
    const std::vector<observe::FrontSample> samples = observer.front();
    messages::Series series{.time = {{"time_s", column(rows, &observe::TimeSample::time)},
                                     {"front_chainage_m", column(rows, &observe::TimeSample::front_chainage)},
                                     {"kinetic_energy_J", column(rows, &observe::TimeSample::kinetic_energy)},
                                     {"potential_energy_J", column(rows, &observe::TimeSample::potential_energy)},
                                     {"largest_speed_mps", column(rows, &observe::TimeSample::largest_speed)},
                                     {"mean_compression", column(rows, &observe::TimeSample::mean_compression)},
                                     {"max_compression", column(rows, &observe::TimeSample::max_compression)},
                                     {"overcompressed_share", column(rows, &observe::TimeSample::overcompressed_share)},
                                     {"time_step_s", column(rows, &observe::TimeSample::time_step)}},
                            .front = {.chainage_m = column(samples, &observe::FrontSample::chainage),
                                      .arrival_time_s = column(samples, &observe::FrontSample::arrival_time),
                                      .front_velocity_mps = column(samples, &observe::FrontSample::front_velocity),
                                      .particle_speed_mps = column(samples, &observe::FrontSample::particle_speed)},
                            .gauges = gauge_curves(observer.gauges())};
    for (const observe::NamedNumber& volume : observe::volume_numbers) {
        series.time[std::string(volume.key)] = column(rows, volume.sample);
    }
    return with_short_numbers(series);
}

json impacts_json(const Scenario& scenario, std::optional<double> time) {
    const LiveRun& run = scenario.run();
    const report::IntensityGuideline& guideline = guideline_of(scenario.scene());
    messages::Impacts all{.buildings = {}, .barriers = {}, .removed = {}};
    for (const BuildingSetup& building : run.setup().buildings) {
        all.buildings.push_back(impact_of(building.id, run.impact_on(building.id, time), guideline));
    }
    for (const BarrierSetup& barrier : run.setup().barriers) {
        all.barriers.push_back(barrier_impact_of(barrier.id, run.impact_on(barrier.id, time), guideline));
    }
    for (const LiveRun::Removed& gone : run.removed()) all.removed.push_back(removed_impact_of(gone, guideline));
    return with_short_numbers(all);
}

json journal_json(const Scenario& scenario) {
    return write_journal(journal_of(scenario));
}

json recording_json(const Scenario& scenario) {
    const Recording& recording = scenario.run().recording();
    messages::Recording told{.times_s = {}, .bytes = recording.bytes()};
    told.times_s.reserve(recording.frames().size());
    for (const FramePtr& frame : recording.frames()) told.times_s.push_back(frame->time);
    return told;
}

}  // namespace talus::twin
