#include "twin/scene_copy.hpp"

#include <gmock/gmock.h>

#include "scene/scene_folder.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class SceneCopyTest : public scene::SceneFolder {
  protected:
    SceneCopyTest() : before_(std::filesystem::current_path()) {
        write("water.csv", "time_s,pore_pressure_ratio\n0,0.1\n60,0.5\n");
        write_valley(
            "pore_pressure_hydrograph = \"water.csv\"\n[solver]\ntarget_particle_count = 300\n"
            "[[trigger]]\nname = \"tilt\"\nrelease = \"scarp\"\npore_pressure_ratio_limit = 0.8\n");
        // As `talus serve scene.toml` has it: its paths are relative.
        std::filesystem::current_path(folder);
        auto loaded = scene::load_scene("scene.toml");
        EXPECT_TRUE(loaded) << (loaded ? "" : loaded.error().message);
        scenario_ = open(*std::move(loaded));
    }
    ~SceneCopyTest() override { std::filesystem::current_path(before_); }

    [[nodiscard]] Result<SceneCopy> copied() const {
        return scene_copy_of(*scenario_)(std::filesystem::absolute("scene.toml"), {});
    }
    std::string draw(double x) {
        return act(*scenario_, {{"action", "put_release"},
                                {"name", "drawn"},
                                {"polygon", ring(west + x, south + 90, west + x + 20, south + 110)},
                                {"thickness_m", 1}})
            .created;
    }

    std::filesystem::path before_;
    std::unique_ptr<Scenario> scenario_;
};

TEST_F(SceneCopyTest, has_whole_paths_of_releases_beside_one_that_was_drawn) {
    act(*scenario_, {{"action", "trigger_release"}, {"id", draw(80)}});
    const auto copy = copied();
    ASSERT_TRUE(copy) << copy.error().message;
    EXPECT_THAT(copy->text, HasSubstr((folder / "release.geojson").string()));
    EXPECT_THAT(copy->text, HasSubstr((folder / "water.csv").string()));
    EXPECT_THAT(copy->text, HasSubstr("drawn.gpkg"));
    EXPECT_THAT(copy->text, HasSubstr("name = \"tilt\""));
    ASSERT_EQ(copy->layers.size(), 1U);
}

TEST_F(SceneCopyTest, leaves_out_triggers_of_what_is_gone) {
    act(*scenario_, {{"action", "trigger_release"}, {"id", draw(80)}});
    act(*scenario_, {{"action", "remove_release"}, {"id", setup_json(*scenario_)["releases"][0]["id"]}});
    const auto copy = copied();
    ASSERT_TRUE(copy) << copy.error().message;
    EXPECT_THAT(copy->text, HasSubstr("Left out: trigger \"tilt\""));
    EXPECT_THAT(copy->text, Not(HasSubstr("name = \"tilt\"")));
}

TEST_F(SceneCopyTest, of_a_setup_without_debris_is_refused) {
    (void)draw(80);
    act(*scenario_, {{"action", "remove_release"}, {"id", setup_json(*scenario_)["releases"][0]["id"]}});
    const auto copy = copied();
    ASSERT_FALSE(copy);
    EXPECT_THAT(copy.error().message, HasSubstr("no release was triggered"));
}

TEST_F(SceneCopyTest, has_the_ratio_of_a_message_in_place_of_water_that_rises) {
    act(*scenario_, {{"action", "trigger"}, {"trigger", "tilt"}, {"values", {{"pore_pressure_ratio", 0.7}}}});
    const auto copy = copied();
    ASSERT_TRUE(copy) << copy.error().message;
    EXPECT_THAT(copy->text, HasSubstr("pore_pressure_ratio = 0.7"));
    EXPECT_THAT(copy->text, Not(HasSubstr("pore_pressure_hydrograph")));
}

}  // namespace
}  // namespace talus::twin::test
