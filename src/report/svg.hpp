#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "report/number_text.hpp"

namespace talus::report {

/// Writes SVG: elements with their attributes, all text escaped.
class Svg {
  public:
    /// An empty text means no attribute.
    struct Attribute {
        std::string_view name;
        std::string value;

        Attribute(std::string_view n, double number) : name(n), value(coordinate(number)) {}
        Attribute(std::string_view n, std::string text) : name(n), value(std::move(text)) {}
        Attribute(std::string_view n, std::string_view text) : name(n), value(text) {}
        Attribute(std::string_view n, const char* text) : name(n), value(text) {}
    };
    using Attributes = std::initializer_list<Attribute>;

    /// An element that holds nothing but `text`.
    void add(std::string_view element, Attributes attributes, std::string_view text = {});
    /// An element that holds what follows until its close().
    void open(std::string_view element, Attributes attributes);
    void close(std::string_view element);
    void append(const Svg& other) { text_ += other.text_; }

    void line(std::string_view css_class, double x1, double y1, double x2, double y2);
    void rect(std::string_view css_class, double x, double y, double width, double height, std::string_view fill = {});
    void circle(std::string_view css_class, double x, double y, double radius);
    /// `title` is shown under the pointer.
    void path(std::string_view css_class, std::string_view data, std::string_view title = {});
    void text(std::string_view css_class, double x, double y, std::string_view words, std::string_view anchor = {});
    /// Centred at its place, rotated by `degrees` clockwise.
    void turned_text(std::string_view css_class, double x, double y, double degrees, std::string_view words,
                     std::string_view anchor = {}, std::string_view dy = {});

    [[nodiscard]] const std::string& str() const { return text_; }

  private:
    void start(std::string_view element, Attributes attributes);
    std::string text_;
};

/// The data of a path of straight lines, in tenths. Points are written from the one before, and points on a straight
/// line between their neighbours are left out: a third of the text, and to a tenth the same picture.
class PathData {
  public:
    void move_to(double x, double y);
    void line_to(double x, double y);
    /// Back to where it moved to last.
    void close();
    [[nodiscard]] bool empty() const { return text_.empty(); }
    /// The whole text.
    [[nodiscard]] std::string take();

  private:
    /// In tenths.
    struct Place {
        long x = 0, y = 0;
    };
    void flush();
    void add_number(long tenths);

    std::string text_;
    Place from_, to_, first_;  ///< to_: where a line is being drawn to from from_
    char command_ = 0;         ///< the last one
};

/// The path of a diamond, or of a disc, around a place.
[[nodiscard]] std::string diamond(double x, double y);
[[nodiscard]] std::string disc(double x, double y);

/// "translate(x y)"
[[nodiscard]] std::string translation(double x, double y);

}  // namespace talus::report
