#pragma once

#include <array>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "geo/crs.hpp"

namespace talus::geo {

/// A flat scene on the globe: a place and three axes, in metres from the centre of the earth (EPSG:4978).
struct EarthFixed {
    std::array<double, 3> origin{};
    std::array<double, 3> east{}, north{}, up{};  ///< per metre along the scene's axes; up is a unit
};

/// The scene's axes at a place: they keep the turn and the scale of its reference system there. A flat scene touches
/// the ellipsoid: at distance d it is d^2 / 12742 km too high. `p.z` is above the ellipsoid (WGS 84; NIMA 2000,
/// TR8350.2). Errors: no transformation is known, as for a local system.
[[nodiscard]] Result<EarthFixed> earth_fixed(const Crs& crs, const WorldPoint& p);

}  // namespace talus::geo
