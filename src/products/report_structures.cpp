// What debris did to barriers, and the force on what it hit, over time.
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "products/report_plot.hpp"
#include "products/report_sections.hpp"
#include "products/report_text.hpp"

namespace talus::report {
namespace {

constexpr std::size_t most_lines = 8;  // of the figure: report.css has so many colours
constexpr std::size_t most_nets = 4;   // a plot each

/// Structures with a history to draw, those under the greatest force first.
std::vector<const BuildingImpact*> drawn(const RunResult& result) {
    std::vector<const BuildingImpact*> all;
    for (const BuildingImpact& impact : result.observation.buildings) {
        if (impact.history.size() > 1 && impact.peak_force > 0) all.push_back(&impact);
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const auto* a, const auto* b) { return a->peak_force > b->peak_force; });
    if (all.size() > most_lines) all.resize(most_lines);
    return all;
}

std::string name_of(const BuildingImpact& impact) {
    return impact.name.empty() ? "unnamed" : impact.name;
}

std::string failures(const std::vector<BuildingImpact>& impacts) {
    std::string html;
    for (const BuildingImpact& impact : impacts) {
        if (std::isnan(impact.failure_time)) continue;
        html +=
            fmt::format("<p><b>{} failed at {} s</b>: the force exceeded its resistance; from then on it is gone.</p>",
                        escape(name_of(impact)), fixed(impact.failure_time, 2));
    }
    return html;
}

/// A sentence on each net that debris met.
std::string net_balances(const std::vector<BuildingImpact>& impacts) {
    std::string html;
    for (const BuildingImpact& net : impacts) {
        if (!net.hit || std::isnan(net.passing_share)) continue;
        const double let_by = net.passed_volume + net.overtopped_volume, all = net.held_volume + let_by;
        html += fmt::format(
            "<p><b>{}</b>, a net: its meshes let {} % of the grains through, by volume, and hold the others. Of {} m³ "
            "that "
            "came to it, {} m³ lie behind it{}, {} m³ went through and {} m³ over it; at most {} kN bore on it.</p>\n",
            escape(name_of(net)), fmt::format("{:.3g}", 100 * net.passing_share), fixed(all, 1),
            fixed(net.held_volume, 1), all > 0 ? fmt::format(" ({} %)", fixed(100 * net.held_volume / all, 0)) : "",
            fixed(net.passed_volume, 1), fixed(net.overtopped_volume, 1), significant(net.peak_force / 1e3, 3));
    }
    return html;
}

}  // namespace

std::string barrier_table(const RunResult& result) {
    const auto& impacts = result.observation.buildings;
    std::string html = failures(impacts);
    if (std::none_of(impacts.begin(), impacts.end(), [](const auto& b) { return b.is_barrier; })) return html;
    html +=
        R"(<h3>Barriers</h3><table class="data"><thead><tr><th>Barrier</th><th class="n">First hit<br><small>s</small></th><th class="n">Peak force<br><small>kN</small></th><th class="n">Impulse<br><small>kN s</small></th><th class="n">Over the crest<br><small>m³</small></th><th class="n">First over<br><small>s</small></th><th class="n">Through openings and meshes<br><small>m³</small></th><th class="n">Held at the end<br><small>m³</small></th><th class="n">Held at most<br><small>m³</small></th><th class="n">Filled at most<br><small>m</small></th></tr></thead><tbody>
)";
    for (const BuildingImpact& b : impacts) {
        if (!b.is_barrier) continue;
        html += fmt::format(
            R"(<tr><td>{}</td><td class="n">{}</td><td class="n">{}</td><td class="n">{}</td><td class="n"><b>{}</b></td><td class="n">{}</td><td class="n">{}</td><td class="n">{}</td><td class="n">{}</td><td class="n">{}</td></tr>
)",
            escape(name_of(b)), fixed(b.first_hit_time, 1), significant(b.peak_force / 1e3, 3),
            significant(b.impulse / 1e3, 3), fixed(b.overtopped_volume, 1), fixed(b.first_overtopping_time, 1),
            fixed(b.passed_volume, 1), fixed(b.held_volume, 1), fixed(b.peak_held_volume, 1),
            fixed(b.peak_filling_height, 2));
    }
    return html +
           R"(</tbody></table><p class="note">Over the crest and through openings or the meshes of nets: what crossed the barrier's line
