#include "report/svg.hpp"

#include <cmath>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

namespace talus::report {

void Svg::start(std::string_view element, Attributes attributes) {
    text_.append("<").append(element);
    for (const Attribute& attribute : attributes) {
        if (attribute.value.empty()) continue;
        text_.append(" ").append(attribute.name).append("=\"").append(escape(attribute.value)).append("\"");
    }
}

void Svg::add(std::string_view element, Attributes attributes, std::string_view text) {
    start(element, attributes);
    if (text.empty()) {
        text_ += "/>";
        return;
    }
    text_.append(">").append(escape(text));
    close(element);
}

void Svg::open(std::string_view element, Attributes attributes) {
    start(element, attributes);
    text_ += ">";
}

void Svg::close(std::string_view element) {
    text_.append("</").append(element).append(">");
}

void Svg::line(std::string_view css_class, double x1, double y1, double x2, double y2) {
    add("line", {{"class", css_class}, {"x1", x1}, {"y1", y1}, {"x2", x2}, {"y2", y2}});
}

void Svg::rect(std::string_view css_class, double x, double y, double width, double height, std::string_view fill) {
    add("rect", {{"class", css_class}, {"x", x}, {"y", y}, {"width", width}, {"height", height}, {"fill", fill}});
}

void Svg::circle(std::string_view css_class, double x, double y, double radius) {
    add("circle", {{"class", css_class}, {"cx", x}, {"cy", y}, {"r", radius}});
}

void Svg::path(std::string_view css_class, std::string_view data, std::string_view title) {
    if (title.empty()) return add("path", {{"class", css_class}, {"d", data}});
    open("path", {{"class", css_class}, {"d", data}});
    add("title", {}, title);
    close("path");
}

void Svg::text(std::string_view css_class, double x, double y, std::string_view words, std::string_view anchor) {
    add("text", {{"class", css_class}, {"x", x}, {"y", y}, {"text-anchor", anchor}}, words);
}

void Svg::turned_text(std::string_view css_class, double x, double y, double degrees, std::string_view words,
                      std::string_view anchor, std::string_view dy) {
    const std::string place = fmt::format("{} rotate({})", translation(x, y), coordinate(degrees));
    add("text", {{"class", css_class}, {"transform", place}, {"text-anchor", anchor}, {"dy", dy}}, words);
}

void PathData::add_number(long tenths) {
    // A sign or a command before a number needs no space.
    const char last = text_.empty() ? '\0' : text_.back();
    if (tenths >= 0 && last >= '0' && last <= '9') text_ += ' ';
    if (tenths < 0) text_ += '-';
    const long size = std::abs(tenths);
    if (size >= 10 || size == 0) text_ += std::to_string(size / 10);
    if (size % 10 != 0) text_.append(".").append(std::to_string(size % 10));
}

void PathData::move_to(double x, double y) {
    flush();
    from_ = to_ = first_ = {std::lround(10 * x), std::lround(10 * y)};
    text_ += command_ = 'M';
    add_number(to_.x);
    add_number(to_.y);
}

void PathData::line_to(double x, double y) {
    const Place next{std::lround(10 * x), std::lround(10 * y)};
    const long ax = to_.x - from_.x, ay = to_.y - from_.y, bx = next.x - to_.x, by = next.y - to_.y;
    const bool straight_on = ax * by == ay * bx && ax * bx + ay * by >= 0;
    if (!straight_on) flush();
    to_ = next;
}

void PathData::flush() {
    const long dx = to_.x - from_.x, dy = to_.y - from_.y;
    if (dx == 0 && dy == 0) return;
    const char command = dy == 0 ? 'h' : dx == 0 ? 'v' : 'l';
    if (command != command_) text_ += command_ = command;
    if (dx != 0) add_number(dx);
    if (dy != 0) add_number(dy);
    from_ = to_;
}

void PathData::close() {
    flush();
    text_ += command_ = 'Z';
    from_ = to_ = first_;
}

std::string PathData::take() {
    flush();
    return std::move(text_);
}

std::string diamond(double x, double y) {
    return fmt::format("M{} {}l7 7l-7 7l-7 -7Z", coordinate(x), coordinate(y - 7));
}

std::string disc(double x, double y) {
    return fmt::format("M{} {}a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0Z", coordinate(x - 4.5), coordinate(y));
}

std::string translation(double x, double y) {
    return fmt::format("translate({} {})", coordinate(x), coordinate(y));
}

}  // namespace talus::report
