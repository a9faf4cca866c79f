#include "calibrate/calibration_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "ensemble/reduction.hpp"
#include "calibration_report_files.hpp"
#include "params/fields.hpp"
#include "products/report_colour.hpp"
#include "products/report_plot.hpp"
#include "products/report_text.hpp"

namespace talus::report {
namespace {

constexpr std::array<double, 9> misfit_breaks = {0, 0.5, 1, 2, 4, 8, 16, 32, 64};  // limits of the map's colours

Colour misfit_colour(double misfit) {
    std::size_t index = 0;
    while (index + 1 < misfit_breaks.size() && misfit >= misfit_breaks[index + 1]) ++index;
    constexpr Ramp ramp = {95, 0.05, 262, 0.12, 0.96, 0.34};
    return ramp.at(1 - static_cast<double>(index) / (misfit_breaks.size() - 1));
}

std::string circle(double x, double y, double radius, std::string_view css_class) {
    return fmt::format(R"(<circle class="{}" cx="{}" cy="{}" r="{}"/>)", css_class, coordinate(x), coordinate(y),
                       radius);
}

std::string cell(double x1, double x2, double y1, double y2, const std::string& colour) {
    // A little larger than it is, or seams show between cells.
    return fmt::format(R"(<rect x="{}" y="{}" width="{}" height="{}" fill="{}"/>)", coordinate(std::min(x1, x2)),
                       coordinate(std::min(y1, y2)), coordinate(std::abs(x2 - x1) + 0.4),
                       coordinate(std::abs(y2 - y1) + 0.4), colour);
}

const char* dot_class(SearchPhase phase) {
    return phase == SearchPhase::design ? "dot-design" : phase == SearchPhase::search ? "dot-search" : "dot-check";
}

double value_of(const Calibration& c, std::size_t factor, const std::vector<double>& point) {
    return c.factors[factor].distribution.quantile(point[factor]);
}

/// The factor's value in the scene as given; NaN where it is none or not given.
double given_value(const Calibration& c, std::size_t factor) {
    const std::string& key = c.factors[factor].key;
    double found = never;
    for_each_value(c.scene->spec, [&](const Section& section, std::size_t index, const Parameter& parameter,
                                      const ParameterValue& value) {
        const auto* number = std::get_if<double>(&value);
        if (number == nullptr) return;
        if (key_path(section, index, parameter) == key || (index == 0 && section.name + "." + parameter.key == key)) {
            found = *number;
        }
    });
    return found;
}

std::string cross(double x, double y) {
    return fmt::format(R"(<path class="given-mark" d="M{0} {2}L{1} {3}M{0} {3}L{1} {2}"/>)", coordinate(x - 6),
                       coordinate(x + 6), coordinate(y - 6), coordinate(y + 6));
}

/// The colours of the map with the misfits between which they stand.
std::string colour_key(double left, double top) {
    std::string svg =
        fmt::format(R"(<text class="note-strong" x="{}" y="{}">Misfit</text>)", coordinate(left), coordinate(top - 8));
    for (std::size_t i = 0; i < misfit_breaks.size(); ++i) {
        const double y = top + 22 * static_cast<double>(i);
        svg += cell(left, left + 18, y, y + 22, misfit_colour(misfit_breaks[i]).hex());
        const bool last = i + 1 == misfit_breaks.size();
        svg += fmt::format(R"(<text class="tick" x="{}" y="{}">{}</text>)", coordinate(left + 25), coordinate(y + 15),
                           last ? fmt::format("over {}", misfit_breaks[i])
                                : fmt::format("{} – {}", misfit_breaks[i], misfit_breaks[i + 1]));
    }
    return svg;
}

std::string dot_key(double left, double top, bool given) {
    std::string svg;
    double y = top;
    const auto row = [&](const std::string& mark, std::string_view name) {
        svg += mark + fmt::format(R"(<text class="tick" x="{}" y="{}">{}</text>)", coordinate(left + 25),
                                  coordinate(y + 4), name);
        y += 20;
    };
    row(circle(left + 9, y, 3.6, "dot-design"), "design");
    row(circle(left + 9, y, 3.6, "dot-search"), "search");
    row(circle(left + 9, y, 3.6, "dot-check"), "check");
    row(circle(left + 9, y, 7, "best-mark"), "best fit");
    if (given) row(cross(left + 9, y), "as given");
    return svg;
}

/// Both panels over the first two factors.
std::string draw_plane(const Calibration& c, const MisfitMap& map) {
    const ValueRange x{map.x.front(), map.x.back()}, y{map.y.front(), map.y.back()};
    Plot left(70, 24, 350, 350, x, y);
    std::string cells;
    for (std::size_t i = 0; i < map.misfit.size(); ++i) {
        const std::size_t column = i % map.cells, row = i / map.cells;
        cells += cell(left.px(map.x[column]), left.px(map.x[column + 1]), left.py(map.y[row]), left.py(map.y[row + 1]),
                      misfit_colour(map.misfit[i]).hex());
    }
    left.axes(c.factors[0].key, c.factors[1].key);
    std::string dots;
    for (const SearchRun& run : c.result.runs) {
        dots += circle(left.px(value_of(c, 0, run.point)), left.py(value_of(c, 1, run.point)), 3.6,
                       run.predicted.empty() ? "dot-failed" : dot_class(run.phase));
    }
    Plot right(640, 24, 350, 350, x, y);
    right.axes(c.factors[0].key, c.factors[1].key);
    std::string draws;
    for (const auto& draw : c.result.posterior.draws) {
        draws += circle(right.px(std::clamp(value_of(c, 0, draw), x.low, x.high)),
                        right.py(std::clamp(value_of(c, 1, draw), y.low, y.high)), 1.5, "draw-dot");
    }
    const auto& best = c.result.runs[*c.result.best].point;
    const double given_x = given_value(c, 0), given_y = given_value(c, 1);
    const bool given = given_x >= x.low && given_x <= x.high && given_y >= y.low && given_y <= y.high;
    for (const Plot* plot : {&left, &right}) {
        dots += circle(plot->px(value_of(c, 0, best)), plot->py(value_of(c, 1, best)), 7, "best-mark");
        if (given) dots += cross(plot->px(given_x), plot->py(given_y));
    }
    const std::string titles =
        R"(<text class="note-strong" x="70" y="14">Misfit and runs</text><text class="note-strong" x="640" y="14">Draws from the posterior</text>)";
    return cells + left.svg() + right.svg() + draws + dots + colour_key(440, 44) + dot_key(440, 272, given) + titles;
}

/// The only factor.
std::string draw_line(const Calibration& c, const MisfitMap& map) {
    const ValueRange x{map.x.front(), map.x.back()};
    std::vector<double> at;
    ValueRange y{0, 1};
    for (std::size_t i = 0; i < map.cells; ++i) {
        at.push_back((map.x[i] + map.x[i + 1]) / 2);
        y.include(std::min(map.misfit[i], 100.0));
    }
    y.high *= 1.05;
    Plot plot(70, 24, 760, 350, x, y);
    plot.axes(c.factors[0].key, "misfit");
    std::vector<double> shown;
    for (const double misfit : map.misfit) shown.push_back(misfit <= y.high ? misfit : never);
    plot.line(at, shown, "series blue");
    std::string dots;
    for (const SearchRun& run : c.result.runs) {
        if (!(run.misfit <= y.high)) continue;
        dots += circle(plot.px(value_of(c, 0, run.point)), plot.py(run.misfit), 3.6, dot_class(run.phase));
    }
    return plot.svg() + dots + dot_key(850, 44, false);
}

constexpr const char* misfit_title = "Misfit of all runs";

std::string draw_misfit(const Calibration& c, const MisfitMap& map) {
    return map.y.empty() ? draw_line(c, map) : draw_plane(c, map);
}

}  // namespace

std::string misfit_figure(const Calibration& c, const MisfitMap& map, int number) {
    const std::string others =
        c.factors.size() > 2 ? " at those values of the other factors that fit best there" : std::string();
    return "<figure>" + figure_svg(1000, 440, misfit_title, draw_misfit(c, map)) +
           caption(
               number, "Misfit and posterior.",
               fmt::format("Left: sum of the squared deviations from the observations in standard deviations, as the "
                           "emulators have it{}; a dot per run. Right: {} draws from the posterior.",
                           others, c.result.posterior.draws.size())) +
           "</figure>";
}

std::string misfit_picture(const Calibration& c, const MisfitMap& map) {
    std::string svg = figure_svg(1000, 440, misfit_title, draw_misfit(c, map));
    const std::string style = fmt::format(
        "<style>svg{{font-family:'Liberation Sans',Arial,sans-serif;font-size:13px;background:#fff}}{}</style>",
        calibration_report_files::calibration_css);
    const std::size_t end = svg.find('>');
    svg.insert(end + 1, style);
    constexpr std::string_view tag = "<svg";
    if (svg.find("xmlns") == std::string::npos) svg.insert(tag.size(), R"( xmlns="http://www.w3.org/2000/svg")");
    return svg + "\n";
}

std::string factor_figure(const Calibration& c, const CalibrationSummary& s, int number) {
    constexpr std::size_t columns = 3, bars = 30;
    constexpr double width = 1000.0 / columns, height = 240;
    std::string svg;
    for (std::size_t k = 0; k < s.factors.size(); ++k) {
        const Distribution& prior = c.factors[k].distribution;
        const bool open = prior.kind == DistributionKind::normal;
        const ValueRange x{prior.quantile(open ? 0.005 : 0), prior.quantile(open ? 0.995 : 1)};
        std::vector<double> counts(bars, 0), before_x, before;
        const double step = (x.high - x.low) / bars,
                     share = 100.0 / static_cast<double>(c.result.posterior.draws.size());
        for (const auto& draw : c.result.posterior.draws) {
            const double at = (value_of(c, k, draw) - x.low) / step;
            counts[static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(bars - 1)))] += share;
        }
        ValueRange y{0, 1};
        for (const double count : counts) y.include(count * 1.1);
        for (std::size_t i = 0; i < bars; ++i) {
            const double from = x.low + step * static_cast<double>(i);
            before_x.insert(before_x.end(), {from, from + step});
            const double part = 100 * (share_below(prior, from + step) - share_below(prior, from));
            before.insert(before.end(), {part, part});
            y.include(part * 1.1);
        }
        const double left = width * static_cast<double>(k % columns) + 56;
        const std::size_t row = k / columns;
        Plot plot(left, height * static_cast<double>(row) + 16, width - 76, height - 66, x, y);
        plot.axes(c.factors[k].key, k % columns == 0 ? "draws, %" : "");
        for (std::size_t i = 0; i < bars; ++i) {
            if (counts[i] <= 0) continue;
            const double from = x.low + step * static_cast<double>(i), top = plot.py(counts[i]);
            svg += fmt::format(R"(<rect class="bar" x="{}" y="{}" width="{}" height="{}"/>)",
                               coordinate(plot.px(from) + 0.5), coordinate(top),
                               coordinate(plot.px(from + step) - plot.px(from) - 1), coordinate(plot.py(0) - top));
        }
        plot.line(before_x, before, "series black");
        for (const double limit : {s.factors[k].low, s.factors[k].high}) plot.vertical(limit, "percentile-line");
        svg += plot.svg();
    }
    const std::size_t rows = (s.factors.size() + columns - 1) / columns;
    return "<figure>" + figure_svg(1000, height * static_cast<double>(rows), "Factors before and after", svg) +
           caption(number, "What is known of each factor.",
                   "Bars: draws from the posterior; red: the interval that holds 95 % of them. Dashed: the same before "
                   "the observations, as the plan states it.") +
           "</figure>";
}

