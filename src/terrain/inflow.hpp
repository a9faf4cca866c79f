#pragma once

#include <string>
#include <vector>

#include "core/geometry.hpp"

namespace talus {

/// A row of a hydrograph; between rows both change linearly.
struct InflowSample {
    double time = 0;       ///< s
    double discharge = 0;  ///< m3/s of bulk debris at rest density
    double velocity = 0;   ///< m/s, along the ground
};

/// Debris that comes in across a straight line, at right angles to it and towards its right, seen from `from` to `to`.
struct Inflow {
    std::string name;
    PlanPoint from, to;                    ///< world
    std::vector<InflowSample> hydrograph;  ///< by time, two rows or more

    /// What has come in until then, m3, and how far the debris that came in first would have got at inflow velocity, m.
    [[nodiscard]] double volume_until(double time) const;
    [[nodiscard]] double way_until(double time) const;
    /// Of the whole hydrograph, m3.
    [[nodiscard]] double volume() const { return volume_until(hydrograph.back().time); }
};

}  // namespace talus
