#pragma once

#include <filesystem>
#include <string>

#include "ensemble/ensemble.hpp"
#include "ensemble/ensemble_products.hpp"

namespace talus::cli {

/// Results of an ensemble, for a terminal.
[[nodiscard]] std::string ensemble_text(const ensemble::EnsembleResult& result, const std::filesystem::path& folder);

/// The same as one JSON object in a line: {"event": "result", ...}.
[[nodiscard]] std::string ensemble_json(const ensemble::EnsembleResult& result, const std::filesystem::path& folder);

/// "12 of 64 runs, 1 failed, 8.2 runs per minute, about 6:20 left".
[[nodiscard]] std::string progress_text(const ensemble::EnsembleProgress& progress);

/// The same as one JSON object in a line: {"event": "progress", ...}.
[[nodiscard]] std::string progress_json(const ensemble::EnsembleProgress& progress);

}  // namespace talus::cli
