#include "scene/suspect_ground.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/terrain_frame.hpp"
#include "scene/load.hpp"

namespace talus::scene {
namespace {

// Steps from a cell to the next. Cliffs have ledges: few stand over their whole length at 76 degrees (4 cells), none of
// 100 m at 83 degrees (8 cells).
constexpr double odd_step = 20, odd_step_cells = 4;       // m, cells
constexpr double false_step = 100, false_step_cells = 8;  // m, cells
constexpr std::size_t fewest_cells = 4;
constexpr int mixed_width = 6;  // cells over which resampling mixes ground and nodata

struct Around {
    int column, row;
};
constexpr std::array<Around, 8> around{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};

/// Calls `visit` with the elevation of each neighbour: the first four share an edge.
template <class Visit>
void for_neighbours(const Grid<float>& elevation, int column, int row, std::size_t count, const Visit& visit) {
    const GridGeometry& g = elevation.geometry;
    for (std::size_t k = 0; k < count; ++k) {
        const int c = column + around[k].column, r = row + around[k].row;
        if (c >= 0 && r >= 0 && c < g.columns && r < g.rows) visit(elevation.at(c, r), c, r);
    }
}

/// Cells within `mixed_width` of nodata.
Grid<std::uint8_t> near_nodata(const Grid<float>& elevation) {
    const GridGeometry& g = elevation.geometry;
    Grid<std::uint8_t> along_rows(g, 0), near(g, 0);
    const auto spread = [&](int lines, int length, const auto& is_nodata, const auto& mark) {
        for (int line = 0; line < lines; ++line) {
            for (const int step : {1, -1}) {
                int since = mixed_width + 1;
                for (int k = 0; k < length; ++k) {
                    const int at = step > 0 ? k : length - 1 - k;
                    since = is_nodata(line, at) ? 0 : since + 1;
                    if (since <= mixed_width) mark(line, at);
                }
            }
        }
    };
    spread(
        g.rows, g.columns, [&](int row, int column) { return std::isnan(elevation.at(column, row)); },
        [&](int row, int column) { along_rows.at(column, row) = 1; });
    spread(
        g.columns, g.rows, [&](int column, int row) { return along_rows.at(column, row) != 0; },
        [&](int column, int row) { near.at(column, row) = 1; });
    return near;
}

double median_of(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Cells of one value and the steps from them up to the ground beside them.
struct Plain {
    float value = 0;
    std::size_t cells = 0;
    std::vector<double> steps;  ///< m
    PlanPoint place;            ///< of the highest step
    double highest = 0;         ///< m
};

Plain plain_of(const Grid<float>& elevation, const ReachableGround& reachable, float value) {
    const GridGeometry& g = elevation.geometry;
    Plain plain{.value = value, .steps = {}, .place = {}};
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            if (elevation.at(column, row) != value || !reachable.holds(column, row)) continue;
            ++plain.cells;
            for_neighbours(elevation, column, row, 4, [&](float beside, int, int) {
                if (std::isnan(beside) || beside == value) return;
                const double step = std::abs(static_cast<double>(beside) - value);
                plain.steps.push_back(step);
                if (step <= plain.highest) return;
                plain.highest = step;
                plain.place = g.centre(column, row);
            });
        }
    }
    return plain;
}

/// A value that stands for missing data and is not declared: the ground beside it is far away almost everywhere.
Status check_plain(const ParsedScene& parsed, const ReachableGround& reachable, float value, Scene& scene) {
    const Grid<float>& elevation = scene.terrain.elevation();
    Plain plain = plain_of(elevation, reachable, value);
    if (plain.cells < fewest_cells || plain.steps.size() < fewest_cells) return {};
    const double step = median_of(plain.steps), cells = step / scene.terrain.cell();
    if (step < odd_step || cells < odd_step_cells) return {};
    const params::TerrainSpec& spec = scene.spec.terrain;
    const std::string text = fmt::format(
        "{} cells hold exactly {:.10g} m within reach of the debris; along their edge the adjacent ground differs by "
        "{:.0f} m (median; {:.0f} m at {})",
        plain.cells, value, step, plain.highest, place_text(plain.place));
    const std::string command = geo::declare_nodata_command(spec.file, spec.band, value);
    if (step < false_step || cells < false_step_cells) {
        scene.notes.push_back(
            fmt::format("terrain: {}; check these heights. If the value marks missing data: {}", text, command));
        return {};
    }
    return Error{fmt::format(
        "{}: {}: {}: it marks missing data, over whose edge debris would fall; declare it as nodata: {} (or "
        "leave these cells out with terrain.extent_m)",
        parsed.at("terrain.file"), spec.file, text, command)};
}

/// Cells beside nodata that are no ground.
struct Mixed {
    std::size_t cells = 0;
    PlanPoint place;  ///< of the one that differs most
    double most = 0;  ///< m
    double elevation = 0;

