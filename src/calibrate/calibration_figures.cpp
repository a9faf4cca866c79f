#include "calibrate/calibration_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "ensemble/reduction.hpp"
#include "params/fields.hpp"
#include "report/colour.hpp"
#include "report/number_text.hpp"

namespace talus::calibrate {
namespace {

constexpr std::array<double, 9> misfit_breaks = {0, 0.5, 1, 2, 4, 8, 16, 32, 64};  // limits of the map's colours

std::vector<std::string> misfit_colours() {
    constexpr Ramp ramp = {95, 0.05, 262, 0.12, 0.96, 0.34};
    std::vector<std::string> colours;
    for (std::size_t i = 0; i < misfit_breaks.size(); ++i) {
        colours.push_back(report::colour_at(ramp, 1 - static_cast<double>(i) / (misfit_breaks.size() - 1)).hex());
    }
    return colours;
}

double value_of(const Calibration& c, std::size_t factor, const std::vector<double>& point) {
    return c.factors[factor].distribution.quantile(point[factor]);
}

/// The factor's value in the scene as given; NaN where it is not a number or not given.
double given_value(const Calibration& c, std::size_t factor) {
    const std::string& key = c.factors[factor].key;
    double found = observe::never;
    for_each_value(c.scene->spec, [&](const params::Section& section, std::size_t index,
                                      const params::Parameter& parameter, const params::ParameterValue& value) {
        const auto* number = std::get_if<double>(&value);
        if (number == nullptr) return;
        if (key_path(section, index, parameter) == key || (index == 0 && section.name + "." + parameter.key == key)) {
            found = *number;
        }
    });
    return found;
}

constexpr std::array<const char*, 4> dot_names = {"design", "search", "check", "failed"};

/// Dots of one style.
report::Curve dots_of(const char* style, const char* name, double radius) {
    return {report::Curve::Shape::dots, style, name, {}, {}, {}, radius};
}

/// The runs of the fast model as dots, if there is one.
template <class Place>
void add_fast_runs(report::Plot& plot, const Calibration& c, const Place& place) {
    report::Curve dots = dots_of("dot-fast", "depth-averaged", 2.2);
    for (const SearchRun& run : c.result.fast_runs) {
        const auto [x, y] = place(run);
        dots.x.push_back(x);
        dots.y.push_back(y);
    }
    if (!dots.x.empty()) plot.curves.push_back(std::move(dots));
}

/// The runs as dots, each kind in its colour; `place` gives the position; NaN: not drawn.
template <class Place>
void add_runs(report::Plot& plot, const Calibration& c, double radius, const Place& place) {
    std::array<report::Curve, 4> kinds = {
        dots_of("dot-design", dot_names[0], radius), dots_of("dot-search", dot_names[1], radius),
        dots_of("dot-check", dot_names[2], radius), dots_of("dot-failed", dot_names[3], radius)};
    for (const SearchRun& run : c.result.runs) {
        const auto [x, y] = place(run);
        report::Curve& kind = kinds[run.predicted.empty()              ? 3
                                    : run.phase == SearchPhase::design ? 0
                                    : run.phase == SearchPhase::search ? 1
                                                                       : 2];
        kind.x.push_back(x);
        kind.y.push_back(y);
    }
    for (report::Curve& kind : kinds) {
        if (!kind.x.empty()) plot.curves.push_back(std::move(kind));
    }
}

/// Both panels over the first two factors.
report::Chart plane_chart(const Calibration& c, const MisfitMap& map) {
    const report::ValueRange x{map.x.front(), map.x.back()}, y{map.y.front(), map.y.back()};
    report::Plot left(70, 24, 350, 350, x, y), right(640, 24, 350, 350, x, y);
    left.name = "Misfit and runs";
    right.name = "Draws from the posterior";
    left.cells = {map.x, map.y, map.misfit, {misfit_breaks.begin(), misfit_breaks.end()}, misfit_colours(), "Misfit"};
    left.key = report::Plot::Key::beside;
    for (report::Plot* plot : {&left, &right}) plot->axes(c.factors[0].key, c.factors[1].key);
    const auto place = [&](const SearchRun& run) {
        return std::pair{value_of(c, 0, run.point), value_of(c, 1, run.point)};
    };
    add_fast_runs(left, c, place);
    add_runs(left, c, 3.6, place);
    report::Curve draws = dots_of("draw-dot", "", 1.5);
    for (const auto& draw : c.result.posterior.draws) {
        draws.x.push_back(std::clamp(value_of(c, 0, draw), x.low, x.high));
        draws.y.push_back(std::clamp(value_of(c, 1, draw), y.low, y.high));
    }
    right.curves.push_back(std::move(draws));
    const auto& best = c.result.runs[*c.result.best].point;
    const double given_x = given_value(c, 0), given_y = given_value(c, 1);
    const bool given = given_x >= x.low && given_x <= x.high && given_y >= y.low && given_y <= y.high;
    for (report::Plot* plot : {&left, &right}) {
        const bool named = plot == &left;
        plot->curves.push_back({report::Curve::Shape::dots,
                                "best-mark",
                                named ? "best fit" : "",
                                {value_of(c, 0, best)},
                                {value_of(c, 1, best)},
                                {},
                                7});
        if (given) {
            plot->curves.push_back(
                {report::Curve::Shape::crosses, "given-mark", named ? "as given" : "", {given_x}, {given_y}, {}, 0});
        }
    }
    return {"Misfit of all runs", 1000, 440, {std::move(left), std::move(right)}};
}

/// The only factor.
report::Chart line_chart(const Calibration& c, const MisfitMap& map) {
    const report::ValueRange x{map.x.front(), map.x.back()};
    std::vector<double> at;
    report::ValueRange y{0, 1};
    for (std::size_t i = 0; i < map.cells; ++i) {
        at.push_back((map.x[i] + map.x[i + 1]) / 2);
        y.include(std::min(map.misfit[i], 100.0));
    }
    y.high *= 1.05;
    report::Plot plot(70, 24, 760, 350, x, y);
    plot.axes(c.factors[0].key, "misfit");
    plot.key = report::Plot::Key::beside;
    std::vector<double> shown;
    for (const double misfit : map.misfit) shown.push_back(misfit <= y.high ? misfit : observe::never);
    plot.line(at, shown, "series blue");
    const auto place = [&](const SearchRun& run) {
        return std::pair{value_of(c, 0, run.point), run.misfit <= y.high ? run.misfit : observe::never};
    };
    add_fast_runs(plot, c, place);
    add_runs(plot, c, 3.6, place);
    return {"Misfit of all runs", 1000, 440, {std::move(plot)}};
}

}  // namespace

report::Chart misfit_chart(const Calibration& c, const MisfitMap& map) {
    return map.y.empty() ? line_chart(c, map) : plane_chart(c, map);
}

report::Chart factor_chart(const Calibration& c, const CalibrationSummary& s) {
    constexpr std::size_t columns = 3, bars = 30;
    constexpr double width = 1000.0 / columns, height = 240;
    report::Chart chart{"Factors before and after", 1000, 0, {}};
    for (std::size_t k = 0; k < s.factors.size(); ++k) {
        const stats::Distribution& prior = c.factors[k].distribution;
        const bool open = prior.kind == stats::DistributionKind::normal;
        const report::ValueRange x{prior.quantile(open ? 0.005 : 0), prior.quantile(open ? 0.995 : 1)};
        const double step = (x.high - x.low) / bars,
                     share = 100.0 / static_cast<double>(c.result.posterior.draws.size());
        report::Curve after{report::Curve::Shape::bars, "bar", "", {}, std::vector<double>(bars, 0), {}, step};
        for (const auto& draw : c.result.posterior.draws) {
            const double at = (value_of(c, k, draw) - x.low) / step;
            after.y[static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(bars - 1)))] += share;
        }
        report::ValueRange y{0, 1};
        for (const double count : after.y) y.include(count * 1.1);
        std::vector<double> before_x, before;
        for (std::size_t i = 0; i < bars; ++i) {
            const double from = x.low + step * static_cast<double>(i);
            after.x.push_back(from);
            before_x.insert(before_x.end(), {from, from + step});
            const double part = 100 * (share_below(prior, from + step) - share_below(prior, from));
            before.insert(before.end(), {part, part});
            y.include(part * 1.1);
        }
        const std::size_t row = k / columns;
        report::Plot plot(width * static_cast<double>(k % columns) + 56, height * static_cast<double>(row) + 16,
                          width - 76, height - 66, x, y);
        plot.axes(c.factors[k].key, k % columns == 0 ? "draws, %" : "");
        plot.curves.push_back(std::move(after));
        plot.line(before_x, before, "series black");
        for (const double limit : {s.factors[k].low, s.factors[k].high}) plot.vertical(limit, "percentile-line");
        chart.plots.push_back(std::move(plot));
        chart.height = height * static_cast<double>(row + 1);
    }
    return chart;
}

