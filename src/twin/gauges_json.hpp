#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "observe/observation.hpp"
#include "terrain/cross_section.hpp"
#include "terrain/gauge.hpp"

namespace talus::twin {

/// Name and place.
[[nodiscard]] nlohmann::json gauge_place(const terrain::Gauge& gauge);
/// `gauges` of GET /api/scene.
[[nodiscard]] nlohmann::json gauge_places(const std::vector<terrain::Gauge>& gauges);
/// `cross_sections` of GET /api/scene.
[[nodiscard]] nlohmann::json section_places(const std::vector<terrain::CrossSection>& sections);
/// `gauges` of GET /api/scenarios/{s}/series: at most 600 rows.
[[nodiscard]] nlohmann::json gauge_curves(const std::vector<observe::GaugeRecord>& records);

}  // namespace talus::twin
