#pragma once

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "twin/setup.hpp"

/// A setup in a journal: complete, except that entries unchanged from the scene are given by their index only.
namespace talus::twin {

[[nodiscard]] nlohmann::json write_setup(const Setup& setup);

/// Errors name key and value.
[[nodiscard]] Result<Setup> read_setup(const nlohmann::json& file, const scene::Scene& scene);

}  // namespace talus::twin
