#include "report/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "report/colour.hpp"
#include "report_files.hpp"

namespace talus::report {
namespace {

constexpr double key_row_height = 20, key_sample = 26, key_gap = 32, key_apart = 22;
/// Names may extend slightly beyond the plot below them; their length is only estimated.
constexpr double key_slack = 18;

double key_length(const Curve& curve) {
    return key_gap + 6.7 * static_cast<double>(curve.name.size()) + key_apart;
}

/// The sample of a curve in a key, centred at `y`.
void draw_sample(Svg& svg, const Curve& curve, double x, double y) {
    using Shape = Curve::Shape;
    switch (curve.shape) {
        case Shape::band:
        case Shape::bars:
            svg.rect(curve.style, x, y - 5, key_sample, 10);
            break;
        case Shape::diamonds:
            svg.path(curve.style, diamond(x + key_sample / 2, y));
            break;
        case Shape::dots:
            svg.circle(curve.style, x + key_sample / 2, y, curve.size);
            break;
        default:
            svg.line(curve.style, x, y, x + key_sample, y);
    }
}

std::vector<double> copied(std::span<const double> values) {
    return {values.begin(), values.end()};
}

}  // namespace

void ValueRange::include(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
}

Ticks round_ticks(const ValueRange& range, int count) {
    const double step = round_step((range.high - range.low) / count);
    Ticks ticks;
    while (ticks.digits < 6 &&
           std::abs(step * std::pow(10, ticks.digits) - std::round(step * std::pow(10, ticks.digits))) > 1e-6) {
        ++ticks.digits;
    }
    const double last = std::floor(range.high / step + 1e-9);
    for (double k = std::ceil(range.low / step - 1e-9); k <= last; ++k) ticks.values.push_back(k * step);
    return ticks;
}

int key_rows(const std::vector<Curve>& curves, double width) {
    int rows = 1;
    double x = 0;
    for (const Curve& curve : curves) {
        if (curve.name.empty()) continue;
        if (x > 0 && x + key_length(curve) - key_apart > width + key_slack) {
            x = 0;
            ++rows;
        }
        x += key_length(curve);
    }
    return rows;
}

Plot::Plot(double from_left, double from_top, double wide, double high, const ValueRange& x, const ValueRange& y)
    : left(from_left), top(from_top), width(wide), height(high), x_range(x), y_range(y) {
    if (!(x_range.high > x_range.low)) x_range.high = x_range.low + 1;
    if (!(y_range.high > y_range.low)) y_range.high = y_range.low + 1;
}

void Plot::axes(std::string_view title_of_x, std::string_view title_of_y) {
    has_axes = true;
    x_title = title_of_x;
    y_title = title_of_y;
}

void Plot::line(std::span<const double> x, std::span<const double> y, std::string_view style,
                std::string_view curve_name) {
    curves.push_back({Curve::Shape::line, std::string(style), std::string(curve_name), copied(x), copied(y), {}, 0});
}

void Plot::band(std::span<const double> x, std::span<const double> low, std::span<const double> high,
                std::string_view style, std::string_view curve_name) {
    curves.push_back(
        {Curve::Shape::band, std::string(style), std::string(curve_name), copied(x), copied(high), copied(low), 0});
}

void Plot::vertical(double x, std::string_view style) {
    curves.push_back({Curve::Shape::vertical, std::string(style), "", {x}, {}, {}, 0});
}

void Plot::horizontal(double y, std::string_view style, std::string_view curve_name) {
    curves.push_back({Curve::Shape::horizontal, std::string(style), std::string(curve_name), {}, {y}, {}, 0});
}

void Plot::mark(double x, double y, std::string_view style, std::string_view curve_name) {
    curves.push_back({Curve::Shape::diamonds, std::string(style), std::string(curve_name), {x}, {y}, {}, 0});
}

void Plot::dots(std::span<const double> x, std::span<const double> y, double radius, std::string_view style,
                std::string_view curve_name) {
    curves.push_back(
        {Curve::Shape::dots, std::string(style), std::string(curve_name), copied(x), copied(y), {}, radius});
}

void Plot::label(double x, double y, double dx, double dy, std::string_view anchor, std::string_view style,
                 std::string_view text) {
    notes.push_back({x, y, dx, dy, std::string(anchor), std::string(style), std::string(text)});
}

void Plot::draw(Svg& svg) const {
    draw_cells(svg);
    if (has_axes) draw_axes(svg);
    if (!name.empty()) svg.text("note-strong", left, top - 10, name);
    for (const Curve& curve : curves) draw_curve(svg, curve);
    for (const Note& note : notes) {
        svg.text(note.style, px(note.x) + note.dx, py(note.y) + note.dy, note.text, note.anchor);
    }
    if (key != Key::none) draw_key(svg);
}

void Plot::draw_cells(Svg& svg) const {
    for (std::size_t i = 0; i < cells.values.size(); ++i) {
        const std::size_t column = i % (cells.x.size() - 1), row = i / (cells.x.size() - 1);
        std::size_t k = 0;
        while (k + 1 < cells.breaks.size() && cells.values[i] >= cells.breaks[k + 1]) ++k;
        // Slightly enlarged, otherwise seams show between cells.
        svg.rect("", px(cells.x[column]), py(cells.y[row + 1]), px(cells.x[column + 1]) - px(cells.x[column]) + 0.4,
                 py(cells.y[row]) - py(cells.y[row + 1]) + 0.4, cells.colours[k]);
    }
}

void Plot::draw_axes(Svg& svg) const {
    const double right = left + width, bottom = top + height;
    const Ticks across = round_ticks(x_range, std::max(3, static_cast<int>(width / 75)));
    for (const double v : across.values) {
        svg.line("grid", px(v), top, px(v), bottom);
        if (!x_title.empty()) svg.text("tick", px(v), bottom + 16, fixed(v, across.digits), "middle");
    }
    if (has_y_axis) {
        const Ticks up = round_ticks(y_range, std::max(3, static_cast<int>(height / 36)));
        for (const double v : up.values) {
            svg.line("grid", left, py(v), right, py(v));
            svg.text("tick", left - 7, py(v) + 4, fixed(v, up.digits), "end");
        }
        svg.line("axis", left, top, left, bottom);
    }
    svg.line("axis", left, bottom, right, bottom);
    if (!x_title.empty()) svg.text("axis-title", left + width / 2, bottom + 35, x_title, "middle");
    if (!y_title.empty()) svg.turned_text("axis-title", left - 46, top + height / 2, -90, y_title, "middle");
}

void Plot::draw_curve(Svg& svg, const Curve& curve) const {
    using Shape = Curve::Shape;
    const std::vector<double>&x = curve.x, &y = curve.y;
    PathData path;
    switch (curve.shape) {
        case Shape::vertical:
            for (const double at : x) svg.line(curve.style, px(at), top, px(at), top + height);
            return;
        case Shape::horizontal:
            for (const double value : y) svg.line(curve.style, left, py(value), left + width, py(value));
            return;
        case Shape::band: {
            const std::size_t n = std::min({x.size(), y.size(), curve.low.size()});
            if (n < 2) return;
            path.move_to(px(x[0]), py(y[0]));
            for (std::size_t i = 1; i < n; ++i) path.line_to(px(x[i]), py(y[i]));
            for (std::size_t i = n; i-- > 0;) path.line_to(px(x[i]), py(curve.low[i]));
            path.close();
            return svg.path(curve.style, path.take());
        }
        default:
            break;
    }
    bool drawing = false;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
        if (!std::isfinite(x[i]) || !std::isfinite(y[i])) {
            drawing = false;
            continue;
        }
        const double at_x = px(x[i]), at_y = py(y[i]);
        if (curve.shape == Shape::diamonds) {
            svg.path(curve.style, diamond(at_x, at_y));
        } else if (curve.shape == Shape::dots) {
            svg.circle(curve.style, at_x, at_y, curve.size);
        } else if (curve.shape == Shape::crosses) {
            svg.path(curve.style, fmt::format("M{} {}l12 12m0 -12l-12 12", coordinate(at_x - 6), coordinate(at_y - 6)));
        } else if (curve.shape == Shape::bars) {
            if (y[i] > 0) svg.rect(curve.style, at_x + 0.75, at_y, px(x[i] + curve.size) - at_x - 1.5, py(0) - at_y);
        } else {
            drawing ? path.line_to(at_x, at_y) : path.move_to(at_x, at_y);
            drawing = true;
        }
    }
    if (!path.empty()) svg.path(curve.style, path.take());
}

