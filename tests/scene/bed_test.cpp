#include <algorithm>
#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "run/run_scene.hpp"
#include "scene/scene.hpp"
#include "scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

class LoadBed : public SceneFolder {
  protected:
    static double volume_of(const terrain::Bed& bed) {
        return cell * cell * std::accumulate(bed.depth.begin(), bed.depth.end(), 0.0);
    }
    void write_channel() const {
        write_features("channel.geojson", {rectangle(50, 80, 200, 120, "\"depth_m\": 0.5, \"text\": \"deep\""),
                                           rectangle(200, 80, 250, 120, "\"depth_m\": 1.5, \"text\": \"deep\"")});
    }
};

TEST_F(LoadBed, lies_everywhere_without_polygons) {
    write_valley("[[bed]]\ndepth_m = 0.4\ngrowth_rate_per_m = 0.01\n");
    const Scene scene = loaded();
    EXPECT_NEAR(volume_of(scene.bed), 0.4 * columns * rows * cell * cell, 1);
    ASSERT_EQ(scene.bed.materials.size(), 1U);
    EXPECT_EQ(scene.bed.materials[0].name, "bed 1");
    EXPECT_EQ(scene.bed.materials[0].growth_rate, 0.01);
    EXPECT_THAT(scene.notes, Contains(HasSubstr("bed \"bed 1\": 24000 m3 on the ground")));
}

TEST_F(LoadBed, takes_depths_from_its_polygons) {
    write_channel();
    write_valley("[[bed]]\nfile = \"channel.geojson\"\ndepth_attribute = \"depth_m\"\ngrowth_rate_per_m = 0.01\n");
    const Scene scene = loaded();
    EXPECT_NEAR(volume_of(scene.bed), 0.5 * 150 * 40 + 1.5 * 50 * 40, 1);
    EXPECT_THAT(scene.inputs, Contains(testing::Field(&InputFile::role, "bed \"bed 1\"")));
}

TEST_F(LoadBed, takes_depths_from_a_raster_within_its_polygons) {
    write_channel();
    write_terrain("depth.tif", [](double x, double) { return x < west + 100 ? 0 : 2; });
    write_valley(
        "[[bed]]\nfile = \"channel.geojson\"\ndepth_raster = \"depth.tif\"\nlaw = \"shear\"\n"
        "critical_shear_stress_Pa = 500\n");
    const Scene scene = loaded();
    EXPECT_NEAR(volume_of(scene.bed), 2 * 150 * 40, 1);
    EXPECT_EQ(scene.bed.materials[0].law, params::EntrainmentLaw::shear);
    EXPECT_EQ(scene.bed.materials[0].critical_shear_stress, 500);
}

TEST_F(LoadBed, the_last_of_several_lies_on_top) {
    write_channel();
    write_valley(
        "[[bed]]\ndepth_m = 0.1\ngrowth_rate_per_m = 0.01\n[[bed]]\nname = \"channel\"\nfile = \"channel.geojson\"\n"
        "depth_m = 1\nlaw = \"shear\"\n");
    const Scene scene = loaded();
    const GridGeometry& g = scene.terrain.elevation().geometry;
    EXPECT_EQ(scene.bed.material_at[g.index(20, 20)], 2);
    EXPECT_EQ(scene.bed.depth[g.index(20, 20)], 1.0F);
    EXPECT_EQ(scene.bed.material_at[g.index(20, 2)], 1);
}

TEST_F(LoadBed, refuses_what_does_not_say_how_much_there_is) {
    write_valley("[[bed]]\ngrowth_rate_per_m = 0.01\n");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("bed[0]"), HasSubstr("exactly one of depth_m, depth_attribute, "
                                                                   "depth_raster must be given; there is none")));
    write_valley("[[bed]]\ndepth_m = 1\ndepth_raster = \"d.tif\"\ngrowth_rate_per_m = 0.01\n");
    EXPECT_THAT(load_error(), HasSubstr("given are depth_m, depth_raster"));
    write_valley("[[bed]]\ndepth_attribute = \"d\"\ngrowth_rate_per_m = 0.01\n");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("scene.toml:8"), HasSubstr("needs the polygons that have it")));
}

