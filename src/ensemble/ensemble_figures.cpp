#include "ensemble/ensemble_figures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "report/colour.hpp"
#include "report/number_text.hpp"

namespace talus::ensemble {
namespace {

constexpr std::size_t run_out_measure = 0;  // in measures_of
constexpr double infinite = std::numeric_limits<double>::infinity();

report::ValueRange range_of(const std::vector<double>& values) {
    report::ValueRange range{infinite, -infinite};
    for (const double v : values) range.include(v);
    return range;
}

/// Bars of a round width that hold the values, starting at a multiple of it.
struct Histogram {
    double first = 0, width = 1;
    std::vector<double> counts;
};

Histogram histogram_of(const std::vector<double>& values, const report::ValueRange& range) {
    Histogram h;
    const double wanted = std::clamp(2 * std::cbrt(static_cast<double>(values.size())), 6.0, 40.0);
    const double spread = range.high - range.low;
    h.width = report::round_step(spread > 0 ? spread / wanted : 1);
    h.first = std::floor(range.low / h.width) * h.width;
    h.counts.assign(static_cast<std::size_t>(std::floor((range.high - h.first) / h.width)) + 1, 0);
    for (const double v : values) h.counts[static_cast<std::size_t>((v - h.first) / h.width)] += 1;
    return h;
}

double number_of(const report::Json& value) {
    return value.is_number() ? value.get<double>() : observe::never;
}

/// A bar of the sensitivity figure.
struct Bar {
    double value = 0, low = 0, high = 0;
    const char* css_class = "effect-first";
    bool whisker = false;
};

/// Of an effect_json().
std::vector<Bar> bars_of(const report::Json& effect) {
    if (effect.contains("first_order")) {
        const report::Json &first = effect["first_order"], &total = effect["total"];
        return {{number_of(first[0]), number_of(first[1]), number_of(first[2]), "effect-first", true},
                {number_of(total[0]), number_of(total[1]), number_of(total[2]), "effect-total", true}};
    }
    if (effect.contains("mean_absolute_effect")) {
        return {{number_of(effect["mean_absolute_effect"]), 0, 0, "effect-first", false},
                {number_of(effect["standard_deviation"]), 0, 0, "effect-total", false}};
    }
    const double correlation = number_of(effect["rank_correlation"]);
    return {{correlation, 0, 0, correlation < 0 ? "effect-fall" : "effect-first", false}};
}

/// The scale of one result's bars: shares and correlations have their own, elementary effects the result's unit.
report::ValueRange scale_of(const report::Json& sensitivity, const report::Json& effects) {
    if (sensitivity["rank"].get<bool>()) return {-1, 1};
    report::ValueRange range{0, sensitivity["variance"].get<bool>() ? 1 : 1e-12};
    for (const report::Json& effect : effects) {
        for (const Bar& bar : bars_of(effect)) {
            range.include(bar.value);
            if (bar.whisker) range.include(std::min(bar.high, 1.3));
            if (bar.whisker) range.include(std::max(bar.low, -0.2));
        }
    }
    return range;
}

std::string value_text(const report::Json& sensitivity, const std::vector<Bar>& bars, const std::string& unit) {
    if (sensitivity["variance"].get<bool>())
        return fmt::format("{} / {}", report::fixed(bars[0].value, 2), report::fixed(bars[1].value, 2));
    if (sensitivity["screening"].get<bool>()) return fmt::format("{} {}", report::significant(bars[0].value, 3), unit);
    return report::fixed(bars[0].value, 2);
}

/// The bars of one result and factor, `width` wide from `left`, with their value behind.
void draw_effect(report::Svg& svg, const report::Json& sensitivity, const report::Json& result, std::size_t factor,
                 double left, double width, double y, double row) {
    const report::ValueRange scale = scale_of(sensitivity, result["effects"]);
    const auto px = [&](double v) {
        return left + (std::clamp(v, scale.low, scale.high) - scale.low) / (scale.high - scale.low) * width;
    };
    const std::vector<Bar> bars = bars_of(result["effects"][factor]);
    const double height = (row - 12) / static_cast<double>(bars.size());
    for (std::size_t b = 0; b < bars.size(); ++b) {
        const double from = y + 6 + height * static_cast<double>(b), middle = from + (height - 1) / 2;
        const double start = std::min(px(0), px(bars[b].value));
        svg.rect(bars[b].css_class, start, from, std::abs(px(bars[b].value) - px(0)), height - 1);
        if (bars[b].whisker) svg.line("whisker", px(bars[b].low), middle, px(bars[b].high), middle);
    }
    svg.line("axis", px(0), y + 3, px(0), y + row - 3);
    svg.text("tick", left + width + 8, y + 19, value_text(sensitivity, bars, result["unit"].get<std::string>()));
}

/// "solver.iteration_count" under its value in the run; a text has none.
double number_of(const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    return end != text.c_str() && *end == '\0' ? value : observe::never;
}

}  // namespace

report::Json run_out_chart(const EnsembleResult& result) {
    std::vector<double> values = result.values_of(run_out_measure);
    if (values.empty()) return {};
    const double low = percentile(values, 5), median = percentile(values, 50), high = percentile(values, 95);
    const Histogram h = histogram_of(values, range_of(values));
    const double end = h.first + h.width * static_cast<double>(h.counts.size());
    const report::ValueRange x{h.first - h.width, end + h.width};
    report::ValueRange counts{0, 1};
    for (const double c : h.counts) counts.include(c);
    counts.high *= 1.22;

    report::Plot left(66, 20, 420, 250, x, counts);
    left.axes("run-out along the flow, m", "runs");
    report::Curve inside{report::Curve::Shape::bars, "bar", "", {}, {}, {}, h.width}, outside = inside;
    outside.style = "bar outside";
    for (std::size_t i = 0; i < h.counts.size(); ++i) {
        const double from = h.first + h.width * static_cast<double>(i), middle = from + h.width / 2;
        report::Curve& bars = middle < low || middle > high ? outside : inside;
        bars.x.push_back(from);
        bars.y.push_back(h.counts[i]);
    }
    left.curves = {std::move(inside), std::move(outside)};
    for (const double v : {low, median, high}) left.vertical(v, "percentile-line");
    const auto label = [&](double v, const char* anchor, double dx, double dy, const char* name) {
        left.label(v, counts.high, dx, dy, anchor, v == median ? "note-strong" : "note",
                   fmt::format("{} {} m", name, report::fixed(v, 0)));
    };
    label(low, "end", -5, 14, "5 %:");
    label(median, "middle", 0, -5, "median");
    label(high, "start", 5, 14, "95 %:");

    report::Plot right(570, 20, 412, 250, x, {0, 100});
    right.axes("run-out along the flow, m", "runs that run out farther, %");
    std::vector<double> at = {x.low}, share = {100};
    const auto n = static_cast<double>(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {  // a stair: percentile() has ordered the values
        at.push_back(values[i]);
        share.push_back(share.back());
        at.push_back(values[i]);
        share.push_back(100 * (n - static_cast<double>(i) - 1) / n);
    }
    at.push_back(x.high);
    share.push_back(0);
    right.line(at, share, "series blue");
    return report::chart_json({"Run-out along the flow of all runs", 1000, 320, {std::move(left), std::move(right)}});
}

report::Json sensitivity_data(const EnsembleResult& result) {
    const auto& factors = result.runs->plan().factors;
    std::size_t used = 0;
    stats::SensitivityKind kind = stats::SensitivityKind::rank;
    report::Json names = report::Json::array(), rows = report::Json::array();
    for (const Factor& f : factors) names.push_back(f.key);
    for (std::size_t m = 0; m < result.measures.size(); ++m) {
        const stats::Sensitivity& s = result.sensitivity[m];
        if (s.effects.empty()) continue;
        used = std::max(used, s.used);
        kind = s.kind;
        report::Json effects = report::Json::array();
        for (std::size_t k = 0; k < factors.size(); ++k)
            effects.push_back(effect_json(s.kind, factors[k].key, s.effects[k]));
        rows.push_back({{"name", result.measures[m].name}, {"unit", result.measures[m].unit}, {"effects", effects}});
    }
    if (used == 0) return {};
    return {{"used", used},
            {"variance", kind == stats::SensitivityKind::variance},
            {"screening", kind == stats::SensitivityKind::screening},
            {"rank", kind == stats::SensitivityKind::rank},
            {"factors", names},
            {"rows", rows}};
}

std::string sensitivity_svg(const report::Json& sensitivity) {
    constexpr double left = 270, row = 30, head = 30;
    constexpr std::size_t max_columns = 4;  // factors per row
    const report::Json& factors = sensitivity["factors"];
    report::Svg svg;
    double y = 0;
    for (std::size_t first = 0; first < factors.size(); first += max_columns) {
        const std::size_t columns = std::min(max_columns, factors.size() - first);
        const double width = (1000 - left) / static_cast<double>(columns);
        for (std::size_t c = 0; c < columns; ++c) {
            svg.text("column-name", left + width * (static_cast<double>(c) + 0.5), y + 16,
                     report::shortened(factors[first + c].get<std::string>(), static_cast<std::size_t>(width / 7.2)));
        }
        y += head;
        for (const report::Json& result : sensitivity["rows"]) {
            svg.line("row-rule", 0, y, 1000, y);
            svg.text("row-name", 0, y + 19, report::shortened(result["name"].get<std::string>(), 40));
            for (std::size_t c = 0; c < columns; ++c) {
                const double from = left + width * static_cast<double>(c) + 12;
                draw_effect(svg, sensitivity, result, first + c, from,
                            width - (sensitivity["rank"].get<bool>() ? 70 : 108), y, row);
            }
            y += row;
        }
        y += 14;
    }
    return figure_svg(1000, y, "Sensitivity of every result to every factor", svg);
}

report::Json scatter_chart(const EnsembleResult& result) {
    const auto& factors = result.runs->plan().factors;
    std::vector<std::size_t> shown;
    for (std::size_t k = 0; k < factors.size(); ++k) {
        const stats::Distribution& d = factors[k].distribution;
        const bool texts = d.kind == stats::DistributionKind::list && std::isnan(number_of(d.entries.front()));
        if (!texts && shown.size() < 6) shown.push_back(k);
    }
    const std::vector<double> all = result.values_of(run_out_measure);
    if (shown.empty() || all.empty()) return {};
    report::ValueRange y = range_of(all);
    const double margin = std::max(1.0, 0.08 * (y.high - y.low));
    y = {y.low - margin, y.high + margin};
    const std::size_t columns = std::min<std::size_t>(3, shown.size());
    const double width = 1000.0 / static_cast<double>(columns);
    report::Chart chart{"Run-out along the flow against every factor", 1000, 0, {}};
    for (std::size_t i = 0; i < shown.size(); ++i) {
        std::vector<double> xs, ys;
        for (const RunRecord& run : result.reduction.runs) {
            if (!run.complete() || run.results.empty() || !std::isfinite(run.results[run_out_measure])) continue;
            xs.push_back(number_of(run.values[shown[i]]));
            ys.push_back(run.results[run_out_measure]);
        }
        report::ValueRange x = range_of(xs);
        const double pad = 0.05 * (x.high - x.low);
        x = {x.low - pad, x.high + pad};
        const std::size_t row = i / columns;
        report::Plot plot(width * static_cast<double>(i % columns) + 66, 300.0 * static_cast<double>(row) + 12,
                          width - 84, 226, x, y);
        plot.axes(factors[shown[i]].key, i % columns == 0 ? "run-out along the flow, m" : "");
        plot.dots(xs, ys, xs.size() > 400 ? 2.2 : 4, "run-dot");
        chart.plots.push_back(std::move(plot));
        chart.height = 300 * static_cast<double>(row + 1);
    }
    return chart_json(chart);
}

}  // namespace talus::ensemble
