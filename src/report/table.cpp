#include "report/table.hpp"

#include "report/chart.hpp"
#include "report/number_text.hpp"

namespace talus::report {
namespace {

Json text_or_null(const Json& object, const char* key) {
    return object.is_object() && object.contains(key) ? object[key] : Json();
}

Json cell_of(const Json& column, const Json& given) {
    const Json value = given.is_object() ? text_or_null(given, "value") : given;
    const Json format = text_or_null(given, "format");
    const Json share = text_or_null(given, "share"), sample = text_or_null(given, "sample");
    return {
        {"text", value_text(value, format.is_null() ? column["format"].get<std::string>() : format.get<std::string>(),
                            column["missing"].get<std::string>())},
        {"class", column["style"]},
        {"strong", column["strong"]},
        {"code", column["style"] == "code"},
        {"span", nullptr},
        {"mark", text_or_null(given, "mark")},
        {"tone", text_or_null(given, "tone")},
        {"note", text_or_null(given, "note")},
        {"note_tone", text_or_null(given, "note_tone")},
        {"footnote", text_or_null(given, "footnote")},
        {"share", share.is_null() ? Json() : Json(coordinate(100 * share.get<double>()))},
        {"sample", sample.is_null() ? Json() : Json(sample_svg(sample.get<std::string>()))},
        {"link", text_or_null(given, "link")},
        {"verdict", text_or_null(given, "verdict")}};
}

Json row_of(const Json& columns, const Json& row) {
    Json cells = Json::array();
    for (const Json& column : columns) {
        const std::string key = column["key"];
        if (row.contains("fills") && row["fills"] == key) {  // this and all columns after it
            Json cell = cell_of(column, row[key]);
            cell["class"] = "missing";
            cell["span"] = columns.size() - cells.size();
            cells.push_back(std::move(cell));
            break;
        }
        cells.push_back(cell_of(column, row.contains(key) ? row[key] : Json()));
    }
    return {{"cells", std::move(cells)},
            {"row_style", text_or_null(row, "row_style")},
            {"heading", text_or_null(row, "heading")},
            {"heading_note", text_or_null(row, "heading_note")}};
}

}  // namespace

Json table(const std::vector<Column>& columns, std::string_view style) {
    Json json = {{"kind", "table"}, {"style", style}, {"columns", Json::array()}, {"rows", Json::array()}};
    for (const Column& c : columns) {
        json["columns"].push_back({{"key", c.key},
                                   {"name", c.name},
                                   {"unit", c.unit},
                                   {"format", c.format},
                                   {"style", c.style.empty() && !c.format.empty() ? "n" : c.style},
                                   {"missing", c.missing},
                                   {"strong", c.strong}});
    }
    return json;
}

Json table_cells(const Json& table) {
    Json shown = {{"table_style", table["style"]}, {"columns", Json::array()}, {"rows", Json::array()}};
    for (const Json& column : table["columns"]) {
        const bool number = column["style"] == "n";
        shown["columns"].push_back(
            {{"name", column["name"]}, {"unit", column["unit"]}, {"class", number ? column["style"] : Json()}});
    }
    shown["column_count"] = shown["columns"].size();
    for (const Json& row : table["rows"]) shown["rows"].push_back(row_of(table["columns"], row));
    return shown;
}

Json key_figure(std::string_view key, std::string_view name, Json value, std::string_view format, std::string_view unit,
                std::string_view note, bool alert) {
    return {{"kind", "key_figure"}, {"key", key},   {"name", name}, {"value", std::move(value)},
            {"format", format},     {"unit", unit}, {"note", note}, {"alert", alert}};
}

Json fact(std::string_view name, std::string_view text, std::string_view verdict, bool good) {
    return {{"name", name}, {"text", text}, {"good", good ? verdict : ""}, {"bad", good ? "" : verdict}};
}

std::string value_text(const Json& value, std::string_view format, std::string_view missing) {
    if (value.is_string()) return value.get<std::string>();
    if (!value.is_number()) return std::string(missing);
    const double number = value.get<double>();
    return number == number ? formatted(number, format) : std::string(missing);
}

}  // namespace talus::report
