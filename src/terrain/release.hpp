#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "params/spec.hpp"
#include "terrain/terrain.hpp"

namespace talus::terrain {

/// A polygon of failing ground with its thickness, m.
struct ReleasePatch {
    Polygon polygon;
    double thickness = 0;
    bool operator==(const ReleasePatch&) const = default;
};

/// A body of debris that starts to move at one moment.
struct Release {
    std::string name;
    std::vector<ReleasePatch> patches;            ///< not overlapping
    std::optional<Grid<float>> thickness_raster;  ///< if present, replaces the patches' thickness (NaN, <= 0: none)
    double volume = 0;                            ///< m3, as integrated by release_volume
    std::vector<params::PressureSample> water;    ///< pore pressure until it fails, by time; empty: no water rises
    params::ReleaseSpec spec;                     ///< its specification by scene or user, without the name

    /// Thickness as measured at a world plan position; 0 outside the patches.
    [[nodiscard]] double thickness_at(const PlanPoint& p) const;
    /// Whether thickness is measured vertically, not normal to the slope.
    [[nodiscard]] bool vertical() const { return spec.thickness_direction == params::ThicknessDirection::vertical; }
    /// Vertical depth there; 0 where the terrain does not cover it.
    [[nodiscard]] double depth_at(const Terrain& terrain, const PlanPoint& p) const;
    [[nodiscard]] Extent extent() const;
};

/// Integral of the vertical depth (thickness / cos(slope), where it is normal to it) over the plan area, m3; ground
/// that the terrain does not cover does not count.
[[nodiscard]] double release_volume(const Terrain& terrain, const Release& release);

/// Mean over the ground that has any, normal to the slope, m; 0 without ground. The release must have its volume.
[[nodiscard]] double mean_thickness(const Terrain& terrain, const Release& release);

/// Area of its patches on the slope, m2.
[[nodiscard]] double release_slope_area(const Terrain& terrain, const Release& release);

}  // namespace talus::terrain
