#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/decimals.hpp"
#include "geo/vector.hpp"
#include "scene/load.hpp"
#include "scene/polygons.hpp"

namespace talus::scene {
namespace {

double distance(const PlanPoint& a, const PlanPoint& b) {
    return std::hypot(b.x - a.x, b.y - a.y);
}

/// Removes points that repeat the previous one.
std::vector<PlanPoint> distinct(const std::vector<PlanPoint>& points) {
    std::vector<PlanPoint> out;
    for (const PlanPoint& p : points) {
        if (out.empty() || distance(out.back(), p) > 1e-3) out.push_back(p);
    }
    return out;
}

/// From `p` to the nearest point of the line.
double distance_to_line(const PlanPoint& p, const std::vector<PlanPoint>& line) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const PlanPoint &a = line[i], &b = line[i + 1];
        const double dx = b.x - a.x, dy = b.y - a.y;
        const double t = std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
        nearest = std::min(nearest, distance(p, {a.x + t * dx, a.y + t * dy}));
    }
    return nearest;
}

void note_far_releases(Scene& scene, const std::vector<PlanPoint>& line) {
    const double allowed = scene.spec.flow_path.corridor_width / 2;
    for (const terrain::Release& release : scene.releases) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const terrain::ReleasePatch& patch : release.patches) {
            for_each_inside(patch.polygon, scene.terrain.cell(),
                            [&](const PlanPoint& p) { nearest = std::min(nearest, distance_to_line(p, line)); });
        }
        if (nearest > allowed) {
            scene.notes.push_back(
                fmt::format("flow path: release \"{}\" lies {:.0f} m from it, outside the corridor of "
                            "{:.6g} m: its debris counts as front only once it gets there",
                            release.name, nearest, scene.spec.flow_path.corridor_width));
        }
    }
}

/// Highest and lowest ground of the source area.
struct ReleaseRelief {
    PlanPoint crown, lowest;
};

ReleaseRelief relief_of(const std::vector<Polygon>& parts, const terrain::Terrain& terrain) {
    ReleaseRelief relief;
    double highest = -std::numeric_limits<double>::infinity(), lowest = -highest;
    Extent extent = extent_of(parts.front());
    for (const Polygon& part : parts) {
        const Extent own = extent_of(part);
        extent.include({own.x_min, own.y_min});
        extent.include({own.x_max, own.y_max});
    }
    const double step = std::min(terrain.cell() / 2, std::max(extent.width(), extent.height()) / 50);
    for (const Polygon& part : parts) {
        for_each_inside(part, step, [&](const PlanPoint& p) {
            const double z = terrain.elevation_at(p);
            if (z > highest) {
                highest = z;
                relief.crown = p;
            }
            if (z < lowest) {
                lowest = z;
                relief.lowest = p;
            }
        });
    }
    return relief;
}

/// The source from which the path is traced, and its start.
struct Source {
    std::string label;
    PlanPoint crown, lowest;
};

Source largest_source(const Scene& scene) {
    if (scene.releases.empty()) {
        const terrain::Inflow& inflow = *std::max_element(
            scene.inflows.begin(), scene.inflows.end(),
            [](const terrain::Inflow& a, const terrain::Inflow& b) { return a.volume() < b.volume(); });
        if (inflow.over_area()) {
            const ReleaseRelief relief = relief_of(inflow.area, scene.terrain);
            return {"inflow \"" + inflow.name + "\"", relief.crown, relief.lowest};
        }
        const PlanPoint middle{(inflow.from.x + inflow.to.x) / 2, (inflow.from.y + inflow.to.y) / 2};
        return {"inflow \"" + inflow.name + "\"", middle, middle};
    }
    const terrain::Release& largest =
        *std::max_element(scene.releases.begin(), scene.releases.end(),
                          [](const terrain::Release& a, const terrain::Release& b) { return a.volume < b.volume; });
    std::vector<Polygon> parts;
    for (const terrain::ReleasePatch& patch : largest.patches) parts.push_back(patch.polygon);
    const ReleaseRelief relief = relief_of(parts, scene.terrain);
    return {"release \"" + largest.name + "\"", relief.crown, relief.lowest};
}

Status trace_from_release(const ParsedScene& parsed, Scene& scene) {
    const Source relief = largest_source(scene);
    const Extent extent = scene.terrain.elevation().geometry.extent();
    const double longest = 2 * std::hypot(extent.width(), extent.height());
    const Result<std::vector<PlanPoint>> traced =
        terrain::trace_flow_path(scene.terrain.elevation(), relief.lowest, longest);
    if (!traced) return Error{parsed.file.string() + ": " + traced.error().message};
    // Chainage starts at the crown: it starts with a straight line through the release.
    std::vector<PlanPoint> points{relief.crown, relief.lowest};
    points.insert(points.end(), traced->begin(), traced->end());
    points = distinct(points);
    if (points.size() < 2) {
        scene.notes.emplace_back("flow path: no way downhill leads from the release, there is no chainage; draw one");
        return {};
    }
    scene.flow_path = terrain::FlowPath(points, scene.spec.flow_path.corridor_width);
    scene.notes.push_back(fmt::format("flow path: traced downhill from {}, {:.{}f} m from its crown at {} to {}",
                                      relief.label, scene.flow_path.length(), decimals_for(scene.flow_path.length(), 0),
                                      place_text(points.front()), place_text(points.back())));
    note_far_releases(scene, points);
    return {};
}

}  // namespace

Status load_flow_path(const ParsedScene& parsed, Scene& scene) {
    const params::FlowPathSpec& spec = scene.spec.flow_path;
    if (spec.file.empty()) {
        scene.flow_path_origin = PathOrigin::traced;
        return trace_from_release(parsed, scene);
    }
    const Result<geo::SingleLine> layer = read_line(spec.file, spec.layer, scene.crs);
    if (!layer) return Error{parsed.at("flow_path.file") + ": " + layer.error().message};
    record_input("flow path", spec.file, scene);
    if (!layer->reprojection.empty()) scene.notes.push_back("flow path: " + layer->reprojection);
    std::vector<PlanPoint> points = distinct(layer->points);
    if (points.size() < 2) {
        return Error{fmt::format("{}: {}: the line has no length; draw it from the crown downstream",
                                 parsed.at("flow_path.file"), spec.file)};
    }
    const double first = scene.terrain.elevation_at(points.front()), last = scene.terrain.elevation_at(points.back());
    if (last > first) {
        std::reverse(points.begin(), points.end());
        scene.notes.push_back(
            fmt::format("flow path: it was drawn upstream ({:.1f} m to {:.1f} m) and has been turned", first, last));
    }
    const auto outside = std::count_if(points.begin(), points.end(),
                                       [&](const PlanPoint& p) { return std::isnan(scene.terrain.elevation_at(p)); });
    if (outside == static_cast<std::ptrdiff_t>(points.size())) {
        return Error{fmt::format("{}: {}: the line lies outside the terrain, {} ({})", parsed.at("flow_path.file"),
                                 spec.file, extent_text(covered_extent(scene.terrain)), scene.crs.label())};
    }
    if (outside > 0) {
        scene.notes.push_back(
            fmt::format("flow path: {} of its {} points lie outside the terrain", outside, points.size()));
    }
    scene.flow_path = terrain::FlowPath(points, spec.corridor_width);
    note_far_releases(scene, points);
    return {};
}

}  // namespace talus::scene