report::Chart observation_chart(const Calibration& c, const CalibrationSummary& s) {
    constexpr double row = 46, left = 300;
    report::ValueRange x{-3, 3};
    const auto scaled = [&](std::size_t j, double value) {
        const double shown = std::isfinite(value) ? value : c.observed[j].unreached;
        return std::clamp((shown - c.observed[j].value) / c.observed[j].uncertainty, -12.0, 12.0);
    };
    for (std::size_t j = 0; j < s.observations.size(); ++j) {
        const ObservationResult& o = s.observations[j];
        for (const double value : {o.prior_low, o.prior_high, o.low, o.high, o.best})
            x.include(scaled(j, value) * 1.08);
    }
    const auto count = static_cast<double>(s.observations.size());
    report::Plot plot(left, 26, 660, row * count, x, {0, count});
    plot.axes("standard deviations from what was observed", "");
    plot.has_y_axis = false;
    plot.vertical(0, "axis");
    report::Curve checks = dots_of("dot-check", "", 3.4), best = dots_of("best-mark", "", 6);
    for (std::size_t j = 0; j < s.observations.size(); ++j) {
        const ObservationResult& o = s.observations[j];
        const ensemble::ObservedValue& observed = c.observed[j];
        const double y = count - static_cast<double>(j) - 0.5, apart = 11 / row;
        const auto span = [&](double from, double to, double at, const char* style) {
            const std::vector<double> ends = {scaled(j, from), scaled(j, to)}, level = {at, at};
            plot.line(ends, level, style);
        };
        const char* side = observed.kind == ensemble::ObservedValue::Kind::at_least ? "at least "
                           : observed.kind == ensemble::ObservedValue::Kind::below  ? "below "
                                                                                    : "";
        plot.label(x.low, y, -left, -2, "start", "row-name", report::shortened(observed.name, 42));
        plot.label(
            x.low, y, -left, 14, "start", "tick",
            fmt::format("{}{} ± {} {}; best fit {}", side, report::significant(observed.value, 3),
                        report::significant(observed.uncertainty, 2), observed.unit, report::significant(o.best, 3)));
        span(observed.value - observed.uncertainty, observed.value + observed.uncertainty, y + apart, "span-observed");
        span(o.prior_low, o.prior_high, y - apart, "span-before");
        span(o.low, o.high, y, "span-after");
        for (const Check& check : c.result.checks) {
            if (check.observation != j) continue;
            checks.x.push_back(scaled(j, check.computed));
            checks.y.push_back(y);
        }
        best.x.push_back(scaled(j, o.best));
        best.y.push_back(y);
    }
    plot.curves.push_back(std::move(checks));
    plot.curves.push_back(std::move(best));
    return {"Predicted against observed", 1000, 26 + row * count + 56, {std::move(plot)}};
}

