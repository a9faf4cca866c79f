#include "scene/new_terrain.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "scene/load.hpp"
#include "scene/reach.hpp"

namespace talus::scene {
namespace {

constexpr double first_reach = 1000, first_reach_cells = 100;  // around the release: m and cells, at least
constexpr double least_margin = 50, least_margin_cells = 10;   // m and cells
constexpr double most_searched = 6e7;                          // cells: 2 GB while they are searched

/// Whether all that debris can reach lies within the part, or the part ends where the raster does: closer to its edge
/// than a cell.
bool holds(const Extent& part, const Extent& reached, const Extent& all, double cell) {
    const auto side = [&](double part_edge, double reached_edge, double raster_edge) {
        return std::abs(reached_edge - part_edge) > cell / 2 || std::abs(part_edge - raster_edge) < cell * 0.999;
    };
    return side(part.x_min, reached.x_min, all.x_min) && side(part.x_max, reached.x_max, all.x_max) &&
           side(part.y_min, reached.y_min, all.y_min) && side(part.y_max, reached.y_max, all.y_max);
}

/// The reachable ground and a margin, in whole cells of the terrain.
Extent reachable_part(const Scene& scene) {
    const GridGeometry& g = scene.terrain.elevation().geometry;
    const double margin = std::max(least_margin, least_margin_cells * g.cell);
    const Extent reach =
        reachable_extent(scene.terrain, scene.releases, travel_angle_deg * std::numbers::pi / 180).grown(margin);
    const Extent all = g.extent();
    const auto down = [&](double value, double edge) { return edge + g.cell * std::floor((value - edge) / g.cell); };
    const auto up = [&](double value, double edge) { return edge + g.cell * std::ceil((value - edge) / g.cell); };
    return {std::max(all.x_min, down(reach.x_min, g.x_min)), std::max(all.y_min, down(reach.y_min, g.y_min)),
            std::min(all.x_max, up(reach.x_max, g.x_min)), std::min(all.y_max, up(reach.y_max, g.y_min))};
}

Extent common(const Extent& a, const Extent& b) {
    return {std::max(a.x_min, b.x_min), std::max(a.y_min, b.y_min), std::min(a.x_max, b.x_max),
            std::min(a.y_max, b.y_max)};
}

}  // namespace

Result<int> coarsening(const std::string& file, const geo::TerrainFrame& frame, double cell) {
    const double own = frame.geometry.cell, ratio = cell / own, whole = std::round(ratio);
    if (!std::isfinite(ratio) || !(ratio > 0.999)) {
        return Error{fmt::format(
            "cell {:.6g} m is refused; {} has cells of {:.6g} m, and it must be a multiple of that", cell, file, own)};
    }
    if (std::abs(ratio - whole) > 1e-3 || whole > 1e4) {
        return Error{fmt::format(
            "cell {:.6g} m is refused; it must be a whole multiple of {:.6g} m, the cells of {}: "
            "{:.6g} or {:.6g}",
            cell, own, file, own * std::floor(std::min(ratio, 1e4)), own * std::ceil(std::min(ratio, 1e4)))};
    }
    return static_cast<int>(whole);
}

Result<Extent> choose_extent(const ParsedScene& parsed, const geo::TerrainFrame& frame, const Extent& footprint,
                             int factor) {
    const params::TerrainSpec& spec = parsed.spec.terrain;
    const Extent all = frame.geometry.extent();
    const double cell = frame.geometry.cell * factor;
    for (double reach = std::max(first_reach, first_reach_cells * cell);; reach *= 2) {
        const Extent part = common(footprint.grown(reach), all);
        const double cells = part.width() / cell * (part.height() / cell);
        if (cells > most_searched) {
            return Error{fmt::format(
                "{}: {}: debris of this release can reach more than {:.0f} million cells of {:.6g} m; name the part "
                "that "
                "matters with --extent XMIN YMIN XMAX YMAX (the release lies at {}), or larger cells with --cell M",
                parsed.at("terrain.file"), spec.file, most_searched / 1e6, cell, extent_text(footprint))};
        }
        const bool local = spec.crs == params::CrsChoice::local;
        Result<geo::Raster> raster = factor > 1 ? geo::read_coarse_terrain(spec.file, spec.band, part, factor, local)
                                                : geo::read_terrain_raster(spec.file, spec.band, part, local);
        if (!raster) return Error{parsed.at("terrain.file") + ": " + raster.error().message};
        Scene scene;
        scene.spec = parsed.spec;
        scene.crs = raster->crs;
        scene.terrain = terrain::Terrain(std::move(raster->grid));
        TALUS_TRY(load_releases(parsed, scene));
        const Extent read = scene.terrain.elevation().geometry.extent();
        const Extent reached = reachable_part(scene);
        if (holds(read, reached, all, cell)) return reached;
    }
}

}  // namespace talus::scene