void Plot::draw_key(Svg& svg) const {
    const int rows = key_rows(curves, width);
    const bool above = key == Key::above;
    double x = above ? left : left + width + 24;
    double y = above ? top - 14 - key_row_height * (rows - 1) : draw_cell_key(svg, x, top) + 16;
    for (const Curve& curve : curves) {
        if (curve.name.empty()) continue;
        if (above && x > left && x + key_length(curve) - key_apart > left + width + key_slack) {
            x = left;
            y += key_row_height;
        }
        draw_sample(svg, curve, x, y);
        svg.text("key", x + key_gap, y + 4, curve.name);
        (above ? x : y) += above ? key_length(curve) : 24;
    }
}

double Plot::draw_cell_key(Svg& svg, double x, double y) const {
    if (cells.values.empty()) return y;
    svg.text("note-strong", x, y + 12, cells.title);
    y += 20;
    for (std::size_t k = 0; k < cells.breaks.size(); ++k) {
        const std::string from = plain(cells.breaks[k]);
        svg.rect("", x, y, 18, 22, cells.colours[k]);
        svg.text(
            "tick", x + 25, y + 15,
            k + 1 < cells.breaks.size() ? fmt::format("{} – {}", from, plain(cells.breaks[k + 1])) : "over " + from);
        y += 22;
    }
    return y;
}

