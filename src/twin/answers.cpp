#include "twin/answers.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
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

json range_json(const params::Range& range) {
    return {{"low", number_or_null<json>(range.low)},
            {"high", number_or_null<json>(range.high)},
            {"low_included", range.low_included},
            {"high_included", range.high_included}};
}

/// The range of a value in this scene, regardless of the other values.
params::Range range_in(const scene::Scene& scene, const params::Parameter& parameter) {
    params::Range range = parameter.range;
    const double highest = std::floor(1e4 * scene::highest_viscosity(scene.spec.solver)) / 1e4;
    if (parameter.key == "viscosity" && highest < range.high) {
        range.high = highest;
        range.high_included = true;
    }
    return range;
}

/// Keys of the scene that others need, with their values.
json settings_json(const scene::Scene& scene) {
    json settings = json::object();
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

json live_parameters_json(const scene::Scene& scene, const sim::Model& model, const params::MaterialSpec& now) {
    json list = json::array();
    for (const params::Parameter* parameter : live_parameters()) {
        // A scene that gives the kinematic viscosity also determines this one, at its spacing.
        const double scene_viscosity =
            scene.spec.material.kinematic_viscosity && now.kinematic_viscosity ? model.viscosity : 0;
        list.push_back(
            {{"key", "material." + parameter->key},
             {"label", label_of(*parameter)},
             {"unit", parameter->unit},
             {"default", number_or_null<json>(value_in_force(scene.spec.material, *parameter, scene_viscosity))},
             {"range", range_json(range_in(scene, *parameter))},
             {"help", parameter->help},
             {"used_by_depth_averaged", parameter->use != params::KeyUse::particles},
             {"value", number_or_null<json>(value_in_force(now, *parameter, model.viscosity))}});
    }
    return list;
}

json flow_path_json(const scene::Scene& scene) {
    const terrain::FlowPath& path = scene.flow_path;
    if (path.empty()) return nullptr;
    json points = json::array(), chainages = json::array();
    double chainage = 0;
    const PlanPoint* before = nullptr;
    for (const PlanPoint& p : path.points()) {
        if (before != nullptr) chainage += std::hypot(p.x - before->x, p.y - before->y);
        points.push_back({p.x, p.y, number_or_null<json>(scene.terrain.elevation_at(p))});
        chainages.push_back(chainage);
        before = &p;
    }
    return {{"points", points},
            {"chainage_m", chainages},
            {"corridor_width_m", path.corridor_width()},
            {"traced", scene.flow_path_origin != scene::PathOrigin::file}};
}

std::pair<float, float> elevation_range(const terrain::Terrain& terrain) {
    float lowest = INFINITY, highest = -INFINITY;
    for (const float z : terrain.elevation().values) {
        if (z < lowest) lowest = z;
        if (z > highest) highest = z;
    }
    return {lowest, highest};
}

/// With every number that comes from a single-precision one as short as it is read back to that: 4.77, not
/// 4.769999980926514. For what is measured; values that somebody gave stay as they are.
json with_short_numbers(json measured) {
    if (measured.is_structured()) {
        for (json& child : measured) child = with_short_numbers(std::move(child));
    } else if (measured.is_number_float()) {
        const auto value = measured.get<double>();
        const auto single = static_cast<float>(value);
        if (static_cast<double>(single) != value) return measured;
        constexpr std::size_t noticeably = 4;  // digits; a coordinate such as 824347.8125 is left alone
        const std::string text = fmt::format("{}", single);
        if (text.size() + noticeably <= fmt::format("{}", value).size()) measured = std::strtod(text.c_str(), nullptr);
    }
    return measured;
}

const report::IntensityGuideline& guideline_of(const scene::Scene& scene) {
    return report::intensity_guideline(scene.spec.outputs.intensity_guideline);
}

/// The scene's guideline, as GET /api/scene has it.
json intensity_json(const report::IntensityGuideline& guideline) {
    json classes = json::array();
    for (const report::IntensityClass& c : guideline.classes) {
        classes.push_back({{"name", c.name}, {"colour", c.colour.hex()}, {"criterion", c.criterion}});
    }
    return {{"guideline", guideline.name},
            {"classes", classes},
            {"rule", guideline.name +
                         " of a building, by the peak depth h at its walls and the peak depth-averaged "
                         "speed v within a map cell of them. " +
                         guideline.remark},
            {"source", guideline.citation}};
}

json impact_json(const std::string& id, const observe::BuildingImpact& impact, bool barrier,
                 const report::IntensityGuideline& guideline) {
    const report::IntensityClass* intensity = guideline.class_of(impact);
    json row = {{"id", id},
                {"name", impact.name},
                {"hit", impact.hit},
                {"first_hit_s", number_or_null<json>(impact.first_hit_time)},
                {"peak_force_kN", impact.peak_force / 1e3},
                {"peak_impact_pressure_kPa", impact.peak_impact_pressure / 1e3},
                {"peak_depth_m", impact.peak_depth},
                {"peak_speed_mps", number_or_null<json>(impact.peak_speed)},
                {"peak_dynamic_pressure_kPa", number_or_null<json>(impact.peak_dynamic_pressure / 1e3)},
                {"impulse_kNs", impact.impulse / 1e3},
                {"failed_s", number_or_null<json>(impact.failure_time)},
                {"intensity", intensity != nullptr ? json(intensity->name) : json()}};
    if (barrier) {
        row["overtopped_m3"] = impact.overtopped_volume;
        row["first_overtopped_s"] = number_or_null<json>(impact.first_overtopping_time);
        row["passed_m3"] = impact.passed_volume;
        row["retained_m3"] = impact.retained_volume;
        row["peak_filling_height_m"] = impact.peak_filling_height;
    }
    return row;
}

}  // namespace

