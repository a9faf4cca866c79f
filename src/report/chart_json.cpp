#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/number_or_null.hpp"
#include "report/chart.hpp"

namespace talus::report {
namespace {

constexpr std::array<std::string_view, 8> shape_names = {"line", "band",    "bars",     "diamonds",
                                                         "dots", "crosses", "vertical", "horizontal"};
constexpr std::array<std::string_view, 3> key_names = {"above", "beside", "none"};

Json numbers(const std::vector<double>& values) {
    Json list = Json::array();
    for (const double value : values) list.push_back(number_or_null<Json>(value));
    return list;
}

std::vector<double> numbers_from(const Json& list) {
    std::vector<double> values;
    for (const Json& value : list) {
        values.push_back(value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>());
    }
    return values;
}

template <std::size_t count>
int index_of(const std::array<std::string_view, count>& names, const Json& name) {
    const auto found = std::find(names.begin(), names.end(), name.get<std::string>());
    return found == names.end() ? 0 : static_cast<int>(found - names.begin());
}

Json axis_json(const std::string& title, const ValueRange& range) {
    return {{"title", title}, {"low", range.low}, {"high", range.high}};
}

Json plot_json(const Plot& plot) {
    Json json = {{"x", axis_json(plot.x_title, plot.x_range)},
                 {"y", axis_json(plot.y_title, plot.y_range)},
                 {"name", plot.name},
                 {"place", {plot.left, plot.top, plot.width, plot.height}},
                 {"axes", plot.has_axes},
                 {"y_axis", plot.has_y_axis},
                 {"key", key_names.at(static_cast<std::size_t>(plot.key))},
                 {"curves", Json::array()},
                 {"notes", Json::array()}};
    for (const Curve& curve : plot.curves) {
        Json entry = {{"shape", shape_names.at(static_cast<std::size_t>(curve.shape))},
                      {"style", curve.style},
                      {"name", curve.name},
                      {"x", numbers(curve.x)},
                      {"y", numbers(curve.y)}};
        if (!curve.low.empty()) entry["low"] = numbers(curve.low);
        if (curve.size > 0) entry["size"] = curve.size;
        json["curves"].push_back(std::move(entry));
    }
    for (const Note& note : plot.notes) {
        json["notes"].push_back({{"at", {note.x, note.y, note.dx, note.dy}},
                                 {"anchor", note.anchor},
                                 {"style", note.style},
                                 {"text", note.text}});
    }
    if (!plot.cells.values.empty()) {
        json["cells"] = {{"x", numbers(plot.cells.x)},           {"y", numbers(plot.cells.y)},
                         {"values", numbers(plot.cells.values)}, {"breaks", plot.cells.breaks},
                         {"colours", plot.cells.colours},        {"title", plot.cells.title}};
    }
    return json;
}

ValueRange range_from(const Json& axis) {
    return {axis["low"].get<double>(), axis["high"].get<double>()};
}

Plot plot_from(const Json& json) {
    const std::vector<double> place = numbers_from(json["place"]);
    Plot plot(place.at(0), place.at(1), place.at(2), place.at(3), range_from(json["x"]), range_from(json["y"]));
    plot.name = json["name"];
    plot.x_title = json["x"]["title"];
    plot.y_title = json["y"]["title"];
    plot.has_axes = json["axes"];
    plot.has_y_axis = json["y_axis"];
    plot.key = static_cast<Plot::Key>(index_of(key_names, json["key"]));
    for (const Json& entry : json["curves"]) {
        plot.curves.push_back({static_cast<Curve::Shape>(index_of(shape_names, entry["shape"])), entry["style"],
                               entry["name"], numbers_from(entry["x"]), numbers_from(entry["y"]),
                               entry.contains("low") ? numbers_from(entry["low"]) : std::vector<double>(),
                               entry.value("size", 0.0)});
    }
    for (const Json& entry : json["notes"]) {
        const std::vector<double> at = numbers_from(entry["at"]);
        plot.notes.push_back({at.at(0), at.at(1), at.at(2), at.at(3), entry["anchor"], entry["style"], entry["text"]});
    }
    if (json.contains("cells")) {
        const Json& cells = json["cells"];
        plot.cells = {numbers_from(cells["x"]),
                      numbers_from(cells["y"]),
                      numbers_from(cells["values"]),
                      numbers_from(cells["breaks"]),
                      cells["colours"].get<std::vector<std::string>>(),
                      cells["title"]};
    }
    return plot;
}

}  // namespace

Json chart_json(const Chart& chart) {
    Json json = {{"kind", "chart"},
                 {"title", chart.title},
                 {"width", chart.width},
                 {"height", chart.height},
                 {"plots", Json::array()}};
    for (const Plot& plot : chart.plots) json["plots"].push_back(plot_json(plot));
    return json;
}

Chart chart_from(const Json& json) {
    Chart chart{json["title"], json["width"], json["height"], {}};
    for (const Json& plot : json["plots"]) chart.plots.push_back(plot_from(plot));
    return chart;
}

}  // namespace talus::report
