// The ready-made scenes: what they claim to contain, and that their files are what their scripts make.

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geo/raster.hpp"
#include "geo/vector.hpp"
#include "scene/scene.hpp"
#include "support/fixtures.hpp"
#include "terrain/flow_path.hpp"
#include "terrain/terrain.hpp"

namespace talus::test {
namespace {

const std::filesystem::path scenes = std::filesystem::path(TALUS_SOURCE_DIR) / "scenes";

/// The reconstruction's ground and trail, read as a run reads them.
class Reconstruction : public testing::Test {
  protected:
    void SetUp() override {
        auto raster = geo::read_terrain_raster((scenes / "sham_tseng/terrain.tif").string(), 1, std::nullopt);
        ASSERT_TRUE(raster.ok()) << raster.error().message;
        crs = raster->crs;
        terrain = terrain::Terrain(raster->grid);
        auto line = read_line((scenes / "sham_tseng/flow_path.geojson").string(), "", crs);
        ASSERT_TRUE(line.ok()) << line.error().message;
        EXPECT_EQ(line->reprojection, "");
        path = terrain::FlowPath(line->points, 50);
    }

    [[nodiscard]] double bed(double chainage) const { return terrain.elevation_at(path.point_at(chainage)); }

    geo::Crs crs;
    terrain::Terrain terrain;
    terrain::FlowPath path;
};

TEST_F(Reconstruction, is_in_hong_kong_grid_and_has_no_gaps) {
    EXPECT_EQ(crs.epsg, 2326);
    EXPECT_EQ(terrain.cell(), 1.0);
    for (const float elevation : terrain.elevation().values) ASSERT_FALSE(std::isnan(elevation));
}

TEST_F(Reconstruction, bed_has_the_published_elevations) {
    constexpr double chainage_and_elevation[][2] = {{0, 153},   {22, 146}, {45, 132}, {67, 119}, {88, 112}, {98, 112},
                                                    {130, 102}, {162, 88}, {193, 62}, {225, 44}, {258, 29}, {290, 18}};
    double before_chainage = 0, before_elevation = 153;
    for (const auto& [chainage, elevation] : chainage_and_elevation) {
        // Whole metres are published, good to 5 m; the bed is adapted to the waterfall between chainages 67 and 193.
        const bool adapted = chainage > 67 && chainage < 193;
        EXPECT_NEAR(bed(chainage), elevation, adapted ? 5 : 0.5) << "at chainage " << chainage;
        for (double share = 0; share < 1; share += 0.05) {
            const double at = before_chainage + share * (chainage - before_chainage);
            EXPECT_NEAR(bed(at), before_elevation + share * (elevation - before_elevation), 5) << "at chainage " << at;
        }
        before_chainage = chainage;
        before_elevation = elevation;
    }
}

TEST_F(Reconstruction, gully_passes_the_published_plan_positions) {
    struct Place {
        PlanPoint point;
        double elevation;
    };
    constexpr Place places[] = {{{824255, 825780}, 102}, {{824240, 825750}, 88}, {{824230, 825720}, 62},
                                {{824220, 825690}, 44},  {{824205, 825660}, 29}, {{824195, 825630}, 18}};
    for (const Place& place : places) {
        const auto position = path.locate(place.point);
        ASSERT_TRUE(position);
        EXPECT_LT(position->offset, 3) << "at elevation " << place.elevation;
        // From the bend to the first place it is 26 m in plan but 32 m by the listed chainages; the profile follows
        // these.
        EXPECT_NEAR(terrain.elevation_at(place.point), place.elevation, 3);
    }
    const auto bend = path.locate({824262, 825805});
    ASSERT_TRUE(bend);
    EXPECT_NEAR(bend->chainage, 98, 3);
}

TEST_F(Reconstruction, waterfall_is_ten_metres_high_and_nearly_vertical) {
    // Terrain cells of 1 m spread a step of 2 m over 4 m.
    EXPECT_NEAR(bed(113) - bed(117), 10, 1);
    double steepest = 0;
    for (double chainage = 110; chainage < 120; chainage += 0.25) {
        steepest = std::max(steepest, bed(chainage) - bed(chainage + 1));
    }
    EXPECT_GT(steepest, std::tan(70 * M_PI / 180));
}

/// As debris met it: opposite bank in the bend, fall, marks at 121 m, rugged channel, marks at 217 m, House 38.
TEST_F(Reconstruction, waterfall_lies_between_the_bend_and_the_first_marks) {
    EXPECT_GT(bed(110), 110) << "still above the fall, after the bend at 98 m";
    EXPECT_LT(bed(119), 103) << "below it, before the marks at 121 m";
}

TEST_F(Reconstruction, bed_is_rugged_between_the_marks_and_smooth_elsewhere) {
    /// Mean square of the bed's curvature, over steps of 2 m.
    const auto ruggedness = [&](double from, double to) {
        double sum = 0;
        int count = 0;
        for (double at = from; at < to; at += 0.5, ++count) {
            const double bend = bed(at - 2) - 2 * bed(at) + bed(at + 2);
            sum += bend * bend;
        }
        return std::sqrt(sum / count);
    };
    EXPECT_GT(ruggedness(130, 210), 0.3);
    EXPECT_LT(ruggedness(50, 108), 0.1);
    EXPECT_LT(ruggedness(222, 280), 0.1);
}

TEST_F(Reconstruction, bed_descends_all_the_way) {
    for (double chainage = 0; chainage + 12 < path.length(); chainage += 1) {
        const bool rugged = chainage > 107 && chainage < 218;
        const double step = rugged ? 12 : 1;
        EXPECT_LT(bed(chainage + step), bed(chainage)) << "at chainage " << chainage;
    }
}

TEST_F(Reconstruction, bank_opposite_the_hillside_reach_is_high_enough_for_the_impact_marks) {
    // Straight on down the hillside reach and across the gully, 12 m beyond where the trail turns.
    const PlanPoint before = path.point_at(75), at = path.point_at(85);
    const double ahead = 33 / std::hypot(at.x - before.x, at.y - before.y);
    const PlanPoint bank{at.x + ahead * (at.x - before.x), at.y + ahead * (at.y - before.y)};
    EXPECT_GT(terrain.elevation_at(bank) - bed(98), 3);
}

TEST(SceneScripts, make_exactly_the_committed_files) {
    if (std::system("/usr/bin/python3 -c 'import numpy; from osgeo import gdal' >/dev/null 2>&1") != 0) {
        GTEST_SKIP() << "scene scripts not checked: /usr/bin/python3 lacks GDAL or numpy (install python3-gdal)";
    }
    const std::array<std::pair<std::string, std::string>, 2> scripts{
        {{"sham_tseng", "make_terrain.py"}, {"sham_tseng_real", "make_inputs.py"}}};
    for (const auto& [scene, script] : scripts) {
        const test::TemporaryFolder folder;
        const std::filesystem::path& made = folder.path();
        const std::string command =
            "/usr/bin/python3 '" + (scenes / scene / script).string() + "' '" + made.string() + "'";
        ASSERT_EQ(std::system(command.c_str()), 0) << command;
        for (const char* file : {"release.geojson", "release_lower.geojson", "release_long.geojson",
                                 "release_wide.geojson", "buildings.geojson", "flow_path.geojson"}) {
            EXPECT_EQ(test::read_text(made / file), test::read_text(scenes / scene / file)) << scene << "/" << file;
        }
        if (scene == "sham_tseng") {
            auto again = geo::read_terrain_raster((made / "terrain.tif").string(), 1, std::nullopt);
            auto committed = geo::read_terrain_raster((scenes / scene / "terrain.tif").string(), 1, std::nullopt);
            ASSERT_TRUE(again.ok() && committed.ok());
            EXPECT_EQ(again->grid.geometry, committed->grid.geometry);
            EXPECT_EQ(again->grid.values, committed->grid.values);
            EXPECT_EQ(again->crs.epsg, committed->crs.epsg);
        }
    }
}

void expect_the_landslide(const scene::Scene& scene) {
    EXPECT_TRUE(scene.spec.scene.reconstruction);
    EXPECT_GE(scene.spec.scene.assumptions.size(), 8U);
    EXPECT_FALSE(scene.spec.scene.sources.empty());
    EXPECT_EQ(scene.crs.epsg, 2326);
    ASSERT_EQ(scene.releases.size(), 1U);
    EXPECT_NEAR(scene.releases[0].volume, 600, 6);
    EXPECT_EQ(scene.spec.material.rest_density, 2000);
    std::vector<std::string> variants;
    for (const params::VariantSpec& variant : scene.spec.variants) variants.push_back(variant.name);
    EXPECT_EQ(variants,
              (std::vector<std::string>{"paper", "ls-dyna", "voellmy", "guidance", "reconstruction", "yield-stress"}));
    ASSERT_EQ(scene.spec.observations.size(), 2U);
    EXPECT_EQ(scene.spec.observations[0].chainage, 121);
    EXPECT_EQ(scene.spec.observations[0].debris_speed, 11);
    EXPECT_EQ(scene.spec.observations[1].chainage, 217);
    EXPECT_EQ(scene.spec.observations[1].debris_speed, 7);
    bool kitchen = false;
    for (const terrain::Building& building : scene.buildings) kitchen |= building.name == "House 38, kitchen";
    EXPECT_TRUE(kitchen);
    EXPECT_EQ(scene.flow_path_origin, scene::PathOrigin::file);
}

TEST(Scenes, reconstruction_loads) {
    const auto scene = scene::load_scene(scenes / "sham_tseng/scene.toml");
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    expect_the_landslide(*scene);
}

/// One set of values for both grounds, and the published one under its name.
TEST(Scenes, both_have_the_same_material) {
    const std::filesystem::path files[] = {scenes / "sham_tseng/scene.toml", scenes / "sham_tseng_real/scene.toml"};
    const bool given = std::getenv("TALUS_DATA") != nullptr;
    if (!given) setenv("TALUS_DATA", "/nowhere", 1);  // the terrain is not read
    const auto reconstruction = scene::parse_scene(files[0]), official = scene::parse_scene(files[1]);
    ASSERT_TRUE(reconstruction.ok() && official.ok());
    EXPECT_EQ(reconstruction->material.friction_coefficient, official->material.friction_coefficient);
    EXPECT_EQ(reconstruction->material.laminar_viscosity, official->material.laminar_viscosity);
    EXPECT_EQ(reconstruction->material.viscosity, official->material.viscosity);
    for (const auto& file : files) {
        const auto published = scene::parse_scene(file, {"variant=paper"});
        ASSERT_TRUE(published.ok()) << published.error().message;
        EXPECT_EQ(published->material.friction_coefficient, 0.4);
        EXPECT_EQ(published->material.viscosity, 0.1);
        EXPECT_FALSE(published->material.turbulent_friction);
        EXPECT_FALSE(published->material.laminar_viscosity);
        EXPECT_FALSE(published->material.internal_friction_coefficient);
    }
    if (!given) unsetenv("TALUS_DATA");
}

TEST(Scenes, official_terrain_loads) {
    const char* folder = std::getenv("TALUS_DATA");
    if (folder == nullptr || *folder == 0) {
        GTEST_SKIP() << "sham_tseng_real not checked: TALUS_DATA does not say where hk_sham_tseng/ lies";
    }
    const auto scene = scene::load_scene(scenes / "sham_tseng_real/scene.toml");
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    expect_the_landslide(*scene);
    // The trail is drawn along the thalweg: on average downhill over every 20 m.
    for (double chainage = 0; chainage + 20 < 320; chainage += 5) {
        EXPECT_GT(scene->terrain.elevation_at(scene->flow_path.point_at(chainage)),
                  scene->terrain.elevation_at(scene->flow_path.point_at(chainage + 20)))
            << "at chainage " << chainage;
    }
}

TEST(Scenes, without_the_official_terrain_it_says_where_to_get_it) {
    const char* folder = std::getenv("TALUS_DATA");
    const std::string before = folder != nullptr ? folder : "";
    unsetenv("TALUS_DATA");
    const auto scene = scene::load_scene(scenes / "sham_tseng_real/scene.toml");
    if (folder != nullptr) setenv("TALUS_DATA", before.c_str(), 1);
    ASSERT_FALSE(scene.ok());
    EXPECT_NE(scene.error().message.find("TALUS_DATA"), std::string::npos) << scene.error().message;
    EXPECT_NE(scene.error().message.find("data.gov.hk"), std::string::npos) << scene.error().message;
}

}  // namespace
}  // namespace talus::test