    void add(const PlanPoint& p, double z, double step) {
        ++cells;
        if (step <= most) return;
        most = step;
        place = p;
        elevation = z;
    }
};

Status check_edge_of_nodata(const ParsedScene& parsed, const ReachableGround& reachable, Scene& scene) {
    const Grid<float>& elevation = scene.terrain.elevation();
    const GridGeometry& g = elevation.geometry;
    const Grid<std::uint8_t> near = near_nodata(elevation);
    double lowest = std::numeric_limits<double>::infinity();  // of ground away from nodata
    for (std::size_t k = 0; k < g.size(); ++k) {
        if (near.values[k] == 0) lowest = std::min(lowest, static_cast<double>(elevation.values[k]));
    }
    Mixed below, odd;  // far below all ground; far from the ground beside them
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const double z = elevation.at(column, row);
            if (std::isnan(z) || near.at(column, row) == 0 || !reachable.holds(column, row)) continue;
            double step = 0;
            for_neighbours(elevation, column, row, 8, [&](float beside, int, int) {
                if (beside > z) step = std::max(step, beside - z);
            });
            if (step < odd_step || step < odd_step_cells * g.cell) continue;
            (z < lowest - false_step ? below : odd).add(g.centre(column, row), z, step);
        }
    }
    const params::TerrainSpec& spec = scene.spec.terrain;
    constexpr const char* again =
        "resample it again from its original with the nodata value declared (gdalwarp -srcnodata VALUE -dstnodata "
        "-9999)";
    if (below.cells > 0) {
        return Error{fmt::format(
            "{}: {}: {} cells beside nodata are far below all other ground (one of {:.0f} m is {:.0f} m below its "
            "neighbour at {}; the lowest other ground is at {:.0f} m): means of ground and nodata, as resampling "
            "leaves them; {}, or take them out: {}",
            parsed.at("terrain.file"), spec.file, below.cells, below.elevation, below.most, place_text(below.place),
            lowest, again, geo::cut_below_command(spec.file, spec.band, std::floor(lowest)))};
    }
    if (odd.cells >= fewest_cells) {
        scene.notes.push_back(
            fmt::format("terrain: {} cells beside nodata are up to {:.0f} m below their neighbours (at {}); check "
                        "these heights. If they are means of ground and nodata, {}",
                        odd.cells, odd.most, place_text(odd.place), again));
    }
    return {};
}

}  // namespace

Status check_missing_data(const ParsedScene& parsed, const ReachableGround& reachable, Scene& scene) {
    const Grid<float>& elevation = scene.terrain.elevation();
    float lowest = std::numeric_limits<float>::infinity();
    bool has_nodata = false;
    for (const float z : elevation.values) {
        has_nodata = has_nodata || std::isnan(z);
        if (z < lowest) lowest = z;
    }
    TALUS_TRY(check_plain(parsed, reachable, 0, scene));
    if (lowest < 0) TALUS_TRY(check_plain(parsed, reachable, lowest, scene));
    return has_nodata ? check_edge_of_nodata(parsed, reachable, scene) : Status();
}

}  // namespace talus::scene
