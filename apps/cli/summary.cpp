#include "summary.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/angle.hpp"
#include "core/decimals.hpp"
#include "core/hash.hpp"
#include "core/number_or_null.hpp"
#include "products/results_json.hpp"
#include "products/writers.hpp"
#include "report/results.hpp"
#include "run/verdict.hpp"
#include "run/words.hpp"
#include "scene/warning.hpp"
#include "sim/compression.hpp"
#include "variant_plan.hpp"
#include "zoom_text.hpp"

namespace talus::cli {
namespace {

std::vector<const observe::BuildingImpact*> buildings_hit(const observe::Observation& observation) {
    std::vector<const observe::BuildingImpact*> hit;
    for (const observe::BuildingImpact& building : observation.buildings) {
        if (building.hit && !building.is_barrier) hit.push_back(&building);
    }
    std::stable_sort(hit.begin(), hit.end(), [](const observe::BuildingImpact* a, const observe::BuildingImpact* b) {
        return a->first_hit_time < b->first_hit_time;
    });
    return hit;
}

std::string buildings_text(const observe::Observation& observation) {
    constexpr std::size_t longest_list = 6;
    const auto hit = buildings_hit(observation);
    std::string text = fmt::format("{} of {}", hit.size(), hits_among(observation.buildings, false).all);
    for (std::size_t i = 0; i < std::min(hit.size(), longest_list); ++i) {
        text += fmt::format("{}{} ({:.1f} s, {:.0f} kPa)", i == 0 ? ": " : ", ", hit[i]->name, hit[i]->first_hit_time,
                            hit[i]->peak_impact_pressure / 1000);
    }
    if (hit.size() > longest_list) text += fmt::format(" and {} more in buildings.csv", hit.size() - longest_list);
    return text;
}

std::string barrier_text(const observe::BuildingImpact& barrier, int decimals) {
    return fmt::format(
        "{0}: peak force {1:.0f} kN, {2:.{5}f} m3 over it, {3:.{5}f} m3 through openings, {4:.{5}f} m3 retained",
        barrier.name, barrier.peak_force / 1000, barrier.overtopped_volume, barrier.passed_volume,
        barrier.retained_volume, decimals);
}

std::string discharge_text(const observe::DischargeRecord& r, int decimals) {
    if (std::isnan(r.peak_time)) return fmt::format("{}: nothing passed", r.section.name);
    return fmt::format("{}: peak {:.3g} m3/s at {:.1f} s, {:.{}f} m3 passed", r.section.name, r.peak_discharge,
                       r.peak_time, r.passed, decimals);
}

std::string initiation_text(const run::Initiation& one) {
    if (std::isnan(one.ratio)) return fmt::format("{}: was still held at the end", one.release);
    if (std::isnan(one.failed_at)) {
        return fmt::format("{}: did not fail, at a pore-pressure ratio of {:.2f} at the end", one.release, one.ratio);
    }
    return fmt::format("{}: failed at {:.1f} s, at a pore-pressure ratio of {:.2f}", one.release, one.failed_at,
                       one.ratio);
}

std::string speed_text(double speed) {
    return std::isfinite(speed) ? fmt::format("{:.1f} m/s", speed) : std::string("not known");
}

std::string compression_text(const observe::Compression& c) {
    std::string text = fmt::format(
        "mean {:.2f} % at worst (limit {:g} %), above {:g} % in {:.2g} % of the particles "
        "(limit {:g} %)",
        100 * c.worst_mean, 100 * sim::mean_compression_limit, 100 * sim::overcompressed_compression,
        100 * c.worst_overcompressed_share, 100 * sim::overcompressed_share_limit);
    if (c.time_share_iterated > 0)
        text += fmt::format(", extra iterations {:.2g} % of the time", 100 * c.time_share_iterated);
    return text;
}

std::string layers_text(const scene::Scene& scene, const observe::FlowThickness& flow, double spacing) {
    const std::string asked = scene.thinnest ? fmt::format("{:.4g} asked for over {}; ",
                                                           *scene.spec.solver.target_layers, scene.thinnest->name)
                                             : "";
    return fmt::format("{}the flow was {:.1f} particles thick in the median of the trail, {:.1f} in its thinnest tenth",
                       asked, flow.median / spacing, flow.thin / spacing);
}

/// What to change where compression is above its limits.
std::string remedy(const params::SolverSpec& solver) {
    return fmt::format("; raise solver.extra_iteration_count (now {}) or {}", solver.extra_iteration_count,
                       solver.time_step ? "lower solver.time_step_s"
                                        : "halve solver.largest_time_step_s and solver.displacement_limit");
}

std::string moving_text(const run::StillMoving& moving, double deposited_speed) {
    if (!(moving.volume > 0)) return fmt::format("nothing faster than {:.3g} m/s", deposited_speed);
    return fmt::format("{} m3 ({} % of the debris), at up to {} m/s", run::rounded(moving.volume, 3),
                       run::rounded(100 * moving.share, 3), run::rounded(moving.greatest_speed, 2));
}

std::string line(const char* label, const std::string& text) {
    return fmt::format("  {:<16} {}\n", label, text);
}

std::string verdict_text(const scene::Scene& scene, const run::RunVerdict& verdict) {
    if (verdict.within_limits()) return line("verdict", run::uncapitalised(verdict.text()));
    std::string text = line("VERDICT", run::uncapitalised(verdict.text()));
    for (const run::Check& check : verdict.checks) {
        if (check.state != run::CheckState::beyond) continue;
        text += line("", check.text + (check.key == "compression" ? remedy(scene.spec.solver) : ""));
    }
    return text;
}

/// Where the front came to, and why it stays behind the run-out where debris got too thin for it.
std::string front_text(const scene::Scene& scene, const observe::Observation& seen) {
    const double chainage = seen.run_out.front_chainage;
    std::string text = fmt::format("to chainage {:.{}f} m", chainage, decimals_for(seen.run_out.along_flow, 0));
    if (seen.followed_path) text += " of the path that debris followed; until now chainages were along the traced one";
    if (chainage < 0.9 * seen.run_out.along_flow) {
        text += fmt::format("; beyond it debris was at most {:g} m deep (outputs.arrival_depth_m)",
                            scene.spec.outputs.arrival_depth);
    }
    return text;
}

}  // namespace

std::string summary_text(const scene::Scene& scene, const run::RunResult& result,
                         const std::vector<run::Comparison>& comparisons, const std::filesystem::path& output) {
    const observe::Observation& seen = result.observation;
    const observe::TimeSample end = seen.at_end();
    std::string text = scene.spec.scene.title;
    const bool said = text.find("reconstruction") != std::string::npos;
    if (scene.spec.scene.reconstruction && !said) text += " (reconstruction)";
    text += result.status == run::RunStatus::complete ? "\n" : ", PARTIAL RESULT\n";
    text += line("stopped", result.stop_reason);
    text += line("still moving", moving_text(result.still_moving(), scene.spec.outputs.deposited_speed));
    text += line(
        "simulated",
        fmt::format("{:.1f} s in {:.1f} s: {:.2f} x real time, {}", result.simulated_time, result.wall_time,
                    result.real_time_factor(),
                    result.depth_averaged()
                        ? fmt::format("depth-averaged on {} cells of {:.3g} m, {:.3g} million cell updates/s",
                                      result.grid_cells, result.grid_cell,
                                      static_cast<double>(result.cell_updates) / 1e6 / std::max(result.wall_time, 1e-9))
                        : fmt::format("{} particles of {:.3g} m", result.particles, result.particle_spacing)));
    if (result.zoom) {
        text += line("zoom", zoom_text(*result.zoom));
        text += line(
            "", fmt::format("all results are of this area; {:.1f} s depth-averaged before", result.zoom->wall_time));
    }
    for (const params::ObservationSpec& observed : scene.spec.observations) {
        const observe::FrontSample front = front_at(seen, observed.chainage);
        const std::string computed =
            report::outside_zoom(scene, result, observed.chainage) ? "outside the zoom"
            : std::isnan(front.arrival_time)                       ? "not reached"
            : observed.debris_speed
                ? fmt::format("{}, front {}", speed_text(front.particle_speed), speed_text(front.front_velocity))
                : fmt::format("{}, debris there {}", speed_text(front.front_velocity),
                              speed_text(front.particle_speed));
        text += line(observed.debris_speed ? "debris speed" : "front velocity",
                     fmt::format("at {:g} m: {}; observed {:g} m/s", observed.chainage, computed, observed.value()));
    }
    if (const observe::RunOut& r = seen.run_out; std::isfinite(r.along_flow)) {
        text += line("run-out",
                     fmt::format("{0}{1:.{2}f} m along the flow, {3:.{2}f} m straight, drop {4:.{2}f} m, run-out angle "
                                 "{5:.1f} degrees{6}",
                                 r.at_least ? "at least " : "", r.along_flow, decimals_for(r.along_flow, 0), r.straight,
                                 r.drop, r.runout_angle * degrees_per_radian,
                                 r.at_least ? "; " + report::left_text(scene, result) : ""));
    }
    if (std::isfinite(seen.run_out.front_chainage)) text += line("front", front_text(scene, seen));
    const int decimals = decimals_for(seen.volume_released + seen.erosion.volume, 1);
    text += line("volume",
                 fmt::format("{0:.{5}f} m3 released: {1:.{5}f} deposited, {2:.{5}f} moving, {3:.{5}f} left the {4}",
                             seen.volume_released, end.volume_deposited, end.volume_moving + end.volume_held,
                             end.volume_left, result.domain(), decimals));
    for (const run::Initiation& one : result.initiations) text += line("initiation", initiation_text(one));
    for (const observe::DischargeRecord& r : seen.cross_sections)
        text += line("discharge", discharge_text(r, decimals));
    if (!scene.bed.empty()) {
        text += line("entrained", fmt::format("{:.{}f} m3 from the bed", seen.erosion.volume, decimals));
    }
    if (hits_among(seen.buildings, false).all > 0) text += line("buildings hit", buildings_text(seen));
    for (const observe::BuildingImpact& b : seen.buildings) {
        if (b.is_barrier) text += line("barrier", barrier_text(b, decimals));
        if (!std::isnan(b.failure_time)) text += line("FAILED", fmt::format("{} at {:.2f} s", b.name, b.failure_time));
    }
    if (seen.thickness.known() && !result.depth_averaged()) {
        text += line("layers", layers_text(scene, seen.thickness, result.particle_spacing));
    }
    if (!result.depth_averaged()) text += line("compression", compression_text(seen.compression));
    for (const std::string& warning : scene::warnings_in(scene.notes)) text += line("WARNING", warning);
    text += verdict_text(scene, judge(result, comparisons));
    for (const run::Comparison& comparison : comparisons) text += comparison_text(comparison, result);
    text += line("report", (output / "report.html").string());
    return text;
}

std::string summary_json(const scene::Scene& scene, const run::RunResult& result,
                         const std::vector<run::Comparison>& comparisons, const std::filesystem::path& output) {
    const observe::Observation& seen = result.observation;
    const observe::TimeSample end = seen.at_end();
    auto observations = nlohmann::ordered_json::array();
    for (const params::ObservationSpec& observed : scene.spec.observations) {
        const observe::FrontSample front = front_at(seen, observed.chainage);
        observations.push_back({{"name", observed.name},
                                {"chainage_m", observed.chainage},
                                {"quantity", observed.key()},
                                {"observed_mps", observed.value()},
                                {"front_velocity_mps", number_or_null<nlohmann::ordered_json>(front.front_velocity)},
                                {"particle_speed_mps", number_or_null<nlohmann::ordered_json>(front.particle_speed)},
                                {"arrival_time_s", number_or_null<nlohmann::ordered_json>(front.arrival_time)}});
    }
    auto buildings = nlohmann::ordered_json::array();
    for (const observe::BuildingImpact* building : buildings_hit(seen)) {
        buildings.push_back({{"name", building->name},
                             {"first_hit_s", number_or_null<nlohmann::ordered_json>(building->first_hit_time)},
                             {"peak_impact_pressure_kPa", building->peak_impact_pressure / 1000},
                             {"peak_depth_m", building->peak_depth}});
    }
    nlohmann::ordered_json event = {
        {"event", "result"},
        {"status", products::status_text(result.status)},
        {"stop_reason", result.stop_reason},
        {"verdict", verdict_json(judge(result, comparisons))},
        {"title", scene.spec.scene.title},
        {"reconstruction", scene.spec.scene.reconstruction},
        {"output", output.string()},
        {"hash", to_hex(result.hash)},
        {"simulated_time_s", result.simulated_time},
        {"wall_time_s", result.wall_time},
        {"real_time_factor", result.real_time_factor()},
        {"steps", result.steps},
        {"particles", result.depth_averaged() ? nlohmann::ordered_json() : nlohmann::ordered_json(result.particles)},
        {"particle_spacing_m",
         result.depth_averaged() ? nlohmann::ordered_json() : nlohmann::ordered_json(result.particle_spacing)},
        {"target_layers", scene.thinnest ? nlohmann::ordered_json(*scene.spec.solver.target_layers) : nullptr},
        {"thread_count", result.thread_count},
        {"volume_released_m3", seen.volume_released},
        {"volume_entrained_m3", seen.erosion.volume},
        {"volume_moving_m3", end.volume_moving},
        {"volume_deposited_m3", end.volume_deposited},
        {"still_moving", report::still_moving(result)},
        {"volume_held_m3", end.volume_held},
        {"volume_left_m3", end.volume_left},
        {"observations", observations},
        {"buildings_hit", buildings},
        {"structures", products::structures_json(seen)},
        {"cross_sections", products::cross_sections_json(seen)},
        {"compression", result.depth_averaged() ? nlohmann::ordered_json() : products::compression_json(seen)},
    };
    event.update(products::run_out_json(seen));
    event.update(products::comparisons_json(comparisons));
    return event.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace talus::cli
