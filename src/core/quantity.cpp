#include "core/quantity.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace talus {
namespace {

constexpr double foot = 0.3048, inch = foot / 12;  // m

struct Unit {
    Dimension dimension;
    std::string_view name;
    double factor;
};

/// The first of a dimension's units is the one that a number without unit has.
constexpr Unit units[] = {
    {Dimension::length, "m", 1},       {Dimension::length, "cm", 0.01},     {Dimension::length, "mm", 0.001},
    {Dimension::length, "ft", foot},   {Dimension::length, "'", foot},      {Dimension::length, "in", inch},
    {Dimension::length, "\"", inch},   {Dimension::length, "feet", foot},   {Dimension::length, "foot", foot},
    {Dimension::length, "metre", 1},   {Dimension::length, "metres", 1},    {Dimension::length, "meter", 1},
    {Dimension::length, "meters", 1},  {Dimension::pressure, "Pa", 1},      {Dimension::pressure, "kPa", 1e3},
    {Dimension::pressure, "MPa", 1e6}, {Dimension::pressure, "kN/m2", 1e3}, {Dimension::pressure, "kN/m\xC2\xB2", 1e3},
};

/// Blanks and signs that look the same, in one form.
std::string plain(std::string_view text) {
    constexpr std::pair<std::string_view, std::string_view> same[] = {
        {"\xC2\xA0", " "},      {"\xE2\x80\xAF", " "},  // no-break spaces
        {"\xE2\x80\xB2", "'"},  {"\xE2\x80\x99", "'"},  // prime, right quotation mark
        {"\xE2\x80\xB3", "\""}, {"\xE2\x80\x9D", "\""},
    };
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        const auto found = std::find_if(std::begin(same), std::end(same),
                                        [&](const auto& pair) { return text.substr(i).starts_with(pair.first); });
        out += found != std::end(same) ? found->second : text.substr(i, 1);
        i += found != std::end(same) ? found->first.size() : 1;
    }
    return out;
}

void skip_blanks(std::string_view& text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t' || text.front() == '\r')) {
        text.remove_prefix(1);
    }
}

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// Takes a number from the front of the text. None: it does not begin with one.
Result<std::optional<double>> take_number(std::string_view& text, Comma comma) {
    std::string digits;
    std::size_t at = 0;
    if (at < text.size() && (text[at] == '-' || text[at] == '+')) {
        if (text[at] == '-') digits = "-";
        ++at;
    }
    const auto take_digits = [&] {
        const std::size_t first = at;
        while (at < text.size() && is_digit(text[at])) digits += text[at++];
        return at - first;
    };
    const std::size_t before = take_digits();
    const bool leading_zero = before > 0 && text[at - before] == '0';
    std::size_t behind = 0;
    if (at < text.size() && (text[at] == '.' || text[at] == ',')) {
        const bool is_comma = text[at++] == ',';
        digits += '.';
        behind = take_digits();
        if (is_comma && comma == Comma::either && behind == 3 && before > 0 && before < 4 && !leading_zero) {
            return Error{"its comma may mark the decimals or the thousands; write a decimal point"};
        }
    }
    if (before + behind == 0) return std::optional<double>();
    if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
        std::size_t power = at + 1;
        if (power < text.size() && (text[power] == '-' || text[power] == '+')) ++power;
        if (power < text.size() && is_digit(text[power])) {
            digits += 'e';
            if (text[at + 1] == '-') digits += '-';
            at = power;
            take_digits();
        }
    }
    double value = 0;
    const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (read.ec != std::errc() || !std::isfinite(value)) return Error{"its number is out of range"};
    text.remove_prefix(at);
    return std::optional(value);
}

std::string names_of(Dimension dimension) {
    return dimension == Dimension::length ? "m, cm, mm, ft, in, ' and \"" : "Pa, kPa, MPa and kN/m2";
}

}  // namespace

Result<double> read_quantity(std::string_view text, Dimension dimension, Comma comma) {
    const std::string written = plain(text);
    std::string_view rest = written;
    skip_blanks(rest);
    Result<std::optional<double>> number = take_number(rest, comma);
    if (!number) return number.error();
    if (!*number) return Error{"it does not begin with a number"};
    double value = **number;
    skip_blanks(rest);
    while (!rest.empty() && (rest.back() == ' ' || rest.back() == '\t' || rest.back() == '\r')) rest.remove_suffix(1);
    if (rest.empty()) return value;

    // Feet and inches, as 5'6".
    if (dimension == Dimension::length && rest.front() == '\'' && rest.size() > 1 && rest.back() == '"') {
        std::string_view inches = rest.substr(1, rest.size() - 2);
        skip_blanks(inches);
        const bool negative = value < 0 || inches.starts_with('-') || inches.starts_with('+');
        const Result<std::optional<double>> more = take_number(inches, comma);
        if (more && *more && inches.empty() && !negative && **more < 12) return value * foot + **more * inch;
    }
    for (const Unit& unit : units) {
        if (unit.dimension == dimension && unit.name == rest) return value * unit.factor;
    }
    const std::string behind = "after its number comes \"" + std::string(rest) + "\"";
    return Error{dimension == Dimension::none ? behind : behind + "; units are " + names_of(dimension)};
}

}  // namespace talus
