#include "report/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <kainjow/mustache.hpp>

#include <fmt/format.h>

#include "core/decimals.hpp"
#include "core/visible_text.hpp"

namespace talus::report {

std::string escape(std::string_view text) {
    return kainjow::mustache::html_escape(visible(text));
}

std::string fixed(double value, int digits) {
    if (!std::isfinite(value)) return "–";
    std::string plain = fmt::format("{:.{}f}", std::abs(value), std::max(0, digits));
    const bool zero = plain.find_first_not_of("0.") == std::string::npos;
    const std::size_t whole = std::min(plain.find('.'), plain.size());
    // Four digits stay together (a year, a density); from five on, thousands are separated by a narrow space.
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

std::string formatted(double value, std::string_view format) {
    const int digits = format.size() > 1 ? format[1] - '0' : 0;
    switch (format.empty() ? ' ' : format[0]) {
        case 'f':
            return fixed(value, digits);
        case 's':
            return significant(value, digits);
        case 'l':
            return fixed(value, decimals_for(value, digits));
        case 'd':
            return (value > 0 ? "+" : "") + fixed(value, digits);
        case 'p':
            return plain(value);
        case 'c':
            return coordinate(value);
        default:
            return std::isfinite(value) ? fmt::format("{}", value) : "–";
    }
}

}  // namespace talus::report
