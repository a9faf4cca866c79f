#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "products/report_map.hpp"
#include "products/report_sections.hpp"
#include "products/report_text.hpp"

namespace talus::report {
namespace {

double degrees(double radians) {
    return radians * 180 / std::numbers::pi;
}

struct Peak {
    double value = never;
    PlanPoint at;
};

Peak peak_of(const Grid<float>& map) {
    Peak peak;
    for (int r = 0; r < map.geometry.rows; ++r) {
        for (int c = 0; c < map.geometry.columns; ++c) {
            const double v = map.at(c, r);
            if (std::isnan(v) || v <= peak.value) continue;
            peak = {v, map.geometry.centre(c, r)};
        }
    }
    return peak;
}

/// "at chainage 88 m", or the coordinates where the path does not come by.
std::string place(const Scene& scene, const Peak& peak) {
    if (std::isnan(peak.value)) return "no debris mapped";
    if (!scene.flow_path.empty()) {
        if (const auto on_path = scene.flow_path.locate(peak.at)) {
            return fmt::format("at chainage {} m", fixed(on_path->chainage, 0));
        }
    }
    return fmt::format("at {} E {} N", fixed(peak.at.x, 0), fixed(peak.at.y, 0));
}

std::string card(std::string_view name, const std::string& value, std::string_view unit, const std::string& below,
                 std::string_view css_class = "") {
    return fmt::format(
        R"(<div class="card {}"><dt>{}</dt><dd><strong>{}</strong> <span class="unit">{}</span></dd><dd class="below">{}</dd></div>
)",
        css_class, name, value, unit, below);
}

struct MassBalance {
    double entrained = 0, held = 0, moving = 0, deposited = 0, left = 0, residual = 0;
    bool closes = false;
};

MassBalance mass_balance(const Observation& observation) {
    MassBalance m;
    if (!observation.timeseries.empty()) {
        const TimeSample& s = observation.timeseries.back();
        m.entrained = s.volume_entrained;
        m.held = s.volume_held;
        m.moving = s.volume_moving;
        m.deposited = s.volume_deposited;
        m.left = s.volume_left;
    }
    m.residual = observation.volume_released + m.entrained - m.held - m.moving - m.deposited - m.left;
    m.closes = std::abs(m.residual) <= 1e-9 * std::max(1.0, observation.volume_released);
    return m;
}

std::string plural(std::size_t n, std::string_view word) {
    return fmt::format("{} {}{}", n, word, n == 1 ? "" : "s");
}

}  // namespace

std::string banners(const Scene& scene, const RunResult& result) {
    std::string html;
    if (result.status != RunStatus::complete) {
        html += fmt::format(
            R"(<div class="banner partial" role="alert"><b>Partial result.</b> The run {} at {} s of simulated time and did not come to its end{} Peaks, run-out and deposit can only be lower bounds.</div>
)",
            result.status == RunStatus::fault ? "was stopped by a fault" : "was interrupted",
            fixed(result.simulated_time, 1),
            result.stop_reason.empty() ? "." : ": <q>" + escape(result.stop_reason) + "</q>.");
    }
    if (scene.spec.scene.reconstruction) {
        html +=
            R"(<div class="banner reconstruction"><b>Reconstruction.</b> The terrain and other inputs of this scene are reconstructed from published descriptions, not surveyed. What was assumed is listed under <a href="#assumptions">Assumptions</a>. The results illustrate the event; they are not a basis for design or zoning.</div>
)";
    }
    const Observation& o = result.observation;
    if (!within_compression_limits(o)) {
        html += fmt::format(
            R"(<div class="banner unconverged"><b>Not converged.</b> Debris was compressed by up to {}&nbsp;% on average (at {} s; limit {}&nbsp;%) and {}&nbsp;% at a single particle (at {} s; limit {}&nbsp;%), above a limit during {}&nbsp;% of the simulated time. Raise <code>solver.iteration_count</code> (now {}) or {}; <code>talus run --convergence</code> shows whether results change.</div>
)",
            fixed(100 * o.worst_mean_compression, 2), fixed(o.worst_mean_time, 1),
            fixed(100 * mean_compression_limit, 0), fixed(100 * o.worst_max_compression, 1), fixed(o.worst_max_time, 1),
            fixed(100 * max_compression_limit, 0), significant(100 * o.compressed_time_share, 2),
            scene.spec.solver.iteration_count,
            scene.spec.solver.time_step
                ? "lower <code>solver.time_step_s</code>"
                : "halve <code>solver.largest_time_step_s</code> and <code>solver.displacement_limit</code>");
    }
    return html;
}

