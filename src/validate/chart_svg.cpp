#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "products/report_plot.hpp"
#include "products/report_text.hpp"
#include "validate/page.hpp"
#include "validation_page_files.hpp"

namespace talus::validate {
namespace {

using report::coordinate;
using report::escape;

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

struct Keys {
    std::string svg;
    int rows = 1;
};

Keys make_keys(const Chart& chart, const std::vector<std::string>& classes) {
    Keys keys;
    double x = left;
    for (std::size_t i = 0; i < chart.series.size(); ++i) {
        const Series& series = chart.series[i];
        const double length = 34 + 6.7 * static_cast<double>(series.name.size()) + 20;
        if (x > left && x + length > width - right) {
            x = left;
            ++keys.rows;
        }
        const double y = keys.rows * key_row - 6;
        if (series.style == Series::Style::marks) {
            keys.svg += fmt::format(R"(<path class="mark {}" d="M{} {}l6 6l-6 6l-6 -6Z"/>)", classes[i],
                                    coordinate(x + 13), coordinate(y - 6));
        } else {
            keys.svg += fmt::format(R"(<line class="series {}" x1="{}" y1="{}" x2="{}" y2="{}"/>)", classes[i],
                                    coordinate(x), coordinate(y), coordinate(x + 26), coordinate(y));
        }
        keys.svg += fmt::format(R"(<text class="key" x="{}" y="{}">{}</text>)", coordinate(x + 32), coordinate(y + 4),
                                escape(series.name));
        x += length;
    }
    return keys;
}

}  // namespace

std::string chart_svg(const Chart& chart, bool self_contained) {
    const std::vector<std::string> classes = classes_of(chart);
    const Keys keys = make_keys(chart, classes);
    const double top = keys.rows * key_row + 14, height = top + plot_height + below;
    report::Plot plot(left, top, width - left - right, plot_height, range_of(chart, &Series::x),
                      range_of(chart, &Series::y));
    plot.axes(chart.x_title, chart.y_title);
    for (std::size_t i = 0; i < chart.series.size(); ++i) {
        const Series& series = chart.series[i];
        if (series.style != Series::Style::marks) {
            plot.line(series.x, series.y, "series " + classes[i]);
            continue;
        }
        for (std::size_t k = 0; k < series.x.size(); ++k) {
            if (std::isfinite(series.x[k]) && std::isfinite(series.y[k])) {
                plot.mark(series.x[k], series.y[k], "mark " + classes[i]);
            }
        }
    }
    // A file of its own stands on any ground, white or dark: it brings a white panel.
    const std::string own = self_contained
                                ? fmt::format(R"(<style>{}</style><rect class="panel" width="{}" height="{}" rx="6"/>)",
                                              validation_page_files::chart_css, coordinate(width), coordinate(height))
                                : "";
    const std::string size = self_contained
                                 ? fmt::format(R"( xmlns="http://www.w3.org/2000/svg" width="{}" height="{}")",
                                               coordinate(width), coordinate(height))
                                 : "";
    return fmt::format(R"(<svg class="chart"{} viewBox="0 0 {} {}" role="img" aria-label="{}">{}{}{}</svg>)", size,
                       coordinate(width), coordinate(height), escape(chart.title), own, plot.svg(), keys.svg);
}

}  // namespace talus::validate
