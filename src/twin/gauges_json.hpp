#pragma once

#include <vector>

#include "messages/messages.hpp"
#include "observe/observation.hpp"
#include "terrain/cross_section.hpp"
#include "terrain/gauge.hpp"

namespace talus::twin {

/// A value of every row.
template <class Row>
[[nodiscard]] std::vector<double> column(const std::vector<Row>& rows, double Row::*value) {
    std::vector<double> values;
    values.reserve(rows.size());
    for (const Row& row : rows) values.push_back(row.*value);
    return values;
}

/// Name and place.
[[nodiscard]] messages::GaugePlace gauge_place(const terrain::Gauge& gauge);
/// `gauges` of GET /api/scene.
[[nodiscard]] std::vector<messages::GaugePlace> gauge_places(const std::vector<terrain::Gauge>& gauges);
/// `cross_sections` of GET /api/scene.
[[nodiscard]] std::vector<messages::SectionPlace> section_places(const std::vector<terrain::CrossSection>& sections);
/// `gauges` of GET /api/scenarios/{s}/series: at most 600 rows.
[[nodiscard]] messages::GaugeSeries gauge_curves(const std::vector<observe::GaugeRecord>& records);

}  // namespace talus::twin