std::string key_results(const Scene& scene, const RunResult& result) {
    const Observation& o = result.observation;
    const Peak depth = peak_of(o.maps.peak_depth), speed = peak_of(o.maps.peak_speed),
               pressure = peak_of(o.maps.peak_pressure);
    const auto hit = static_cast<std::size_t>(
        std::count_if(o.buildings.begin(), o.buildings.end(), [](const BuildingImpact& b) { return b.hit; }));
    const auto worst = std::max_element(o.buildings.begin(), o.buildings.end(),
                                        [](const auto& a, const auto& b) { return a.peak_pressure < b.peak_pressure; });
    const MassBalance mass = mass_balance(o);
    std::string html = card("Released volume", fixed(o.volume_released, o.volume_released < 100 ? 1 : 0), "m³",
                            scene.inflows.empty() ? plural(scene.releases.size(), "release")
                                                  : plural(scene.releases.size(), "release") + ", " +
                                                        plural(scene.inflows.size(), "inflow"));
    if (!scene.bed.empty()) {
        html += card("Picked up from the bed", fixed(mass.entrained, mass.entrained < 100 ? 1 : 0), "m³",
                     fmt::format("{} × the released volume, deepest {} m", fixed(mass.entrained / o.volume_released, 2),
                                 fixed(greatest(o.erosion.depth), 2)));
    }
    const bool ran = std::isfinite(o.run_out.horizontal_distance);
    const std::string drop = fmt::format("drop {} m", fixed(o.run_out.drop, 1));
    html += card("Run-out distance", fixed(o.run_out.horizontal_distance, 0), ran ? "m" : "",
                 !ran ? "no debris ran out"
                 : std::isfinite(o.run_out.front_chainage)
                     ? fmt::format("front to chainage {} m, {}", fixed(o.run_out.front_chainage, 0), drop)
                     : drop);
    html += card(
        "Runout angle", fixed(degrees(o.run_out.runout_angle), 1), ran ? "°" : "",
        ran ? fmt::format("travel angle of the centre of mass {}°", fixed(degrees(o.run_out.travel_angle), 1)) : "");
    html += card("Buildings hit", fmt::format("{}", hit), fmt::format("of {}", o.buildings.size()),
                 hit > 0 ? fmt::format("highest pressure {} kPa, {}", significant(worst->peak_pressure / 1e3, 3),
                                       worst->name.empty() ? "unnamed" : escape(worst->name))
                         : "no building was hit",
                 hit > 0 ? "alert" : "");
    html += card("Peak flow depth", fixed(depth.value, 1), "m", place(scene, depth));
    html += card("Peak speed", fixed(speed.value, 1), "m/s", place(scene, speed));
    html += card("Peak impact pressure", significant(pressure.value / 1e3, 3), "kPa", place(scene, pressure) + ", ρv²");
    html += card("Mass balance", mass.closes ? "closed" : fixed(mass.residual, 3), mass.closes ? "" : "m³ missing",
                 fmt::format("deposited&nbsp;{} · moving&nbsp;{} · left&nbsp;{}&nbsp;m³{}", fixed(mass.deposited, 1),
                             fixed(mass.moving, 1), fixed(mass.left, 1),
                             mass.held > 0 ? fmt::format(" · held&nbsp;{}&nbsp;m³", fixed(mass.held, 1)) : ""),
                 mass.closes ? "" : "alert");
    return html;
}

