#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "twin/setup.hpp"

/// A setup in a journal: complete, except that entries unchanged from the scene are given by their index only.
namespace talus::twin {

/// As in a setup file and in GET /api/scenarios/{s}/setup.
[[nodiscard]] nlohmann::json note_json(const NoteSetup& note);

[[nodiscard]] nlohmann::json tables_json(const std::vector<TableSetup>& entries);

[[nodiscard]] nlohmann::json write_setup(const Setup& setup);

/// Errors name key and value.
[[nodiscard]] Result<Setup> read_setup(const nlohmann::json& file, const scene::Scene& scene);

}  // namespace talus::twin
