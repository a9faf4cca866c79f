#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/version.h>

#include "core/angle.hpp"
#include "core/hash.hpp"
#include "core/phases.hpp"
#include "geo/versions.hpp"
#include "observe/number_names.hpp"
#include "params/fields.hpp"
#include "products/results_json.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"
#include "report/hardware.hpp"
#include "report/hazard_map.hpp"
#include "run/verdict.hpp"
#include "sim/backend_choice.hpp"
#include "sim/device/card.hpp"

namespace talus::products {

namespace {

using Json = nlohmann::ordered_json;

struct ToJson {
    Json operator()(std::monostate) const { return nullptr; }
    Json operator()(const Extent& e) const { return {e.x_min, e.y_min, e.x_max, e.y_max}; }
    Json operator()(const std::vector<PlanPoint>& points) const {
        Json list = Json::array();
        for (const PlanPoint& p : points) list.push_back({p.x, p.y});
        return list;
    }
    template <class T>
    Json operator()(const T& value) const {
        return value;
    }
};

/// As in the scene file: a table per section, a list of tables where it repeats.
Json parameters(const params::SceneSpec& spec) {
    Json all = Json::object();
    for (const params::Section& section : params::scene_sections())
        all[section.name] = section.repeats ? Json::array() : Json::object();
    for_each_value(spec, [&](const params::Section& section, std::size_t index, const params::Parameter& parameter,
                             const params::ParameterValue& value) {
        Json& table = section.repeats ? all[section.name][index] : all[section.name];
        table[parameter.key] = std::visit(ToJson{}, value);
    });
    return all;
}

/// Values that the program chose where the scene does not set them.
/// Null where the processor moved the particles.
Json graphics_card(const run::RunResult& result) {
    if (result.backend != sim::backend_name(params::BackendChoice::cuda)) return nullptr;
    const Result<sim::device::Card>& card = sim::device::card();
    return {{"name", card->name}, {"driver", card->driver}};
}

Json resolved(const scene::Scene& scene, const run::RunResult& result) {
    Json releases = Json::array();
    for (const terrain::Release& release : scene.releases) {
        releases.push_back(
            {{"name", release.name}, {"start_time_s", release.spec.start_time}, {"volume_m3", release.volume}});
    }
    Json inflows = Json::array();
    for (const terrain::Inflow& inflow : scene.inflows) {
        inflows.push_back({{"name", inflow.name},
                           {"volume_m3", inflow.volume()},
                           {"volume_by_the_end_m3", inflow.volume_until(result.simulated_time)}});
        if (inflow.has_density()) inflows.back()["mass_kg"] = inflow.mass_until(inflow.hydrograph.back().time);
    }
    const bool flat = result.depth_averaged();
    const auto of_particles = [&](auto value) { return flat ? Json() : Json(value); };
    return {{"model", flat ? "depth_averaged" : "particles"},
            {"grid_cell_m", flat ? Json(result.grid_cell) : Json()},
            {"particle_spacing_m", of_particles(result.particle_spacing)},
            {"support_radius_m", of_particles(result.support_radius)},
            {"particle_count", of_particles(result.particles)},
            {"viscosity", of_particles(result.viscosity)},
            {"kinematic_viscosity_m2ps", of_particles(result.kinematic_viscosity)},
            {"map_cell_m", result.map_cell},
            {"smallest_time_step_s", result.smallest_time_step},
            {"largest_time_step_s", result.largest_time_step},
            {"thread_count", result.thread_count},
            {"backend", result.backend},
            {"instruction_set", result.instruction_set},
            {"graphics_card", graphics_card(result)},
            {"flow_path", scene.flow_path.empty() ? "none" : origin_text(scene.flow_path_origin)},
            {"flow_path_length_m", scene.flow_path.length()},
            {"releases", releases},
            {"inflows", inflows}};
}

Json terrain(const scene::Scene& scene) {
    const GridGeometry& g = scene.terrain.elevation().geometry;
    const WorldPoint origin = scene.terrain.frame().origin;
    return {{"crs", scene.crs.label()},
            {"crs_wkt", scene.crs.wkt},
            {"vertical_unit", scene.vertical_unit},
            {"columns", g.columns},
            {"rows", g.rows},
            {"cell_m", g.cell},
            {"x_min_m", g.x_min},
            {"y_min_m", g.y_min},
            {"nodata_share", scene.nodata_share},
            {"local_origin_m", {origin.x, origin.y, origin.z}}};
}

Json inputs(const scene::Scene& scene) {
    Json all = Json::array();
    for (const scene::InputFile& input : scene.inputs) {
        all.push_back({{"role", input.role}, {"path", input.path}, {"bytes", input.bytes}, {"fnv1a_64", input.hash}});
    }
    return all;
}

Json gauges_json(const observe::Observation& observation) {
    Json all = Json::array();
    for (const observe::GaugeRecord& record : observation.gauges) {
        all.push_back({{"name", record.gauge.name},
                       {"x_m", record.gauge.at.x},
                       {"y_m", record.gauge.at.y},
                       {"chainage_m", record.gauge.chainage},
                       {"arrival_time_s", record.arrival_time},
                       {"peak_depth_m", record.peak_depth},
                       {"peak_speed_mps", record.peak_speed}});
    }
    return all;
}

Json zoom_json(const run::RunResult& result) {
    if (!result.zoom) return nullptr;
    const run::ZoomRecord& zoom = *result.zoom;
    Json corners = Json::array();
    for (const PlanPoint& p : zoom.area.outer) corners.push_back({p.x, p.y});
    return {{"around", zoom.around},
            {"polygon_m", std::move(corners)},
            {"surroundings_m", zoom.surroundings},
            {"grid_cell_m", zoom.grid_cell},
            {"depth_averaged_wall_time_s", zoom.wall_time},
            {"event_volume_m3", zoom.event_volume},
            {"volume_in_m3", zoom.volumes.in},
            {"volume_out_m3", zoom.volumes.out},
            {"particle_volume_in_m3", zoom.brought_volume},
            {"momentum_in_Ns", {zoom.momentum.x, zoom.momentum.y}},
            {"particle_momentum_in_Ns", {zoom.brought_momentum.x, zoom.brought_momentum.y}},
            {"thickness_m", zoom.thickness}};
}

Json results(const run::RunResult& result) {
    const observe::Observation& o = result.observation;
    Json greatest_values = Json::object();
    for (const report::HazardMap& map : report::hazard_maps()) {
        const std::string suffix = std::string(map.unit) == "m/s" ? "mps" : map.unit;
        greatest_values[std::string(map.file) + "_" + suffix] = report::greatest(o.maps.*map.grid) * map.factor;
    }
    Json volumes = Json::object();
    for (const observe::NamedNumber& volume : observe::volume_numbers) {
        volumes[std::string(volume.key.substr(std::string_view("volume_").size()))] = volume.value(o);
    }
    const observe::Hits buildings = hits_among(o.buildings, false), barriers = hits_among(o.buildings, true);
    Json all = run_out_json(o);
    all.update({{"greatest", greatest_values},
                {"volumes", volumes},
                {"buildings", buildings.all},
                {"buildings_hit", buildings.hit},
                {"barriers", barriers.all},
                {"barriers_hit", barriers.hit},
                {"structures", structures_json(o)},
                {"gauges", gauges_json(o)},
                {"cross_sections", cross_sections_json(o)},
                {"zoom", zoom_json(result)},
                {"compression", result.depth_averaged() ? Json() : compression_json(o)}});
    return all;
}

/// From the scene's files to the last product before the manifest: wall time of each part. Products are written beside
/// each other, so that theirs add up to more than passed.
Json phases(const scene::Scene& scene, const run::RunResult& result, const std::vector<Phase>& written) {
    std::vector<Phase> all = {{"load", scene.load_time}};
    if (result.zoom) all.push_back({"depth_averaged_model", result.zoom->wall_time});
    all.push_back({"seed", result.seed_time});
    all.push_back({"steps", result.step_time()});
    all.push_back({"finish", result.finish_time});
    all.insert(all.end(), written.begin(), written.end());
    Json list = Json::array();
    for (const Phase& phase : all) list.push_back({{"phase", phase.name}, {"wall_s", phase.seconds}});
    return list;
}

Json performance(const scene::Scene& scene, const run::RunResult& result, const std::vector<Phase>& written) {
    const double steps = static_cast<double>(result.steps);
    const double per_step = steps > 0 ? 1 / steps : observe::never;
    const double per_wall = result.wall_time > 0 ? 1 / result.wall_time : observe::never;
    const double step_time = result.step_time();
    Json stages = Json::array();
    double rest = step_time;
    const auto add = [&](std::string_view name, double seconds) {
        stages.push_back({{"stage", name},
                          {"total_s", seconds},
                          {"per_step_ms", 1e3 * seconds * per_step},
                          {"share", step_time > 0 ? seconds / step_time : observe::never}});
        rest -= seconds;
    };
    if (result.depth_averaged()) {
        for (const Phase& stage : result.grid_stages) add(stage.name, stage.seconds);
    } else {
        for (std::size_t i = 0; i < sim::stage_count; ++i) {
            add(sim::step_stages[i].name, result.stage_times.seconds[i]);
        }
        add("other", std::max(0.0, rest));
    }
    return {{"simulated_time_s", result.simulated_time},
            {"wall_time_s", result.wall_time},
            {"real_time_factor", result.real_time_factor()},
            {"steps", result.steps},
            {"steps_per_second", steps * per_wall},
            {"step_ms", 1e3 * result.wall_time * per_step},
            {"stages", stages},
            {"phases", phases(scene, result, written)}};
}

Json versions() {
    return {{"talus", TALUS_VERSION},
            {"gdal", geo::gdal_version()},
            {"proj", geo::proj_version()},
            {"tbb", TBB_VERSION_STRING},
            {"compiler", report::compiler_version()},
#ifdef NDEBUG
            {"assertions", false}
#else
            {"assertions", true}
#endif
    };
}

Json hardware() {
    const report::Hardware machine = report::this_machine();
    return {{"cpu", machine.cpu},
            {"logical_cores", machine.logical_cores},
            {"memory_GiB", machine.memory_GiB},
            {"system", machine.system}};
}

/// The files in the folder, so that a missing file can be detected.
Json files_in(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    std::error_code failed;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, failed)) {
        if (entry.is_regular_file(failed)) {
            names.push_back(entry.path().lexically_relative(folder).generic_string());
        }
    }
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace

const char* origin_text(scene::PathOrigin origin) {
    switch (origin) {
        case scene::PathOrigin::file:
            return "given";
        case scene::PathOrigin::traced:
            return "traced";
        case scene::PathOrigin::followed:
            break;
    }
    return "followed";
}

Status write_manifest(const scene::Scene& scene, const run::RunResult& result,
                      const std::vector<run::Comparison>& comparisons, const std::filesystem::path& folder,
                      const std::vector<Phase>& written) {
    const params::SceneInfo& info = scene.spec.scene;
    const Json manifest = {
        {"program", "talus"},
        {"title", info.title},
        {"created", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now()))},
        {"status", status_text(result.status)},
        {"partial", result.status != run::RunStatus::complete},
        {"stop_reason", result.stop_reason},
        {"verdict", verdict_json(judge(result, comparisons))},
        {"reconstruction", info.reconstruction},
        {"result_hash", to_hex(result.hash)},
        {"results", results(result)},
        {"comparisons", comparisons_json(comparisons)},
        {"performance", performance(scene, result, written)},
        {"hardware", hardware()},
        {"versions", versions()},
        {"scene_file", scene.file.string()},
        {"inputs", inputs(scene)},
        {"terrain", terrain(scene)},
        {"resolved", resolved(scene, result)},
        {"parameters", parameters(scene.spec)},
        {"assumptions", info.assumptions},
        {"notes", scene.notes},
        {"sources", info.sources},
        {"files", files_in(folder)},
    };
    // Names from attribute tables need not be valid UTF-8; the manifest is.
    const std::string text = manifest.dump(2, ' ', false, Json::error_handler_t::replace);
    return write_text_file(folder / "manifest.json", text + "\n");
}

}  // namespace talus::products