std::string run_quality(const Scene& scene, const RunResult& result) {
    const Observation& o = result.observation;
    const char* status = result.status == RunStatus::complete      ? "complete"
                         : result.status == RunStatus::interrupted ? "partial: interrupted"
                                                                   : "partial: stopped by a fault";
    std::string html =
        row("Status", fmt::format("{}{}", status, result.stop_reason.empty() ? "" : "; " + escape(result.stop_reason)));
    html += row("Simulated time",
                fmt::format("{} s in {} s of wall time, {} steps of {} to {} ms", fixed(result.simulated_time, 1),
                            fixed(result.wall_time, 1), fixed(static_cast<double>(result.steps), 0),
                            fixed(1e3 * result.smallest_time_step, 2), fixed(1e3 * result.largest_time_step, 2)));
    html += row("Real-time factor", fmt::format("{} (simulated over wall time; 1 is real time)",
                                                significant(result.real_time_factor(), 3)));
    html +=
        row("Particles", fmt::format("{}, spacing {} m", fixed(result.particles, 0), plain(result.particle_spacing)));
    html +=
        row("Compression",
            fmt::format(
                "worst mean over the debris {} % (at {} s; limit {} %), worst particle {} % (at {} s; limit {} %): {}",
                fixed(100 * o.worst_mean_compression, 2), fixed(o.worst_mean_time, 1),
                fixed(100 * mean_compression_limit, 0), fixed(100 * o.worst_max_compression, 2),
                fixed(o.worst_max_time, 1), fixed(100 * max_compression_limit, 0),
                within_compression_limits(o)
                    ? "<b class=\"good\">within limits</b>"
                    : fmt::format("<b class=\"bad\">not converged</b> during {} % of the simulated time",
                                  significant(100 * o.compressed_time_share, 2))));
    const MassBalance mass = mass_balance(o);
    html += row(
        "Mass balance",
        fmt::format("released {}{} = held {} + moving {} + deposited {} + left {} m³{}", fixed(o.volume_released, 2),
                    scene.bed.empty() ? "" : fmt::format(" + picked up {}", fixed(mass.entrained, 2)),
                    fixed(mass.held, 2), fixed(mass.moving, 2), fixed(mass.deposited, 2), fixed(mass.left, 2),
                    mass.closes ? "" : fmt::format("; <b class=\"bad\">{} m³ missing</b>", fixed(mass.residual, 3))));
    return html;
}

std::string observation_table(const Scene& scene, const RunResult& result) {
    if (scene.spec.observations.empty()) return "<p>The scene gives no field observation of front velocity.</p>";
    std::string html =
        R"(<table class="data"><thead><tr><th>Observation</th><th class="n">Chainage<br><small>m</small></th><th class="n">Observed<br><small>m/s</small></th><th class="n">Computed front<br><small>m/s</small></th><th class="n">Difference</th><th class="n">Particle speed<br><small>m/s</small></th><th class="n">Arrival<br><small>s</small></th><th>Source</th></tr></thead><tbody>
)";
    for (const ObservationSpec& observed : scene.spec.observations) {
        const FrontSample computed = front_at(result.observation, observed.chainage);
        const double share = 100 * (computed.front_velocity / observed.front_velocity - 1);
        html += fmt::format(
            "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\"><b>{}</b></td><td "
            "class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"source\">{}</td></tr>\n",
            escape(observed.name), fixed(observed.chainage, 0), fixed(observed.front_velocity, 1),
            std::isnan(computed.arrival_time) ? "not reached" : fixed(computed.front_velocity, 1),
            std::isfinite(share) ? fmt::format("{}{} %", share > 0 ? "+" : "", fixed(share, 0)) : "–",
            fixed(computed.particle_speed, 1), fixed(computed.arrival_time, 1), escape(observed.source));
    }
    return html + "</tbody></table>";
}

namespace {

/// Escaped; with what became of a building that was taken away.
std::string displayed_name(const BuildingImpact& b) {
    const std::string name = b.name.empty() ? "unnamed" : escape(b.name);
    return std::isnan(b.removed_time) ? name
                                      : fmt::format("{} <small>(until {} s)</small>", name, fixed(b.removed_time, 1));
}

}  // namespace

