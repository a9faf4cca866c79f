#pragma once

#include <optional>
#include <string>

#include "core/geometry.hpp"
#include "geo/crs.hpp"

namespace talus::geo {

/// Where heights above the sea are 0.
struct GeoidHeight {
    double height = 0;  ///< m above the ellipsoid of WGS 84
    std::string model;  ///< "EGM96"
};

/// Of a geoid grid that is installed with PROJ: EGM2008 (Pavlis et al. 2012), otherwise EGM96 (Lemoine et al. 1998).
/// Nothing is fetched from the network. Empty: no such grid, or no place on the globe.
[[nodiscard]] std::optional<GeoidHeight> geoid_height(const Crs& crs, const PlanPoint& place);

}  // namespace talus::geo
