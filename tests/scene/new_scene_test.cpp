#include "scene/new_scene.hpp"

#include <cmath>
#include <iterator>
#include <numbers>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/check.hpp"
#include "scene/reach.hpp"
#include "scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

class NewSceneTest : public SceneFolder {
  protected:
    NewSceneTest() {
        write_valley();
        options.dem = path("dem.tif");
        options.release = path("release.geojson");
        options.folder = folder / "new" / "valley";
    }
    [[nodiscard]] NewScene made() const {
        auto scene = write_new_scene(options);
        if (!scene) throw std::runtime_error(scene.error().message);
        return *scene;
    }
    [[nodiscard]] std::string refusal() const {
        const auto scene = write_new_scene(options);
        EXPECT_FALSE(scene);
        EXPECT_FALSE(std::filesystem::exists(options.folder)) << "nothing may be left behind";
        return scene ? "" : scene.error().message;
    }
    static Scene loaded(const std::filesystem::path& file) {
        auto scene = load_scene(file);
        if (!scene) throw std::runtime_error(scene.error().message);
        return std::move(*scene);
    }
    [[nodiscard]] static std::string text_of(const std::filesystem::path& file) {
        std::ifstream in(file);
        return {std::istreambuf_iterator<char>(in), {}};
    }

    NewSceneOptions options;
};

TEST_F(NewSceneTest, LoadsAndNamesItsInputsRelativeToItself) {
    options.volume = 600;
    options.target_particle_count = 5000;
    const NewScene made_scene = made();
    EXPECT_EQ(made_scene.file, options.folder / "scene.toml");
    const std::string text = text_of(made_scene.file);
    EXPECT_THAT(text, HasSubstr("\nfile = \"../../dem.tif\"\n"));
    EXPECT_THAT(text, HasSubstr("\ntarget_particle_count = 5000\n"));
    EXPECT_THAT(text, HasSubstr("\n# friction_coefficient = 0.4\n"));
    const Scene scene = loaded(made_scene.file);
    EXPECT_NEAR(scene.releases.at(0).volume, 600, 0.1);
    EXPECT_EQ(scene.spec.scene.title, "valley");
}

TEST_F(NewSceneTest, WorksFromRelativeNames) {
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(folder);
    options.dem = "dem.tif";
    options.release = "release.geojson";
    options.folder = "deep/er/valley";
    const auto scene = write_new_scene(options);
    std::filesystem::current_path(before);
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_THAT(text_of(folder / scene->file), HasSubstr("\nfile = \"../../../dem.tif\"\n"));
    EXPECT_EQ(loaded(folder / scene->file).releases.size(), 1U);
}

TEST_F(NewSceneTest, WithoutThicknessTheAssumptionIsWrittenDown) {
    const Scene scene = loaded(made().file);
    EXPECT_EQ(scene.spec.releases.at(0).thickness, 2.0);
    EXPECT_THAT(scene.spec.scene.assumptions, Contains(HasSubstr("2 m thick")));
}

TEST_F(NewSceneTest, TakesThicknessHeightAndNameFromTheirAttributes) {
    write_features("release.geojson", {rectangle(20, 90, 40, 110, "\"thickness_m\": 1.5")});
    write_features("houses.geojson", {rectangle(200, 90, 210, 100, "\"height_m\": 9, \"name\": \"House 38\"")});
    options.buildings = path("houses.geojson");
    const Scene scene = loaded(made().file);
    EXPECT_EQ(scene.releases.at(0).patches.at(0).thickness, 1.5);
    EXPECT_EQ(scene.buildings.at(0).name, "House 38");
    EXPECT_EQ(scene.buildings.at(0).height, 9);
    EXPECT_TRUE(scene.spec.scene.assumptions.empty());
}

TEST_F(NewSceneTest, TheExtentLeavesOutWhatDebrisCannotReach) {
    // Ground that climbs away from the release on both sides, and level ground 100 m down the way.
    write_terrain("dem.tif", [](double x, double y) {
        return 100 + 1.5 * std::abs(y - (south + 100)) - 0.1 * std::min(x - west, 100.0);
    });
    const Scene scene = loaded(made().file);
    const Extent extent = scene.terrain.elevation().geometry.extent();
    EXPECT_TRUE(extent.contains({west + 20, south + 90}) && extent.contains({west + 40, south + 110}));
    EXPECT_LT(extent.x_max, west + columns * cell);
    EXPECT_GT(extent.x_max, west + 100);
    EXPECT_EQ(std::fmod(extent.x_min - west, cell), 0);
}

