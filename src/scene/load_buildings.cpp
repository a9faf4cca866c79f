#include <cmath>

#include <fmt/format.h>

#include "geo/vector.hpp"
#include "scene/load.hpp"
#include "scene/polygons.hpp"

namespace talus {
namespace {

constexpr double highest = 1000;  // m, as buildings.default_height_m allows

/// Whether any part of the footprint stands on known ground.
bool on_terrain(const PolygonFeature& feature, const Terrain& terrain) {
    bool covered = false;
    const auto test = [&](const PlanPoint& p) { covered = covered || !std::isnan(terrain.elevation_at(p)); };
    for (const Polygon& part : feature.parts) {
        for_each_on_rings(part, terrain.cell() / 2, test);
        if (!covered) for_each_inside(part, terrain.cell() / 2, test);
        if (covered) return true;
    }
    return false;
}

bool any_has(const PolygonLayer& layer, const std::string& attribute) {
    for (const PolygonFeature& feature : layer.features) {
        if (feature.attributes.count(attribute) > 0) return true;
    }
    return false;
}

Status check_attribute(const ParsedScene& parsed, const std::string& key, const std::string& attribute,
                       const PolygonLayer& layer) {
    if (attribute.empty() || any_has(layer, attribute)) return {};
    std::string names;
    for (const auto& [name, value] : layer.features.front().attributes) names += (names.empty() ? "" : ", ") + name;
    return Error{fmt::format("{} = \"{}\": {} has no such attribute; its attributes: {}", parsed.at(key), attribute,
                             parsed.spec.buildings.file, names.empty() ? "none" : names)};
}

double height_of(const PolygonFeature& feature, const std::string& attribute) {
    const auto found = feature.attributes.find(attribute);
    if (found == feature.attributes.end()) return 0;
    if (const auto* number = std::get_if<double>(&found->second)) return *number;
    if (const auto* text = std::get_if<std::string>(&found->second)) return std::strtod(text->c_str(), nullptr);
    return 0;
}

std::string name_of(const PolygonFeature& feature, const std::string& attribute, std::size_t number) {
    const auto found = feature.attributes.find(attribute);
    if (found != feature.attributes.end()) {
        if (const auto* text = std::get_if<std::string>(&found->second); text && !text->empty()) return *text;
        if (const auto* value = std::get_if<double>(&found->second)) return fmt::format("{}", *value);
    }
    return fmt::format("building {}", number);
}

/// Plan area of a building on a release, m2; touching outlines count nothing.
double shared_area(const Release& release, const Building& building) {
    double area = 0;
    for (const ReleasePatch& patch : release.patches) {
        for (const Polygon& part : building.footprint) {
            const Overlap overlap = overlap_of(patch.polygon, part);
            if (is_true_overlap(overlap, patch.polygon, part)) area += overlap.area;
        }
    }
    return area;
}

/// A building whose ground fails is no obstacle to the debris: it goes with it.
void leave_out_buildings_on_releases(Scene& scene) {
    std::erase_if(scene.buildings, [&](const Building& building) {
        for (const Release& release : scene.releases) {
            const double area = shared_area(release, building);
            if (area <= 0) continue;
            scene.notes.push_back(
                fmt::format("building \"{}\" stands on release \"{}\" with {:.3g} m2 and was left out: "
                            "the ground under it fails",
                            building.name, release.name, area));
            return true;
        }
        return false;
    });
}

}  // namespace

Status load_buildings(const ParsedScene& parsed, Scene& scene) {
    const BuildingsSpec& spec = scene.spec.buildings;
    if (spec.file.empty()) return {};
    const Result<PolygonLayer> layer = read_polygons(spec.file, spec.layer, scene.crs);
    if (!layer) return Error{parsed.at("buildings.file") + ": " + layer.error().message};
    record_input("buildings", spec.file, scene);
    if (!layer->reprojection.empty()) scene.notes.push_back("buildings: " + layer->reprojection);
    if (Status s = check_attribute(parsed, "buildings.height_attribute", spec.height_attribute, *layer); !s) return s;
    if (Status s = check_attribute(parsed, "buildings.name_attribute", spec.name_attribute, *layer); !s) return s;

    std::size_t outside = 0, assumed = 0;
    for (std::size_t i = 0; i < layer->features.size(); ++i) {
        const PolygonFeature& feature = layer->features[i];
        if (!on_terrain(feature, scene.terrain)) {
            ++outside;
            continue;
        }
        Building building;
        building.name = name_of(feature, spec.name_attribute, i + 1);
        building.footprint = feature.parts;
        building.height = height_of(feature, spec.height_attribute);
        if (!(building.height > 0)) {
            building.height = spec.default_height;
            building.height_assumed = true;
            ++assumed;
        } else if (building.height > highest) {
            return Error{
                fmt::format("{}: {}: feature {} (\"{}\") has {} = {:.6g}; it must be a height of at most {:.0f} (m)",
                            parsed.at("buildings.height_attribute"), spec.file, i + 1, building.name,
                            spec.height_attribute, building.height, highest)};
        }
        scene.buildings.push_back(std::move(building));
    }
    if (scene.buildings.empty()) {
        return Error{
            fmt::format("{}: {}: all {} buildings lie outside the terrain, {} ({}); leave out [buildings] or use "
                        "another file",
                        parsed.at("buildings.file"), spec.file, outside, extent_text(covered_extent(scene.terrain)),
                        scene.crs.label())};
    }
    if (outside > 0) {
        scene.notes.push_back(fmt::format("buildings: {} of {} lie outside the terrain and were left out", outside,
                                          layer->features.size()));
    }
    if (assumed > 0) {
        scene.notes.push_back(fmt::format("buildings: the height of {} of {} is assumed to be {:.6g} m", assumed,
                                          scene.buildings.size(), spec.default_height));
    }
    place_buildings(scene.terrain, scene.buildings);
    leave_out_buildings_on_releases(scene);
    return {};
}

}  // namespace talus
