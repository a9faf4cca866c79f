#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "run/comparison.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"

namespace talus::cli {

/// The main results in a dozen lines, and a table per comparison.
[[nodiscard]] std::string summary_text(const scene::Scene& scene, const run::RunResult& result,
                                       const std::vector<run::Comparison>& comparisons,
                                       const std::filesystem::path& output);

/// The same for programs: the last line of `talus run --json`.
[[nodiscard]] std::string summary_json(const scene::Scene& scene, const run::RunResult& result,
                                       const std::vector<run::Comparison>& comparisons,
                                       const std::filesystem::path& output);

}  // namespace talus::cli
