#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "report/results.hpp"

/// What runs have measured over time at numbered places of a scene: gauges, cross-sections.
namespace talus::report {

/// A row per place and run; with several runs, their names are a column between those of the place and of the values.
struct PlaceRows {
    std::vector<Column> place, values;
    std::function<Json(const NamedRun&, std::size_t)> place_of;
    std::function<void(Json& row, const NamedRun&, std::size_t)> add_values;
};
[[nodiscard]] Json place_table(const std::vector<NamedRun>& runs, std::size_t places, const PlaceRows& rows);

/// A row of two plots per place, with a curve per run.
struct PlacePlots {
    struct Curves {
        std::vector<double> time, first, second;
    };
    std::string title, first_axis, second_axis;
    std::function<bool(const NamedRun&, std::size_t)> shows;  ///< a place is drawn if one of the runs has something
    std::function<Curves(const NamedRun&, std::size_t)> curves;
    std::function<std::string(std::size_t)> name;
};
/// The chart, null: nothing to draw; and how many places are left out, or null.
[[nodiscard]] std::pair<Json, Json> place_chart(const std::vector<NamedRun>& runs, std::size_t places,
                                                const PlacePlots& plots);

}  // namespace talus::report
