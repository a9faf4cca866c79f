#include "geo/earth_fixed.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "support/fixtures.hpp"

namespace talus::geo {
namespace {

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Crs crs_of(const char* text) {
    return *crs_from_text(text);
}

TEST(EarthFixed, places_the_crossing_of_equator_and_central_meridian) {
    // UTM zone 31: 500 km east is 3 degrees east of Greenwich, at a scale of 0.9996.
    const auto place = earth_fixed(crs_of("EPSG:32631"), {500000, 0, 100});
    ASSERT_TRUE(place) << place.error().message;
    const double longitude = 3 * std::acos(-1.0) / 180;
    EXPECT_NEAR(place->origin[0], 6378237 * std::cos(longitude), 1e-3);
    EXPECT_NEAR(place->origin[1], 6378237 * std::sin(longitude), 1e-3);
    EXPECT_NEAR(place->origin[2], 0, 1e-3);
    EXPECT_NEAR(place->up[0], std::cos(longitude), 1e-9);
    EXPECT_NEAR(place->north[2], (1 + 100 / 6335439.0) / 0.9996, 1e-6) << "to the pole";
    EXPECT_NEAR(place->east[1], std::cos(longitude) / 0.9996, 1e-4);
}

TEST(EarthFixed, axes_are_square_and_right_handed_anywhere) {
    for (const auto& [crs, x, y] : {std::tuple{"EPSG:2326", 824500.0, 825400.0},  // Hong Kong
                                    {"EPSG:2056", 2600000.0, 1200000.0},          // Bern
                                    {"EPSG:32719", 300000.0, 6200000.0}}) {       // Chile
        const auto place = earth_fixed(crs_of(crs), {x, y, 0});
        ASSERT_TRUE(place) << crs;
        const auto& [origin, east, north, up] = *place;
        EXPECT_NEAR(dot(east, north), 0, 1e-5) << crs;
        EXPECT_NEAR(dot(east, up), 0, 1e-5) << crs;
        EXPECT_NEAR(std::sqrt(dot(east, east)), 1, 2e-3) << crs;
        const std::array<double, 3> across = {east[1] * north[2] - east[2] * north[1],
                                              east[2] * north[0] - east[0] * north[2],
                                              east[0] * north[1] - east[1] * north[0]};
        EXPECT_NEAR(dot(across, up), 1, 4e-3) << crs;
        EXPECT_NEAR(std::sqrt(dot(origin, origin)), 6371e3, 15e3) << crs;
    }
    // The projection centre of the Swiss grid is the old observatory of Bern, at 46.951 degrees north.
    const auto bern = earth_fixed(crs_of("EPSG:2056"), {2600000, 1200000, 0});
    EXPECT_NEAR(std::asin(bern->up[2]) * 180 / std::acos(-1.0), 46.9511, 2e-4);
}

TEST(EarthFixed, refuses_a_system_that_is_nowhere) {
    EXPECT_FALSE(earth_fixed(Crs{}, {0, 0, 0}));
}

}  // namespace
}  // namespace talus::geo
