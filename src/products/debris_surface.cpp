#include "products/debris_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/try.hpp"

namespace talus::products {
namespace {

constexpr float thinnest = 0.01F;      // m; thinner debris is not drawn
constexpr float picture_lift = 0.05F;  // m, above the debris' surface: as deep, it would flicker with the ground
constexpr double margin_share = 0.25;
constexpr int least_margin = 20;  // cells
constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// The cells of the map around those that debris reached: in its grid, within the terrain.
GridGeometry surroundings(const Grid<float>& peak, const Extent& terrain) {
    const GridGeometry& map = peak.geometry;
    int west = map.columns, east = -1, south = map.rows, north = -1;
    for (int row = 0; row < map.rows; ++row) {
        for (int column = 0; column < map.columns; ++column) {
            if (!(peak.at(column, row) > 0)) continue;
            west = std::min(west, column);
            east = std::max(east, column);
            south = std::min(south, row);
            north = std::max(north, row);
        }
    }
    if (east < 0) return map;
    const int margin = std::max(least_margin, static_cast<int>(margin_share * std::max(east - west, north - south)));
    const auto within = [&](double edge, int cell, bool down) {
        const double limit = edge / map.cell;
        return down ? std::max(cell, static_cast<int>(std::ceil(limit - 1e-6)))
                    : std::min(cell, static_cast<int>(std::floor(limit + 1e-6)) - 1);
    };
    west = within(terrain.x_min - map.x_min, west - margin, true);
    south = within(terrain.y_min - map.y_min, south - margin, true);
    east = within(terrain.x_max - map.x_min, east + margin, false);
    north = within(terrain.y_max - map.y_min, north + margin, false);
    return {map.x_min + west * map.cell, map.y_min + south * map.cell, map.cell, east - west + 1, north - south + 1};
}

std::vector<std::size_t> evenly(std::size_t all, std::size_t most) {
    const std::size_t count = std::min(all, most);
    std::vector<std::size_t> chosen(count);
    for (std::size_t i = 0; i < count; ++i) {
        chosen[i] = count < 2 ? 0 : (i * (all - 1) + (count - 1) / 2) / (count - 1);
    }
    return chosen;
}

/// Unit normal of a height field that rises by so much per metre.
LocalPoint normal_of(float rise_x, float rise_y) {
    const float length = std::sqrt(1 + rise_x * rise_x + rise_y * rise_y);
    return {-rise_x / length, -rise_y / length, 1 / length};
}

/// Rise between the neighbours on both sides of a point, of those that are known.
float rise_of(float before, float here, float after, float cell) {
    const bool has_before = std::isfinite(before), has_after = std::isfinite(after);
    if (has_before && has_after) return (after - before) / (2 * cell);
    if (has_after) return (after - here) / cell;
    return has_before ? (here - before) / cell : 0;
}

LocalPoint normal_at(const Grid<float>& height, int column, int row) {
    const GridGeometry& g = height.geometry;
    const auto cell = static_cast<float>(g.cell);
    const auto at = [&](int c, int r) {
        return c < 0 || r < 0 || c >= g.columns || r >= g.rows ? std::numeric_limits<float>::quiet_NaN()
                                                               : height.at(c, r);
    };
    const float here = height.at(column, row);
    return normal_of(rise_of(at(column - 1, row), here, at(column + 1, row), cell),
                     rise_of(at(column, row - 1), here, at(column, row + 1), cell));
}

}  // namespace

Result<DebrisSurface> DebrisSurface::make(const terrain::Terrain& terrain, const Grid<float>& peak_depth,
                                          const SeriesFrames& frames) {
    DebrisSurface surface(terrain, frames);
    surface.animated_ = evenly(frames.times().size(), max_frames);
    const GridGeometry cells = surroundings(peak_depth, terrain.elevation().geometry.extent());
    TALUS_ASSIGN(const std::size_t debris, surface.count_animated(cells));
    // At its edge the surface of the debris goes on to points without any: about as many again where it is narrow.
    int factor = 1;
    while (cells.size() / (factor * factor) > max_ground_points || 2 * debris / (factor * factor) > max_debris_points) {
        ++factor;
    }
    surface.lay_lattice(cells, factor);
    return surface;
}

Result<std::size_t> DebrisSurface::count_animated(const GridGeometry& cells) const {
    std::vector<float> depths(static_cast<std::size_t>(cells.columns));
    std::size_t count = 0;
    for (const std::size_t frame : animated_) {
        for (int row = 0; row < cells.rows; ++row) {
            TALUS_TRY(frames_.read(0, frame, cells, row, depths.data()));
            count += std::count_if(depths.begin(), depths.end(), [](float depth) { return depth >= thinnest; });
        }
    }
    return count;
}

void DebrisSurface::lay_lattice(const GridGeometry& cells, int factor) {
    factor_ = factor;
    cells_ = cells;
    ground_ = Grid<float>({cells.x_min, cells.y_min, cells.cell * factor, std::max(1, cells.columns / factor),
                           std::max(1, cells.rows / factor)});
    const LocalFrame& frame = terrain_.frame();
    lowest_ = std::numeric_limits<double>::infinity();
    highest_ = -lowest_;
    for (int row = 0; row < ground_.geometry.rows; ++row) {
        for (int column = 0; column < ground_.geometry.columns; ++column) {
            const double z = terrain_.elevation_at(ground_.geometry.centre(column, row)) - frame.origin.z;
            ground_.at(column, row) = static_cast<float>(z);
            lowest_ = std::fmin(lowest_, z);
            highest_ = std::fmax(highest_, z);
        }
    }
}

namespace {

LocalPoint point_on(const LocalFrame& frame, const Grid<float>& ground, int column, int row, float above) {
    const PlanPoint p = ground.geometry.centre(column, row);
    return {static_cast<float>(p.x - frame.origin.x), static_cast<float>(p.y - frame.origin.y),
            ground.at(column, row) + above};
}

/// Gives every point of a lattice that a triangle uses its place in a mesh; `add` adds it.
template <class Wanted, class Add>
std::vector<std::uint32_t> triangles_of(const GridGeometry& lattice, const Wanted& wanted, const Add& add) {
    std::vector<std::uint32_t> places(lattice.size(), none), corners;
    std::uint32_t count = 0;
    const auto take = [&](const std::array<int, 6>& triangle) {
        for (std::size_t k = 0; k < 6; k += 2) {
            std::uint32_t& place = places[lattice.index(triangle[k], triangle[k + 1])];
            if (place == none) {
                place = count++;
                add(triangle[k], triangle[k + 1]);
            }
            corners.push_back(place);
        }
    };
    for (int row = 0; row + 1 < lattice.rows; ++row) {
        for (int column = 0; column + 1 < lattice.columns; ++column) {
            const int c = column, r = row;
            for (const std::array<int, 6>& triangle :
                 {std::array{c, r, c + 1, r, c + 1, r + 1}, std::array{c, r, c + 1, r + 1, c, r + 1}}) {
                if (wanted(triangle)) take(triangle);
            }
        }
    }
    return corners;
}

}  // namespace

TriangleMesh DebrisSurface::ground() const {
    TriangleMesh mesh;
    const auto known = [&](const std::array<int, 6>& t) {
        return std::isfinite(ground_.at(t[0], t[1]) + ground_.at(t[2], t[3]) + ground_.at(t[4], t[5]));
    };
    mesh.corners = triangles_of(ground_.geometry, known, [&](int column, int row) {
        mesh.points.push_back(point_on(terrain_.frame(), ground_, column, row, 0));
        mesh.normals.push_back(normal_at(ground_, column, row));
    });
    return mesh;
}

Status DebrisSurface::read(std::size_t frame, Grid<float>& depth, Grid<float>& speed) const {
    depth = speed = Grid<float>(ground_.geometry);
    const auto width = static_cast<std::size_t>(cells_.columns);
    std::vector<float> depths(width), speeds(width);
    const int columns = std::min(cells_.columns, depth.geometry.columns * factor_);
    for (int row = 0; row < std::min(cells_.rows, depth.geometry.rows * factor_); ++row) {
        TALUS_TRY(frames_.read(0, frame, cells_, row, depths.data()));
        TALUS_TRY(frames_.read(1, frame, cells_, row, speeds.data()));
        for (int column = 0; column < columns; ++column) {
            const auto k = static_cast<std::size_t>(column);
            if (!(depths[k] > 0)) continue;
            depth.at(column / factor_, row / factor_) += depths[k];
            if (std::isfinite(speeds[k])) speed.at(column / factor_, row / factor_) += depths[k] * speeds[k];
        }
    }
    for (std::size_t i = 0; i < depth.values.size(); ++i) {
        if (depth.values[i] > 0) speed.values[i] /= depth.values[i];
        depth.values[i] /= static_cast<float>(factor_ * factor_);
        if (depth.values[i] < thinnest) depth.values[i] = 0;
    }
    return {};
}

Result<DebrisMesh> DebrisSurface::debris(std::size_t frame) const {
    Grid<float> depth, speed;
    TALUS_TRY(read(frame, depth, speed));
    return mesh_debris(terrain_.frame(), ground_, depth, speed, picture_lift);
}

DebrisMesh mesh_debris(const LocalFrame& frame, const Grid<float>& ground, const Grid<float>& depth,
                       const Grid<float>& speed, float lift) {
    Grid<float> surface = ground;
    for (std::size_t i = 0; i < surface.values.size(); ++i) surface.values[i] += depth.values[i];
    DebrisMesh mesh;
    const auto wet = [&](const std::array<int, 6>& t) {
        return depth.at(t[0], t[1]) + depth.at(t[2], t[3]) + depth.at(t[4], t[5]) > 0 &&
               std::isfinite(surface.at(t[0], t[1]) + surface.at(t[2], t[3]) + surface.at(t[4], t[5]));
    };
    mesh.corners = triangles_of(ground.geometry, wet, [&](int column, int row) {
        const float deep = depth.at(column, row);
        mesh.points.push_back(point_on(frame, ground, column, row, deep > 0 ? deep + lift : 0));
        mesh.normals.push_back(normal_at(surface, column, row));
        mesh.depth.push_back(deep);
        mesh.speed.push_back(speed.at(column, row));
    });
    return mesh;
}

}  // namespace talus::products
