#include "observe/wall_patches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus::observe {
namespace {

int parts_of(double length, double edge) {
    return std::max(1, static_cast<int>(length / edge + 1e-6));  // three metres less rounding are three parts
}

/// Twice the signed area: positive where a ring runs counter-clockwise.
double turning(const Ring& ring) {
    double twice = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const PlanPoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
        twice += (a.x - ring[0].x) * (b.y - ring[0].y) - (b.x - ring[0].x) * (a.y - ring[0].y);
    }
    return twice;
}

double roof_of(const terrain::Building& building, std::size_t part) {
    return building.part_roof_elevations.empty() ? building.roof_elevation : building.part_roof_elevations[part];
}

/// The highest roof of a building at a place, world; minus infinity beside it.
double roof_at(const terrain::Building& building, const PlanPoint& p) {
    double roof = -std::numeric_limits<double>::infinity();
    for (std::size_t part = 0; part < building.footprint.size(); ++part) {
        if (roof_of(building, part) > roof && contains(building.footprint[part], p)) roof = roof_of(building, part);
    }
    return roof;
}

}  // namespace

WallPatches::WallPatches(const terrain::Terrain& terrain, const std::vector<terrain::Building>& buildings, double edge,
                         double reach)
    : edge_(edge), patches_(buildings.size(), 0) {
    const double origin_z = terrain.frame().origin.z;
    for (std::size_t b = 0; b < buildings.size(); ++b) {
        const terrain::Building& building = buildings[b];
        if (!stands(building)) continue;
        for (std::size_t p = 0; p < building.footprint.size(); ++p) {
            const Polygon& part = building.footprint[p];
            const double elevation = roof_of(building, p);
            if (!std::isfinite(elevation)) continue;
            const double clearance = building.barrier ? building.barrier->clearance.value_or(0) : 0;
            const int index = static_cast<int>(b);
            add_walls(terrain, building, part.outer, false, clearance, elevation - origin_z, index);
            for (const Ring& hole : part.holes) {
                add_walls(terrain, building, hole, true, clearance, elevation - origin_z, index);
            }
            add_roof(terrain, part, elevation - origin_z, index);
        }
    }
    fill_bins(reach);
}

void WallPatches::add_column(Column column, double height) {
    column.rows = parts_of(height, edge_);
    column.row_height = height / column.rows;
    column.area = std::max(column.width, edge_) * std::max(column.row_height, edge_);
    std::uint32_t& patches = patches_[static_cast<std::size_t>(column.building)];
    column.first_patch = patches;
    patches += static_cast<std::uint32_t>(column.rows);
    columns_.push_back(column);
}

/// `clearance` of the wall's foot above the ground, m.
void WallPatches::add_walls(const terrain::Terrain& terrain, const terrain::Building& of, const Ring& ring, bool hole,
                            double clearance, double roof, int building) {
    const LocalFrame& frame = terrain.frame();
    const bool turned = (turning(ring) < 0) != hole;  // the solid must be on the left
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const PlanPoint &first = ring[i], &second = ring[(i + 1) % ring.size()];
        const PlanPoint &a = turned ? second : first, &b = turned ? first : second;
        const double length = std::hypot(b.x - a.x, b.y - a.y);
        if (!(length > 0)) continue;
        const double along_x = (b.x - a.x) / length, along_y = (b.y - a.y) / length;
        const int parts = parts_of(length, edge_);
        const double width = length / parts;
        for (int k = 0; k < parts; ++k) {
            const double x = a.x - frame.origin.x + k * width * along_x;
            const double y = a.y - frame.origin.y + k * width * along_y;
            const double ground = terrain.sample(x + width / 2 * along_x, y + width / 2 * along_y).height + clearance;
            double foot = ground < roof - 1e-3 ? ground : roof - edge_;  // or buried
            // Where parts of a structure meet there is a wall only above the lower one.
            constexpr double off = 0.02;  // m
            const PlanPoint outside{a.x + (k + 0.5) * width * along_x + off * along_y,
                                    a.y + (k + 0.5) * width * along_y - off * along_x};
            foot = std::max(foot, roof_at(of, outside) - frame.origin.z);
            if (!(foot < roof - 1e-3)) continue;
            add_column({x, y, foot, along_x, along_y, k * width, length, width, 0, 0, 0, building, 0, false},
                       roof - foot);
        }
    }
}

void WallPatches::add_roof(const terrain::Terrain& terrain, const Polygon& part, double roof, int building) {
    const LocalFrame& frame = terrain.frame();
    const Extent extent = extent_of(part);
    const int parts = parts_of(extent.width(), edge_);
    const double width = extent.width() / parts;
    for (int k = 0; k < parts; ++k) {
        add_column({extent.x_min - frame.origin.x + k * width, extent.y_min - frame.origin.y, roof, 1, 0, k * width,
                    extent.width(), width, 0, 0, 0, building, 0, true},
                   extent.height());
    }
}

void WallPatches::fill_bins(double reach) {
    std::vector<Extent> extents;
    for (const Column& c : columns_) {
        const double height = c.roof ? c.rows * c.row_height : 0;
        const PlanPoint end{c.x + c.width * c.along_x - height * c.along_y,
                            c.y + c.width * c.along_y + height * c.along_x};
        extents.push_back(
            Extent{std::min(c.x, end.x), std::min(c.y, end.y), std::max(c.x, end.x), std::max(c.y, end.y)}.grown(
                reach));
    }
    bins_ = terrain::PlanBins(extents, std::max(reach, edge_));
}

}  // namespace talus::observe
