#include "twin/results.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/hazard_maps.hpp"
#include "core/number_or_null.hpp"
#include "observe/erosion.hpp"
#include "products/page_files.hpp"
#include "products/products.hpp"
#include "products/results_json.hpp"
#include "report/results.hpp"
#include "run/run_scene.hpp"
#include "twin/gauges_json.hpp"
#include "twin/json_keys.hpp"
#include "twin/past_maps.hpp"
#include "twin/scenario_parts.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

Grid<float> present_layer(const observe::MapAccumulator& maps, const std::string& name) {
    if (name == "depth") {
        Grid<float> depth = maps.present().depth;
        for (float& value : depth.values) {
            if (value == 0) value = std::numeric_limits<float>::quiet_NaN();
        }
        return depth;
    }
    HazardMaps peaks = maps.maps();
    return std::move(peaks.*find_map(name)->grid);
}

Grid<float> erosion_layer(const GridGeometry& terrain, const std::vector<float>& eroded) {
    Grid<float> depth = observe::erosion_depth(terrain, eroded);
    if (!depth.values.empty()) return depth;
    return Grid<float>({terrain.x_min, terrain.y_min, terrain.cell, 1, 1}, std::numeric_limits<float>::quiet_NaN());
}

/// Notes that the tables of a plain run do not contain: removed obstacles.
std::vector<std::string> obstacle_notes(const LiveRun& run) {
    std::vector<std::string> notes;
    for (const LiveRun::Removed& gone : run.removed()) {
        notes.push_back(fmt::format("{} \"{}\": removed at {:.2f} s", gone.barrier ? "barrier" : "building",
                                    gone.body->name, gone.impact.removed_time));
    }
    return notes;
}

messages::ProbeSeries read_probe(const std::vector<FramePtr>& frames, const GridGeometry& map, const PlanPoint& p) {
    messages::ProbeSeries series{
        .time_s = {}, .depth_m = {}, .speed_mps = {}, .pressure_kPa = {}, .pore_pressure_ratio = {}};
    const double column = std::floor((p.x - map.x_min) / map.cell), row = std::floor((p.y - map.y_min) / map.cell);
    const bool on_map = column >= 0 && row >= 0 && column < map.columns && row < map.rows;
    for (const FramePtr& frame : frames) {
        const DebrisAt here =
            on_map ? debris_at(*frame, static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row))
                   : DebrisAt{};
        series.time_s.push_back(frame->time);
        series.depth_m.push_back(here.depth);
        series.speed_mps.push_back(here.speed);
        series.pressure_kPa.push_back(here.density * here.speed * here.speed / 1e3);
        series.pore_pressure_ratio.push_back(here.pore_pressure_ratio);
    }
    return series;
}

/// What was changed during the run, so that its files are the result of no single setup; empty: nothing.
std::string changed_text(const Scenario& scenario) {
    std::string text;
    for (const Scenario::Parts::ChangeOnTheWay& change : scenario.parts().changes) {
        text += fmt::format("{}{} at {:.1f} s", text.empty() ? "" : "; ", change.sentence, change.time);
    }
    return text;
}

}  // namespace

Result<std::function<Grid<float>()>> layer_of(const Scenario& scenario, const std::string& name,
                                              std::optional<double> time) {
    const std::vector<std::string_view> layer_names = run_layers();
    if (std::find(layer_names.begin(), layer_names.end(), name) == layer_names.end()) {
        return Error{fmt::format("layer = {}: must be one of {}", shown(json(name)), fmt::join(layer_names, ", "))};
    }
    const LiveRun& run = scenario.run();
    const observe::MapAccumulator& maps = run.observer().maps();
    std::vector<FramePtr> frames;
    if (time) frames = run.recording().until(*time);
    if (time && frames.empty()) return Error{fmt::format("nothing is recorded at or before time_s = {}", *time)};
    if (name == "erosion_depth") {
        const auto then = time ? std::optional(frames.back()->time) : std::nullopt;
        return std::function<Grid<float>()>([terrain = run.ground().terrain.elevation().geometry,
                                             eroded = run.eroded(then)] { return erosion_layer(terrain, eroded); });
    }
    if (name == pore_pressure_layer && !time) frames = {run.frame(1, 0)};
    if (frames.empty()) return std::function<Grid<float>()>([grid = present_layer(maps, name)] { return grid; });
    MapFrame frame{maps.geometry(), maps.thinnest_depth(), {}};
    const NamedMap* named = find_map(name);
    if (named != nullptr && named->kind == MapKind::arrival) frame.arrival_now = maps.maps().*named->grid;
    return std::function<Grid<float>()>(
        [name, frames = std::move(frames), frame = std::move(frame)] { return past_layer(name, frames, frame); });
}