std::string observation_figure(const Calibration& c, const CalibrationSummary& s, int number) {
    constexpr double row = 46, left = 300, top = 26, width = 660;
    ValueRange x{-3, 3};
    const auto scaled = [&](std::size_t j, double value) {
        const double shown = std::isfinite(value) ? value : c.observed[j].unreached;
        return std::clamp((shown - c.observed[j].value) / c.observed[j].uncertainty, -12.0, 12.0);
    };
    for (std::size_t j = 0; j < s.observations.size(); ++j) {
        const ObservationResult& o = s.observations[j];
        for (const double value : {o.prior_low, o.prior_high, o.low, o.high, o.best})
            x.include(scaled(j, value) * 1.08);
    }
    const double height = row * static_cast<double>(s.observations.size());
    Plot plot(left, top, width, height, x, {0, 1});
    std::string svg = fmt::format(R"(<text class="axis-title" x="{}" y="{}" text-anchor="middle">{}</text>)",
                                  coordinate(left + width / 2), coordinate(top + height + 38),
                                  "standard deviations from what was observed");
    const Ticks ticks = round_ticks(x, 8);
    for (const double value : ticks.values) {
        plot.vertical(value, value == 0 ? "axis" : "grid");
        svg += fmt::format(R"(<text class="tick" x="{}" y="{}" text-anchor="middle">{}</text>)",
                           coordinate(plot.px(value)), coordinate(top + height + 17), fixed(value, ticks.digits));
    }
    for (std::size_t j = 0; j < s.observations.size(); ++j) {
        const ObservationResult& o = s.observations[j];
        const ObservedValue& observed = c.observed[j];
        const double y = top + row * (static_cast<double>(j) + 0.5);
        const auto line = [&](double from, double to, double at, const char* css_class) {
            return fmt::format(R"(<line class="{0}" x1="{1}" x2="{2}" y1="{3}" y2="{3}"/>)", css_class,
                               coordinate(plot.px(scaled(j, from))), coordinate(plot.px(scaled(j, to))),
                               coordinate(at));
        };
        const char* side = observed.kind == ObservedValue::Kind::at_least ? "at least "
                           : observed.kind == ObservedValue::Kind::below  ? "below "
                                                                          : "";
        svg += fmt::format(R"(<text class="row-name" x="0" y="{}">{}</text>)", coordinate(y - 2),
                           escape(shortened(observed.name, 42)));
        svg += fmt::format(R"(<text class="tick" x="0" y="{}">{}{} ± {} {}; best fit {}</text>)", coordinate(y + 14),
                           side, significant(observed.value, 3), significant(observed.uncertainty, 2), observed.unit,
                           significant(o.best, 3));
        svg +=
            line(observed.value - observed.uncertainty, observed.value + observed.uncertainty, y - 11, "span-observed");
        svg += line(o.prior_low, o.prior_high, y + 11, "span-before") + line(o.low, o.high, y, "span-after");
        for (const Check& check : c.result.checks) {
            if (check.observation != j) continue;
            svg += circle(plot.px(scaled(j, check.computed)), y, 3.4, "dot-check");
        }
        svg += circle(plot.px(scaled(j, o.best)), y, 6, "best-mark");
    }
    return "<figure>" + figure_svg(1000, top + height + 56, "Predicted against observed", plot.svg() + svg) +
           caption(
               number, "Predicted against observed.",
               "Dark: one standard deviation around what was observed. Blue: 95 % of runs that the posterior expects. "
               "Grey: 90 % of the runs of the design, before anything was learned. Green dots: runs that check the "
               "posterior; ring: the best fit. Beyond 12 standard deviations marks are drawn there.") +
           "</figure>";
}

