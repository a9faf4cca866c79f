#pragma once

#include <optional>

#include "core/geometry.hpp"
#include "geo/crs.hpp"

namespace talus::geo {

/// Latitude in degrees of a plan position; empty where no transformation is known.
[[nodiscard]] std::optional<double> latitude_deg(const Crs& crs, const PlanPoint& p);

}  // namespace talus::geo