namespace {

Svg drawn(const Chart& chart) {
    Svg svg;
    for (const Plot& plot : chart.plots) plot.draw(svg);
    return svg;
}

}  // namespace

std::string chart_svg(const Chart& chart) {
    return figure_svg(chart.width, chart.height, chart.title, drawn(chart));
}

std::string chart_file(const Chart& chart) {
    Svg svg;
    svg.open("svg", {{"xmlns", "http://www.w3.org/2000/svg"},
                     {"class", "figure"},
                     {"width", chart.width},
                     {"height", chart.height},
                     {"viewBox", fmt::format("0 0 {} {}", coordinate(chart.width), coordinate(chart.height))},
                     {"role", "img"},
                     {"aria-label", chart.title}});
    svg.add("style", {}, report_files::chart_css);
    svg.add("rect", {{"class", "panel"}, {"width", chart.width}, {"height", chart.height}, {"rx", 6.0}});
    svg.append(drawn(chart));
    svg.close("svg");
    return svg.str() + "\n";
}

std::string figure_svg(double width, double height, std::string_view title, const Svg& content, double widest,
                       double printed) {
    std::string style;
    if (widest > 0) style = fmt::format("max-width:{}px", coordinate(widest));
    if (printed > 0) style += fmt::format("{}--printed:{}mm", style.empty() ? "" : ";", coordinate(printed));
    Svg svg;
    svg.open("svg", {{"class", "figure"},
                     {"viewBox", fmt::format("0 0 {} {}", coordinate(width), coordinate(height))},
                     {"style", style},
                     {"role", "img"},
                     {"aria-label", title}});
    svg.append(content);
    svg.close("svg");
    return svg.str();
}

std::string sample_svg(std::string_view style) {
    Svg svg;
    svg.open("svg", {{"class", "sample"}, {"viewBox", "0 0 26 8"}});
    svg.line(style, 0, 4, 26, 4);
    svg.close("svg");
    return svg.str();
}

}  // namespace talus::report
