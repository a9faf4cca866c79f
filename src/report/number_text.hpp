#pragma once

#include <string>
#include <string_view>

/// Text of reports: escaping, and numbers as an engineer prints them.
namespace talus::report {

/// Text from a scene as HTML or SVG text or attribute: & < > " ' are escaped.
[[nodiscard]] std::string escape(std::string_view text);

/// `digits` decimals, thousands set apart, a true minus sign; an en dash where the value is not finite.
[[nodiscard]] std::string fixed(double value, int digits);

/// About `digits` significant digits without an exponent, otherwise as `fixed`.
[[nodiscard]] std::string significant(double value, int digits);

/// As a scene file would give it: up to six digits, no trailing zeros; an en dash where the value is not finite.
[[nodiscard]] std::string plain(double value);

/// Cut to `longest` bytes with an ellipsis, for labels with limited space.
[[nodiscard]] std::string shortened(const std::string& text, std::size_t longest);

/// For coordinates in SVG: at most two decimals, "." as the point, no trailing zeros.
[[nodiscard]] std::string coordinate(double value);

/// A number in the format requested by a template: "f2" two decimals, "l2" the same or what decimals_for() says, "d2"
/// the same with a plus sign, "s3" three significant digits, "p" plain, "c" a coordinate, "" the fewest digits that
/// identify it.
[[nodiscard]] std::string formatted(double value, std::string_view format);

}  // namespace talus::report