json scene_json(const Scenario& scenario) {
    const scene::Scene& scene = scenario.scene();
    const LiveRun& run = scenario.run();
    const sim::Model& model = run.model();
    const WorldPoint origin = run.ground().terrain.frame().origin;
    const Extent e = scene.terrain.elevation().geometry.extent();
    const auto [lowest, highest] = elevation_range(scene.terrain);
    const GridGeometry& map = run.observer().maps().geometry();
    const auto latitude = geo::latitude_deg(scene.crs, {0.5 * (e.x_min + e.x_max), 0.5 * (e.y_min + e.y_max)});
    return {{"title", scene.spec.scene.title},
            {"description", scene.spec.scene.description},
            {"reconstruction", scene.spec.scene.reconstruction},
            {"assumptions", scene.spec.scene.assumptions},
            {"sources", scene.spec.scene.sources},
            {"crs", scene.crs.epsg != 0 ? fmt::format("EPSG:{}", scene.crs.epsg) : scene.crs.name},
            {"crs_name", scene.crs.name},
            {"vertical_unit", scene.vertical_unit},
            {"latitude_deg", latitude ? json(*latitude) : json(nullptr)},
            {"origin", {origin.x, origin.y, origin.z}},
            {"extent_m", {e.x_min, e.y_min, e.x_max, e.y_max}},
            {"elevation_m", with_short_numbers({lowest, highest})},
            {"map",
             {{"x_min_m", map.x_min},
              {"y_min_m", map.y_min},
              {"cell_m", map.cell},
              {"columns", map.columns},
              {"rows", map.rows}}},
            {"orthophoto", !scene.spec.terrain.orthophoto.empty()},
            {"particle_spacing_m", model.particle_spacing},
            {"end_time_s", scene.spec.solver.end_time},
            {"gravity_mps2", model.gravity},
            {"flow_path", flow_path_json(scene)},
            {"table_sections", table_sections_json()},
            {"gauges", gauge_places(scene.gauges)},
            {"cross_sections", section_places(scene.cross_sections)},
            {"parameters", live_parameters_json(scene, model, run.setup().material)},
            {"settings", settings_json(scene)},
            {"intensity", intensity_json(guideline_of(scene))}};
}

namespace {

/// Largest speed of the run so far: of the recorded rows and now, so that it is the same whoever asks and when.
double peak_speed(const observe::Observer& observer, const sim::State& state) {
    double peak = state.max_speed;
    for (const observe::TimeSample& row : observer.timeseries()) peak = std::max(peak, row.largest_speed);
    return peak;
}

}  // namespace

