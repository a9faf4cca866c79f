#pragma once

#include <memory>

#include <ogr_geometry.h>

/// Closed lines where polygons are wanted. Not for other modules.
namespace talus::geo {

struct ClosedLine {
    bool is_line = false;
    std::unique_ptr<OGRGeometry> polygon;  ///< null: the line is open
};

/// A line that ends where it begins is a polygon that was drawn with another tool, as by GPS receivers and in KML.
/// `tolerance`: between its ends, in its own unit.
[[nodiscard]] ClosedLine close_line(const OGRGeometry& geometry, double tolerance);

}  // namespace talus::geo
