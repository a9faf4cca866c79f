#include "report/results.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "core/decimals.hpp"
#include "core/number_or_null.hpp"
#include "observe/front_tracker.hpp"
#include "observe/number_names.hpp"
#include "report/hazard_map.hpp"
#include "report/number_text.hpp"
#include "run/words.hpp"
#include "scene/warning.hpp"
#include "sim/compression.hpp"

namespace talus::report {
namespace {

std::string place_of(const scene::Scene& scene, const observe::Peak& peak) {
    return std::isnan(peak.value) ? "no debris mapped" : place(scene, peak.at);
}

/// m of chainage; where map cells saw the front, no less than those need.
double front_velocity_window(const scene::Scene& scene, const run::RunResult& result) {
    const double window = scene.spec.outputs.front_velocity_window;
    const bool by_cells = result.depth_averaged() || result.observation.followed_path;
    return by_cells ? std::max(window, observe::resolved_cells * result.map_cell) : window;
}

struct MassBalance {
    double residual = 0;
    bool closes = false;
};

MassBalance mass_balance(const observe::Observation& o) {
    const observe::TimeSample end = o.at_end();
    const double residual = o.volume_released + end.volume_entrained - end.volume_held - end.volume_moving -
                            end.volume_deposited - end.volume_left;
    return {residual, std::abs(residual) <= o.volume_rounding * std::max(1.0, o.volume_released)};
}

std::string moving_text(const run::RunResult& result, double deposited_speed) {
    const run::StillMoving moving = result.still_moving();
    if (!(moving.volume > 0)) return fmt::format("nothing faster than {} m/s", plain(deposited_speed));
    return fmt::format("{} m³ ({} % of the debris), at up to {} m/s", significant(moving.volume, 3),
                       significant(100 * moving.share, 3), significant(moving.greatest_speed, 2));
}

}  // namespace

Json still_moving(const run::RunResult& result) {
    const run::StillMoving moving = result.still_moving();
    return {{"volume_m3", moving.volume},
            {"share_percent", 100 * moving.share},
            {"greatest_speed_mps", moving.greatest_speed},
            {"slow_since_s", number_or_null<Json>(moving.slow_since)}};
}

Json status(const run::RunResult& result, const run::RunVerdict& verdict) {
    const bool fault = result.status == run::RunStatus::fault, complete = result.status == run::RunStatus::complete;
    return {{"name", complete ? "complete"
                     : fault  ? "fault"
                              : "interrupted"},
            {"partial", !complete},
            {"beyond_limits", beyond_limits(verdict)},
            {"fault", fault},
            {"stop_reason", result.stop_reason},
            {"simulated_time_s", result.simulated_time},
            {"still_moving", still_moving(result)}};
}

Json beyond_limits(const run::RunVerdict& verdict) {
    return verdict.within_limits() ? Json() : Json(run::uncapitalised(verdict.text()));
}

Json named_verdict(std::string_view name, const Json& verdict) {
    const std::string limits = verdict["within_limits"].get<bool>() ? "within limits" : "beyond limits";
    Json shown = {{"heading", name.empty() ? run::capitalised(limits) : fmt::format("{}: {}", name, limits)},
                  {"within_limits", verdict["within_limits"]},
                  {"checks", Json::array()}};
    for (const Json& check : verdict["checks"]) {
        // The depth-averaged model has no such thing.
        if (check["key"] == "compression" && check["state"] == "not_measured") continue;
        shown["checks"].push_back({{"name", check["name"]},
                                   {"beyond", check["state"] == "beyond"},
                                   {"not_measured", check["state"] == "not_measured"},
                                   {"text", check["text"]}});
    }
    return shown;
}

Json compression(const scene::Scene& scene, const run::RunResult& result) {
    if (result.depth_averaged()) return nullptr;
    const observe::Compression& c = result.observation.compression;
    const params::SolverSpec& solver = scene.spec.solver;
    return {{"within_limits", c.within_limits()},
            {"worst_mean_percent", 100 * c.worst_mean},
            {"worst_mean_time_s", c.worst_mean_time},
            {"mean_limit_percent", 100 * sim::mean_compression_limit},
            {"worst_overcompressed_percent", 100 * c.worst_overcompressed_share},
            {"worst_overcompressed_time_s", c.worst_overcompressed_time},
            {"overcompressed_limit_percent", 100 * sim::overcompressed_share_limit},
            {"overcompressed_compression_percent", 100 * sim::overcompressed_compression},
            {"worst_percent", 100 * c.worst_max},
            {"worst_time_s", c.worst_max_time},
            {"time_above_a_limit_percent", 100 * c.time_share_above},
            {"time_limit_percent", 100 * observe::Compression::time_share_limit},
            {"iteration_count", solver.iteration_count},
            {"extra_iteration_count", solver.extra_iteration_count},
            {"mean_iterations", c.mean_iterations},
            {"time_with_extra_iterations_percent", 100 * c.time_share_iterated},
            {"fixed_time_step", solver.time_step.has_value()}};
}

Json flow_thickness(const scene::Scene& scene, const run::RunResult& result) {
    const observe::FlowThickness& flow = result.observation.thickness;
    if (!flow.known() || result.depth_averaged()) return nullptr;
    return {{"median_m", flow.median},
            {"thinnest_tenth_m", flow.thin},
            {"median_layers", flow.median / result.particle_spacing},
            {"thinnest_tenth_layers", flow.thin / result.particle_spacing},
            {"target_layers", scene.thinnest ? Json(*scene.spec.solver.target_layers) : Json()}};
}

Json key_figures(const scene::Scene& scene, const run::RunResult& result) {
    const observe::Observation& o = result.observation;
    const observe::TimeSample end = o.at_end();
    const MassBalance mass = mass_balance(o);
    Json all = Json::array();
    const auto add = [&](std::string_view key, std::string_view name, Json value, const std::string& format,
                         std::string_view unit, const std::string& note, bool alert = false) {
        all.push_back(key_figure(key, name, std::move(value), format, unit, note, alert));
    };
    const int volume_decimals = decimals_for(o.volume_released + end.volume_entrained, 1);
    const int run_out_decimals = decimals_for(o.run_out.along_flow, 0);
    const auto volume_format = [&](double v) { return v < 100 ? fmt::format("f{}", volume_decimals) : "f0"; };
    const auto in_m3 = [&](double volume) { return fixed(volume, volume_decimals); };
    add("released_volume_m3", observe::find_number("volume_released_m3")->title, o.volume_released,
        volume_format(o.volume_released), "m³",
        result.zoom ? fmt::format("of the event's {} m³ came into the zoom", fixed(result.zoom->event_volume, 0))
                    : plural(scene.releases.size(), "release") +
                          (scene.inflows.empty() ? "" : ", " + plural(scene.inflows.size(), "inflow")));
    if (!scene.bed.empty()) {
        const double entrained = end.volume_entrained;
        add("entrained_volume_m3", observe::find_number("volume_entrained_m3")->title, entrained,
            volume_format(entrained), "m³",
            fmt::format("{} × the released volume, deepest {}\u00a0m", fixed(entrained / o.volume_released, 2),
                        fixed(greatest(o.erosion.depth), length_decimals(scene, 2))));
    }
    const bool ran = std::isfinite(o.run_out.along_flow);
    const std::string front =
        std::isfinite(o.run_out.front_chainage)
            ? fmt::format(", front to chainage {}\u00a0m", fixed(o.run_out.front_chainage, run_out_decimals))
            : "";
    const observe::NamedNumber &run_out = observe::run_out_number, &angle = *observe::find_number("runout_angle_deg");
    add(run_out.key, std::string(run_out.title) + (o.run_out.at_least ? ", at least" : ""), o.run_out.along_flow,
        fmt::format("f{}", run_out_decimals), ran ? "m" : "",
        ran ? fmt::format("{}\u00a0m in a straight line, drop {}\u00a0m{}{}",
                          fixed(o.run_out.straight, run_out_decimals),
                          fixed(o.run_out.drop, std::max(1, run_out_decimals)), front,
                          o.run_out.at_least ? "; " + left_text(scene, result) : "")
            : "no debris ran out");
    add(angle.key, angle.title, angle.value(o), "f1", ran ? "°" : "",
        std::isfinite(o.run_out.travel_angle)
            ? fmt::format("travel angle of the centre of mass\u00a0{}°",
                          fixed(observe::find_number("travel_angle_deg")->value(o), 1))
            : "");
    const observe::Hits hits = hits_among(o.buildings, false), barriers_hit = hits_among(o.buildings, true);
    const observe::BuildingImpact* worst = nullptr;
    for (const observe::BuildingImpact& b : o.buildings) {
        if (b.is_barrier || !b.hit) continue;
        if (worst == nullptr || b.peak_impact_pressure > worst->peak_impact_pressure) worst = &b;
    }
    std::string hits_note = worst == nullptr ? "no building was hit"
                                             : fmt::format("highest impact pressure {} kPa, {}",
                                                           significant(worst->peak_impact_pressure / 1e3, 3),
                                                           worst->name.empty() ? "unnamed" : worst->name);
    if (barriers_hit.all > 0) {
        hits_note += fmt::format("; {} of {} hit", barriers_hit.hit, plural(barriers_hit.all, "barrier"));
    }
    all.push_back(key_figure("buildings_hit", "Buildings hit", hits.hit, "f0", fmt::format("of {}", hits.all),
                             hits_note, hits.hit > 0));
    const auto [depth, speed, pressure] = observe::measure_peaks(o.maps);
    const auto& [of_depth, of_speed, of_pressure] = observe::peak_numbers;
    add(of_depth.key, of_depth.map.title, depth.value, fmt::format("f{}", length_decimals(scene, 1)), "m",
        place_of(scene, depth));
    add(of_speed.key, of_speed.map.title, speed.value, "f1", "m/s", place_of(scene, speed));
    add(of_pressure.key, of_pressure.map.title, pressure.value / 1e3, "s3", "kPa",
        "ρv² of the free flow, " + place_of(scene, pressure));
    add("mass_balance", "Mass balance", mass.closes ? Json("closed") : Json(mass.residual), "f3",
        mass.closes ? "" : "m³ missing",
        fmt::format("deposited\u00a0{} · moving\u00a0{} · left\u00a0{}\u00a0m³{}", in_m3(end.volume_deposited),
                    in_m3(end.volume_moving), in_m3(end.volume_left),
                    end.volume_held > 0 ? fmt::format(" · held\u00a0{}\u00a0m³", in_m3(end.volume_held)) : ""),
        !mass.closes);
    return all;
}

/// Thickness of the flow in particles.
Json layers(const scene::Scene& scene, const run::RunResult& result) {
    const observe::FlowThickness& flow = result.observation.thickness;
    const std::string asked =
        scene.thinnest ? fmt::format("asked for: {} over {}, {} m thick; ", plain(*scene.spec.solver.target_layers),
                                     scene.thinnest->name, significant(scene.thinnest->thickness, 3))
                       : "";
    if (!flow.known()) return fact("Layers of particles", asked + "debris reached no map cell");
    const double median = flow.median / result.particle_spacing;
    const bool enough = median >= observe::FlowThickness::min_layers;
    const std::string warning = fmt::format("fewer than {}: depths, speeds and forces mean little",
                                            fixed(observe::FlowThickness::min_layers, 0));
    return fact("Layers of particles",
                fmt::format("{}median {} ({} m), thinnest tenth of the trail {} ({} m), when the flow was thickest at "
                            "each place{}",
                            asked, fixed(median, 1), fixed(flow.median, length_decimals(scene, 2)),
                            fixed(flow.thin / result.particle_spacing, 1), fixed(flow.thin, length_decimals(scene, 2)),
                            enough ? "" : ": "),
                enough ? "" : warning, enough);
}

Json quality(const scene::Scene& scene, const run::RunResult& result) {
    const observe::Observation& o = result.observation;
    const char* state = result.status == run::RunStatus::complete      ? "complete"
                        : result.status == run::RunStatus::interrupted ? "partial: interrupted"
                                                                       : "partial: stopped by a fault";
    const observe::TimeSample end = o.at_end();
    const MassBalance mass = mass_balance(o);
    const observe::Compression& c = o.compression;
    Json all = {
        fact("Status", result.stop_reason.empty() ? state : state + ("; " + result.stop_reason)),
        fact("Still moving", moving_text(result, scene.spec.outputs.deposited_speed)),
        fact("Simulated time",
             fmt::format("{} s in {} s of wall time, {} of {} to {} ms", fixed(result.simulated_time, 1),
                         fixed(result.wall_time, 1), plural(result.steps, "step"),
                         fixed(1e3 * result.smallest_time_step, 2), fixed(1e3 * result.largest_time_step, 2))),
        fact("Real-time factor",
             significant(result.real_time_factor(), 3) + " (simulated over wall time; 1 is real time)"),
    };
    const int decimals = decimals_for(o.volume_released + end.volume_entrained, 2);
    const auto in_m3 = [&](double volume) { return fixed(volume, decimals); };
    const Json balance =
        fact("Mass balance",
             fmt::format("released {}{} = held {} + moving {} + deposited {} + left {} m³", in_m3(o.volume_released),
                         scene.bed.empty() ? "" : fmt::format(" + entrained {}", in_m3(end.volume_entrained)),
                         in_m3(end.volume_held), in_m3(end.volume_moving), in_m3(end.volume_deposited),
                         in_m3(end.volume_left)),
             mass.closes ? "" : fmt::format("; {} m³ missing", fixed(mass.residual, 3)));
    if (result.depth_averaged()) {
        all.push_back(fact(
            "Model",
            fmt::format(
                "depth-averaged, {} cells of {} m; {} million cell updates per second",
                fixed(static_cast<double>(result.grid_cells), 0), plain(result.grid_cell),
                significant(static_cast<double>(result.cell_updates) / 1e6 / std::max(result.wall_time, 1e-9), 3))));
        all.push_back(balance);
        return all;
    }
    all.insert(
        all.end(),
        {fact("Particles", fmt::format("{}, spacing {} m", fixed(result.particles, 0), plain(result.particle_spacing))),
         layers(scene, result),
         fact(
             "Compression",
             fmt::format(
                 "worst mean over the debris {} % (at {} s; limit {} %), more than {} % in {} % of the particles "
                 "at worst (limit {} %), worst particle {} %: ",
                 fixed(100 * c.worst_mean, 2), fixed(c.worst_mean_time, 1), fixed(100 * sim::mean_compression_limit, 0),
                 fixed(100 * sim::overcompressed_compression, 0), fixed(100 * c.worst_overcompressed_share, 2),
                 fixed(100 * sim::overcompressed_share_limit, 0), fixed(100 * c.worst_max, 1)),
             c.within_limits() ? "within limits"
                               : fmt::format("above a limit during {} % of the simulated time",
                                             significant(100 * c.time_share_above, 2)),
             c.within_limits()),
         fact("Iterations",
              c.time_share_iterated > 0
                  ? fmt::format("{} per step, up to {} more while debris was overcompressed: in {} % of the simulated "
                                "time, {} on average",
                                scene.spec.solver.iteration_count, scene.spec.solver.extra_iteration_count,
                                significant(100 * c.time_share_iterated, 2), fixed(c.mean_iterations, 1))
                  : fmt::format("{} per step", scene.spec.solver.iteration_count)),
         balance});
    return all;
}

Json title_block(const params::ReportSpec& report) {
    const auto given = [](const std::string& text) { return text.empty() ? Json() : Json(text); };
    const Json block = {{"client", given(report.client)},
                        {"reference", given(report.reference)},
                        {"revision", given(report.revision)},
                        {"date", given(report.date)},
                        {"author", given(report.author)},
                        {"checker", given(report.checker)},
                        {"limits_of_use", given(report.limits_of_use)}};
    const bool empty = std::all_of(block.begin(), block.end(), [](const Json& text) { return text.is_null(); });
    return empty ? Json() : block;
}

Json observations(const scene::Scene& scene, const run::RunResult& result) {
    if (scene.spec.observations.empty()) return {};
    Json rows =
        table({{"observation", "Observation", ""},
               {"chainage_m", "Chainage", "m", fmt::format("f{}", length_decimals(scene))},
               {"quantity", "Quantity", ""},
               {"observed_mps", "Observed", "m/s", "f1"},
               {"computed_mps", "Computed", "m/s", "f1", "", "not reached", true},
               {"difference_percent", "Difference", "%", "d0"},
               {"front_velocity_mps", "Front velocity", "m/s", "f1"},
               {"particle_speed_mps", result.depth_averaged() ? "Speed of the flow" : "Particle speed", "m/s", "f1"},
               {"arrival_s", "Arrival", "s", "f1"},
               {"source", "Source", "", "", "source"}});
    for (const params::ObservationSpec& observed : scene.spec.observations) {
        const observe::FrontSample computed = front_at(result.observation, observed.chainage);
        const double value = computed_for(observed, result.observation);
        Json velocity = number_or_null<Json>(value);
        if (velocity.is_null() && outside_zoom(scene, result, observed.chainage)) velocity = "outside the zoom";
        rows["rows"].push_back({{"observation", observed.name},
                                {"chainage_m", observed.chainage},
                                {"quantity", observed.quantity()},
                                {"observed_mps", observed.value()},
                                {"computed_mps", std::move(velocity)},
                                {"difference_percent", number_or_null<Json>(100 * (value / observed.value() - 1))},
                                {"front_velocity_mps", number_or_null<Json>(computed.front_velocity)},
                                {"particle_speed_mps", number_or_null<Json>(computed.particle_speed)},
                                {"arrival_s", number_or_null<Json>(computed.arrival_time)},
                                {"source", observed.source}});
    }
    return rows;
}

Json results_head(std::string_view format) {
    const auto now = fmt::gmtime(std::chrono::system_clock::now());
    return {{"format", format},
            {"version", results_version},
            {"program", std::string("talus ") + TALUS_VERSION},
            {"created", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", now)},
            {"date", fmt::format("{:%d %B %Y, %H:%M} UTC", now)},
            {"report", nullptr}};
}

Json results_head(std::string_view format, const scene::Scene& scene) {
    const params::SceneInfo& info = scene.spec.scene;
    Json head = results_head(format);
    head["title"] = info.title.empty() ? scene.file.stem().string() : info.title;
    head["description"] = info.description;
    head["report"] = title_block(scene.spec.report);
    head["reconstruction"] = info.reconstruction;
    head["reference_system"] = scene.crs.label();
    return head;
}

Json run_results(const scene::Scene& scene, const run::RunResult& result,
                 const std::vector<run::Comparison>& comparisons) {
    const run::RunVerdict verdict = judge(result, comparisons);
    Json all = results_head("talus results", scene);
    all.update({{"status", status(result, verdict)},
                {"verdict", verdict_json(verdict)},
                {"depth_averaged", result.depth_averaged() ? Json{{"grid_cell_m", result.grid_cell}} : Json()},
                {"compression", compression(scene, result)},
                {"flow_thickness", flow_thickness(scene, result)},
                {"key_figures", key_figures(scene, result)},
                {"observations", observations(scene, result)},
                {"quality", quality(scene, result)},
                {"buildings", buildings(scene, result)},
                {"barriers", barriers(result)},
                {"impact_filter_window_s", scene.spec.outputs.impact_filter_window},
                {"impact_patch_edge_m", scene.spec.outputs.impact_patch_edge},
                {"intensity", intensity(scene, result)},
                {"force", force_chart(result)},
                {"front", front_chart(scene, result)},
                {"front_velocity_window_m", front_velocity_window(scene, result)},
                {"time", time_chart(result)},
                {"gauges", gauges({{"", &result}})},
                {"cross_sections", cross_sections({{"", &result}})},
                {"zoom", zoom(result)},
                {"zones", zones(scene)},
                {"initiation", initiation(result)},
                {"inflow", inflow(scene, result)},
                {"erosion", erosion(scene, result)},
                {"comparisons", Json::array()},
                {"method", method(scene)},
                {"assumptions", scene.spec.scene.assumptions},
                {"not_set", not_set(scene, result)},
                {"notes", scene.notes},
                {"input_warnings", scene::warnings_in(scene.notes)},
                {"sources", scene.spec.scene.sources},
                {"as_computed", chosen_values(scene, result)},
                {"parameters", parameters(scene)},
                {"defaults", defaults(scene)},
                {"inputs", inputs(scene)},
                {"computation", computation(scene, result)}});
    for (const run::Comparison& compared : comparisons) {
        all["comparisons"].push_back(comparison(compared, scene, result));
    }
    return all;
}

}  // namespace talus::report
