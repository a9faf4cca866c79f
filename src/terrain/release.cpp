#include "terrain/release.hpp"

#include <algorithm>
#include <cmath>

namespace talus::terrain {
namespace {

/// 0 outside the raster, where there is no data and where it is <= 0.
double raster_thickness(const Grid<float>& raster, const PlanPoint& p) {
    const float value = value_at(raster, p);
    return value > 0 ? value : 0;  // the comparison also turns NaN into 0
}

/// Crossings of the line y = constant with the polygon's rings, sorted: inside between the 1st and 2nd, 3rd and 4th,
/// ...
void find_crossings(const Polygon& polygon, double y, std::vector<double>& crossings) {
    crossings.clear();
    const auto add_ring = [&](const Ring& ring) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const PlanPoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
            if ((a.y > y) != (b.y > y)) crossings.push_back(a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y));
        }
    };
    add_ring(polygon.outer);
    for (const Ring& hole : polygon.holes) add_ring(hole);
    std::sort(crossings.begin(), crossings.end());
}

/// Integral of `f` over the polygon by the midpoint rule in strips of about `step`, whose ends lie exactly on the
/// rings.
template <class Function>
double integrate(const Polygon& polygon, double step, const Function& f) {
    const Extent extent = extent_of(polygon);
    if (!(extent.height() > 0)) return 0;
    const auto strips = static_cast<int>(std::ceil(extent.height() / step));
    const double strip = extent.height() / strips;
    std::vector<double> crossings;
    double sum = 0;
    for (int s = 0; s < strips; ++s) {
        const double y = extent.y_min + (s + 0.5) * strip;
        find_crossings(polygon, y, crossings);
        for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) {
            const double width = crossings[k + 1] - crossings[k];
            if (!(width > 0)) continue;
            const auto pieces = static_cast<int>(std::ceil(width / step));
            const double piece = width / pieces;
            for (int i = 0; i < pieces; ++i) sum += f({crossings[k] + (i + 0.5) * piece, y}) * piece * strip;
        }
    }
    return sum;
}

double vertical_depth(const Terrain& terrain, const PlanPoint& p, double thickness, bool vertical) {
    if (!(thickness > 0)) return 0;
    const double cosine = terrain.slope_cosine_at(p);
    return std::isnan(cosine) ? 0 : vertical ? thickness : thickness / cosine;
}

Polygon rectangle(const Extent& e) {
    return {{{e.x_min, e.y_min}, {e.x_max, e.y_min}, {e.x_max, e.y_max}, {e.x_min, e.y_max}}, {}};
}

}  // namespace

double Release::thickness_at(const PlanPoint& p) const {
    if (patches.empty()) return thickness_raster ? raster_thickness(*thickness_raster, p) : 0;
    for (const ReleasePatch& patch : patches) {
        if (contains(patch.polygon, p))
            return thickness_raster ? raster_thickness(*thickness_raster, p) : patch.thickness;
    }
    return 0;
}

double Release::depth_at(const Terrain& terrain, const PlanPoint& p) const {
    return vertical_depth(terrain, p, thickness_at(p), vertical());
}

Extent Release::extent() const {
    if (patches.empty()) return thickness_raster ? thickness_raster->geometry.extent() : Extent{};
    Extent extent = extent_of(patches.front().polygon);
    for (const ReleasePatch& patch : patches) {
        const Extent e = extent_of(patch.polygon);
        extent.include({e.x_min, e.y_min});
        extent.include({e.x_max, e.y_max});
    }
    return extent;
}

namespace {

/// Integral of `f(place, thickness)` over the plan area.
template <class Function>
double integrate(const Terrain& terrain, const Release& release, const Function& f) {
    double sum = 0;
    const auto add = [&](const Polygon& polygon, double thickness) {
        const Extent extent = extent_of(polygon);
        // An eighth of a cell resolves the slope's jumps at cell edges, a 400th of the patch its outline.
        double step = std::min(terrain.cell() / 8, std::max(extent.width(), extent.height()) / 400);
        if (release.thickness_raster) step = std::min(step, release.thickness_raster->geometry.cell / 8);
        // A large patch needs at most 4000 strips: its outline is a small share of it.
        step = std::max(step, std::max(extent.width(), extent.height()) / 4000);
        sum += integrate(polygon, step, [&](const PlanPoint& p) {
            return f(p, release.thickness_raster ? raster_thickness(*release.thickness_raster, p) : thickness);
        });
    };
    if (release.patches.empty() && release.thickness_raster) {
        add(rectangle(release.thickness_raster->geometry.extent()), 0);
    }
    for (const ReleasePatch& patch : release.patches) add(patch.polygon, patch.thickness);
    return sum;
}

}  // namespace

double release_volume(const Terrain& terrain, const Release& release) {
    return integrate(terrain, release, [&](const PlanPoint& p, double thickness) {
        return vertical_depth(terrain, p, thickness, release.vertical());
    });
}

double mean_thickness(const Terrain& terrain, const Release& release) {
    const double slope_area = integrate(terrain, release, [&](const PlanPoint& p, double thickness) {
        return vertical_depth(terrain, p, thickness > 0 ? 1 : 0, false);
    });
    return slope_area > 0 ? release.volume / slope_area : 0;
}

double release_slope_area(const Terrain& terrain, const Release& release) {
    Release sheet = release;  // 1 m thick everywhere: its volume is the area
    sheet.thickness_raster.reset();
    sheet.spec.thickness_direction = params::ThicknessDirection::normal;
    for (ReleasePatch& patch : sheet.patches) patch.thickness = 1;
    return release_volume(terrain, sheet);
}

}  // namespace talus::terrain