json state_json(const Scenario& scenario, bool with_hash) {
    const LiveRun& run = scenario.run();
    const sim::State& state = run.state();
    const observe::TimeSample now = run.observer().sample(run.model(), state);
    const std::vector<observe::FrontSample> front = run.observer().front();
    // The front is moving while it reaches new chainages.
    constexpr double lately = 1;  // s
    const bool advances = !front.empty() && state.time - front.back().arrival_time <= lately;
    const std::vector<FramePtr>& frames = run.recording().frames();
    json answer = {{"status", phase_name(run.phase())},
                   {"message", scenario.message()},
                   {"time_s", state.time},
                   {"end_time_s", scenario.scene().spec.solver.end_time},
                   {"expected_end_s", number_or_null<json>(run.expected_end().value_or(observe::never))},
                   {"wall_remaining_s", number_or_null<json>(run.wall_remaining().value_or(observe::never))},
                   {"step", state.step},
                   {"particles", state.count},
                   {"pore_pressure", knows_pore_pressure(run.model())},
                   {"front_chainage_m", number_or_null<json>(now.front_chainage)},
                   {"front_velocity_mps", advances ? number_or_null<json>(front.back().front_velocity) : json()},
                   {"largest_speed_mps", number_or_null<json>(state.max_speed)},
                   {"peak_speed_mps", number_or_null<json>(peak_speed(run.observer(), state))},
                   {"mean_compression", number_or_null<json>(state.mean_compression)},
                   {"max_compression", number_or_null<json>(state.max_compression)},
                   {"overcompressed_share", number_or_null<json>(state.overcompressed_share)},
                   {"too_compressed", state.step == 0 ? json() : json(run.too_compressed())},
                   {"verdict", state.step == 0 ? json() : json(run::verdict_json(run.verdict()))},
                   {"recording",
                    {{"first_s", frames.empty() ? json() : json(frames.front()->time)},
                     {"last_s", frames.empty() ? json() : json(frames.back()->time)},
                     {"frames", frames.size()},
                     {"bytes", run.recording().bytes()}}}};
    for (const observe::NamedNumber& volume : observe::volume_numbers) {
        answer[std::string(volume.key)] = now.*volume.sample;
    }
    if (with_hash) answer["hash"] = to_hex(hash_state(state));
    return with_short_numbers(std::move(answer));
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
        changes.push_back({{"time_s", change.time}, {"by", change.by}, {"sentence", change.sentence}});
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
    json time = {{"time_s", column_json(rows, &observe::TimeSample::time)},
                 {"front_chainage_m", column_json(rows, &observe::TimeSample::front_chainage)},
                 {"kinetic_energy_J", column_json(rows, &observe::TimeSample::kinetic_energy)},
                 {"potential_energy_J", column_json(rows, &observe::TimeSample::potential_energy)},
                 {"largest_speed_mps", column_json(rows, &observe::TimeSample::largest_speed)},
                 {"mean_compression", column_json(rows, &observe::TimeSample::mean_compression)},
                 {"max_compression", column_json(rows, &observe::TimeSample::max_compression)},
                 {"overcompressed_share", column_json(rows, &observe::TimeSample::overcompressed_share)},
                 {"time_step_s", column_json(rows, &observe::TimeSample::time_step)}};
    for (const observe::NamedNumber& volume : observe::volume_numbers) {
        time[std::string(volume.key)] = column_json(rows, volume.sample);
    }
    const std::vector<observe::FrontSample> samples = observer.front();
    const json front = {{"chainage_m", column_json(samples, &observe::FrontSample::chainage)},
                        {"arrival_time_s", column_json(samples, &observe::FrontSample::arrival_time)},
                        {"front_velocity_mps", column_json(samples, &observe::FrontSample::front_velocity)},
                        {"particle_speed_mps", column_json(samples, &observe::FrontSample::particle_speed)}};
    return with_short_numbers({{"time", time}, {"front", front}, {"gauges", gauge_curves(observer.gauges())}});
}

json impacts_json(const Scenario& scenario, std::optional<double> time) {
    const LiveRun& run = scenario.run();
    const report::IntensityGuideline& guideline = guideline_of(scenario.scene());
    json buildings = json::array(), barriers = json::array(), removed = json::array();
    for (const BuildingSetup& building : run.setup().buildings) {
        buildings.push_back(impact_json(building.id, run.impact_on(building.id, time), false, guideline));
    }
    for (const BarrierSetup& barrier : run.setup().barriers) {
        barriers.push_back(impact_json(barrier.id, run.impact_on(barrier.id, time), true, guideline));
    }
    for (const LiveRun::Removed& gone : run.removed()) {
        json row = impact_json(gone.id, gone.impact, gone.barrier, guideline);
        row["kind"] = gone.barrier ? "barrier" : "building";
        row["removed_s"] = gone.impact.removed_time;
        removed.push_back(std::move(row));
    }
    return with_short_numbers({{"buildings", buildings}, {"barriers", barriers}, {"removed", removed}});
}

json journal_json(const Scenario& scenario) {
    return write_journal(journal_of(scenario));
}

json recording_json(const Scenario& scenario) {
    const Recording& recording = scenario.run().recording();
    json times = json::array();
    for (const FramePtr& frame : recording.frames()) times.push_back(frame->time);
    return {{"times_s", times}, {"bytes", recording.bytes()}};
}

}  // namespace talus::twin
