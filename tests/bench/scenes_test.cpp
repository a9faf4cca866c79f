#include "bench/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/builtin.hpp"
#include "sim/physics/contact.hpp"
#include "support/fixtures.hpp"

namespace talus::bench {
namespace {

class Scenes : public testing::TestWithParam<std::string> {
  protected:
    [[nodiscard]] Result<Start> make(int particles) const {
        return make_start(GetParam(), particles, *scene::unpack_builtin_scene(folder_.path()));
    }
    test::TemporaryFolder folder_;
};

TEST_P(Scenes, has_about_as_many_particles_as_asked_for) {
    for (const int particles : {min_particles, 5000, 20000, 75000}) {
        const Result<Start> start = make(particles);
        ASSERT_TRUE(start) << start.error().message;
        EXPECT_NEAR(start->state.count, particles, 0.02 * particles);
        EXPECT_EQ(start->state.seeded, start->state.count);
    }
}

TEST_P(Scenes, has_all_that_a_run_has) {
    const Result<Start> start = make(5000);
    ASSERT_TRUE(start) << start.error().message;
    EXPECT_EQ(start->scene, GetParam());
    EXPECT_FALSE(start->ground.buildings.empty());
    EXPECT_FALSE(start->ground.solids.empty());
    EXPECT_FALSE(start->flow_path.empty());
    EXPECT_GT(start->model.friction_coefficient, 0);
    EXPECT_GT(start->model.viscosity, 0);
    EXPECT_FALSE(start->model.solver.time_step) << "docs and table say that the step is adaptive";
}

TEST_P(Scenes, debris_lies_freely_on_known_ground_under_its_own_weight) {
    const Result<Start> start = make(5000);
    ASSERT_TRUE(start) << start.error().message;
    const sim::State& state = start->state;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const LocalPoint p = state.position.at(i);
        ASSERT_TRUE(start->ground.terrain.covers(p.x, p.y));
        ASSERT_TRUE(is_free(start->ground, p));
        ASSERT_EQ(state.id[i], i);
    }
    const auto& multiplier = state.multiplier;
    EXPECT_LT(*std::min_element(multiplier.begin(), multiplier.begin() + state.count), 0);
    EXPECT_LE(*std::max_element(multiplier.begin(), multiplier.begin() + state.count), 0);
}

INSTANTIATE_TEST_SUITE_P(All, Scenes, testing::ValuesIn(scene_names()));

TEST(SlabScene, slides_down_its_slope) {
    const Result<Start> start = make_start("slab", 5000, "");
    ASSERT_TRUE(start);
    const LocalPoint v = start->state.velocity.at(0);
    EXPECT_GT(v.x, 2);
    EXPECT_NEAR(v.z / v.x, -std::tan(25 * M_PI / 180), 1e-3);
}

TEST(SlabScene, needs_no_files) {
    EXPECT_TRUE(make_start("slab", 500, "/no/such/scene.toml"));
    EXPECT_TRUE(make_start("column", 500, "/no/such/scene.toml"));
    EXPECT_FALSE(make_start("sham_tseng", 500, "/no/such/scene.toml"));
}

TEST(UnknownScene, is_refused_by_name) {
    const Result<Start> start = make_start("slap", 500, "");
    ASSERT_FALSE(start);
    EXPECT_THAT(start.error().message, testing::HasSubstr("slap"));
    EXPECT_THAT(start.error().message, testing::HasSubstr("sham_tseng"));
}

}  // namespace
}  // namespace talus::bench
