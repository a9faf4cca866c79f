#pragma once

#include <nlohmann/json.hpp>

#include "observe/observation.hpp"

namespace talus::twin {

/// Intensity of debris flows after the Swiss recommendations: BWW, BRP, BUWAL (1997), Empfehlungen: Beruecksichtigung
/// der Hochwassergefahren bei raumwirksamen Taetigkeiten; as in Loat & Petrascheck. High: deeper than 1 m and faster
/// than 1 m/s. Medium: either is less. A low intensity of debris flows does not exist.
inline constexpr double high_intensity_depth = 1;  ///< m
inline constexpr double high_intensity_speed = 1;  ///< m/s

/// Name of the class of a building, by peak depth at its walls and peak depth-averaged speed within a cell of them;
/// nullptr: not hit.
[[nodiscard]] const char* intensity_class(const observe::BuildingImpact& impact);

/// Classes, rule and source, as GET /api/scene has them.
[[nodiscard]] nlohmann::json intensity_json();

}  // namespace talus::twin
