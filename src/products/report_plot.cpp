#include "products/report_plot.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "products/report_colour.hpp"
#include "products/report_text.hpp"

namespace talus::report {

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

Plot::Plot(double left, double top, double width, double height, const ValueRange& x, const ValueRange& y)
    : left_(left), top_(top), width_(width), height_(height), x_(x), y_(y) {
    if (!(x_.high > x_.low)) x_.high = x_.low + 1;
    if (!(y_.high > y_.low)) y_.high = y_.low + 1;
}

void Plot::axes(std::string_view x_title, std::string_view y_title) {
    const double right = left_ + width_, bottom = top_ + height_;
    const auto rule = [&](double x1, double y1, double x2, double y2, std::string_view css_class) {
        svg_ += fmt::format(R"(<line class="{}" x1="{}" y1="{}" x2="{}" y2="{}"/>)", css_class, coordinate(x1),
                            coordinate(y1), coordinate(x2), coordinate(y2));
    };
    const auto text = [&](double x, double y, std::string_view anchor, std::string_view content) {
        svg_ += fmt::format(R"(<text class="tick" x="{}" y="{}" text-anchor="{}">{}</text>)", coordinate(x),
                            coordinate(y), anchor, content);
    };
    const Ticks across = round_ticks(x_, std::max(3, static_cast<int>(width_ / 75)));
    for (const double v : across.values) {
        rule(px(v), top_, px(v), bottom, "grid");
        if (!x_title.empty()) text(px(v), bottom + 16, "middle", fixed(v, across.digits));
    }
    const Ticks up = round_ticks(y_, std::max(3, static_cast<int>(height_ / 36)));
    for (const double v : up.values) {
        rule(left_, py(v), right, py(v), "grid");
        text(left_ - 7, py(v) + 4, "end", fixed(v, up.digits));
    }
    rule(left_, bottom, right, bottom, "axis");
    rule(left_, top_, left_, bottom, "axis");
    if (!x_title.empty()) {
        svg_ += fmt::format(R"(<text class="axis-title" x="{}" y="{}" text-anchor="middle">{}</text>)",
                            coordinate(left_ + width_ / 2), coordinate(bottom + 35), escape(x_title));
    }
    svg_ += fmt::format(
        R"svg(<text class="axis-title" transform="translate({} {}) rotate(-90)" text-anchor="middle">{}</text>)svg",
        coordinate(left_ - 46), coordinate(top_ + height_ / 2), escape(y_title));
}

void Plot::line(std::span<const double> x, std::span<const double> y, std::string_view css_class) {
    std::string path;
    bool drawing = false;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
        if (!std::isfinite(x[i]) || !std::isfinite(y[i])) {
            drawing = false;
            continue;
        }
        path += fmt::format("{}{} {}", drawing ? "L" : "M", coordinate(px(x[i])), coordinate(py(y[i])));
        drawing = true;
    }
    if (!path.empty()) svg_ += fmt::format(R"(<path class="{}" d="{}"/>)", css_class, path);
}

void Plot::band(std::span<const double> x, std::span<const double> low, std::span<const double> high,
                std::string_view css_class) {
    const std::size_t n = std::min({x.size(), low.size(), high.size()});
    std::string path;
    for (std::size_t i = 0; i < n; ++i) {
        path += fmt::format("{}{} {}", i == 0 ? "M" : "L", coordinate(px(x[i])), coordinate(py(high[i])));
    }
    for (std::size_t i = n; i-- > 0;) path += fmt::format("L{} {}", coordinate(px(x[i])), coordinate(py(low[i])));
    if (n > 1) svg_ += fmt::format(R"(<path class="{}" d="{}Z"/>)", css_class, path);
}

void Plot::vertical(double x, std::string_view css_class) {
    svg_ += fmt::format(R"(<line class="{}" x1="{}" y1="{}" x2="{}" y2="{}"/>)", css_class, coordinate(px(x)),
                        coordinate(top_), coordinate(px(x)), coordinate(top_ + height_));
}

void Plot::horizontal(double y, std::string_view css_class) {
    svg_ += fmt::format(R"(<line class="{}" x1="{}" y1="{}" x2="{}" y2="{}"/>)", css_class, coordinate(left_),
                        coordinate(py(y)), coordinate(left_ + width_), coordinate(py(y)));
}

void Plot::mark(double x, double y, std::string_view css_class) {
    svg_ += fmt::format(R"(<path class="{}" d="M{} {}l7 7l-7 7l-7 -7Z"/>)", css_class, coordinate(px(x)),
                        coordinate(py(y) - 7));
}

void Plot::label(double x, double y, double dx, double dy, std::string_view anchor, std::string_view css_class,
                 std::string_view text) {
    svg_ += fmt::format(R"(<text class="{}" x="{}" y="{}" text-anchor="{}">{}</text>)", css_class,
                        coordinate(px(x) + dx), coordinate(py(y) + dy), anchor, escape(text));
}

void Plot::keys(std::initializer_list<Key> entries) {
    double x = left_;
    const double y = top_ - 14;
    for (const Key& key : entries) {
        svg_ += fmt::format(
            R"(<line class="{} sample" x1="{}" y1="{}" x2="{}" y2="{}"/><text class="key" x="{}" y="{}">{}</text>)",
            key.css_class, coordinate(x), coordinate(y), coordinate(x + 26), coordinate(y), coordinate(x + 32),
            coordinate(y + 4), escape(key.name));
        x += 32 + 6.7 * static_cast<double>(key.name.size()) + 22;
    }
}

std::string figure_svg(double width, double height, std::string_view title, std::string_view content) {
    return fmt::format(R"(<svg class="figure" viewBox="0 0 {0} {1}" role="img" aria-label="{2}">{3}</svg>)",
                       coordinate(width), coordinate(height), escape(title), content);
}

}  // namespace talus::report
