#pragma once

#include <memory>

#include <ogr_geometry.h>

#include "core/result.hpp"

/// Closed lines where polygons are wanted. Not for other modules.
namespace talus::geo {

/// The polygon within a line that ends where it begins, as GPS receivers and KML draw polygons; null: it is no line.
/// `geographic`: its coordinates are degrees. Error, the end of a sentence: it is an open line.
[[nodiscard]] Result<std::unique_ptr<OGRGeometry>> polygon_of_line(const OGRGeometry& geometry, bool geographic);

}  // namespace talus::geo
