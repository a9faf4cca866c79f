#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Line plots as SVG; their look is in report.css.
namespace talus::report {

struct ValueRange {
    double low = 0, high = 1;

    /// Grown to hold `value` if that is finite.
    void include(double value);
};

/// Round numbers across a range, about `count` of them.
struct Ticks {
    std::vector<double> values;
    int digits = 0;  ///< decimals that tell them apart
};
[[nodiscard]] Ticks round_ticks(const ValueRange& range, int count);

/// One plot area with its axes inside an SVG. Drawn in call order.
class Plot {
  public:
    /// The area inside the axes, in SVG units, and the values along its edges.
    Plot(double left, double top, double width, double height, const ValueRange& x, const ValueRange& y);

    /// Grid, ticks and axis titles. An empty `x_title` leaves the x numbers out (a plot below continues the axis).
    void axes(std::string_view x_title, std::string_view y_title);
    /// A line through the points with finite values; others leave gaps.
    void line(std::span<const double> x, std::span<const double> y, std::string_view css_class);
    /// The area between two curves over the same x.
    void band(std::span<const double> x, std::span<const double> low, std::span<const double> high,
              std::string_view css_class);
    void vertical(double x, std::string_view css_class);
    void horizontal(double y, std::string_view css_class);
    /// A diamond.
    void mark(double x, double y, std::string_view css_class);
    /// Text near a place: `dx`, `dy` in SVG units, `anchor` "start", "middle" or "end". Escaped here.
    void label(double x, double y, double dx, double dy, std::string_view anchor, std::string_view css_class,
               std::string_view text);
    /// A row of line samples and names above the plot area.
    struct Key {
        std::string_view css_class, name;
    };
    void keys(std::initializer_list<Key> entries);

    [[nodiscard]] double px(double x) const { return left_ + (x - x_.low) / (x_.high - x_.low) * width_; }
    [[nodiscard]] double py(double y) const { return top_ + (y_.high - y) / (y_.high - y_.low) * height_; }
    [[nodiscard]] const std::string& svg() const { return svg_; }

  private:
    double left_, top_, width_, height_;
    ValueRange x_, y_;
    std::string svg_;
};

/// An <svg> of the given size around its content, scaling with the page.
[[nodiscard]] std::string figure_svg(double width, double height, std::string_view title, std::string_view content);

}  // namespace talus::report
