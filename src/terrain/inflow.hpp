#pragma once

#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "params/spec.hpp"

namespace talus::terrain {

/// Inflow of debris across a straight line, at right angles to it and towards its right, seen from `from` to `to`; or
/// over an area.
struct Inflow {
    std::string name;
    PlanPoint from, to;                            ///< world
    std::vector<params::InflowSample> hydrograph;  ///< by time, two rows or more
    std::vector<Polygon> area = {};                ///< world; empty: across the line
    params::InflowSpec spec = {};                  ///< its specification by scene or user, without the name

    [[nodiscard]] bool over_area() const { return !area.empty(); }
    [[nodiscard]] bool has_density() const { return hydrograph.front().density > 0; }

    /// The volume injected until then, m3, and the distance that the first debris would have travelled at inflow
    /// velocity, m.
    [[nodiscard]] double volume_until(double time) const;
    [[nodiscard]] double way_until(double time) const;
    /// kg, where there is a density.
    [[nodiscard]] double mass_until(double time) const;
    [[nodiscard]] double velocity_at(double time) const;
    /// kg/m3, of the inflow between two times: its mass over its volume.
    [[nodiscard]] double density_between(double early, double late) const;
    /// r_u with which debris comes in; negative: that of the material.
    [[nodiscard]] double pore_pressure_ratio_at(double time) const;
    /// Of the whole hydrograph, m3.
    [[nodiscard]] double volume() const { return volume_until(hydrograph.back().time); }
    /// Mean over the ground that the debris would cover at inflow velocity, m; of inflow across a line.
    [[nodiscard]] double mean_thickness() const;
};

}  // namespace talus::terrain
