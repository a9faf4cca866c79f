#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/raster_outline.hpp"
#include "geo/vector.hpp"
#include "scene/attributes.hpp"
#include "scene/known_ground.hpp"
#include "scene/load.hpp"
#include "scene/polygons.hpp"
#include "scene/pressure_hydrograph.hpp"

namespace talus::scene {
namespace {

/// Maximum thickness of any release, m.
double thickest() {
    return params::parameter_of("release", "thickness_m").range.high;
}

Result<double> feature_thickness(const params::ReleaseSpec& spec, const geo::PolygonLayer& layer, std::size_t feature) {
    if (spec.thickness) return *spec.thickness;
    if (spec.thickness_attribute.empty()) return 1.0;  // a raster replaces it, a target volume scales it
    return read_length(spec.file, layer, feature, {spec.thickness_attribute, "thickness", thickest()});
}

/// Every point of the polygon must lie on known ground.
Status check_covered(const Polygon& polygon, const std::string& label, const Scene& scene) {
    const std::optional<PlanPoint> bare = known_ground(polygon, scene.terrain).bare;
    if (!bare) return {};
    const Extent hull = covered_extent(scene.terrain);
    if (hull.contains(*bare)) {
        return Error{
            fmt::format("{} lies over nodata of the terrain at {}; fill the terrain there or redraw the release", label,
                        place_text(*bare))};
    }
    const Extent extent = extent_of(polygon);
    const bool wholly = extent.x_max < hull.x_min || extent.x_min > hull.x_max || extent.y_max < hull.y_min ||
                        extent.y_min > hull.y_max;
    return Error{fmt::format("{} {} the terrain: {} is not in {} ({}); {}", label,
                             wholly ? "lies outside" : "reaches beyond", place_text(*bare), extent_text(hull),
                             scene.crs.label(),
                             scene.spec.terrain.extent ? "redraw the release or widen terrain.extent_m"
                                                       : "redraw the release or use a larger terrain")};
}

/// The raster must hold thickness somewhere on the patches; missing parts are noted.
Status check_thickness_raster(const params::ReleaseSpec& spec, const std::string& label,
                              const terrain::Release& release, Scene& scene) {
    std::size_t points = 0, with_thickness = 0;
    double thickest_here = 0;
    const double step = std::min(scene.terrain.cell(), release.thickness_raster->geometry.cell) / 2;
    for (const terrain::ReleasePatch& patch : release.patches) {
        for_each_inside(patch.polygon, step, [&](const PlanPoint& p) {
            const double thickness = release.thickness_at(p);
            ++points;
            if (thickness > 0) ++with_thickness;
            thickest_here = std::max(thickest_here, thickness);
        });
    }
    if (with_thickness == 0) {
        return Error{fmt::format("{}: has no thickness above 0 {}", spec.thickness_raster,
                                 spec.file.empty() ? "over the terrain" : "inside the polygons of " + spec.file)};
    }
    if (thickest_here > thickest()) {
        return Error{fmt::format("{}: holds a thickness of {:.6g}; it must be at most {:.0f} (m)",
                                 spec.thickness_raster, thickest_here, thickest())};
    }
    if (with_thickness < points) {
        const auto bare = static_cast<double>(points - with_thickness) / static_cast<double>(points);
        scene.notes.push_back(fmt::format(
            "{}: {:.2g} % of its area has no thickness in the raster and releases nothing", label, 100 * bare));
    }
    return {};
}

/// Sets the uniform thickness that gives the target volume.
Status spread_volume(const params::ReleaseSpec& spec, const std::string& label, terrain::Release& release,
                     Scene& scene) {
    const double slope_area = release_volume(scene.terrain, release);  // the patches are 1 m thick so far
    const double thickness = slope_area > 0 ? *spec.volume / slope_area : 0;
    if (!(thickness > 0) || thickness > thickest()) {
        return Error{
            fmt::format("{} of {:.6g} m3 over {:.6g} m2 of slope would be {:.6g} m thick; it must be greater than 0 "
                        "and at most {:.0f} m",
                        label, *spec.volume, slope_area, thickness, thickest())};
    }
    for (terrain::ReleasePatch& patch : release.patches) patch.thickness = thickness;
    scene.notes.push_back(fmt::format("{}: {:.6g} m3 over {:.4g} m2 of slope is a uniform thickness of {:.4g} m", label,
                                      *spec.volume, slope_area, thickness));
    return {};
}

/// Mean downhill direction in plan under the patches. Errors: the ground is level.
Result<PlanPoint> downhill(const terrain::Release& release, const terrain::Terrain& terrain) {
    const double h = terrain.cell();
    double east = 0, north = 0, points = 0;  // rises per metre, summed up
    for (const terrain::ReleasePatch& patch : release.patches) {
        for_each_inside(patch.polygon, h / 2, [&](const PlanPoint& p) {
            const double rise_east = terrain.elevation_at({p.x + h, p.y}) - terrain.elevation_at({p.x - h, p.y});
            const double rise_north = terrain.elevation_at({p.x, p.y + h}) - terrain.elevation_at({p.x, p.y - h});
            if (std::isnan(rise_east + rise_north)) return;
            east += rise_east / (2 * h);
            north += rise_north / (2 * h);
            ++points;
        });
    }
    const double steepness = std::hypot(east, north);
    if (steepness < 1e-3 * points || points == 0) {
        return Error{"is refused; the ground under the release is level, so that nothing is along it or across it"};
    }
    return PlanPoint{-east / steepness, -north / steepness};
}

void move(Polygon& polygon, const PlanPoint& by) {
    const auto move_ring = [&](Ring& ring) {
        for (PlanPoint& p : ring) p = {p.x + by.x, p.y + by.y};
    };
    move_ring(polygon.outer);
    for (Ring& hole : polygon.holes) move_ring(hole);
}

/// Moves the patches along and across the slope; returns the displacement.
Result<PlanPoint> shift(const params::ReleaseSpec& spec, const std::string& label, terrain::Release& release,
                        Scene& scene) {
    if (spec.shift_along == 0 && spec.shift_across == 0) return PlanPoint{0, 0};
    TALUS_ASSIGN(const PlanPoint down, downhill(release, scene.terrain));
    const PlanPoint by{spec.shift_along * down.x - spec.shift_across * down.y,
                       spec.shift_along * down.y + spec.shift_across * down.x};
    for (terrain::ReleasePatch& patch : release.patches) move(patch.polygon, by);
    scene.notes.push_back(
        fmt::format("{}: moved by {:.4g} m to the east and {:.4g} m to the north, {:.4g} m down the "
                    "slope and {:.4g} m to the left",
                    label, by.x, by.y, spec.shift_along, spec.shift_across));
    return by;
}

/// Volume of the raster's cells whose centres lie in no polygon, m3.
double volume_outside(const terrain::Release& release) {
    const Grid<float>& raster = *release.thickness_raster;
    const GridGeometry& g = raster.geometry;
    Grid<std::uint8_t> inside(g, 0);
    for (const terrain::ReleasePatch& patch : release.patches) {
        for_each_cell_inside(patch.polygon, g, [&](int column, int row) { inside.at(column, row) = 1; });
    }
    double sum = 0;
    for (std::size_t k = 0; k < raster.values.size(); ++k) {
        if (raster.values[k] > 0 && inside.values[k] == 0) sum += static_cast<double>(raster.values[k]);
    }
    return sum * g.cell * g.cell;
}

/// Notes the volume of the release next to that of its raster.
void note_raster_volume(const std::string& label, const terrain::Release& release, Scene& scene) {
    const Grid<float>& raster = *release.thickness_raster;
    double sum = 0;
    for (const float thickness : raster.values) sum += thickness > 0 ? static_cast<double>(thickness) : 0;
    const double whole = sum * raster.geometry.cell * raster.geometry.cell;
    std::string text = fmt::format(
        "{}: releases {:.6g} m3; the cells of its raster times their thickness are {:.6g} m3, thickness being taken "
        "as {}",
        label, release.volume, whole, release.vertical() ? "vertical" : "normal to the slope (thickness_direction)");
    if (!release.spec.file.empty()) {
        const double outside = volume_outside(release);
        text += outside > 0
                    ? fmt::format("; {:.6g} m3 of these ({:.2g} %) lie outside the polygons and are not released",
                                  outside, 100 * outside / whole)
                    : std::string("; none of these lie outside the polygons");
    }
    scene.notes.push_back(std::move(text));
}

Result<terrain::Release> load_release(const ParsedScene& parsed, std::size_t index, Scene& scene) {
    params::ReleaseSpec& spec = scene.spec.releases[index];
    if (spec.name.empty()) spec.name = fmt::format("release {}", index + 1);
    const std::string label = fmt::format("release \"{}\"", spec.name);
    const std::string path = fmt::format("release[{}].", index);
    const auto refused = [&](const std::string& key, const Error& error) {
        return Error{parsed.at(path + key) + ": " + error.message};
    };

    terrain::Release release;
    release.name = spec.name;
    release.spec = spec;
    if (!spec.file.empty()) {
        const Result<geo::PolygonLayer> layer = load_polygons(label, spec.file, spec.layer, scene);
        if (!layer) return refused("file", layer.error());
        for (std::size_t feature = 0; feature < layer->features.size(); ++feature) {
            const Result<double> thickness = feature_thickness(spec, *layer, feature);
            if (!thickness) return refused("thickness_attribute", thickness.error());
            for (const Polygon& part : layer->features[feature].parts) release.patches.push_back({part, *thickness});
        }
    }
    if (!spec.thickness_raster.empty()) {
        Result<geo::Raster> raster = read_value_raster(spec.thickness_raster, scene.crs);
        if (!raster) return refused("thickness_raster", raster.error());
        record_input(label + " thickness", spec.thickness_raster, scene);
        if (raster->crs_assumed) {
            scene.notes.push_back(fmt::format("{}: {} states no coordinate reference system, taken as the terrain's",
                                              label, spec.thickness_raster));
        }
        release.thickness_raster = std::move(raster->grid);
        if (spec.file.empty()) {
            const auto outlines = geo::outlines_above_zero(*release.thickness_raster);
            if (!outlines) return refused("thickness_raster", outlines.error());
            for (const Polygon& outline : *outlines) release.patches.push_back({outline, 0});
        }
    }
    if (!spec.pore_pressure_hydrograph.empty()) {
        Result<std::vector<params::PressureSample>> rows = read_pressure_hydrograph(spec.pore_pressure_hydrograph);
        if (!rows) return refused("pore_pressure_hydrograph", rows.error());
        record_input(label + " pore pressure", spec.pore_pressure_hydrograph, scene);
        release.water = std::move(*rows);
    }
    const char* const moved = spec.shift_along != 0 ? "shift_along_m" : "shift_across_m";
    const Result<PlanPoint> by = shift(spec, label, release, scene);
    if (!by) return refused(moved, by.error());
    const bool as_drawn = by->x == 0 && by->y == 0;
    for (const terrain::ReleasePatch& patch : release.patches) {
        if (Status s = check_covered(patch.polygon, label, scene); !s) {
            return refused(!as_drawn ? moved : spec.file.empty() ? "thickness_raster" : "file", s.error());
        }
    }
    if (release.thickness_raster) {
        release.thickness_raster->geometry.x_min += by->x;
        release.thickness_raster->geometry.y_min += by->y;
        if (Status s = check_thickness_raster(spec, label, release, scene); !s) {
            return refused("thickness_raster", s.error());
        }
    }
    if (spec.volume) {
        if (Status s = spread_volume(spec, label, release, scene); !s) return refused("volume_m3", s.error());
    }
    release.volume = release_volume(scene.terrain, release);
    if (!(release.volume > 0)) return refused("file", Error{label + " has no volume; its polygons have no area"});
    if (release.thickness_raster) note_raster_volume(label, release, scene);
    return Result<terrain::Release>(std::move(release));
}

/// Debris must not be released twice from the same ground.
Status check_overlaps(const ParsedScene& parsed, const Scene& scene) {
    struct Item {
        std::size_t release, patch;
        Extent extent;
    };
    std::vector<Item> items;
    for (std::size_t r = 0; r < scene.releases.size(); ++r) {
        for (std::size_t p = 0; p < scene.releases[r].patches.size(); ++p) {
            items.push_back({r, p, extent_of(scene.releases[r].patches[p].polygon)});
        }
    }
    std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.extent.x_min < b.extent.x_min; });
    for (std::size_t i = 0; i < items.size(); ++i) {
        for (std::size_t k = i + 1; k < items.size() && items[k].extent.x_min < items[i].extent.x_max; ++k) {
            const Item &first = items[i], &second = items[k];
            const Polygon& a = scene.releases[first.release].patches[first.patch].polygon;
            const Polygon& b = scene.releases[second.release].patches[second.patch].polygon;
            const std::string shared = shared_ground(a, b);
            if (shared.empty()) continue;
            const std::size_t later = std::max(first.release, second.release);
            const std::size_t earlier = std::min(first.release, second.release);
            const std::string at = parsed.at(fmt::format("release[{}].file", later));
            if (later == earlier) {
                return Error{fmt::format("{}: polygons of release \"{}\" overlap {}, merge or trim them", at,
                                         scene.releases[later].name, shared)};
            }
            return Error{fmt::format("{}: releases \"{}\" and \"{}\" overlap {}, trim one of them", at,
                                     scene.releases[earlier].name, scene.releases[later].name, shared)};
        }
    }
    return {};
}

}  // namespace

Status load_releases(const ParsedScene& parsed, Scene& scene) {
    for (std::size_t i = 0; i < scene.spec.releases.size(); ++i) {
        TALUS_ASSIGN(terrain::Release release, load_release(parsed, i, scene));
        scene.releases.push_back(std::move(release));
    }
    return check_overlaps(parsed, scene);
}

}  // namespace talus::scene