report::Chart convergence_chart(const Calibration& c) {
    const auto& runs = c.result.runs;
    report::ValueRange x{0, static_cast<double>(runs.size())}, y{-2, 1};
    const auto level = [](double misfit) { return std::log10(std::max(misfit, 0.01)); };
    for (const SearchRun& run : runs) y.include(level(run.misfit));
    y.high += 0.1;
    report::Plot left(70, 24, 400, 250, x, y);
    left.axes("run", "log10 of the misfit");
    left.key = report::Plot::Key::none;
    add_runs(left, c, 3.4, [&](const SearchRun& run) {
        const double number = static_cast<double>(&run - runs.data()) + 1;
        return std::pair{number, run.predicted.empty() ? observe::never : level(run.misfit)};
    });
    std::vector<double> at, least;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        if (runs[i].predicted.empty()) continue;
        at.push_back(static_cast<double>(i) + 1);
        least.push_back(std::min(level(runs[i].misfit), least.empty() ? 1e9 : least.back()));
    }
    left.line(at, least, "series black");

    report::ValueRange range{-3, 3};
    std::vector<double> computed, emulated;
    for (std::size_t j = 0; j < c.observed.size(); ++j) {
        if (!c.result.fit.emulators[j].value()) continue;
        for (const stats::Emulator::LeftOut& run : c.result.fit.emulators[j].value()->leave_one_out()) {
            const auto scaled = [&](double value) {
                return std::clamp((value - c.observed[j].value) / c.observed[j].uncertainty, -12.0, 12.0);
            };
            computed.push_back(scaled(run.computed));
            emulated.push_back(scaled(run.mean));
            range.include(computed.back());
            range.include(emulated.back());
        }
    }
    report::Plot right(570, 24, 400, 250, range, range);
    right.axes("computed, standard deviations from observed", "by the emulator");
    const std::vector<double> ends = {range.low, range.high};
    right.line(ends, ends, "series black");
    right.dots(computed, emulated, 2.6, "run-dot");
    return {"Convergence", 1000, 330, {std::move(left), std::move(right)}};
}

}  // namespace talus::calibrate