std::string building_table(const Scene& scene, const RunResult& result) {
    const auto& impacts = result.observation.buildings;
    if (impacts.empty()) return "<p>The scene has no buildings.</p>";
    std::vector<std::size_t> hit;
    for (std::size_t i = 0; i < impacts.size(); ++i) {
        if (impacts[i].hit) hit.push_back(i);
    }
    const auto assumed = std::count_if(scene.buildings.begin(), scene.buildings.end(),
                                       [](const Building& b) { return b.height_assumed; });
    std::string html, removed;
    for (const BuildingImpact& b : impacts) {
        if (std::isnan(b.removed_time)) continue;
        removed += fmt::format("{}{} at {} s", removed.empty() ? "" : ", ", b.name.empty() ? "unnamed" : escape(b.name),
                               fixed(b.removed_time, 1));
    }
    if (hit.empty()) {
        html = fmt::format("<p><b>No building was hit.</b> Debris reached none of the {} in the scene.</p>",
                           plural(impacts.size(), "building"));
    } else {
        std::stable_sort(hit.begin(), hit.end(), [&](std::size_t a, std::size_t b) {
            return impacts[a].peak_pressure > impacts[b].peak_pressure;
        });
        html =
            R"(<table class="data"><thead><tr><th>Building</th><th class="n">First hit<br><small>s</small></th><th class="n">Peak force<br><small>kN</small></th><th class="n">Peak pressure<br><small>kPa, filtered</small></th><th class="n">Peak ρv² beside it<br><small>kPa</small></th><th class="n">Peak depth at walls<br><small>m</small></th><th class="n">Height<br><small>m</small></th></tr></thead><tbody>
)";
        constexpr std::size_t shown = 30;
        for (std::size_t k = 0; k < std::min(shown, hit.size()); ++k) {
            const BuildingImpact& b = impacts[hit[k]];
            std::string height = "–";
            if (hit[k] < scene.buildings.size()) {
                const Building& building = scene.buildings[hit[k]];
                height = fixed(building.height, 1) + (building.height_assumed ? "<sup>a</sup>" : "");
            }
            html += fmt::format(
                R"(<tr><td><i class="dot hit-{}"></i>{}</td><td class="n">{}</td><td class="n">{}</td><td class="n"><b>{}</b></td><td class="n">{}</td><td class="n">{}</td><td class="n">{}</td></tr>
)",
                impact_class(b), displayed_name(b), fixed(b.first_hit_time, 1), significant(b.peak_force / 1e3, 3),
                significant(b.peak_pressure / 1e3, 3), significant(b.peak_dynamic_pressure / 1e3, 3),
                fixed(b.peak_depth, 2), height);
        }
        html += "</tbody></table>";
        if (hit.size() > shown) {
            html += fmt::format("<p>The first {} of {} buildings hit, by pressure; buildings.csv has them all.</p>",
                                shown, hit.size());
        }
        html += fmt::format("<p class=\"note\">Hit: {} of {}. ", hit.size(), plural(impacts.size(), "building"));
        html += fmt::format(
            "Force is what the simulation exchanges with the walls, normal to them, averaged over {} s; pressure is "
            "that force over the wall area in contact. Colours: below 15, 15 to 30 and over 30 kPa, the limits between "
            "slight, extensive and complete damage to buildings not of reinforced concrete (Kang &amp; Kim 2014).</p>",
            plain(scene.spec.outputs.impact_filter_window));
    }
    if (!removed.empty()) {
        html += fmt::format(
            "<p class=\"note\">Taken away while the run went on: {}. What is told of them is until then.</p>", removed);
    }
    if (assumed > 0) {
        html += fmt::format("<p class=\"note\"><sup>a</sup> Height assumed, not in the data ({} of {}).</p>", assumed,
                            plural(scene.buildings.size(), "building"));
    }
    return html;
}

}  // namespace talus::report
