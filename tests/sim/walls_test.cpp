// What particles near walls are spared must change nothing.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "sim/cpu/work.hpp"
#include "sim/physics/net.hpp"
#include "sim_fixtures.hpp"

namespace talus::sim::cpu {
namespace {

/// Two houses, one built on to the other, on level ground, and particles around them that are displaced and shifted.
class BesideWalls : public ::testing::Test {
  protected:
    static constexpr std::size_t count = 4000;
    static constexpr double spacing = 0.4;

    BesideWalls() {
        std::vector<terrain::Building> buildings(2);
        buildings[0].footprint = {testing::rectangle(18, 18, 22, 21)};
        buildings[0].height = 3;
        buildings[1].footprint = {testing::rectangle(22, 18.5, 24, 20)};
        buildings[1].height = 1.5;
        const terrain::Terrain terrain = testing::terrain_of(40, 40, 1, [](double, double) { return 10.0; });
        place_buildings(terrain, buildings);
        ground_ = Ground(terrain, buildings, model_.support_radius);
        const LocalPoint low = terrain.frame().to_local({16.8, 16.8, 9.9});
        const LocalPoint high = terrain.frame().to_local({25.2, 22.2, 13.5});
        state_ = testing::state_of(testing::random_points(count, low, high, 1));
        displacements_ = testing::random_points(count, {-0.25F, -0.25F, -0.25F}, {0.25F, 0.25F, 0.25F}, 2);
        shifts_ = testing::random_points(count, {-0.05F, -0.05F, -0.05F}, {0.05F, 0.05F, 0.05F}, 3);
        corrections_ = testing::random_points(count, {-0.1F, -0.1F, -0.1F}, {0.1F, 0.1F, 0.1F}, 4);
    }

    [[nodiscard]] Vec3<float> end_of(std::uint32_t i) const { return state_.position.at(i) + displacements_[i]; }
    /// As the stages do it: walls sampled where a step is expected to lead, then overlaps undone where it does.
    Vec3<float> overlap_undone(std::uint32_t i) {
        const auto max_shift = static_cast<float>(spacing / 4);
        const Vec3<float> expected = end_of(i) + corrections_[i], end = end_of(i);
        work_.wall_place.set(i, expected);
        work_.wall_distance[i] = static_cast<float>(ground_.solids.range());
        if (ground_.solids.near(expected.x, expected.y)) {
            sample_walls(model_, ground_, state_, work_, i, sample_ground(model_, ground_.terrain, expected), expected,
                         displacements_[i] + corrections_[i]);
        }
        const auto below = ground_.terrain.sample(end.x, end.y);
        const float overlap = static_cast<float>(model_.contact_distance()) - (end.z - below.height) * below.normal.z;
        return undo_overlap_near_walls(model_, ground_, state_, work_, i, end, max_shift,
                                       below.normal * std::max(0.0F, std::min(overlap, max_shift)));
    }

    Model model_ = make_model({}, {}, spacing);
    Ground ground_;
    State state_;
    Work work_{count};
    std::vector<LocalPoint> displacements_, shifts_, corrections_;
};

TEST_F(BesideWalls, overlaps_are_undone_as_if_walls_were_sampled_again) {
    int touching = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3<float> end = end_of(i), shift = overlap_undone(i);
        const auto all = undo_overlap(model_, ground_, end, static_cast<float>(spacing / 4));
        ASSERT_EQ(shift.x, all.x) << i;
        ASSERT_EQ(shift.y, all.y) << i;
        ASSERT_EQ(shift.z, all.z) << i;
        const auto wall = ground_.solids.nearest(end);
        touching += wall.building >= 0 && wall.distance < static_cast<float>(model_.contact_distance()) ? 1 : 0;
    }
    EXPECT_GT(touching, 100);
}

TEST_F(BesideWalls, what_is_not_swept_would_be_free) {
    int clear = 0, near = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3<float> start = state_.position.at(i), displacement = displacements_[i], end = end_of(i);
        if (!is_free(ground_, start)) continue;
        overlap_undone(i);
        work_.shift.set(i, shifts_[i]);
        work_.displaced[i].v = {end.x, end.y, end.z, 0, displacement.x, displacement.y, displacement.z, 0};
        near += ground_.solids.near(end.x, end.y) ? 1 : 0;
        if (!sweeps_clear_of_walls(model_, state_, work_, i)) continue;
        clear += ground_.solids.near(end.x, end.y) ? 1 : 0;
        const int parts = sweep_parts(length(displacement), static_cast<float>(spacing / 4));
        for (int part = 1; part <= parts; ++part) {
            const float share = static_cast<float>(part) / static_cast<float>(parts);
            ASSERT_FALSE(ground_.solids.inside(part == parts ? end : start + displacement * share)) << i;
        }
        ASSERT_FALSE(ground_.solids.inside(end + shifts_[i])) << i;
    }
    EXPECT_GT(clear, near / 3) << "most of the work is spared";
    EXPECT_LT(clear, near) << "or nothing came near a wall";
}

}  // namespace
}  // namespace talus::sim::cpu
