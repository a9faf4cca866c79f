#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/scene.hpp"
#include "scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::StartsWith;

/// A plane that falls by 0.4 to the east and 0.3 to the north, with a release of 20 m x 20 m.
class ReleaseShift : public SceneFolder {
  protected:
    ReleaseShift() {
        write_valley();
        write_terrain("dem.tif", [](double x, double y) { return 300 - 0.4 * (x - west) - 0.3 * (y - south); });
        write_features("release.geojson", {rectangle(100, 90, 120, 110)});
    }
    [[nodiscard]] static PlanPoint corner(const Scene& scene) { return scene.releases[0].patches[0].polygon.outer[0]; }
    [[nodiscard]] PlanPoint moved(const std::vector<std::string>& overrides) const {
        const PlanPoint from = corner(loaded()), to = corner(loaded(overrides));
        return {to.x - from.x, to.y - from.y};
    }
};

TEST_F(ReleaseShift, along_is_down_the_slope_and_across_to_the_left) {
    const PlanPoint along = moved({"release.shift_along_m=10"});
    EXPECT_NEAR(along.x, 8, 1e-3);
    EXPECT_NEAR(along.y, 6, 1e-3);
    const PlanPoint across = moved({"release.shift_across_m=10"});
    EXPECT_NEAR(across.x, -6, 1e-3);
    EXPECT_NEAR(across.y, 8, 1e-3);
    const PlanPoint both = moved({"release.shift_along_m=-5", "release.shift_across_m=2"});
    EXPECT_NEAR(both.x, -4 - 1.2, 1e-3);
    EXPECT_NEAR(both.y, -3 + 1.6, 1e-3);
}

TEST_F(ReleaseShift, keeps_the_volume_and_is_noted) {
    const Scene shifted = loaded({"release.shift_along_m=10"});
    EXPECT_NEAR(shifted.releases[0].volume, loaded().releases[0].volume, 1e-3);
    EXPECT_THAT(shifted.notes, Contains(HasSubstr("release \"scarp\": moved by 8 m to the east and 6 m to the north")));
}

TEST_F(ReleaseShift, takes_the_raster_of_thickness_along) {
    write_terrain("thickness.tif", [](double x, double) { return x < west + 110 ? 1.0 : 3.0; });
    const std::vector<std::string> raster{"release.thickness_m=none", "release.thickness_raster=thickness.tif"};
    std::vector<std::string> shifted = raster;
    shifted.emplace_back("release.shift_along_m=10");
    const terrain::Release given = loaded(raster).releases[0], there = loaded(shifted).releases[0];
    EXPECT_NEAR(there.volume, given.volume, 0.02 * given.volume);
    for (const double x : {102.0, 118.0}) {
        EXPECT_EQ(there.thickness_at({west + x + 8, south + 106}), given.thickness_at({west + x, south + 100}));
    }
}

TEST_F(ReleaseShift, beyond_the_terrain_or_on_level_ground_is_refused) {
    EXPECT_THAT(load_error({"release.shift_along_m=400"}),
                AllOf(StartsWith("--set release.shift_along_m=400: release[0].shift_along_m: "),
                      HasSubstr("lies outside the terrain")));
    write_terrain("dem.tif", [](double, double) { return 7.0; });
    EXPECT_THAT(load_error({"release.shift_across_m=4"}),
                AllOf(StartsWith("--set release.shift_across_m=4: release[0].shift_across_m: "), HasSubstr("level")));
}

}  // namespace
}  // namespace talus::scene