TEST_F(LoadBed, refuses_a_law_without_its_number) {
    write_valley("[[bed]]\ndepth_m = 1\n");
    EXPECT_THAT(load_error(),
                AllOf(HasSubstr("bed[0].growth_rate_per_m: missing"), HasSubstr("law = \"growth\" needs it")));
    write_valley("[[bed]]\ndepth_m = 1\nlaw = \"shear\"\ngrowth_rate_per_m = 0.1\n");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("scene.toml:10"), HasSubstr("is not for law = \"shear\"")));
    write_valley("[[bed]]\ndepth_m = 1\nlaw = \"wind\"\n");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("'wind'"), HasSubstr("\"growth\", \"shear\"")));
}

TEST_F(LoadBed, refuses_what_lies_nowhere) {
    write_features("away.geojson", {rectangle(5000, 5000, 5100, 5100)});
    write_valley("[[bed]]\nfile = \"away.geojson\"\ndepth_m = 1\ngrowth_rate_per_m = 0.01\n");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("bed[0].file"), HasSubstr("covers the centre of no cell")));
    write_channel();
    write_valley("[[bed]]\nfile = \"channel.geojson\"\ndepth_attribute = \"text\"\ngrowth_rate_per_m = 0.01\n");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("channel.geojson"), HasSubstr("text = \"deep\"")));
    write_terrain("deep.tif", [](double, double) { return 3000; });
    write_valley("[[bed]]\ndepth_raster = \"deep.tif\"\ngrowth_rate_per_m = 0.01\n");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("depth of 3000"), HasSubstr("at most 100 (m)")));
}

TEST_F(LoadBed, runs_and_balances_its_volume) {
    write_valley(
        "[[bed]]\ndepth_m = 0.5\ngrowth_rate_per_m = 0.01\n[solver]\ntarget_particle_count = 400\nend_time_s = 8\n");
    const Scene scene = loaded();
    const Result<run::RunResult> run = run::run_scene(scene, {});
    ASSERT_TRUE(run);
    const observe::Observation& seen = run->observation;
    EXPECT_GT(seen.erosion.volume, 0.05 * seen.volume_released);
    const observe::TimeSample& end = seen.timeseries.back();
    const double present = end.volume_held + end.volume_moving + end.volume_deposited + end.volume_left;
    EXPECT_NEAR(end.volume_released + end.volume_entrained, present, 1e-6 * present);
    EXPECT_NEAR(seen.erosion.volume, end.volume_entrained, 1e-3 * end.volume_entrained);
    double on_map = 0;
    for (const float depth : seen.erosion.depth.values) on_map += depth > 0 ? depth * cell * cell : 0;
    EXPECT_NEAR(on_map, seen.erosion.volume, 1e-6 * on_map);
    ASSERT_FALSE(seen.erosion.upstream.empty());
    EXPECT_TRUE(std::is_sorted(seen.erosion.upstream.begin(), seen.erosion.upstream.end()));
    EXPECT_NEAR(seen.erosion.upstream.back(), seen.erosion.volume, 0.3 * seen.erosion.volume) << "within the corridor";
}

TEST_F(LoadBed, an_earlier_surge_changes_the_ground) {
    write_terrain("deposit.tif", [](double x, double) { return x < west + 100 ? 1.5 : -9; });
    write_terrain("erosion.tif", [](double x, double) { return x < west + 200 ? 0 : 0.5; });
    write_valley();
    const Scene before = loaded();
    write_terrain("dem.tif", valley);
    write("scene.toml",
          "[terrain]\nfile = \"dem.tif\"\ndeposit = \"deposit.tif\"\nerosion = \"erosion.tif\"\n[[release]]\nfile = "
          "\"release.geojson\"\nthickness_m = 1\n");
    const Scene after = loaded();
    const auto change = [&](double x) {
        const PlanPoint p{west + x, south + 50};
        return after.terrain.elevation_at(p) - before.terrain.elevation_at(p);
    };
    EXPECT_NEAR(change(50), 1.5, 1e-3);
    EXPECT_NEAR(change(150), 0, 1e-3) << "depths below zero count as none";
    EXPECT_NEAR(change(250), -0.5, 1e-3);
    EXPECT_THAT(after.notes, Contains(HasSubstr("terrain: raised by 30000 m3 of deposit")));
    write_terrain("none.tif", [](double, double) { return 0; });
    write("scene.toml",
          "[terrain]\nfile = \"dem.tif\"\ndeposit = \"none.tif\"\n[[release]]\nfile = \"release.geojson\"\n"
          "thickness_m = 1\n");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("scene.toml:3"), HasSubstr("has no depth above 0 on the terrain")));
}

}  // namespace
}  // namespace talus::scene
