#include "geo/longitude_latitude.hpp"

#include <limits>
#include <memory>

#include <fmt/format.h>

#include "geo/gdal.hpp"
#include "geo/spatial_reference.hpp"

namespace talus::geo {

Result<ToLongitudeLatitude> to_wgs84(const Crs& crs) {
    const GdalMessages messages;
    const OGRSpatialReference from = to_spatial_reference(crs);
    OGRSpatialReference degrees;
    degrees.SetWellKnownGeogCS("WGS84");
    degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::shared_ptr<OGRCoordinateTransformation> transformation(
        from.IsEmpty() ? nullptr : OGRCreateCoordinateTransformation(&from, &degrees));
    if (!transformation) return Error{fmt::format("{}: its place on the globe is not known", crs.label())};
    return ToLongitudeLatitude([transformation](const PlanPoint& place) {
        const GdalMessages quiet;
        PlanPoint p = place;
        if (transformation->Transform(1, &p.x, &p.y) != 0) return p;
        constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();
        return PlanPoint{nowhere, nowhere};
    });
}

}  // namespace talus::geo
