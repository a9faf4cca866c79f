#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"
#include "params/spec.hpp"

namespace talus::scene {

/// Reads a CSV file given as release.pore_pressure_hydrograph, by time. Errors name file, line, column and what is
/// allowed.
[[nodiscard]] Result<std::vector<params::PressureSample>> read_pressure_hydrograph(const std::string& file);

}  // namespace talus::scene
