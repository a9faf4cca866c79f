#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "core/geometry.hpp"
#include "terrain/plan_bins.hpp"

namespace talus::terrain {

/// The nearest face of a building.
template <class Real>
struct SolidSample {
    int building = -1;    ///< index, or -1: none within range
    Real distance{};      ///< to the surface, m; negative inside
    Vec3<Real> normal{};  ///< unit, out of the solid
};

/// The rank of a grain that no mesh lets through.
inline constexpr float largest_grain = 1;

/// A piece of a footprint's outline in local plan coordinates, the solid to its left.
struct WallEdge {
    double ax = 0, ay = 0, bx = 0, by = 0;
    double hidden_below = 0;  ///< local z: up to here the wall lies against or within another solid
    /// The same for nets that pass some grains that this wall stops, for grains that all of them stop.
    double hidden_by_nets = -std::numeric_limits<double>::infinity();
    float net_share = 0;

    [[nodiscard]] TALUS_DEVICE double hidden_for(float grain_rank) const {
        return grain_rank < net_share || hidden_by_nets < hidden_below ? hidden_below : hidden_by_nets;
    }
    /// Whether it is certainly farther than `distance` from a position, as its box is. Most edges are: this spares them
    /// a division and a square root. A margin of a nanometre is beyond rounding, so that results do not change.
    [[nodiscard]] TALUS_DEVICE bool beyond(double distance, double x, double y) const {
        const double east = std::max(0.0, std::max(std::min(ax, bx) - x, x - std::max(ax, bx)));
        const double north = std::max(0.0, std::max(std::min(ay, by) - y, y - std::max(ay, by)));
        const double reach = distance + 1e-9;
        return east * east + north * north > reach * reach;
    }
};
/// A part of a building's footprint.
struct WallSolid {
    std::uint32_t first_edge, last_edge;
    int building;
    double x_min, y_min, x_max, y_max;  ///< local, not grown
    double floor, roof;                 ///< local z; -infinity: from below the ground
    float passing_share;                ///< no obstacle for grains of a lower rank

    [[nodiscard]] TALUS_DEVICE bool stops(float grain_rank) const { return grain_rank >= passing_share; }
    /// As WallEdge::beyond(), of all its edges.
    [[nodiscard]] TALUS_DEVICE bool beyond(double distance, double x, double y) const {
        const double east = std::max(0.0, std::max(x_min - x, x - x_max));
        const double north = std::max(0.0, std::max(y_min - y, y - y_max));
        const double reach = distance + 1e-9;
        return east * east + north * north > reach * reach;
    }
};

/// The solids of BuildingSolids by pointers: see there. It owns nothing.
struct SolidWalls {
    static constexpr double infinity = std::numeric_limits<double>::infinity();
    static constexpr double on_the_surface = 1e-9;  ///< m, closer than this the direction to the surface is noise

    const WallEdge* edges = nullptr;
    const WallSolid* solids = nullptr;
    std::uint32_t edge_count = 0;
    double range = 0;
    PlanBinItems bins;

