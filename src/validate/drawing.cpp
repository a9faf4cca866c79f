#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "validate/page.hpp"

namespace talus::validate {
namespace {

constexpr double width = 720, plot_height = 270, left = 70, right = 20, below = 50, key_row = 20;

constexpr std::array colours = {"blue", "orange", "green", "purple", "red", "teal"};

/// Colours follow the curves that were computed; laws are dashed and black, a second one grey.
std::vector<std::string> classes_of(const Chart& chart) {
    std::vector<std::string> classes;
    std::size_t colour = 0, dashed = 0;
    for (const Series& series : chart.series) {
        if (series.style == Series::Style::dashed) {
            classes.emplace_back(dashed++ == 0 ? "black" : "grey");
        } else {
            classes.emplace_back(colours[colour++ % colours.size()]);
        }
    }
    return classes;
}

report::ValueRange range_of(const Chart& chart, std::vector<double> Series::*values) {
    report::ValueRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const Series& series : chart.series) {
        for (const double v : series.*values) range.include(v);
    }
    if (!(range.high >= range.low)) return {0, 1};
    const double margin = 0.04 * (range.high - range.low);
    // From zero where that costs little: ratios are read against it.
    const double low = range.low >= 0 && range.low < 0.5 * range.high ? 0 : range.low - margin;
    return {low, range.high + margin};
}

}  // namespace

report::Chart drawing_of(const Chart& chart) {
    const std::vector<std::string> classes = classes_of(chart);
    report::Plot plot(left, 0, width - left - right, plot_height, range_of(chart, &Series::x),
                      range_of(chart, &Series::y));
    plot.axes(chart.x_title, chart.y_title);
    for (std::size_t i = 0; i < chart.series.size(); ++i) {
        const Series& series = chart.series[i];
        const bool marks = series.style == Series::Style::marks;
        plot.line(series.x, series.y, (marks ? "mark " : "series ") + classes[i], series.name);
        if (marks) plot.curves.back().shape = report::Curve::Shape::diamonds;
    }
    plot.top = report::key_rows(plot.curves, plot.width) * key_row + 14;
    const double height = plot.top + plot_height + below;
    return {chart.title, width, height, {std::move(plot)}};
}

}  // namespace talus::validate
