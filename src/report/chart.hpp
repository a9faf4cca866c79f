#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/svg.hpp"

/// Charts as data, and their drawing as SVG; their look is in chart.css.
namespace talus::report {

using Json = nlohmann::ordered_json;

struct ValueRange {
    double low = 0, high = 1;

    /// Grown to hold `value` if that is finite.
    void include(double value);
};

/// Round numbers across a range, about `count` of them.
struct Ticks {
    std::vector<double> values;
    int digits = 0;  ///< decimals needed to distinguish them
};
[[nodiscard]] Ticks round_ticks(const ValueRange& range, int count);

/// Values over x. Not finite: a gap.
struct Curve {
    enum class Shape {
        line,
        band,      ///< the area between `low` and `y`
        bars,      ///< `size` wide from x on, from 0 to `y`
        diamonds,  ///< like all marks, centred and of fixed size on paper
        dots,      ///< circles of radius `size`, SVG units
        crosses,
        vertical,    ///< across the plot at every x
        horizontal,  ///< across the plot at every y
    };
    Shape shape = Shape::line;
    std::string style;  ///< CSS class
    std::string name;   ///< in the key; empty: not listed
    std::vector<double> x, y, low;
    double size = 0;
};

/// Text at a place; `dx`, `dy` in SVG units, `anchor` "start", "middle" or "end".
struct Note {
    double x = 0, y = 0, dx = 0, dy = 0;
    std::string anchor, style, text;
};

/// Coloured cells of a grid between the edges `x` and `y`: rows from the lowest y up.
struct Cells {
    std::vector<double> x, y, values;
    std::vector<double> breaks;        ///< lower limits of the classes, ascending
    std::vector<std::string> colours;  ///< of the classes
    std::string title;                 ///< in the key
};

/// One plot area with its axes. Curves lie over each other in their order.
class Plot {
  public:
    Plot() = default;
    /// The area inside the axes, in SVG units, and the values along its edges.
    Plot(double left, double top, double width, double height, const ValueRange& x, const ValueRange& y);

    /// Grid, ticks and axis titles. An empty `x_title` omits the x numbers (a plot below continues the axis).
    void axes(std::string_view x_title, std::string_view y_title);
    /// A line through the points with finite values.
    void line(std::span<const double> x, std::span<const double> y, std::string_view style, std::string_view name = {});
    void band(std::span<const double> x, std::span<const double> low, std::span<const double> high,
              std::string_view style, std::string_view name = {});
    void vertical(double x, std::string_view style);
    void horizontal(double y, std::string_view style, std::string_view name = {});
    void mark(double x, double y, std::string_view style, std::string_view name = {});
    void dots(std::span<const double> x, std::span<const double> y, double radius, std::string_view style,
              std::string_view name = {});
    void label(double x, double y, double dx, double dy, std::string_view anchor, std::string_view style,
               std::string_view text);

    [[nodiscard]] double px(double x) const { return left + (x - x_range.low) / (x_range.high - x_range.low) * width; }
    [[nodiscard]] double py(double y) const { return top + (y_range.high - y) / (y_range.high - y_range.low) * height; }
    void draw(Svg& svg) const;

    enum class Key { above, beside, none };

    double left = 0, top = 0, width = 1, height = 1;
    ValueRange x_range, y_range;
    std::string name;  ///< over the plot
    std::string x_title, y_title;
    bool has_axes = false, has_y_axis = true;
    Key key = Key::above;  ///< position of the names of curves
    Cells cells;
    std::vector<Curve> curves;
    std::vector<Note> notes;

  private:
    void draw_cells(Svg& svg) const;
    void draw_axes(Svg& svg) const;
    void draw_curve(Svg& svg, const Curve& curve) const;
    void draw_key(Svg& svg) const;
    /// Draws the colours with the values that separate them, from `y` down; returns where they end.
    double draw_cell_key(Svg& svg, double x, double y) const;
};

/// Rows needed for the names of curves above a plot of this width.
[[nodiscard]] int key_rows(const std::vector<Curve>& curves, double width);

struct Chart {
    std::string title;
    double width = 1000, height = 300;
    std::vector<Plot> plots;
};

/// A chart as data, from which it can be drawn again.
[[nodiscard]] Json chart_json(const Chart& chart);
/// The chart of chart_json(), also after it was written and read again.
[[nodiscard]] Chart chart_from(const Json& json);

/// An <svg> for a page that has chart.css, scaling with it.
[[nodiscard]] std::string chart_svg(const Chart& chart);
/// A separate file, with its style and a white background.
[[nodiscard]] std::string chart_file(const Chart& chart);
/// An <svg> of the given size around its content; on the page at most `widest` pixels wide, on paper `printed` mm, if
/// given.
[[nodiscard]] std::string figure_svg(double width, double height, std::string_view title, const Svg& content,
                                     double widest = 0, double printed = 0);
/// A sample of a curve for a key in words.
[[nodiscard]] std::string sample_svg(std::string_view style);

}  // namespace talus::report
