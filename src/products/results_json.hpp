#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "run/comparison.hpp"

/// Parts of a result as the manifest and `talus run --json` both give them. A value that does not exist is null.
namespace talus::products {

/// Every key of run_out_numbers, the front, and "run_out_at_least".
[[nodiscard]] nlohmann::ordered_json run_out_json(const observe::Observation& observation);

/// Worst compression, its time, its limits, and whether the run stayed within them.
[[nodiscard]] nlohmann::ordered_json compression_json(const observe::Observation& observation);

/// An object with the keys "convergence" and "sensitivity", where present: verdict, quantities, and every variant with
/// its values, changes and cost.
[[nodiscard]] nlohmann::ordered_json comparisons_json(const std::vector<run::Comparison>& comparisons);

/// Structures that were hit, with their peaks, and every barrier. A value that does not exist is null.
[[nodiscard]] nlohmann::ordered_json structures_json(const observe::Observation& observation);

/// What passed every cross-section.
[[nodiscard]] nlohmann::ordered_json cross_sections_json(const observe::Observation& observation);

/// The content of a report, as the file results.json (docs/results.md). Errors name the file and the cause.
[[nodiscard]] Status write_results(const nlohmann::ordered_json& results, const std::filesystem::path& file);

}  // namespace talus::products
