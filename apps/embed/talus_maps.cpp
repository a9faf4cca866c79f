// The functions of talus.h that read maps.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/hazard_maps.hpp"
#include "grid_geometry.hpp"
#include "names.hpp"
#include "twin/results.hpp"

namespace {

using talus::MapKind;

constexpr float no_value = std::numeric_limits<float>::quiet_NaN();

/// Several cells become one by the kind of their map: depths keep their volume, peaks and arrivals stay on the safe
/// side.
Result<MapKind> kind_of(std::string_view name) {
    if (name == "depth" || name == "erosion_depth") return MapKind::present;
    if (name == "speed") return MapKind::peak;
    if (const talus::NamedMap* map = talus::find_map(name)) return map->kind;
    return Error{fmt::format("name = \"{}\": must be one of depth, {}", name,
                             fmt::join(talus::map_keys("speed", "erosion_depth"), ", "))};
}

/// Where there is debris.
Grid<float> present_speed(const Scenario& scenario) {
    auto present = scenario.run().observer().maps().present();
    for (std::size_t k = 0; k < present.speed.values.size(); ++k) {
        if (present.depth.values[k] == 0) present.speed.values[k] = no_value;
    }
    return std::move(present.speed);
}

Result<Grid<float>> read_layer(const Scenario& scenario, const std::string& name) {
    if (name == "speed") return present_speed(scenario);
    TALUS_ASSIGN(const auto read, talus::twin::layer_of(scenario, name));
    return read();
}

/// The cell of `to` that a place lies in; false: none.
bool cell_at(const GridGeometry& to, const talus::PlanPoint& p, std::size_t& cell) {
    const double column = std::floor((p.x - to.x_min) / to.cell), row = std::floor((p.y - to.y_min) / to.cell);
    if (!(column >= 0 && row >= 0 && column < to.columns && row < to.rows)) return false;
    cell = to.index(static_cast<int>(column), static_cast<int>(row));
    return true;
}

void add(float value, MapKind kind, float& sum) {
    if (std::isnan(value)) return;
    if (std::isnan(sum)) {
        sum = value;
    } else if (kind == MapKind::present) {
        sum += value;
    } else {
        sum = kind == MapKind::peak ? std::max(sum, value) : std::min(sum, value);
    }
}

/// Along an axis: which of the wanted cells holds the centre of each cell of the map, and how many centres each would
/// hold, had the map no edges. Both by the same rounding, so that a centre on an edge counts where it is added.
struct Centres {
    std::vector<int> wanted;  ///< -1: none
    std::vector<double> count;
};
/// A centre on an edge counts to the upper cell, also where rounding has moved it: share of a cell.
constexpr double rounding = 1e-6;

Centres centres_in(double from, double cell, int count, double x_min, double spacing, int own) {
    const auto first_in = [&](int k) { return std::ceil((from + k * cell - x_min) / spacing - 0.5 - rounding); };
    Centres centres{std::vector<int>(static_cast<std::size_t>(own), -1), {}};
    centres.count.reserve(static_cast<std::size_t>(count));
    for (int k = 0; k < count; ++k) {
        const double first = first_in(k), last = first_in(k + 1);
        centres.count.push_back(last - first);
        for (double i = std::max(0.0, first); i < std::min<double>(own, last); ++i) {
            centres.wanted[static_cast<std::size_t>(i)] = k;
        }
    }
    return centres;
}

Grid<float> on_cells(const Grid<float>& from, MapKind kind, const GridGeometry& wanted) {
    Grid<float> to(wanted, no_value);
    if (from.values.empty()) return to;
    const GridGeometry& g = from.geometry;
    const Centres columns = centres_in(wanted.x_min, wanted.cell, wanted.columns, g.x_min, g.cell, g.columns),
                  rows = centres_in(wanted.y_min, wanted.cell, wanted.rows, g.y_min, g.cell, g.rows);
    for (int row = 0; row < g.rows; ++row) {
        const int to_row = rows.wanted[static_cast<std::size_t>(row)];
        for (int column = 0; to_row >= 0 && column < g.columns; ++column) {
            const int to_column = columns.wanted[static_cast<std::size_t>(column)];
            if (to_column >= 0) add(from.at(column, row), kind, to.at(to_column, to_row));
        }
    }
    // A mean is over all cells of the map that there would be, had it no edges: beyond them there is no debris.
    std::size_t cell = 0;
    for (int row = 0; row < wanted.rows; ++row) {
        for (int column = 0; column < wanted.columns; ++column) {
            float& value = to.at(column, row);
            const double centres =
                columns.count[static_cast<std::size_t>(column)] * rows.count[static_cast<std::size_t>(row)];
            if (!(centres > 0)) {
                value = cell_at(g, wanted.centre(column, row), cell) ? from.values[cell] : no_value;
            } else if (kind == MapKind::present) {
                value = static_cast<float>(value / centres);
            }
        }
    }
    return to;
}

void give_map(const Answers::Map& made, talus_map* map) {
    const GridGeometry& g = made.geometry;
    give<talus_map>({0, {g.x_min, g.y_min, g.cell, g.columns, g.rows}, made.values.data()}, map);
}

}  // namespace

extern "C" {

int talus_get_map(const talus_simulation* simulation, const char* name, talus_map* map, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(need(name, "name"));
        TALUS_TRY(check_size(map, "map"));
        auto& maps = simulation->answers.maps;
        auto found = maps.find(name);
        if (found == maps.end()) {
            TALUS_TRY(kind_of(name));
            TALUS_ASSIGN(const Grid<float> grid, read_layer(*simulation->scenario, name));
            found = maps.emplace(name, Answers::Map{grid.geometry, buffer_of(grid.values)}).first;
        }
        give_map(found->second, map);
        return {};
    });
}

int talus_get_map_on(const talus_simulation* simulation, const char* name, const talus_grid* grid, talus_map* map,
                     talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(need(name, "name"));
        TALUS_TRY(need(grid, "grid"));
        TALUS_TRY(check_size(map, "map"));
        TALUS_ASSIGN(const MapKind kind, kind_of(name));
        TALUS_ASSIGN(const GridGeometry wanted, talus::embed::geometry_of(*grid, 1));
        auto& maps = simulation->answers.maps;
        const std::string key = fmt::format("{} {} {} {} {} {}", name, wanted.x_min, wanted.y_min, wanted.cell,
                                            wanted.columns, wanted.rows);
        auto found = maps.find(key);
        if (found == maps.end()) {
            TALUS_ASSIGN(const Grid<float> read, read_layer(*simulation->scenario, name));
            const Grid<float> made = on_cells(read, kind, wanted);
            found = maps.emplace(key, Answers::Map{wanted, buffer_of(made.values)}).first;
        }
        give_map(found->second, map);
        return {};
    });
}

}  // extern "C"
