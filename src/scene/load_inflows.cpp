#include <cmath>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/vector.hpp"
#include "scene/hydrograph.hpp"
#include "scene/known_ground.hpp"
#include "scene/load.hpp"

namespace talus::scene {
namespace {

Status load_line(const params::InflowSpec& spec, const std::string& at, const std::string& label,
                 terrain::Inflow& inflow, Scene& scene) {
    std::vector<PlanPoint> line = spec.line;
    if (!spec.file.empty()) {
        auto layer = read_line(spec.file, spec.layer, scene.crs);
        if (!layer) return Error{at + ": " + layer.error().message};
        record_input(label, spec.file, scene);
        if (!layer->reprojection.empty()) scene.notes.push_back(label + ": " + layer->reprojection);
        line = std::move(layer->points);
    }
    if (line.size() != 2) {
        return Error{fmt::format("{}: has {} places; an inflow's line is straight, with exactly two", at, line.size())};
    }
    inflow.from = line[0];
    inflow.to = line[1];
    return check_line(inflow, scene.terrain, at);
}

Status load_area(const params::InflowSpec& spec, const std::string& at, const std::string& label,
                 terrain::Inflow& inflow, Scene& scene) {
    if (!spec.polygon.empty()) {
        if (spec.polygon.size() < 3) {
            return Error{fmt::format("{}: has {} corners; an area needs three or more", at, spec.polygon.size())};
        }
        inflow.area.push_back({spec.polygon, {}});
    } else {
        const Result<geo::PolygonLayer> layer = load_polygons(label, spec.polygon_file, spec.layer, scene);
        if (!layer) return Error{at + ": " + layer.error().message};
        for (const geo::PolygonFeature& feature : layer->features) {
            inflow.area.insert(inflow.area.end(), feature.parts.begin(), feature.parts.end());
        }
    }
    for (const Polygon& part : inflow.area) TALUS_TRY(check_area(scene.terrain, part, at, true));
    return {};
}

std::string where_from(const terrain::Inflow& inflow, const terrain::Terrain& terrain) {
    if (inflow.over_area()) {
        double area = 0;
        for (const Polygon& part : inflow.area) area += plan_area(part);
        return fmt::format(
            "over {:.4g} m2, {}", area,
            inflow.spec.direction ? fmt::format("towards {:.4g} degrees", *inflow.spec.direction) : "down the slope");
    }
    const double width = std::hypot(inflow.to.x - inflow.from.x, inflow.to.y - inflow.from.y);
    const PlanPoint middle{(inflow.from.x + inflow.to.x) / 2, (inflow.from.y + inflow.to.y) / 2};
    const double cell = terrain.cell();
    const PlanPoint ahead{middle.x + (inflow.to.y - inflow.from.y) / width * cell,
                          middle.y - (inflow.to.x - inflow.from.x) / width * cell};
    const double rise = (terrain.elevation_at(ahead) - terrain.elevation_at(middle)) / cell;
    return fmt::format("across {:.4g} m, where the ground {} by {:.2g} in its direction{}", width,
                       rise > 0 ? "rises" : "falls", std::abs(rise),
                       rise > 0.05 ? "; turn the line if it should come from the other side" : "");
}

Result<terrain::Inflow> load_inflow(const ParsedScene& parsed, std::size_t index, Scene& scene) {
    const params::InflowSpec& spec = scene.spec.inflows[index];
    const std::string path = fmt::format("inflow[{}].", index);
    terrain::Inflow inflow;
    inflow.name = spec.name.empty() ? fmt::format("inflow {}", index + 1) : spec.name;
    const std::string label = fmt::format("inflow \"{}\"", inflow.name);
    inflow.spec = spec;
    const std::string at = parsed.at(path + (!spec.line.empty()      ? "line_m"
                                             : !spec.file.empty()    ? "file"
                                             : !spec.polygon.empty() ? "polygon_m"
                                                                     : "polygon_file"));
    TALUS_TRY(spec.over_area() ? load_area(spec, at, label, inflow, scene) : load_line(spec, at, label, inflow, scene));
    const std::string at_hydrograph = parsed.at(path + "hydrograph");
    Result<std::vector<params::InflowSample>> rows = read_hydrograph(spec);
    if (!rows) return Error{at_hydrograph + ": " + rows.error().message};
    record_input(label + " hydrograph", spec.hydrograph, scene);
    inflow.hydrograph = std::move(*rows);
    TALUS_TRY(check_hydrograph(inflow, scene.spec.solver, at_hydrograph));
    scene.notes.push_back(fmt::format("{}: {:.6g} m3 {}", label, inflow.volume(), where_from(inflow, scene.terrain)));
    return Result<terrain::Inflow>(std::move(inflow));
}

}  // namespace

Status load_inflows(const ParsedScene& parsed, Scene& scene) {
    for (std::size_t index = 0; index < scene.spec.inflows.size(); ++index) {
        TALUS_ASSIGN(terrain::Inflow inflow, load_inflow(parsed, index, scene));
        scene.inflows.push_back(std::move(inflow));
    }
    return {};
}

}  // namespace talus::scene
