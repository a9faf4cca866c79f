#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "params/fields.hpp"

namespace talus::params {
namespace {

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            out += '\\';
            out += c;
        } else if (c == '\n') {
            out += "\\n";
        } else if (c == '\t') {
            out += "\\t";
        } else if (code < 0x20 || code == 0x7f) {
            out += fmt::format("\\u{:04X}", code);
        } else {
            out += c;
        }
    }
    return out + '"';
}

template <class Items, class F>
std::string joined(const Items& items, F&& to_text) {
    std::string out;
    for (const auto& item : items) out += (out.empty() ? "" : ", ") + to_text(item);
    return out;
}

bool finite(const Extent& e) {
    return std::isfinite(e.x_min) && std::isfinite(e.y_min) && std::isfinite(e.x_max) && std::isfinite(e.y_max);
}

std::string kind_text(const Parameter& parameter) {
    switch (parameter.kind) {
        case ParameterKind::boolean:
            return "true or false";
        case ParameterKind::integer:
            return "a whole number";
        case ParameterKind::number:
            return "a number";
        case ParameterKind::text:
            return "a text in quotes";
        case ParameterKind::path:
            return "a file path in quotes";
        case ParameterKind::choice:
            return "one of " + joined(parameter.choices, quoted);
        case ParameterKind::text_list:
            return "a list of texts in quotes";
        case ParameterKind::extent:
            return "[x_min, y_min, x_max, y_max] with x_min < x_max and y_min < y_max";
        case ParameterKind::points:
            return "a list of places, a pair of numbers each";
    }
    return "";
}

struct TomlText {
    std::string operator()(std::monostate) const { return ""; }
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(std::int64_t value) const { return std::to_string(value); }
    std::string operator()(double value) const { return fmt::format("{}", value); }
    std::string operator()(const std::string& value) const { return quoted(value); }
    std::string operator()(const std::vector<std::string>& value) const { return "[" + joined(value, quoted) + "]"; }
    std::string operator()(const Extent& e) const {
        return fmt::format("[{}, {}, {}, {}]", e.x_min, e.y_min, e.x_max, e.y_max);
    }
    std::string operator()(const std::vector<PlanPoint>& points) const {
        return "[" + joined(points, [](const PlanPoint& p) { return fmt::format("[{}, {}]", p.x, p.y); }) + "]";
    }
};

struct PlainText : TomlText {
    using TomlText::operator();
    std::string operator()(double value) const { return fmt::format("{:.6g}", value); }
    std::string operator()(const std::string& value) const { return value; }
    std::string operator()(const std::vector<std::string>& value) const {
        return joined(value, [](const std::string& text) { return text; });
    }
};

}  // namespace

bool Range::contains(double value) const {
    return (low_included ? value >= low : value > low) && (high_included ? value <= high : value < high);
}

std::string Range::text() const {
    const bool has_low = std::isfinite(low), has_high = std::isfinite(high);
    if (has_low && has_high) {
        if (low_included) return fmt::format("{} to {}{}", low, high_included ? "" : "below ", high);
        return fmt::format("greater than {} and {} {}", low, high_included ? "at most" : "below", high);
    }
    if (has_low) return fmt::format("{} {}", low_included ? "at least" : "above", low);
    if (has_high) return fmt::format("{} {}", high_included ? "at most" : "below", high);
    return "";
}

std::string allowed_text(const Parameter& parameter) {
    std::string text = kind_text(parameter);
    const std::string range = parameter.range.text();
    const bool between = range.find(" to ") != std::string::npos;
    if (!range.empty()) text += (between ? " from " : " ") + range;
    if (!parameter.unit.empty()) text += " (" + parameter.unit + ")";
    return text;
}

std::string problem_with(const Parameter& parameter, const ParameterValue& value) {
    bool allowed = true;
    if (const auto* whole = std::get_if<std::int64_t>(&value)) {
        allowed = parameter.range.contains(static_cast<double>(*whole));
    } else if (const auto* number = std::get_if<double>(&value)) {
        allowed = std::isfinite(*number) && parameter.range.contains(*number);
    } else if (const auto* e = std::get_if<Extent>(&value)) {
        allowed = finite(*e) && e->x_min < e->x_max && e->y_min < e->y_max;
    } else if (const auto* points = std::get_if<std::vector<PlanPoint>>(&value)) {
        allowed = std::all_of(points->begin(), points->end(),
                              [](const PlanPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y); });
    } else if (parameter.kind == ParameterKind::choice) {
        const auto* text = std::get_if<std::string>(&value);
        allowed = text && std::count(parameter.choices.begin(), parameter.choices.end(), *text) > 0;
    } else if (parameter.kind == ParameterKind::path) {
        const auto* text = std::get_if<std::string>(&value);
        allowed = !text || text->find('\0') == std::string::npos;  // the operating system would end the name there
    }
    return allowed ? "" : allowed_text(parameter);
}

std::string toml_text(const ParameterValue& value) {
    return std::visit(TomlText{}, value);
}

std::string plain_text(const ParameterValue& value) {
    return std::visit(PlainText{}, value);
}

}  // namespace talus::params
