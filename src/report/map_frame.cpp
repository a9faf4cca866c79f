// Which part of the world the maps show.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "report/map.hpp"

namespace talus::report {
namespace {

/// The smallest extent around the cells that have a value.
std::optional<Extent> wet_extent(const Grid<float>& grid) {
    std::optional<Extent> out;
    for (int r = 0; r < grid.geometry.rows; ++r) {
        for (int c = 0; c < grid.geometry.columns; ++c) {
            if (std::isnan(grid.at(c, r))) continue;
            const PlanPoint p = grid.geometry.centre(c, r);
            if (!out) out = Extent{p.x, p.y, p.x, p.y};
            out->include(p);
        }
    }
    return out;
}

/// Widens the shorter side so that no map is too narrow, then keeps the area within the terrain.
Extent well_proportioned(Extent area, const Extent& terrain) {
    constexpr double widest = 1.75, narrowest = 0.85;  // width over height
    const double ratio = area.width() / area.height();
    if (ratio > widest) {
        const double more = (area.width() / widest - area.height()) / 2;
        area.y_min -= more;
        area.y_max += more;
    } else if (ratio < narrowest) {
        const double more = (area.height() * narrowest - area.width()) / 2;
        area.x_min -= more;
        area.x_max += more;
    }
    // Shifted inward first, so that the margin lost on one side is gained on the other; then clipped.
    const auto keep = [](double& low, double& high, double terrain_low, double terrain_high) {
        if (low < terrain_low) {
            high += terrain_low - low;
            low = terrain_low;
        }
        if (high > terrain_high) {
            low = std::max(terrain_low, low - (high - terrain_high));
            high = terrain_high;
        }
    };
    keep(area.x_min, area.x_max, terrain.x_min, terrain.x_max);
    keep(area.y_min, area.y_max, terrain.y_min, terrain.y_max);
    return area;
}

/// With a margin, as large as the page allows.
MapFrame framed(const Extent& around, const Extent& terrain) {
    MapFrame frame;
    frame.area = well_proportioned(around.grown(10 + 0.06 * std::max(around.width(), around.height())), terrain);
    const double widest = 1000 - frame.left - 20 - MapFrame::key_width;
    frame.scale = std::min(widest / frame.area.width(), 700 / frame.area.height());
    return frame;
}

}  // namespace

MapFrame map_frame(const scene::Scene& scene, const MapContent& content) {
    const Extent terrain = scene.terrain.elevation().geometry.extent();
    if (content.zoom) return framed(extent_of(*content.zoom), terrain);
    std::vector<Extent> parts;
    if (const auto wet = wet_extent(*content.reached)) parts.push_back(*wet);
    for (const terrain::Release& release : scene.releases) {
        if (!release.patches.empty() || release.thickness_raster) parts.push_back(release.extent());
    }
    for (const terrain::Inflow& inflow : scene.inflows) {
        for (const Polygon& part : inflow.area) parts.push_back(extent_of(part));
        if (inflow.over_area()) continue;
        for (const PlanPoint& end : {inflow.from, inflow.to}) parts.push_back({end.x, end.y, end.x, end.y});
    }
    if (!scene.flow_path.empty()) {
        double last = content.farthest_chainage;
        for (const params::ObservationSpec& o : scene.spec.observations)
            last = std::isnan(last) ? o.chainage : std::max(last, o.chainage);
        const double end = std::isnan(last) ? scene.flow_path.length() : std::min(scene.flow_path.length(), 1.2 * last);
        for (int k = 0; k <= 100; ++k) {
            const PlanPoint p = scene.flow_path.point_at(end * k / 100);
            parts.push_back({p.x, p.y, p.x, p.y});
        }
    }
    for (std::size_t i = 0; i < std::min(scene.buildings.size(), content.buildings.classes.size()); ++i) {
        if (content.buildings.classes[i] == 0) continue;
        for (const Polygon& polygon : scene.buildings[i].footprint) parts.push_back(extent_of(polygon));
    }
    Extent area = parts.empty() ? terrain : parts.front();
    for (const Extent& e : parts) {
        area.include({e.x_min, e.y_min});
        area.include({e.x_max, e.y_max});
    }
    return framed(area, terrain);
}

}  // namespace talus::report
