#include "products/report_text.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

namespace talus::report {

std::string escape(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::string fixed(double value, int digits) {
    if (!std::isfinite(value)) return "–";
    std::string plain = fmt::format("{:.{}f}", std::abs(value), std::max(0, digits));
    const bool zero = plain.find_first_not_of("0.") == std::string::npos;
    const std::size_t whole = std::min(plain.find('.'), plain.size());
    // Four digits stay together (a year, a density); from five on, thousands are set apart by a narrow space.
    if (whole >= 5) {
        for (std::size_t i = whole; i > 3;) plain.insert(i -= 3, "\u202f");
    }
    return (value < 0 && !zero ? "−" : "") + plain;
}

std::string significant(double value, int digits) {
    if (!std::isfinite(value) || value == 0) return fixed(value, 0);
    const int magnitude = static_cast<int>(std::floor(std::log10(std::abs(value))));
    return fixed(value, std::clamp(digits - 1 - magnitude, 0, 9));
}

std::string plain(double value) {
    return std::isfinite(value) ? fmt::format("{:.6g}", value) : "–";
}

std::string shortened(const std::string& text, std::size_t longest) {
    if (text.size() <= longest) return text;
    std::size_t end = longest;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // not inside a character
    return text.substr(0, end) + "…";
}

std::string coordinate(double value) {
    std::string s = fmt::format("{:.2f}", value);
    while (s.back() == '0') s.pop_back();
    if (s.back() == '.') s.pop_back();
    return s == "-0" ? "0" : s;
}

std::string row(std::string_view name, const std::string& value) {
    return fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", name, value);
}

std::string caption(int number, std::string_view title, std::string_view text) {
    return fmt::format("<figcaption><b>Figure {}. {}</b> {}</figcaption>", number, title, text);
}

std::string fill(std::string_view text, std::initializer_list<std::pair<std::string_view, std::string_view>> values) {
    std::string out;
    while (true) {
        const std::size_t open = text.find("{{"), close = text.find("}}", open);
        if (open == std::string_view::npos || close == std::string_view::npos) break;
        const std::string_view name = text.substr(open + 2, close - open - 2);
        const auto* found = std::find_if(values.begin(), values.end(), [&](const auto& v) { return v.first == name; });
        assert(found != values.end());
        out += text.substr(0, open);
        if (found != values.end()) out += found->second;
        text.remove_prefix(close + 2);
    }
    return out += text;
}

}  // namespace talus::report
