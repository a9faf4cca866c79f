#pragma once

#include <optional>
#include <string>

#include <ogr_spatialref.h>

#include "core/geometry.hpp"
#include "geo/crs.hpp"

/// Coordinate reference systems as GDAL holds them. Not for other modules.
namespace talus::geo {

/// Without its vertical part: maps of depth and speed are not heights.
[[nodiscard]] Crs to_crs(const OGRSpatialReference& reference);

/// With x east and y north, whatever axis order the authority prefers. Empty for an empty Crs.
[[nodiscard]] OGRSpatialReference to_spatial_reference(const Crs& crs);

/// Whether the same x east, y north is the same place in both; vertical parts are not compared. Local systems are taken
/// to be the same: their names say nothing.
[[nodiscard]] bool same_crs(const OGRSpatialReference& a, const OGRSpatialReference& b);

/// None, or "Undefined geographic SRS" and "Undefined Cartesian SRS" as GeoPackage has them (OGC 12-128r18, 1.1.2.1.2).
[[nodiscard]] bool is_undefined(const OGRSpatialReference* reference);

/// Longitude (x) and latitude (y) in degrees of a plan position; empty where no transformation is known.
[[nodiscard]] std::optional<PlanPoint> to_longitude_latitude(const OGRSpatialReference& reference, const PlanPoint& p);

/// A metric system that suits a place: "EPSG:32650" (UTM on WGS 84, polar stereographic near the poles);
/// "EPSG:nnnn" for no place.
[[nodiscard]] std::string metric_crs_for(const std::optional<PlanPoint>& longitude_latitude);

/// A metre of a system that is metric by name, such as Web Mercator, may be this far from one on the ground.
inline constexpr double largest_scale_error = 0.02;

/// Grid distance over true distance at a place, the mean of both axes; empty where it cannot be computed.
[[nodiscard]] std::optional<double> scale_factor(const OGRSpatialReference& reference, const PlanPoint& p);

}  // namespace talus::geo
