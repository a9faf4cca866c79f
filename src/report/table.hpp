#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

/// Parts of results.json that all reports show in the same way: tables, key figures and facts, as data.
namespace talus::report {

using Json = nlohmann::ordered_json;

struct Column {
    std::string key;  ///< in the rows
    std::string name, unit;
    std::string format = {};    ///< of numbers, as formatted() has it
    std::string style = {};     ///< CSS class; "n" where it holds numbers and nothing else is given
    std::string missing = "–";  ///< for null
    bool strong = false;
};

/// {"kind": "table", "columns": [...], "rows": []}. A row is an object by the columns' keys; its entries are text,
/// numbers, null, or an object:
///   value          text or number
///   format         instead of the column's
///   mark, tone     "hit-2": a coloured square before it; "good" or "bad": the value's colour
///   note, note_tone  small text below, and its colour
///   footnote       a letter raised behind it
///   share          0 to 1, drawn as a bar behind it
///   sample         style of a curve, drawn before it
///   link           a place in the page
///   verdict        "pass", "fail", "other": a badge
/// Beside columns a row may have `row_style` and `heading` with `heading_note`: a separate line above.
[[nodiscard]] Json table(const std::vector<Column>& columns, std::string_view style = {});

/// The table in the form of the template `table`: text in all cells.
[[nodiscard]] Json table_cells(const Json& table);

/// A key figure. `value` is a number printed by `format`, or text.
[[nodiscard]] Json key_figure(std::string_view key, std::string_view name, Json value, std::string_view format,
                              std::string_view unit, std::string_view note, bool alert = false);

/// A named line of text. `verdict` is highlighted at its end, in green where `good`, else red.
[[nodiscard]] Json fact(std::string_view name, std::string_view text, std::string_view verdict = {}, bool good = false);

/// The shown text of a number or text.
[[nodiscard]] std::string value_text(const Json& value, std::string_view format, std::string_view missing = "–");

}  // namespace talus::report