std::string convergence_figure(const Calibration& c, int number) {
    const auto& runs = c.result.runs;
    ValueRange x{0, static_cast<double>(runs.size())}, y{-2, 1};
    const auto level = [](double misfit) { return std::log10(std::max(misfit, 0.01)); };
    for (const SearchRun& run : runs) y.include(level(run.misfit));
    y.high += 0.1;
    Plot left(70, 24, 400, 250, x, y);
    left.axes("run", "log10 of the misfit");
    std::string dots;
    std::vector<double> at, least;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        if (runs[i].predicted.empty()) continue;
        const double best = std::min(level(runs[i].misfit), least.empty() ? 1e9 : least.back());
        at.push_back(static_cast<double>(i) + 1);
        least.push_back(best);
        dots += circle(left.px(at.back()), left.py(level(runs[i].misfit)), 3.4, dot_class(runs[i].phase));
    }
    left.line(at, least, "series black");

    ValueRange range{-3, 3};
    std::vector<std::pair<double, double>> pairs;
    for (std::size_t j = 0; j < c.observed.size(); ++j) {
        if (!c.result.fit.emulators[j].value()) continue;
        for (const Emulator::LeftOut& run : c.result.fit.emulators[j].value()->leave_one_out()) {
            const auto scaled = [&](double value) {
                return std::clamp((value - c.observed[j].value) / c.observed[j].uncertainty, -12.0, 12.0);
            };
            pairs.emplace_back(scaled(run.computed), scaled(run.mean));
            range.include(pairs.back().first);
            range.include(pairs.back().second);
        }
    }
    Plot right(570, 24, 400, 250, range, range);
    right.axes("computed, standard deviations from observed", "by the emulator");
    const std::vector<double> ends = {range.low, range.high};
    right.line(ends, ends, "series black");
    std::string emulated;
    for (const auto& pair : pairs) emulated += circle(right.px(pair.first), right.py(pair.second), 2.6, "run-dot");
    return "<figure>" + figure_svg(1000, 330, "Convergence", left.svg() + dots + right.svg() + emulated) +
           caption(
               number, "Convergence.",
               "Left: misfit of every run, and the least so far (white: design, orange: search, green: check; below "
               "0.01 drawn there). Right: every run's results as the emulators tell them from all other runs; on the "
               "line they are right. Runs whose debris did not come there are left out.") +
           "</figure>";
}

}  // namespace talus::report
