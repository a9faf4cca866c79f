#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/mesh.hpp"
#include "geo/vector.hpp"
#include "scene/attributes.hpp"
#include "scene/known_ground.hpp"
#include "scene/load.hpp"
#include "scene/polygons.hpp"
#include "scene/warning.hpp"

namespace talus::scene {
namespace {

/// Maximum height of any building, m.
double highest_building() {
    return params::parameter_of("buildings", "default_height_m").range.high;
}

/// Whether any part of the footprint stands on known ground.
bool on_terrain(const geo::PolygonFeature& feature, const terrain::Terrain& terrain) {
    return std::any_of(feature.parts.begin(), feature.parts.end(),
                       [&](const Polygon& part) { return known_ground(part, terrain).any; });
}

bool any_has(const geo::PolygonLayer& layer, const std::string& attribute) {
    for (const geo::PolygonFeature& feature : layer.features) {
        if (feature.attributes.count(attribute) > 0) return true;
    }
    return false;
}

Status check_attribute(const ParsedScene& parsed, const std::string& key, const std::string& attribute,
                       const geo::PolygonLayer& layer) {
    if (attribute.empty() || any_has(layer, attribute)) return {};
    std::string names;
    for (const auto& [name, value] : layer.features.front().attributes) names += (names.empty() ? "" : ", ") + name;
    return Error{fmt::format("{} = \"{}\": {} has no such attribute; its attributes: {}", parsed.at(key), attribute,
                             parsed.spec.buildings.file, names.empty() ? "none" : names)};
}

geo::Attribute value_of(const geo::PolygonFeature& feature, const std::string& attribute) {
    const auto found = feature.attributes.find(attribute);
    return found == feature.attributes.end() ? geo::Attribute() : found->second;
}

/// The pressure that a building withstands: its own, that of all, or none. `who`: "feature 3".
Status read_resistance(const ParsedScene& parsed, const std::string& who, const geo::Attribute& own,
                       terrain::Building& building) {
    const params::BuildingsSpec& spec = parsed.spec.buildings;
    if (spec.resistance) building.resistance.pressure = *spec.resistance;
    const Result<std::optional<double>> pressure = number_of(own, Dimension::pressure);
    if (!pressure) {
        return Error{fmt::format("{}: {}: {} has {} = {}, where {}", parsed.at("buildings.resistance_attribute"),
                                 spec.file, who, spec.resistance_attribute, attribute_text(own),
                                 pressure.error().message)};
    }
    if (pressure->value_or(0) > 0) building.resistance.pressure = **pressure;
    return {};
}

/// Buildings whose height is assumed.
struct AssumedHeights {
    std::size_t count = 0;
    std::size_t not_understood = 0;  ///< of these
    std::string first;               ///< of those not understood: feature, value and reason
};

void note_assumed(const AssumedHeights& assumed, Scene& scene) {
    const params::BuildingsSpec& spec = scene.spec.buildings;
    if (assumed.count == 0) return;
    scene.notes.push_back(fmt::format("buildings: the height of {} of {} is assumed to be {:.6g} m", assumed.count,
                                      scene.buildings.size(), spec.height));
    if (assumed.not_understood == 0) return;
    scene.notes.push_back(fmt::format("buildings: {}: {} of these have a {} that is no height, the first of them {}",
                                      spec.file, assumed.not_understood, spec.height_attribute, assumed.first));
}

std::string name_of(const geo::PolygonFeature& feature, const std::string& attribute, std::size_t number) {
    const auto found = feature.attributes.find(attribute);
    if (found != feature.attributes.end()) {
        if (const auto* text = std::get_if<std::string>(&found->second); text && !text->empty()) return *text;
        if (const auto* value = std::get_if<double>(&found->second)) return fmt::format("{}", *value);
    }
    return fmt::format("building {}", number);
}

/// A building whose ground fails is no obstacle: it moves with the debris.
void leave_out_buildings_on_releases(Scene& scene) {
    std::erase_if(scene.buildings, [&](const terrain::Building& building) {
        for (const terrain::Release& release : scene.releases) {
            const double area = shared_area(release, building);
            if (area <= 0) continue;
            scene.notes.push_back(as_warning(
                fmt::format("building \"{}\" stands on release \"{}\" with {:.3g} m2 and was left out: the ground "
                            "under it fails, and no damage to it is computed",
                            building.name, release.name, area)));
            return true;
        }
        return false;
    });
}

std::string attribute_of(const geo::MeshBuilding& mesh, const std::string& name) {
    const auto found = mesh.attributes.find(name);
    return found == mesh.attributes.end() ? "" : found->second;
}

Status check_mesh_keys(const ParsedScene& parsed) {
    const params::BuildingsSpec& spec = parsed.spec.buildings;
    for (const auto& [key, given] :
         {std::pair{"layer", !spec.layer.empty()}, std::pair{"height_attribute", !spec.height_attribute.empty()}}) {
        if (!given) continue;
        return Error{
            fmt::format("{}: is refused with the mesh {}, which has its own heights and no layers; leave it out",
                        parsed.at(std::string("buildings.") + key), spec.file)};
    }
    return {};
}

/// Every roof face becomes a part of the footprint with a roof of its own.
Status load_mesh_buildings(const ParsedScene& parsed, Scene& scene, std::size_t& outside) {
    const params::BuildingsSpec& spec = scene.spec.buildings;
    TALUS_TRY(check_mesh_keys(parsed));
    std::vector<std::string> more_files;
    const auto meshes = read_mesh_buildings(spec.file, scene.crs, more_files);
    if (!meshes) return Error{parsed.at("buildings.file") + ": " + meshes.error().message};
    record_input("buildings", spec.file, scene);
    for (const std::string& file : more_files) record_input("buildings", file, scene);
    std::size_t sunk = 0;
    for (const geo::MeshBuilding& mesh : *meshes) {
        geo::PolygonFeature plan;
        terrain::Building building;
        static_cast<params::BuildingSpec&>(building) = spec;
        building.height = 0;  // relative to the ground, until that is known
        double highest = -std::numeric_limits<double>::infinity();
        for (const geo::RoofFace& roof : mesh.roofs) {
            plan.parts.push_back(roof.outline);
            building.part_roof_elevations.push_back(roof.elevation);
            highest = std::max(highest, roof.elevation);
        }
        if (!on_terrain(plan, scene.terrain)) {
            ++outside;
            continue;
        }
        building.footprint = std::move(plan.parts);
        std::vector<terrain::Building> placed{building};
        place_buildings(scene.terrain, placed);  // with no height: the mean ground below it
        building.roof_elevation = highest;
        building.height = highest - placed.front().roof_elevation;
        if (!(building.height > 0)) {
            ++sunk;
            continue;
        }
        if (building.height > highest_building()) {
            return Error{
                fmt::format("{}: {}: \"{}\" is {:.6g} m higher than its ground; it must be at most {:.0f} m; are its "
                            "elevations those of the terrain?",
                            parsed.at("buildings.file"), spec.file, mesh.name, building.height, highest_building())};
        }
        const std::string name = attribute_of(mesh, spec.name_attribute);
        building.name = name.empty() ? mesh.name : name;
        TALUS_TRY(read_resistance(parsed, fmt::format("\"{}\"", one_line(mesh.name, 80)),
                                  attribute_of(mesh, spec.resistance_attribute), building));
        scene.buildings.push_back(std::move(building));
    }
    if (sunk > 0) {
        scene.notes.push_back(fmt::format("buildings: {} of {} have their roofs below the ground and were left out",
                                          sunk, meshes->size()));
    }
    scene.notes.push_back(
        fmt::format("buildings: {} read from a mesh; every roof face is taken to be level at its mean elevation",
                    scene.buildings.size()));
    return {};
}

Status load_footprints(const ParsedScene& parsed, Scene& scene, std::size_t& outside) {
    const params::BuildingsSpec& spec = scene.spec.buildings;
    const Result<geo::PolygonLayer> layer = load_polygons("buildings", spec.file, spec.layer, scene);
    if (!layer) return Error{parsed.at("buildings.file") + ": " + layer.error().message};
    TALUS_TRY(check_attribute(parsed, "buildings.height_attribute", spec.height_attribute, *layer));
    TALUS_TRY(check_attribute(parsed, "buildings.name_attribute", spec.name_attribute, *layer));
    TALUS_TRY(check_attribute(parsed, "buildings.resistance_attribute", spec.resistance_attribute, *layer));
    AssumedHeights assumed;
    for (std::size_t i = 0; i < layer->features.size(); ++i) {
        const geo::PolygonFeature& feature = layer->features[i];
        if (!on_terrain(feature, scene.terrain)) {
            ++outside;
            continue;
        }
        terrain::Building building;
        building.name = name_of(feature, spec.name_attribute, i + 1);
        building.footprint = feature.parts;
        static_cast<params::BuildingSpec&>(building) = spec;
        const std::string who = fmt::format("feature {}", i + 1);
        TALUS_TRY(read_resistance(parsed, who, value_of(feature, spec.resistance_attribute), building));
        const geo::Attribute written = value_of(feature, spec.height_attribute);
        const Result<std::optional<double>> read = number_of(written, Dimension::length);
        const double height = read ? read->value_or(0) : 0;
        if (!(height > 0)) {
            building.height_assumed = true;
            ++assumed.count;
            if (!read && assumed.not_understood++ == 0) {
                assumed.first = fmt::format("{}, {}: {}", who, attribute_text(written), read.error().message);
            }
        } else if (height > highest_building()) {
            return Error{fmt::format("{}: {}: {} (\"{}\") has {} = {}; it must be a height of at most {:.0f} (m)",
                                     parsed.at("buildings.height_attribute"), spec.file, who, building.name,
                                     spec.height_attribute, attribute_text(written), highest_building())};
        } else {
            building.height = height;
        }
        scene.buildings.push_back(std::move(building));
    }
    note_assumed(assumed, scene);
    if (layer->encoding_assumed) {
        scene.notes.push_back(
            fmt::format("buildings: {} holds text that is not UTF-8, read as Windows-1252; a .cpg file beside it, with "
                        "the name of the encoding, says otherwise",
                        spec.file));
    }
    place_buildings(scene.terrain, scene.buildings);
    return {};
}

}  // namespace

double shared_area(const terrain::Release& release, const terrain::Building& building) {
    double area = 0;
    for (const terrain::ReleasePatch& patch : release.patches) {
        for (const Polygon& part : building.footprint) {
            const Overlap overlap = overlap_of(patch.polygon, part);
            if (is_true_overlap(overlap, patch.polygon, part)) area += overlap.area;
        }
    }
    return area;
}

Status load_buildings(const ParsedScene& parsed, Scene& scene) {
    const params::BuildingsSpec& spec = scene.spec.buildings;
    if (spec.file.empty()) return {};
    std::size_t outside = 0;
    Status loaded = geo::is_mesh_file(spec.file) ? load_mesh_buildings(parsed, scene, outside)
                                                 : load_footprints(parsed, scene, outside);
    if (!loaded) return loaded;
    if (scene.buildings.empty() && outside == 0) {
        return Error{fmt::format(
            "{}: {}: holds no building with its roof above the ground; leave out [buildings] or use another file",
            parsed.at("buildings.file"), spec.file)};
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
                                          outside + scene.buildings.size()));
    }
    leave_out_buildings_on_releases(scene);
    return {};
}

}  // namespace talus::scene