    [[nodiscard]] TALUS_DEVICE bool empty() const { return edge_count == 0; }
    [[nodiscard]] TALUS_DEVICE bool near(double x, double y) const { return !bins.near(x, y).empty(); }
    [[nodiscard]] TALUS_DEVICE bool in_plan(const WallSolid& solid, double x, double y) const;
    template <class Real>
    [[nodiscard]] TALUS_DEVICE SolidSample<Real> nearest(const Vec3<Real>& p, float grain_rank = largest_grain) const;
    template <class Real>
    [[nodiscard]] TALUS_DEVICE SolidSample<Real> second_nearest(const Vec3<Real>& p, const SolidSample<Real>& first,
                                                                float grain_rank = largest_grain) const;
    template <class Real>
    [[nodiscard]] TALUS_DEVICE bool inside(const Vec3<Real>& p, float grain_rank = largest_grain) const;
};

TALUS_DEVICE inline bool SolidWalls::in_plan(const WallSolid& solid, double x, double y) const {
    if (x < solid.x_min || x > solid.x_max || y < solid.y_min || y > solid.y_max) return false;
    bool in = false;
    for (std::uint32_t i = solid.first_edge; i < solid.last_edge; ++i) {
        const WallEdge& e = edges[i];
        if ((e.ay > y) != (e.by > y) && x < (e.bx - e.ax) * (y - e.ay) / (e.by - e.ay) + e.ax) in = !in;
    }
    return in;
}

template <class Real>
TALUS_DEVICE SolidSample<Real> SolidWalls::nearest(const Vec3<Real>& p, float grain_rank) const {
    // In double throughout, which represents a float position exactly, so that normals are correct down to a nanometre
    // from a wall.
    const double x = p.x, y = p.y, z = p.z;
    const std::span<const std::uint32_t> candidates = bins.near(x, y);
    if (candidates.empty()) return {};

    // Above or below the highest roof at this plan position; below it, and above the floor, the position is inside.
    int roof_building = -1, floor_building = -1;
    double roof = -infinity, floor = -infinity, below = infinity;
    for (const std::uint32_t k : candidates) {
        const WallSolid& solid = solids[k];
        if (z < solid.floor) {
            if (solid.floor - z < below && solid.stops(grain_rank) && in_plan(solid, x, y))
                below = solid.floor - z, floor_building = solid.building;
            continue;
        }
        if (solid.roof > roof && solid.stops(grain_rank) && in_plan(solid, x, y))
            roof = solid.roof, floor = solid.floor, roof_building = solid.building;
    }
    const bool inside = z < roof;
    int building = roof_building;
    double best = roof_building < 0 ? infinity : std::abs(z - roof);
    Vec3<double> normal{0, 0, 1};
    if (inside ? z - floor < best : below < best) {
        best = inside ? z - floor : below;
        building = inside ? roof_building : floor_building;
        normal.z = -1;
    }

    for (const std::uint32_t k : candidates) {
        const WallSolid& solid = solids[k];
        if (!solid.stops(grain_rank) || solid.beyond(inside ? best : std::min(best, range), x, y)) continue;
        for (std::uint32_t i = solid.first_edge; i < solid.last_edge; ++i) {
            const WallEdge& e = edges[i];
            if (e.beyond(inside ? best : std::min(best, range), x, y)) continue;
            // From inside, only walls not hidden by other solids are a way out. From outside, hidden walls are never
            // nearer.
            const double bottom = inside ? std::max(e.hidden_for(grain_rank), solid.floor) : solid.floor;
            if (bottom >= solid.roof) continue;
            const double dx = e.bx - e.ax, dy = e.by - e.ay, length_squared = dx * dx + dy * dy;
            const double t = std::clamp(((x - e.ax) * dx + (y - e.ay) * dy) / length_squared, 0.0, 1.0);
            const Vec3<double> to{e.ax + t * dx - x, e.ay + t * dy - y, std::clamp(z, bottom, solid.roof) - z};
            const double distance = length(to);
            if (distance >= best) continue;
            best = distance;
            building = solid.building;
            const double edge_length = std::sqrt(length_squared);
            normal = distance > on_the_surface ? (inside ? 1 / distance : -1 / distance) * to
                                               : Vec3<double>{dy / edge_length, -dx / edge_length, 0};
        }
    }
    if (building < 0 || (!inside && best > range)) return {};
    return {building,
            static_cast<Real>(inside ? -best : best),
            {static_cast<Real>(normal.x), static_cast<Real>(normal.y), static_cast<Real>(normal.z)}};
}

template <class Real>
TALUS_DEVICE SolidSample<Real> SolidWalls::second_nearest(const Vec3<Real>& p, const SolidSample<Real>& nearest,
                                                          float grain_rank) const {
    if (nearest.building < 0 || nearest.distance < 0) return {};
    constexpr double same_direction = 0.5;  // cosine
    const double x = p.x, y = p.y, z = p.z;
    const auto turned_away = [&](double nx, double ny, double nz) {
        return nx * nearest.normal.x + ny * nearest.normal.y + nz * nearest.normal.z < same_direction;
    };
    SolidSample<Real> second;
    double best = range;
    const auto take = [&](int building, double distance, double nx, double ny, double nz) {
        best = distance;
        second = {building,
                  static_cast<Real>(distance),
                  {static_cast<Real>(nx), static_cast<Real>(ny), static_cast<Real>(nz)}};
    };
    const std::span<const std::uint32_t> candidates = bins.near(x, y);
    for (const std::uint32_t k : candidates) {
        const WallSolid& solid = solids[k];
        if (!solid.stops(grain_rank) || z < solid.floor) continue;
        if (z >= solid.roof) {
            if (z - solid.roof < best && turned_away(0, 0, 1) && in_plan(solid, x, y)) {
                take(solid.building, z - solid.roof, 0, 0, 1);
            }
            continue;
        }
        if (solid.beyond(best, x, y)) continue;
        for (std::uint32_t i = solid.first_edge; i < solid.last_edge; ++i) {
            const WallEdge& e = edges[i];
            if (e.beyond(best, x, y)) continue;
            const double dx = e.bx - e.ax, dy = e.by - e.ay, length_squared = dx * dx + dy * dy;
            const double t = ((x - e.ax) * dx + (y - e.ay) * dy) / length_squared;
            if (t < 0 || t > 1 || z < e.hidden_for(grain_rank)) continue;
            const double length = std::sqrt(length_squared), nx = dy / length, ny = -dx / length;
            const double distance = (x - e.ax) * nx + (y - e.ay) * ny;
            if (distance < 0 || distance >= best || !turned_away(nx, ny, 0)) continue;
            take(solid.building, distance, nx, ny, 0);
        }
    }
    return second;
}

template <class Real>
TALUS_DEVICE bool SolidWalls::inside(const Vec3<Real>& p, float grain_rank) const {
    const double x = p.x, y = p.y, z = p.z;
    bool below_a_roof = false;
    for (const std::uint32_t k : bins.near(x, y)) {
        const WallSolid& solid = solids[k];
        if (z >= solid.floor && z < solid.roof && solid.stops(grain_rank) && in_plan(solid, x, y)) below_a_roof = true;
    }
    return below_a_roof && nearest(p, grain_rank).distance < 0;  // on a wall is not inside
}

}  // namespace talus::terrain
