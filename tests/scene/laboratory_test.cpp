// A flume in metres of its own, without a reference system.
#include <fstream>

#include <gtest/gtest.h>

#include "matchers.hpp"
#include "scene/check.hpp"
#include "scene/load.hpp"
#include "scene/new_scene.hpp"
#include "scene/output_defaults.hpp"
#include "scene_folder.hpp"

namespace talus::scene {
namespace {

TEST(OutputScale, is_that_of_the_field_from_twenty_metres_on) {
    for (const double length : {20.0, 84.0, 5000.0}) EXPECT_EQ(output_scale(length), 1) << length;
    EXPECT_EQ(output_scale(0), 1) << "no flow path";
}

TEST(OutputScale, falls_with_the_flow_path_in_round_steps) {
    EXPECT_NEAR(output_scale(19.9), 1, 1e-12) << "without a jump";
    EXPECT_NEAR(output_scale(10), 0.5, 1e-12);
    EXPECT_NEAR(output_scale(4), 0.2, 1e-12);
    EXPECT_NEAR(output_scale(2), 0.1, 1e-12);
    EXPECT_NEAR(output_scale(1.91), 0.1, 1e-12);
    EXPECT_NEAR(output_scale(0.5), 0.02, 1e-12);
    EXPECT_EQ(output_scale(1e-6), 0.001) << "the least that a key allows";
}

/// 200 x 30 cells of 2 cm, 30 degrees steep over the first half and level after it.
class Flume : public SceneFolder {
  protected:
    Flume() {
        write("flume.asc", header() + heights());
        write(
            "release.geojson",
            R"({"type": "Polygon", "coordinates": [[[0.1, 0.15], [0.5, 0.15], [0.5, 0.45], [0.1, 0.45], [0.1, 0.15]]]})");
    }
    [[nodiscard]] Scene loaded(const std::string& outputs = "") const {
        write("scene.toml",
              "[terrain]\nfile = \"flume.asc\"\ncrs = \"local\"\n[[release]]\nfile = \"release.geojson\"\n"
              "thickness_m = 0.08\n[outputs]\n" +
                  outputs);
        return SceneFolder::loaded();
    }

  private:
    static std::string header() {
        return "ncols 200\nnrows 30\nxllcorner 0\nyllcorner 0\ncellsize 0.02\nNODATA_value -9999\n";
    }
    static std::string heights() {
        std::string text;
        for (int row = 0; row < 30; ++row) {
            for (int column = 0; column < 200; ++column) {
                text += fmt::format("{:.4f} ", std::max(0.0, 0.577 * (2 - 0.02 * (column + 0.5))));
            }
            text += "\n";
        }
        return text;
    }
};

TEST_F(Flume, works_without_a_reference_system) {
    const Scene scene = loaded();
    EXPECT_TRUE(scene.crs.local);
    EXPECT_NEAR(total_volume(scene), 0.12 * 0.08 / std::cos(std::atan(0.577)), 2e-4);
    EXPECT_THAT(scene.notes, Contains(HasSubstr("taken to be in the terrain's local coordinates")));
    EXPECT_THAT(scene.notes, Contains(AllOf(HasSubstr("terrain: local coordinates"), HasSubstr("results.kml"))));
}

TEST_F(Flume, has_lengths_of_its_size) {
    const Scene scene = loaded();
    ASSERT_FALSE(scene.flow_path.empty());
    const double scale = output_scale(scene.flow_path.length());
    EXPECT_LT(scale, 0.2);
    EXPECT_NEAR(scene.spec.outputs.chainage_interval, scale, 1e-12);
    EXPECT_NEAR(scene.spec.outputs.front_velocity_window, 10 * scale, 1e-12);
    EXPECT_NEAR(scene.spec.outputs.arrival_depth, 0.1 * scale, 1e-12);
    EXPECT_GE(scene.spec.outputs.impact_patch_edge, 0.1) << "the least that the key allows";
    EXPECT_THAT(scene.notes, Contains(HasSubstr("outputs: chainage_interval_m = ")));
    EXPECT_THAT(describe_scene(scene), testing::ContainsRegex("flow path   [0-9]\\.[0-9][0-9] m"));
}

TEST_F(Flume, keeps_the_lengths_that_it_gives) {
    const Scene scene = loaded("chainage_interval_m = 1\narrival_depth_m = 0.1\n");
    EXPECT_EQ(scene.spec.outputs.chainage_interval, 1);
    EXPECT_EQ(scene.spec.outputs.arrival_depth, 0.1);
    EXPECT_THAT(scene.notes, Not(Contains(HasSubstr("chainage_interval_m = "))));
}

TEST_F(Flume, is_a_new_scene) {
    NewSceneOptions options;
    options.dem = path("flume.asc");
    options.release = path("release.geojson");
    options.thickness = 0.08;
    options.folder = folder / "new";
    const auto refused = write_new_scene(options);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("--crs local"));
    options.local = true;
    const auto made = write_new_scene(options);
    ASSERT_TRUE(made) << made.error().message;
    std::ifstream in(made->file);
    EXPECT_THAT(std::string(std::istreambuf_iterator<char>(in), {}), HasSubstr("\ncrs = \"local\"\n"));
    EXPECT_TRUE(load_scene(made->file));
}

TEST_F(Flume, its_field_sized_neighbour_is_as_before) {
    write_valley("");
    const Scene scene = SceneFolder::loaded();
    EXPECT_EQ(scene.spec.outputs.chainage_interval, 1);
    EXPECT_EQ(scene.spec.outputs.arrival_depth, 0.1);
}

}  // namespace
}  // namespace talus::scene
