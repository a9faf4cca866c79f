#include "geo/geoid.hpp"

#include <array>
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <ogr_spatialref.h>

#include "geo/gdal.hpp"
#include "geo/longitude_latitude.hpp"

namespace talus::geo {
namespace {

struct GeoidGrid {
    const char *file, *model;
};
/// As PROJ-data and the older proj-datumgrid name them.
constexpr std::array grids = {GeoidGrid{"us_nga_egm08_25.tif", "EGM2008"}, GeoidGrid{"egm08_25.gtx", "EGM2008"},
                              GeoidGrid{"us_nga_egm96_15.tif", "EGM96"}, GeoidGrid{"egm96_15.gtx", "EGM96"}};

/// Keeps PROJ from the network during its lifetime.
class Offline {
  public:
    Offline() : before_(OSRGetPROJEnableNetwork()) { OSRSetPROJEnableNetwork(0); }
    ~Offline() { OSRSetPROJEnableNetwork(before_); }
    Offline(const Offline&) = delete;
    Offline& operator=(const Offline&) = delete;

  private:
    int before_;
};

std::optional<double> height_by(const GeoidGrid& grid, PlanPoint degrees) {
    // The grid by its name, with no way around it: between two systems PROJ may choose to leave heights as they are.
    const std::string steps = fmt::format(
        "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad +step +proj=vgridshift +grids={} +multiplier=1 "
        "+step +proj=unitconvert +xy_in=rad +xy_out=deg",
        grid.file);
    OGRCoordinateTransformationOptions options;
    if (!options.SetCoordinateOperation(steps.c_str(), false)) return {};
    const std::unique_ptr<OGRCoordinateTransformation> up(OGRCreateCoordinateTransformation(nullptr, nullptr, options));
    double height = 0;
    if (!up || up->Transform(1, &degrees.x, &degrees.y, &height) == 0 || !std::isfinite(height)) return {};
    return height;
}

}  // namespace

std::optional<GeoidHeight> geoid_height(const Crs& crs, const PlanPoint& place) {
    const GdalMessages quiet;
    const auto to_degrees = to_wgs84(crs);
    if (!to_degrees) return {};
    const PlanPoint degrees = (*to_degrees)(place);
    if (!std::isfinite(degrees.x) || !std::isfinite(degrees.y)) return {};
    const Offline offline;
    for (const GeoidGrid& grid : grids) {
        if (const auto height = height_by(grid, degrees)) return GeoidHeight{*height, grid.model};
    }
    return {};
}

}  // namespace talus::geo
