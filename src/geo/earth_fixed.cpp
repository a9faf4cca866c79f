#include "geo/earth_fixed.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/longitude_latitude.hpp"

namespace talus::geo {
namespace {

using Vector = std::array<double, 3>;

constexpr double semi_major = 6378137.0, flattening = 1 / 298.257223563;
constexpr double baseline = 100;  // m, over which the axes are measured

double radians(double degrees) {
    return degrees * std::numbers::pi / 180;
}

Vector up_at(const PlanPoint& degrees) {
    const double longitude = radians(degrees.x), latitude = radians(degrees.y);
    return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude)};
}

Vector from_degrees(const PlanPoint& degrees, double height) {
    const Vector up = up_at(degrees);
    constexpr double squeezed = (1 - flattening) * (1 - flattening);
    const double normal = semi_major / std::sqrt(1 - (1 - squeezed) * up[2] * up[2]);
    return {(normal + height) * up[0], (normal + height) * up[1], (normal * squeezed + height) * up[2]};
}

}  // namespace

Result<EarthFixed> earth_fixed(const Crs& crs, const WorldPoint& p) {
    TALUS_ASSIGN(const auto to_degrees, to_wgs84(crs));
    const auto at = [&](double east, double north) { return from_degrees(to_degrees({p.x + east, p.y + north}), p.z); };
    const auto axis = [&](double east, double north) {
        const Vector a = at(-east, -north), b = at(east, north);
        Vector v{};
        for (std::size_t k = 0; k < 3; ++k) v[k] = (b[k] - a[k]) / (2 * baseline);
        return v;
    };
    const EarthFixed place{at(0, 0), axis(baseline, 0), axis(0, baseline), up_at(to_degrees({p.x, p.y}))};
    for (const Vector& v : {place.origin, place.east, place.north}) {
        if (!std::isfinite(v[0] + v[1] + v[2])) {
            return Error{fmt::format("{}: its place on the globe is not known", crs.label())};
        }
    }
    return place;
}

}  // namespace talus::geo
