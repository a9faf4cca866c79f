#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/raster.hpp"
#include "geo/vector.hpp"
#include "scene/load.hpp"

namespace talus::scene {
namespace {

void note_observations(Scene& scene) {
    for (std::size_t i = 0; i < scene.spec.observations.size(); ++i) {
        const params::ObservationSpec& observation = scene.spec.observations[i];
        if (scene.flow_path.empty() || observation.chainage <= scene.flow_path.length()) continue;
        scene.notes.push_back(
            fmt::format("observation[{}]: chainage {:.6g} m lies beyond the flow path's end at {:.1f} m", i,
                        observation.chainage, scene.flow_path.length()));
    }
}

/// A list of observations at chainages; `section` as in the scene file.
template <class Spec>
Status check_chainages(const ParsedScene& parsed, const Scene& scene, const std::vector<Spec>& list,
                       const char* section) {
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (!scene.flow_path.empty() && list[i].chainage <= scene.flow_path.length()) continue;
        return Error{fmt::format("{} = {:.6g} lies beyond the flow path, which is {:.1f} m long",
                                 parsed.at(fmt::format("{}[{}].chainage_m", section, i)), list[i].chainage,
                                 scene.flow_path.length())};
    }
    return {};
}

/// A list of observations at places.
template <class Spec>
Status check_places(const ParsedScene& parsed, const Scene& scene, const std::vector<Spec>& list, const char* section) {
    for (std::size_t i = 0; i < list.size(); ++i) {
        const PlanPoint p{list[i].x, list[i].y};
        if (!std::isnan(scene.terrain.elevation_at(p))) continue;
        return Error{fmt::format("{}: {} is not on the terrain, {}", parsed.at(fmt::format("{}[{}].x_m", section, i)),
                                 place_text(p), extent_text(covered_extent(scene.terrain)))};
    }
    return {};
}

Status check_damages(const ParsedScene& parsed, const Scene& scene) {
    const std::vector<params::DamageSpec>& damages = scene.spec.damages;
    for (std::size_t i = 0; i < damages.size(); ++i) {
        std::vector<std::string> names;
        for (const terrain::Building& building : scene.buildings) names.push_back(building.name);
        if (std::find(names.begin(), names.end(), damages[i].building) != names.end()) continue;
        const std::string nearest = params::nearest_word(damages[i].building, names);
        return Error{fmt::format("{} = \"{}\" is no building of the scene; {}",
                                 parsed.at(fmt::format("damage[{}].building", i)), one_line(damages[i].building, 80),
                                 nearest.empty() ? "it has none" : "nearest name: " + nearest)};
    }
    return {};
}

Status check_observed(const ParsedScene& parsed, const Scene& scene) {
    const params::SceneSpec& spec = scene.spec;
    TALUS_TRY(check_chainages(parsed, scene, spec.superelevations, "superelevation"));
    TALUS_TRY(check_chainages(parsed, scene, spec.arrivals, "arrival"));
    TALUS_TRY(check_chainages(parsed, scene, spec.observed_run_outs, "observed_run_out"));
    TALUS_TRY(check_places(parsed, scene, spec.run_ups, "run_up"));
    TALUS_TRY(check_places(parsed, scene, spec.deposit_depths, "deposit_depth"));
    return check_damages(parsed, scene);
}

/// `what` in words: "deposit outline"; `section` as in the scene file.
Status load_outlines(const ParsedScene& parsed, const std::vector<params::OutlineSpec>& specs, const char* section,
                     const char* what, std::vector<std::vector<Polygon>>& outlines, Scene& scene) {
    for (std::size_t i = 0; i < specs.size(); ++i) {
        const std::string label = fmt::format("{} {}", what, i + 1);
        const Result<geo::PolygonLayer> layer = load_polygons(label, specs[i].file, specs[i].layer, scene);
        if (!layer) {
            return Error{parsed.at(fmt::format("{}[{}].file", section, i)) + ": " + layer.error().message};
        }
        std::vector<Polygon>& outline = outlines.emplace_back();
        for (const geo::PolygonFeature& feature : layer->features) {
            outline.insert(outline.end(), feature.parts.begin(), feature.parts.end());
        }
    }
    return {};
}

Status load_elevation_changes(const ParsedScene& parsed, Scene& scene) {
    for (std::size_t i = 0; i < scene.spec.elevation_changes.size(); ++i) {
        const params::ElevationChangeSpec& spec = scene.spec.elevation_changes[i];
        const std::string at = parsed.at(fmt::format("elevation_change[{}].file", i)) + ": ";
        Result<geo::Raster> change = read_value_raster(spec.file, scene.crs);
        if (!change) return Error{at + change.error().message};
        const std::vector<float>& values = change->grid.values;
        const bool any = std::any_of(values.begin(), values.end(), [&](float v) {
            return std::abs(v) >= spec.detection_limit && std::abs(v) > 0;  // NaN: neither
        });
        if (!any) {
            return Error{fmt::format("{}{}: holds no change of at least detection_limit_m = {:g}", at, spec.file,
                                     spec.detection_limit)};
        }
        record_input(fmt::format("elevation change {}", i + 1), spec.file, scene);
        scene.elevation_changes.push_back(std::move(change->grid));
    }
    return {};
}

}  // namespace

Status check_observed_places(const ParsedScene& parsed, const Scene& scene) {
    TALUS_TRY(check_chainages(parsed, scene, scene.spec.observations, "observation"));
    return check_observed(parsed, scene);
}

Status load_observations(const ParsedScene& parsed, Scene& scene) {
    note_observations(scene);
    const params::SceneSpec& spec = scene.spec;
    TALUS_TRY(check_observed(parsed, scene));
    TALUS_TRY(load_outlines(parsed, spec.deposit_outlines, "deposit_outline", "deposit outline", scene.deposit_outlines,
                            scene));
    TALUS_TRY(
        load_outlines(parsed, spec.affected_areas, "affected_area", "affected area", scene.affected_areas, scene));
    return load_elevation_changes(parsed, scene);
}

}  // namespace talus::scene