TEST_F(NewSceneTest, RefusesAFolderThatIsThere) {
    std::filesystem::create_directories(options.folder);
    write("new/valley/mine.txt", "keep");
    const auto scene = write_new_scene(options);
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().message, HasSubstr("is already there"));
    EXPECT_TRUE(std::filesystem::exists(options.folder / "mine.txt"));
}

TEST_F(NewSceneTest, BadInputsLeaveNothingBehind) {
    options.dem = path("absent.tif");
    EXPECT_THAT(refusal(), HasSubstr("absent.tif"));
    options.dem = path("dem.tif");
    options.thickness = -1;
    EXPECT_THAT(refusal(), HasSubstr("thickness -1 is refused; it must be a number from 0.001 to 1000 (m)"));
    options.thickness = 1;
    options.volume = 3;
    EXPECT_THAT(refusal(), HasSubstr("give one of them"));
    options.volume.reset();
    options.buildings = path("absent.geojson");
    EXPECT_THAT(refusal(), AllOf(HasSubstr("buildings.file"), HasSubstr("absent.geojson")));
    options.buildings.clear();
    write_features("release.geojson", {rectangle(900, 90, 940, 110)});
    EXPECT_THAT(refusal(), HasSubstr("lies outside the terrain"));
}

TEST_F(NewSceneTest, AFolderThatCannotBeMadeIsNamed) {
    write("file", "");
    options.folder = folder / "file" / "valley";
    const auto scene = write_new_scene(options);
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().message, AllOf(HasSubstr("valley"), HasSubstr("cannot be made")));
}

TEST(ReachableExtent, FollowsTheEnergyLineOverALevelPlain) {
    // A step of 20 m down to a plain: at 45 degrees debris gets 20 m plus its thickness of 1 m away from the edge.
    Grid<float> elevation(GridGeometry{0, 0, 1, 100, 21});
    for (int row = 0; row < 21; ++row) {
        for (int column = 0; column < 100; ++column) elevation.at(column, row) = column < 10 ? 20.0F : 0.0F;
    }
    terrain::Release release;
    release.patches.push_back({{{{5, 5}, {10, 5}, {10, 16}, {5, 16}}, {}}, 1});
    const Extent reach = reachable_extent(terrain::Terrain(elevation), {release}, std::numbers::pi / 4);
    EXPECT_NEAR(reach.x_max, 10 + 20 + 1, 1.01);
    EXPECT_NEAR(reach.x_min, 5 - 1, 1.01);
}

TEST(ReachableExtent, NodataIsNotCrossed) {
    Grid<float> elevation(GridGeometry{0, 0, 1, 100, 5});
    for (int row = 0; row < 5; ++row) {
        for (int column = 0; column < 100; ++column) elevation.at(column, row) = static_cast<float>(100 - column);
        elevation.at(50, row) = std::numeric_limits<float>::quiet_NaN();
    }
    terrain::Release release;
    release.patches.push_back({{{{5, 1}, {10, 1}, {10, 4}, {5, 4}}, {}}, 1});
    EXPECT_EQ(reachable_extent(terrain::Terrain(elevation), {release}, 0.2).x_max, 50);
}

class DescribeScene : public SceneFolder {};

TEST_F(DescribeScene, TellsWhatARunWouldTake) {
    write_valley("[buildings]\nfile = \"houses.geojson\"\n", "volume_m3 = 512");
    write_features("houses.geojson", {rectangle(200, 90, 210, 100)});
    const auto scene = load_scene(folder / "scene.toml", {"solver.particle_spacing_m=0.8"});
    ASSERT_TRUE(scene) << scene.error().message;
    const std::string text = describe_scene(*scene);
    EXPECT_THAT(text, HasSubstr("60 x 40 cells of 5 m, EPSG:2326 (Hong Kong 1980 Grid System)"));
    EXPECT_THAT(text, HasSubstr("\"scarp\": 512 m3, 400 m2 in plan, mean thickness 1.1"));
    EXPECT_THAT(text, HasSubstr("about 1000 with a spacing of 0.8 m (solver.particle_spacing_m)"));
    EXPECT_THAT(text, HasSubstr("map cell    "));
    EXPECT_THAT(text, HasSubstr("buildings   1, 1 with an assumed height"));
    EXPECT_THAT(text, HasSubstr("traced downhill from the release"));
    for (const std::string& note : scene->notes) EXPECT_THAT(text, HasSubstr("  - " + note + "\n"));
}

}  // namespace
}  // namespace talus::scene
