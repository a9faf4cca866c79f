#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "geo/vector.hpp"
#include "scene/scene.hpp"
#include "twin/setup.hpp"

namespace talus::twin {

/// A layer of the file `drawn_file` beside a scene file.
struct DrawnLayer {
    std::string name;
    std::vector<geo::Field> fields;
    std::vector<geo::OutputFeature> features;
};

/// A scene file that has what people changed in the page.
struct SceneCopy {
    std::string text;
    std::vector<DrawnLayer>
        layers;  ///< of `drawn_file`, in the terrain's reference system; none: there is no such file
    static constexpr const char* drawn_file = "drawn.gpkg";
};

/// A scene that loads as `file` with `overrides`, with the material, barriers, buildings, zones, gauges, observations,
/// triggers and alarms of a setup in place of its own: a run of it ends in the state that a restart of the setup ends
/// in. What has not been changed keeps its section and its file. Comments at the top name what it lacks: releases,
/// inflows and beds that were drawn or changed, and alarms of structures that are not there. Errors: as
/// scene::parse_scene.
[[nodiscard]] Result<SceneCopy> scene_copy(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                                           const Setup& setup, const scene::Scene& scene);

}  // namespace talus::twin
