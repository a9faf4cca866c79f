#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "scene/scene.hpp"
#include "twin/setup.hpp"

namespace talus::twin {

/// The text of a scene file that loads as `file` with `overrides`, with the gauges, observations, triggers and alarms
/// of a setup in place of its own. An alarm of a structure that the scene does not have is a comment: it was drawn in
/// the page. Errors: as scene::parse_scene.
[[nodiscard]] Result<std::string> scene_text_with(const std::filesystem::path& file,
                                                  const std::vector<std::string>& overrides, const Setup& setup,
                                                  const scene::Scene& scene);

}  // namespace talus::twin
