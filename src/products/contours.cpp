#include "geo/contours.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/hazard_maps.hpp"
#include "core/try.hpp"
#include "geo/vector.hpp"
#include "params/contours.hpp"
#include "products/writers.hpp"
#include "report/hazard_map.hpp"
#include "report/vector_style.hpp"

namespace talus::products {
namespace {

/// A map as its file has it, and what it is called.
struct ContourMap {
    std::string title, unit;
    Grid<float> values;
};

ContourMap contour_map(const std::string& name, const scene::Scene& scene, const observe::Observation& observation) {
    if (name == "peak_thickness") {
        const report::HazardMap& map = report::thickness_map();
        return {map.title, map.unit,
                report::in_unit(observe::normal_to_slope(observation.maps.peak_depth, scene.terrain), map.factor)};
    }
    if (name == "erosion_depth") {
        const report::HazardMap& map = report::erosion_map();
        return {map.title, map.unit, report::in_unit(observation.erosion.depth, map.factor)};
    }
    for (const report::HazardMap& map : report::hazard_maps()) {
        if (map.file == name) return {map.title, map.unit, report::in_unit(observation.maps.*map.grid, map.factor)};
    }
    return {};
}

}  // namespace

Status write_contours(const scene::Scene& scene, const run::RunResult& result, const std::string& file,
                      std::vector<WrittenLayer>& written) {
    TALUS_ASSIGN(const auto wanted, params::contours_of(scene.spec.outputs.contours));
    for (const params::MapContours& contours : wanted) {
        ContourMap map = contour_map(contours.map, scene, result.observation);
        // Without debris there is none of it: lines close around what it reached. When debris came has no such value.
        const NamedMap* named = find_map(contours.map);
        if (named == nullptr || named->kind != MapKind::arrival) {
            for (float& value : map.values.values) value = std::isnan(value) ? 0 : value;
        }
        std::vector<geo::OutputFeature> features;
        for (geo::Contour& line : geo::contours(map.values, contours.values)) {
            features.push_back({{}, std::move(line.points), {contours.map, line.elevation, map.unit}});
        }
        const std::string layer = "contours_" + contours.map;
        TALUS_TRY(write_geopackage_layer(file, layer, {{"map", true}, {"value"}, {"unit", true}}, features, scene.crs));
        const report::VectorSymbol line{{}, {60, 60, 60}, 255, 0.3, report::VectorSymbol::Kind::line};
        written.push_back({layer, "Contours: " + map.title + ", " + map.unit, qgis_vector_style(line, "value")});
    }
    return {};
}

}  // namespace talus::products
