#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry.hpp"

namespace talus {

/// A row of a hydrograph; between rows all change linearly.
struct InflowSample {
    double time = 0;       ///< s
    double discharge = 0;  ///< m3/s of bulk debris at its own density
    double velocity = 0;   ///< m/s, along the ground
    double density = 0;    ///< kg/m3; 0 in every row: that of the material
    bool operator==(const InflowSample&) const = default;
};

/// Debris that comes in across a straight line, at right angles to it and towards its right, seen from `from` to `to`;
/// or all over an area.
struct Inflow {
    std::string name;
    PlanPoint from, to;                    ///< world
    std::vector<InflowSample> hydrograph;  ///< by time, two rows or more
    std::vector<Polygon> area = {};        ///< world; empty: across the line
    std::optional<double> direction = {};  ///< over an area: azimuth clockwise from north; absent: down the slope

    [[nodiscard]] bool over_area() const { return !area.empty(); }
    [[nodiscard]] bool has_density() const { return hydrograph.front().density > 0; }

    /// What has come in until then, m3, and how far the debris that came in first would have got at inflow velocity, m.
    [[nodiscard]] double volume_until(double time) const;
    [[nodiscard]] double way_until(double time) const;
    /// kg, where there is a density.
    [[nodiscard]] double mass_until(double time) const;
    [[nodiscard]] double velocity_at(double time) const;
    /// kg/m3, of what comes in between two times: its mass over its volume.
    [[nodiscard]] double density_between(double early, double late) const;
    /// Of the whole hydrograph, m3.
    [[nodiscard]] double volume() const { return volume_until(hydrograph.back().time); }
};

}  // namespace talus
