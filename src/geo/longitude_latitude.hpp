#pragma once

#include <functional>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "geo/crs.hpp"

namespace talus::geo {

/// Longitude (x) and latitude (y) on WGS 84 in degrees, of a plan position; not finite where it has none.
using ToLongitudeLatitude = std::function<PlanPoint(const PlanPoint&)>;

/// Errors: no transformation is known, as for a local system.
[[nodiscard]] Result<ToLongitudeLatitude> to_wgs84(const Crs& crs);

}  // namespace talus::geo
