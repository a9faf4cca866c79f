#pragma once

#include <filesystem>
#include <string>

#include "scene/run.hpp"
#include "scene/scene.hpp"

namespace talus {

/// "complete", "interrupted" or "fault".
[[nodiscard]] std::string status_name(RunStatus status);

/// What a person wants to know first, in a dozen lines.
[[nodiscard]] std::string summary_text(const Scene& scene, const RunResult& result,
                                       const std::filesystem::path& output);

/// The same for programs: the last line of `talus run --json`.
[[nodiscard]] std::string summary_json(const Scene& scene, const RunResult& result,
                                       const std::filesystem::path& output);

}  // namespace talus
