#pragma once

#include <optional>

#include "observe/observation.hpp"
#include "params/spec.hpp"
#include "sim/ground.hpp"
#include "terrain/flow_path.hpp"

namespace talus::observe {

/// In place of a path that was traced before the run: the line that debris followed, and what is measured along it.
///
/// The line has a point every three map cells along the flow (TrailDistances): the centroid of the covered ground
/// there, each cell counting by peak depth times peak speed. It runs from the crown to the toe; where the flow parted,
/// through the part that leads to the toe. The front is at a place of the line when debris first arrived in the map
/// cells around it, or around a place beyond it: no projection, so that a corner of the line cannot make the front
/// jump.
///
/// Sets followed_path, front, erosion and all front chainages of `observation`, whose maps and run-out are known.
/// `corridor_width` in m. Nothing changes where debris hardly left its release.
void follow_debris(const sim::Ground& ground, double corridor_width, const params::OutputSpec& outputs,
                   Observation& observation);

/// Moves a run's front, erosion and all front chainages to the path that the debris of another run of the scene
/// followed. Where its debris did not come to that path, it has no front there.
void measure_along(const terrain::FlowPath& path, const params::OutputSpec& outputs, Observation& observation);

}  // namespace talus::observe
