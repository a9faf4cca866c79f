#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

/// Text of the report: escaping, numbers as an engineer prints them, and templates.
namespace talus::report {

/// Text from a scene as HTML or SVG text or attribute: & < > " ' are escaped.
[[nodiscard]] std::string escape(std::string_view text);

/// `digits` decimals, thousands set apart, a true minus sign; an en dash where the value is not finite.
[[nodiscard]] std::string fixed(double value, int digits);

/// About `digits` significant digits without an exponent, else as `fixed`.
[[nodiscard]] std::string significant(double value, int digits);

/// As a scene file would give it: up to six digits, no trailing zeros; an en dash where the value is not finite.
[[nodiscard]] std::string plain(double value);

/// Cut to `longest` bytes with an ellipsis, for labels that have no more room.
[[nodiscard]] std::string shortened(const std::string& text, std::size_t longest);

/// For coordinates in SVG: at most two decimals, "." as the point, no trailing zeros.
[[nodiscard]] std::string coordinate(double value);

/// A row of a table with the row's name as its head; `value` is HTML.
[[nodiscard]] std::string row(std::string_view name, const std::string& value);

/// Below a figure; `text` is HTML.
[[nodiscard]] std::string caption(int number, std::string_view title, std::string_view text);

/// Replaces every {{name}} of a template once; the values themselves are not looked at again. A name that is not given
/// is a bug (asserted) and leaves nothing.
[[nodiscard]] std::string fill(std::string_view text,
                               std::initializer_list<std::pair<std::string_view, std::string_view>> values);

}  // namespace talus::report
