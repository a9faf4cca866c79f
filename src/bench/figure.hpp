#pragma once

#include <string>
#include <vector>

#include "bench/measure.hpp"

namespace talus::bench {

/// Particle-iterations per second against the number of particles, a line per scene, method and number of threads, as a
/// separate SVG. Rows of a single size are separate marks.
[[nodiscard]] std::string scaling_svg(const std::vector<Row>& rows);

}  // namespace talus::bench
