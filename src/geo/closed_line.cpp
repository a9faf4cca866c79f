#include "geo/closed_line.hpp"

#include <cmath>

namespace talus::geo {

ClosedLine close_line(const OGRGeometry& geometry, double tolerance) {
    const OGRGeometry* one = &geometry;
    if (wkbFlatten(one->getGeometryType()) == wkbMultiLineString) {
        const OGRMultiLineString& parts = *one->toMultiLineString();
        if (parts.getNumGeometries() == 1) one = parts.getGeometryRef(0);
    }
    ClosedLine closed;
    if (wkbFlatten(one->getGeometryType()) != wkbLineString) return closed;
    closed.is_line = true;
    const OGRLineString& line = *one->toLineString();
    const int last = line.getNumPoints() - 1;
    if (last < 3 || std::hypot(line.getX(last) - line.getX(0), line.getY(last) - line.getY(0)) > tolerance) {
        return closed;
    }
    OGRLinearRing ring;
    ring.addSubLineString(&line);
    auto polygon = std::make_unique<OGRPolygon>();
    polygon->addRing(&ring);
    polygon->closeRings();
    closed.polygon = std::move(polygon);
    return closed;
}

}  // namespace talus::geo
