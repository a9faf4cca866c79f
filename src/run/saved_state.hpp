#pragma once

#include <string>
#include <string_view>

#include "core/archive.hpp"
#include "core/result.hpp"
#include "run/run.hpp"
#include "scene/scene.hpp"

/// The state of a run between two steps, from which another run of the same scene goes on to the same result, to the
/// bit. Of both models; particles on the processor only.
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

/// What both models have in common. `resolution`, m: the particle spacing, or the cell of the grid.
[[nodiscard]] std::string join_state(const scene::Scene& scene, double resolution, double time,
                                     const std::string& bytes);
/// The bytes of a state. Errors: as restore_state().
[[nodiscard]] Result<std::string_view> split_state(const scene::Scene& scene, double resolution,
                                                   std::string_view state);
/// Whether all of them were read, and made sense.
[[nodiscard]] Status check_whole(const ArchiveReader& archive);

}  // namespace talus::run
