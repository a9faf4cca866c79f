#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "geo/vector.hpp"

namespace talus::twin {

class Scenario;

/// A layer of the file `drawn_file` beside a scene file.
struct DrawnLayer {
    std::string name;
    std::vector<geo::Field> fields;
    std::vector<geo::OutputFeature> features;
};

/// A text file beside a scene file.
struct DrawnTable {
    std::string name, text;
};

/// A scene file that has what people changed in the page.
struct SceneCopy {
    std::string text;
    /// Of `drawn_file`, in the terrain's reference system; none: there is no such file.
    std::vector<DrawnLayer> layers;
    std::vector<DrawnTable> tables;  ///< hydrographs
    static constexpr const char* drawn_file = "drawn.gpkg";
};

/// The work of making a scene that loads as `file`, a whole path, with `overrides`, with what the present setup has in
/// place of its own, notes aside; for any thread. A run of it ends in the state that a restart of the setup ends in, if
/// drawn releases are triggered at their start times. Comments at the top name what it lacks: releases without a start
/// time, triggers and alarms of what is not there. Errors: as scene::parse_scene; no debris.
[[nodiscard]] std::function<Result<SceneCopy>(const std::filesystem::path& file,
                                              const std::vector<std::string>& overrides)>
scene_copy_of(const Scenario& scenario);

}  // namespace talus::twin
