#include <cmath>
#include <ctime>
#include <string>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "calibrate/calibration_figures.hpp"
#include "calibrate/calibration_products.hpp"
#include "calibration_report_files.hpp"
#include "params/fields.hpp"
#include "products/report_text.hpp"

namespace talus {

using namespace report;

namespace {

std::string card(const std::string& name, const std::string& value, const std::string& unit, const std::string& below) {
    return fmt::format(
        "<div class=\"card\"><dt>{}</dt><dd><strong>{}</strong> <span class=\"unit\">{}</span>"
        "<div class=\"below\">{}</div></dd></div>\n",
        name, value, unit, below);
}

std::string key_results(const Calibration& c, const CalibrationSummary& s) {
    const SearchRun& best = c.result.runs[*c.result.best];
    std::string html = card(
        "Least misfit", significant(best.misfit, 3), "",
        fmt::format("{} observation{}; run {}", c.observed.size(), c.observed.size() == 1 ? "" : "s", *c.result.best));
    for (std::size_t k = 0; k < std::min<std::size_t>(2, s.factors.size()); ++k) {
        html += card(escape(shortened(c.factors[k].key, 34)), significant(s.factors[k].median, 3), "",
                     fmt::format("95 %: {} to {}; best fit {}", significant(s.factors[k].low, 3),
                                 significant(s.factors[k].high, 3), significant(s.factors[k].best, 3)));
    }
    return html + card("Runs", fmt::format("{}", s.complete), "",
                       s.failed > 0       ? fmt::format("{} failed", s.failed)
                       : c.result.settled ? "ended as nothing more was to be learned"
                                          : "as many as allowed");
}

std::string unit_of(const std::string& key) {
    const std::size_t dot = key.find('.');
    const Section* section = find_section(key.substr(0, std::min(dot, key.find('['))));
    const Parameter* parameter = section != nullptr ? section->find(key.substr(dot + 1)) : nullptr;
    if (parameter == nullptr) return "";
    return parameter->unit == "m3" ? "m³" : parameter->unit;
}

std::string factor_table(const Calibration& c, const CalibrationSummary& s) {
    std::string html;
    for (std::size_t k = 0; k < s.factors.size(); ++k) {
        const FactorResult& f = s.factors[k];
        html += fmt::format(
            "<tr><td><code>{}</code></td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td "
            "class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{} %</td><td>{}</td></tr>\n",
            escape(c.factors[k].key), escape(c.factors[k].distribution.text()), significant(f.best, 4),
            significant(f.median, 3), significant(f.low, 3), significant(f.high, 3), fixed(100 * f.kept, 0),
            escape(unit_of(c.factors[k].key)));
    }
    return html;
}

std::string correlation_table(const Calibration& c) {
    std::string html = "<thead><tr><th></th>";
    for (const Factor& f : c.factors) html += fmt::format("<th class=\"n\">{}</th>", escape(f.key));
    html += "</tr></thead><tbody>\n";
    for (std::size_t k = 0; k < c.factors.size(); ++k) {
        html += fmt::format("<tr><td><code>{}</code></td>", escape(c.factors[k].key));
        for (std::size_t other = 0; other < c.factors.size(); ++other) {
            const double r = other == k ? 1 : c.result.posterior.correlation(k, other);
            html += fmt::format("<td class=\"n\">{}</td>", fixed(r, 2));
        }
        html += "</tr>\n";
    }
    return html + "</tbody>";
}

std::string observation_table(const Calibration& c, const CalibrationSummary& s) {
    std::string html;
    for (std::size_t j = 0; j < s.observations.size(); ++j) {
        const ObservationResult& o = s.observations[j];
        const ObservedValue& observed = c.observed[j];
        const char* side = observed.kind == ObservedValue::Kind::at_least ? "≥ "
                           : observed.kind == ObservedValue::Kind::below  ? "&lt; "
                                                                          : "";
        html += fmt::format(
            "<tr><td>{}</td><td class=\"n\">{}{} ± {}</td><td class=\"n\">{}</td><td class=\"n\"><span "
            "class=\"{}\">{}</span></td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td "
            "class=\"n\">{}</td><td>{}</td></tr>\n",
            escape(observed.name), side, significant(observed.value, 3), significant(observed.uncertainty, 2),
            significant(o.best, 3), std::abs(o.deviation) > 2 ? "bad" : "good", fixed(o.deviation, 1),
            significant(o.low, 3), significant(o.high, 3), significant(o.left_out, 2), significant(o.noise, 2),
            observed.unit);
    }
    return html;
}

std::string convergence_table(const Calibration& c, const CalibrationSummary& s) {
    std::string html;
    const auto row = [&](const std::string& name, const std::string& value) {
        html += fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", name, value);
    };
    const SearchResult& r = c.result;
    row("Less misfit still expected", significant(r.improvement, 2));
    row("Emulators beside observations",
        fmt::format("{} standard deviations, over the posterior", fixed(r.emulator_share, 2)));
    row("Checks within their 95 %", std::isfinite(s.checks_within)
                                        ? fmt::format("{} % of {} results of runs drawn from the posterior",
                                                      fixed(100 * s.checks_within, 0), r.checks.size())
                                        : std::string("none were run"));
    row("Change by the checks", fmt::format("{} standard deviations, of any median", fixed(r.shift, 2)));
    for (std::size_t k = 0; k < s.factors.size(); ++k) {
        row("Chains of " + escape(c.factors[k].key),
            fmt::format("R-hat {}, {} effective draws", fixed(s.factors[k].r_hat, 3),
                        fixed(s.factors[k].effective, 0)));
    }
    row("Accepted steps", fmt::format("{} %", fixed(100 * r.posterior.accepted, 0)));
    for (std::size_t j = 0; j < s.observations.size(); ++j) {
        row("Emulator of " + escape(c.observed[j].name),
            fmt::format(
                "tells {} % of the variance of runs that it does not know, and of {} % of them whether debris comes",
                fixed(100 * s.observations[j].explained, 1), fixed(100 * s.observations[j].reach_told, 0)));
    }
    return html;
}

std::string warning_list(const CalibrationSummary& s) {
    if (s.warnings.empty()) return "";
    std::string html = "<h3>To mind</h3>\n<ul>\n";
    for (const std::string& warning : s.warnings) html += "<li>" + escape(warning) + "</li>\n";
    return html + "</ul>\n";
}

std::string method_text(const Calibration& c) {
    double wall = 0;
    for (const RunRecord& record : c.records) wall += record.wall_time;
    return fmt::format(
        "<p>Every dot is a full simulation. A Gaussian process (Matérn 5/2, a length per factor, a linear trend, noise "
        "of "
        "its own) stands for each predicted observation between runs. After a Latin hypercube, runs were made where "
        "the "
        "sum of squared deviations was expected to fall most (expected improvement of a composite function, Astudillo "
        "&amp; Frazier 2019) and where the posterior hung most on what emulators did not know. The posterior was drawn "
        "by {} chains of an adaptive Metropolis algorithm (Haario et al. 2001) with the likelihood of independent "
        "normal "
        "deviations; the emulators' variance and the noise of runs add to that of the observations. Its draws were "
        "checked by real runs, which then counted too.</p>\n"
        "<p>Where debris of a run never came, front velocity and run-out count as 0, arrival as the latest end of a "
        "run "
        "and run-up as 15 m below its mark. The runs took {} s of one processor's wall time together. All runs are in "
        "runs.csv; best_fit/scene.toml runs the best one. The interval holds given the scene: what its terrain, "
        "release "
        "and physics get wrong is not in it.</p>",
        chain_count, significant(wall, 3));
}

}  // namespace

std::string render_calibration_report(const Calibration& c) {
    const SceneInfo& info = c.scene->spec.scene;
    const CalibrationSummary s = summarise(c);
    const MisfitMap map = misfit_map(c);
    const std::string date = fmt::format("{:%d %B %Y, %H:%M} UTC", fmt::gmtime(std::time(nullptr)));
    std::string banners;
    if (info.reconstruction) {
        banners +=
            "<div class=\"banner reconstruction\"><b>Reconstruction.</b> The inputs of this scene are reconstructed, "
            "not surveyed.</div>\n";
    }
    std::string style(calibration_report_files::report_css);
    style += calibration_report_files::ensemble_css;
    style += calibration_report_files::calibration_css;
    const std::string description =
        info.description.empty() ? "" : "<p class=\"lead\">" + escape(info.description) + "</p>";
    return fill(calibration_report_files::calibration_html,
                {{"title", escape(info.title)},
                 {"style", style},
                 {"page_note", info.reconstruction ? "Reconstruction, not surveyed" : ""},
                 {"date", date},
                 {"status", "complete"},
                 {"status_class", "complete"},
                 {"version", TALUS_VERSION},
                 {"description", description},
                 {"crs", escape(c.scene->crs.label())},
                 {"banners", banners},
                 {"key_results", key_results(c, s)},
                 {"warnings", warning_list(s)},
                 {"factor_table", factor_table(c, s)},
                 {"misfit_figure", misfit_figure(c, map, 1)},
                 {"factor_figure", factor_figure(c, s, 2)},
                 {"correlation_table", correlation_table(c)},
                 {"observation_figure", observation_figure(c, s, 3)},
                 {"observation_table", observation_table(c, s)},
                 {"convergence_figure", convergence_figure(c, 4)},
                 {"convergence_table", convergence_table(c, s)},
                 {"method", method_text(c)}});
}

}  // namespace talus