std::function<messages::ProbeSeries()> probe_at(const Scenario& scenario, const PlanPoint& p) {
    const LiveRun& run = scenario.run();
    return [frames = run.recording().frames(), map = run.observer().maps().geometry(), p] {
        return read_probe(frames, map, p);
    };
}

std::pair<scene::Scene, run::RunResult> outcome_of(const Scenario& scenario) {
    const Scenario::Parts& p = scenario.parts();
    const LiveRun& run = scenario.run();
    // Beds and inflows of the start of the run, the rest of the current setup.
    Setup wanted = run.setup();
    wanted.beds = run.begun_with().beds;
    wanted.inflows = run.begun_with().inflows;
    scene::Scene told = scene_of(scenario.scene(), wanted);
    for (std::size_t k = 0; k < wanted.releases.size(); ++k) {
        told.releases[k].spec.start_time = run.start_time_of(wanted.releases[k].id);
    }
    for (const LiveRun::Removed& removed : run.removed()) told.buildings.push_back(*removed.body);
    for (std::string& note : obstacle_notes(run)) told.notes.push_back(std::move(note));
    for (const JournalEntry& entry : p.entries) {
        if (entry.step > 0) break;
        told.notes.push_back(fmt::format("before step 0, by {}: {}", entry.by, entry.action.dump()));
    }
    for (const Scenario::Parts::ChangeOnTheWay& change : p.changes) {
        told.notes.push_back(fmt::format("changed at {:.1f} s, by {}: {}", change.time, change.by, change.sentence));
    }
    run::RunResult result = run.result();
    run::take_followed_path(told, result);
    return {std::move(told), std::move(result)};
}

std::function<messages::Figures()> figures_of(const Scenario& scenario) {
    return [outcome = outcome_of(scenario)] {
        return messages::Figures{.figures = json::parse(report::key_figures(outcome.first, outcome.second).dump())};
    };
}

json results_json(const Scenario& scenario) {
    const auto [told, result] = outcome_of(scenario);
    // Paths are as the system has them.
    const report::Json all = report::run_results(told, result, {});
    return json::parse(all.dump(-1, ' ', false, report::Json::error_handler_t::replace));
}

json measures_json(const Scenario& scenario) {
    const run::RunResult result = outcome_of(scenario).second;
    const observe::RunOut& r = result.observation.run_out;
    json gauges = json::array();
    for (const observe::GaugeRecord& record : result.observation.gauges) {
        gauges.push_back({{"name", record.gauge.name},
                          {"x_m", record.gauge.at.x},
                          {"y_m", record.gauge.at.y},
                          {"time_s", column(record.rows, &observe::GaugeSample::time)},
                          {"depth_m", column(record.rows, &observe::GaugeSample::depth)},
                          {"speed_mps", column(record.rows, &observe::GaugeSample::speed)}});
    }
    json run_out = products::run_out_json(result.observation);
    run_out["toe_x_m"] = number_or_null<json>(r.toe.x);
    run_out["toe_y_m"] = number_or_null<json>(r.toe.y);
    return {{"run_out", std::move(run_out)}, {"gauges", std::move(gauges)}, {"crs_wkt", scenario.scene().crs.wkt}};
}

std::vector<RunFile> page_files_of(const Scenario& scenario) {
    if (scenario.step() == 0) return {};
    const auto outcome = std::make_shared<const std::pair<scene::Scene, run::RunResult>>(outcome_of(scenario));
    const auto& [scene, result] = *outcome;
    std::vector<products::PageFile> made = products::tables_of(result, changed_text(scenario));
    for (products::PageFile& map : products::plain_maps_of(scene, result)) made.push_back(std::move(map));
    std::vector<RunFile> files;
    files.reserve(made.size());
    for (products::PageFile& file : made) {
        files.push_back({std::move(file.name), std::move(file.type), std::move(file.what),
                         [outcome, bytes = std::move(file.bytes)] { return bytes(outcome->first, outcome->second); }});
    }
    return files;
}

std::function<Status(const std::filesystem::path&)> products_of(const Scenario& scenario) {
    return [outcome = outcome_of(scenario), changed = changed_text(scenario)](const std::filesystem::path& folder) {
        return products::write_products(outcome.first, outcome.second, folder, {}, changed);
    };
}

Version version_of(const Scenario& scenario) {
    return {scenario.step(), scenario.parts().revision, hash_state(scenario.run().state())};
}

}  // namespace talus::twin