and did not come back; around its ends is neither. Held: debris upstream within five heights of the line. Filled: mean
depth of the deepest section, four particles square, along the upstream face. All of it until a barrier fails.</p>
)" + net_balances(impacts);
}

bool has_structure_figure(const RunResult& result) {
    return !drawn(result).empty();
}

std::string structure_figure(const RunResult& result) {
    const std::vector<const BuildingImpact*> all = drawn(result);
    ValueRange time{0, 0}, forces{0, 0};
    for (const BuildingImpact* impact : all) {
        for (const StructureSample& s : impact->history) {
            time.include(s.time);
            forces.include(s.force / 1e3);
        }
    }
    forces.high = std::max(forces.high * 1.05, 1e-3);
    constexpr double left = 66, width = 640, height = 250;
    Plot plot(left, 24, width, height, time, forces);
    plot.axes("time, s", "force, kN");
    std::string names;
    for (std::size_t k = 0; k < all.size(); ++k) {
        std::vector<double> t, force;
        for (const StructureSample& s : all[k]->history) {
            t.push_back(s.time);
            force.push_back(s.force / 1e3);
        }
        const std::string colour = fmt::format("series v{}", k);
        plot.line(t, force, colour);
        const double y = 40 + 24 * static_cast<double>(k);
        names += fmt::format(
            R"(<line class="{} sample" x1="730" y1="{}" x2="756" y2="{}"/><text class="key" x="762" y="{}">{}</text>)",
            colour, y, y, y + 4, escape(shortened(name_of(*all[k]), 30)));
        if (!std::isnan(all[k]->failure_time)) plot.vertical(all[k]->failure_time, "toe-line");
    }
    return figure_svg(1000, 320, "Force on structures over time", plot.svg() + names);
}

std::string net_figure(const RunResult& result) {
    std::vector<const BuildingImpact*> nets;
    for (const BuildingImpact& impact : result.observation.buildings) {
        if (!std::isnan(impact.passing_share) && impact.history.size() > 1) nets.push_back(&impact);
    }
    std::stable_sort(nets.begin(), nets.end(),
                     [](const auto* a, const auto* b) { return a->peak_force > b->peak_force; });
    if (nets.size() > most_nets) nets.resize(most_nets);
    if (nets.empty()) return "";
    constexpr double left = 66, width = 640, height = 190, step = 270;
    std::string content;
    for (std::size_t k = 0; k < nets.size(); ++k) {
        ValueRange time{0, 0}, volume{0, 1e-3};
        std::vector<double> t, held, through, over;
        for (const StructureSample& s : nets[k]->history) {
            t.push_back(s.time);
            held.push_back(s.held_volume);
            through.push_back(s.passed_volume);
            over.push_back(s.overtopped_volume);
            time.include(s.time);
            for (const double value : {held.back(), through.back(), over.back()}) volume.include(value);
        }
        volume.high *= 1.05;
        const double top = 34 + step * static_cast<double>(k);
        Plot plot(left, top, width, height, time, volume);
        plot.axes("time, s", "volume, m³");
        plot.line(t, held, "series v0");
        plot.line(t, through, "series v1");
        plot.line(t, over, "series v2");
        plot.keys({{"series v0", "held"}, {"series v1", "through"}, {"series v2", "over"}});
        if (!std::isnan(nets[k]->failure_time)) plot.vertical(nets[k]->failure_time, "toe-line");
        content += plot.svg() + fmt::format(R"(<text class="key" x="730" y="{}">{}</text>)", top + 16,
                                            escape(shortened(name_of(*nets[k]), 34)));
    }
    return figure_svg(1000, step * static_cast<double>(nets.size()) + 20, "What nets held and let through", content);
}

}  // namespace talus::report
