#pragma once

#include <string>
#include <string_view>

#include "core/result.hpp"
#include "run/run.hpp"
#include "scene/scene.hpp"

/// The state of a run between two steps, from which another run of the same scene goes on to the same result, to the
/// bit. Particles on the processor only.
namespace talus::run {

/// Why runs of this scene have no state to save or to start from; success: they have.
[[nodiscard]] Status check_state_can_be_saved(const scene::Scene& scene);

/// The same of a run that has started: only the processor's states are saved.
[[nodiscard]] Status check_run_can_be_saved(const Run& run);

/// A line that says of what the state is, and the bytes of the run. Errors: the run is at fault, or on a device.
[[nodiscard]] Result<std::string> save_state(const scene::Scene& scene, Run& run);

/// Gives a run that has just started that state. Errors: the first thing that is different in what the state is of:
/// version of the program, particle spacing, terrain, a value of the scene, an input file. What has no influence on the
/// debris may be different, and so may solver.end_time, which continues a run.
[[nodiscard]] Status restore_state(const scene::Scene& scene, Run& run, std::string_view state);

}  // namespace talus::run
