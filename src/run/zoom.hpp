#pragma once

#include "core/result.hpp"
#include "run/run_scene.hpp"
#include "run/zoom_record.hpp"
#include "scene/scene.hpp"

/// A zoom: the depth-averaged model runs the event, and what crosses the boundary of an area becomes inflow of
/// particles that are finer than those of the whole event could be. What leaves the area is not fed back.
namespace talus::run {

/// What the particles of a zoom run: the scene with the flow across the boundary in place of its releases and inflows,
/// on the ground of the area and its surroundings.
struct ZoomedScene {
    scene::Scene scene;
    ZoomRecord record;
};

/// Runs the depth-averaged model. The scene has a zoom. Errors: as run_scene(); no debris reaches the area; stopped.
[[nodiscard]] Result<ZoomedScene> zoom_in(const scene::Scene& scene, const RunOptions& options);

}  // namespace talus::run
