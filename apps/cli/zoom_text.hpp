#pragma once

#include <atomic>
#include <string>

#include "core/result.hpp"
#include "run/zoom_record.hpp"
#include "scene/scene.hpp"

/// What a zoom is and what it costs, in words.
namespace talus::cli {

/// "42 x 41 m around House 38, cells of 2.5 m: 161 m3 of 600 m3 come in from 29.8 s on, ...".
[[nodiscard]] std::string zoom_text(const run::ZoomRecord& zoom);

/// For `scene check`: runs the depth-averaged model, and a few particles to see how fast this machine is. Errors: as
/// run::zoom_in().
[[nodiscard]] Result<std::string> zoom_cost_text(const scene::Scene& scene, const std::atomic<bool>& stop_requested);

}  // namespace talus::cli
