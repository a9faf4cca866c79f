#include "geo/closed_line.hpp"

#include <cmath>
#include <utility>

namespace talus::geo {

Result<std::unique_ptr<OGRGeometry>> polygon_of_line(const OGRGeometry& geometry, bool geographic) {
    using Polygon = std::unique_ptr<OGRGeometry>;
    const OGRGeometry* one = &geometry;
    if (wkbFlatten(one->getGeometryType()) == wkbMultiLineString) {
        const OGRMultiLineString& parts = *one->toMultiLineString();
        if (parts.getNumGeometries() == 1) one = parts.getGeometryRef(0);
    }
    if (wkbFlatten(one->getGeometryType()) != wkbLineString) return Result<Polygon>(Polygon());
    const OGRLineString& line = *one->toLineString();
    const int last = line.getNumPoints() - 1;
    const double tolerance = geographic ? 1e-8 : 1e-3;  // degrees or metres
    if (last < 3 || std::hypot(line.getX(last) - line.getX(0), line.getY(last) - line.getY(0)) > tolerance) {
        return Error{
            "is an open line, a polygon is needed; end it where it begins, or make a polygon of it (in QGIS: Vector, "
            "Geometry Tools, Lines to Polygons)"};
    }
    OGRLinearRing ring;
    ring.addSubLineString(&line);
    auto polygon = std::make_unique<OGRPolygon>();
    polygon->addRing(&ring);
    polygon->closeRings();
    return Result<Polygon>(Polygon(std::move(polygon)));
}

}  // namespace talus::geo
