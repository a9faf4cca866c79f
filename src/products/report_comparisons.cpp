#include <algorithm>
#include <cctype>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "products/report_plot.hpp"
#include "products/report_sections.hpp"
#include "products/report_text.hpp"

namespace talus::report {
namespace {

constexpr const char* base_class = "series base";

/// Colours repeat after eight variants, dashed.
std::string variant_class(std::size_t i) {
    constexpr std::size_t colours = 8;
    return fmt::format("series v{}{}", i % colours, i >= colours ? " dashed" : "");
}

std::string sample(std::string_view css_class) {
    return fmt::format(
        R"(<svg class="sample" viewBox="0 0 26 8"><line class="{}" x1="0" y1="4" x2="26" y2="4"/></svg>)", css_class);
}

std::string percent_text(double percent) {
    return fmt::format("{}{} %", percent > 0 ? "+" : "", fixed(percent, 1));
}

std::string cost_cells(const RunResult& result) {
    const Observation& o = result.observation;
    return fmt::format(R"(<td class="n">{} / {}</td><td class="n">{}</td><td class="n">{}</td>)",
                       fixed(100 * o.worst_mean_compression, 2), fixed(100 * o.worst_max_compression, 1),
                       fixed(result.particles, 0), fixed(result.wall_time, result.wall_time < 10 ? 1 : 0));
}

std::string change_cell(const Quantity& quantity, const Change& change, bool judged) {
    if (change.verdict == Verdict::not_measured) return R"(<td class="n">not measured</td>)";
    std::string below;
    if (std::isfinite(change.percent)) {
        below = percent_text(change.percent);
    } else {
        below = std::isfinite(quantity.base) ? "base reached it" : "base did not";
    }
    const char* css_class = !judged ? "" : change.verdict == Verdict::pass ? "good" : "bad";
    return fmt::format(R"(<td class="n">{}<br><small class="{}">{}</small></td>)",
                       std::isfinite(change.value) ? significant(change.value, 3) : "not reached", css_class, below);
}

std::string result_cell(const Comparison::Row& row) {
    switch (row.verdict()) {
        case Verdict::pass:
            return R"(<td class="result"><b class="good">pass</b></td>)";
        case Verdict::fail:
            return R"(<td class="result"><b class="bad">fail</b></td>)";
        default:
            return R"(<td class="result">–</td>)";
    }
}

std::string capitalised(std::string text) {
    text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
}

/// "Front velocity" over "at 121 m"; "Run-out" is not broken at its hyphen.
std::string heading(const Quantity& quantity) {
    std::string name = escape(capitalised(quantity.name));
    if (const std::size_t cut = name.find(" at "); cut != std::string::npos) name.replace(cut, 1, "<br>");
    if (const std::size_t hyphen = name.find('-'); hyphen != std::string::npos) name.replace(hyphen, 1, "&#8209;");
    return fmt::format(R"(<th class="n">{}<br><small>{}</small></th>)", name, quantity.unit);
}

std::string table(const Comparison& comparison, const RunResult& base) {
    const bool judged = comparison.kind == ComparisonKind::convergence;
    std::string html = R"(<div class="scroll"><table class="data comparison"><thead><tr><th>Run</th>)";
    for (const Quantity& q : comparison.quantities) html += heading(q);
    html +=
        R"(<th class="n">Compression<br><small>mean / max, %</small></th><th class="n">Particles</th><th class="n">Wall time<br><small>s</small></th>)";
    html += judged ? "<th class=\"result\">Result</th></tr></thead><tbody>\n" : "</tr></thead><tbody>\n";
    html += "<tr class=\"base\"><td>" + sample(base_class) + "as given</td>";
    for (const Quantity& q : comparison.quantities) {
        html +=
            fmt::format(R"(<td class="n">{}</td>)", std::isfinite(q.base) ? significant(q.base, 3) : "not measured");
    }
    html += cost_cells(base) + (judged ? "<td></td></tr>\n" : "</tr>\n");
    for (std::size_t i = 0; i < comparison.rows.size(); ++i) {
        const Comparison::Row& row = comparison.rows[i];
        html += "<tr><td>" + sample(variant_class(i)) + escape(row.run.variant.name) + "</td>";
        if (!row.run.result) {
            html += fmt::format("<td class=\"missing\" colspan=\"{}\">missing: {}</td></tr>\n",
                                comparison.quantities.size() + (judged ? 4 : 3), escape(row.run.missing));
            continue;
        }
        for (std::size_t k = 0; k < comparison.quantities.size(); ++k) {
            html += change_cell(comparison.quantities[k], row.changes[k], judged);
        }
        html += cost_cells(*row.run.result) + (judged ? result_cell(row) : "") + "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

struct Curve {
    std::string css_class;
    std::vector<double> chainage, velocity, arrival;
};

Curve curve_of(std::string css_class, const Observation& observation) {
    Curve curve{std::move(css_class), {}, {}, {}};
    for (const FrontSample& s : observation.front) {
        curve.chainage.push_back(s.chainage);
        curve.velocity.push_back(s.front_velocity);
        curve.arrival.push_back(s.arrival_time);
    }
    return curve;
}

/// The base first: it is drawn broad, and what departs from it on top.
std::vector<Curve> curves_of(const Comparison& comparison, const RunResult& base) {
    std::vector<Curve> curves{curve_of(base_class, base.observation)};
    for (std::size_t i = 0; i < comparison.rows.size(); ++i) {
        const auto& result = comparison.rows[i].run.result;
        if (result) curves.push_back(curve_of(variant_class(i), result->observation));
    }
    return curves;
}

/// Front velocity and arrival time against chainage, the runs over each other; empty where no front was seen.
std::string figure(const Comparison& comparison, const Scene& scene, const RunResult& base) {
    const std::vector<Curve> curves = curves_of(comparison, base);
    ValueRange x{0, 0}, speeds{0, 1}, times{0, 1};
    for (const Curve& curve : curves) {
        for (const double c : curve.chainage) x.include(c);
        for (const double v : curve.velocity) speeds.include(v);
        for (const double t : curve.arrival) times.include(t);
    }
    if (!(x.high > 0)) return "";
    for (const ObservationSpec& o : scene.spec.observations) {
        x.include(o.chainage);
        speeds.include(o.front_velocity);
    }
    x.high *= 1.03;
    speeds.high *= 1.08;
    times.high *= 1.08;
    constexpr double left = 66, width = 916;
    Plot velocity(left, 14, width, 250, x, speeds);
    velocity.axes("", "front velocity, m/s");
    Plot arrival(left, 292, width, 190, x, times);
    arrival.axes("chainage along the flow path, m", "arrival, s");
    for (const ObservationSpec& o : scene.spec.observations) {
        velocity.vertical(o.chainage, "observation-line");
        arrival.vertical(o.chainage, "observation-line");
    }
    for (const Curve& curve : curves) {
        velocity.line(curve.chainage, curve.velocity, curve.css_class);
        arrival.line(curve.chainage, curve.arrival, curve.css_class);
    }
    for (const ObservationSpec& o : scene.spec.observations) velocity.mark(o.chainage, o.front_velocity, "observation");
    return figure_svg(1000, 527, "Front velocity and arrival time against chainage, all runs",
                      velocity.svg() + arrival.svg());
}

std::string key(const Comparison& comparison) {
    std::string html = "<p class=\"figure-key\"><span>" + sample(base_class) + "as given</span>";
    for (std::size_t i = 0; i < comparison.rows.size(); ++i) {
        if (!comparison.rows[i].run.result) continue;
        html += "<span>" + sample(variant_class(i)) + escape(comparison.rows[i].run.variant.name) + "</span>";
    }
    return html + "</p>";
}

std::string notes(const Comparison& comparison) {
    std::string html;
    for (const Quantity& q : comparison.quantities) {
        if (q.not_measured.empty()) continue;
        html += fmt::format("<p class=\"note\">Not measured in the run as given: {} ({}).</p>\n", escape(q.name),
                            escape(q.not_measured));
    }
    const bool velocities = std::any_of(comparison.quantities.begin(), comparison.quantities.end(),
                                        [](const Quantity& q) { return q.unit == "m/s"; });
    if (!velocities) {
        html += "<p class=\"note\">The scene has no observation, so front velocities are drawn but not compared.</p>\n";
    }
    return html;
}

std::string section(const Comparison& comparison, const Scene& scene, const RunResult& base, int figure_number) {
    const bool judged = comparison.kind == ComparisonKind::convergence;
    const Answer answer = comparison.converged();
    std::string html = judged ? "<section id=\"convergence\">\n<h2>Convergence</h2>\n"
                              : "<section id=\"sensitivity\">\n<h2>Sensitivity</h2>\n";
    const std::string verdict = capitalised(comparison.verdict_text());
    html += judged ? fmt::format(
                         "<p><b class=\"{}\">{}.</b> The scene was run again with half the time step at every "
                         "moment, with double the solver iterations, and with three times the particles. A "
                         "result that is to be trusted should change by less than {} %.</p>\n",
                         answer == Answer::yes ? "good" : "bad", escape(verdict), plain(refinement_limit_percent))
                   : fmt::format("<p>{}. Changes are those from the run as given.</p>\n", escape(verdict));
    html += table(comparison, base) + notes(comparison);
    const std::string drawn = figure(comparison, scene, base);
    if (!drawn.empty()) {
        html += fmt::format(
            "<figure>{}{}\n<figcaption><b>Figure {}. Front velocity and arrival time against chainage, the run as "
            "given "
            "and its variants.</b>{}</figcaption></figure>\n",
            key(comparison), drawn, figure_number,
            scene.spec.observations.empty() ? "" : " Diamonds are field observations.");
    }
    return html + "</section>\n";
}

}  // namespace

std::string comparison_banners(const std::vector<Comparison>& comparisons) {
    std::string html;
    for (const Comparison& comparison : comparisons) {
        if (comparison.kind != ComparisonKind::convergence || comparison.converged() == Answer::yes) continue;
        html += fmt::format(
            "<div class=\"banner unconverged\"><b>{}.</b> The results were compared with those of finer numerics; see "
            "<a "
            "href=\"#convergence\">Convergence</a>.</div>\n",
            escape(capitalised(comparison.verdict_text())));
    }
    return html;
}

std::string comparison_sections(const std::vector<Comparison>& comparisons, const Scene& scene, const RunResult& base,
                                int first_figure) {
    std::string html;
    for (const Comparison& comparison : comparisons) html += section(comparison, scene, base, first_figure++);
    return html;
}

}  // namespace talus::report
