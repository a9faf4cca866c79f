#include "validate/measure.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "sim/sources/seed.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace {

TEST(ErrorNorms, are_those_computed_by_hand) {
    const ErrorNorms norms = error_norms({3, 1, 0}, {4, 3, 0});
    EXPECT_NEAR(norms.relative_l2, std::sqrt(1 + 4) / 5, 1e-12);
    EXPECT_NEAR(norms.relative_max, 0.5, 1e-12);
    EXPECT_EQ(error_norms({4, 3, 0}, {4, 3, 0}).relative_l2, 0);
    EXPECT_EQ(error_norms({0, 0}, {1, 2}).relative_l2, 1) << "nothing there at all is an error of one";
}

TEST(Percentile, interpolates_between_values) {
    EXPECT_EQ(percentile({5, 1, 3}, 0), 1);
    EXPECT_EQ(percentile({5, 1, 3}, 0.5), 3);
    EXPECT_EQ(percentile({5, 1, 3}, 0.75), 4);
    EXPECT_EQ(percentile({5, 1, 3}, 1), 5);
    EXPECT_TRUE(std::isnan(percentile({}, 0.5)));
}

TEST(EdgeOf, is_where_the_profile_falls_below_for_good) {
    EXPECT_DOUBLE_EQ(edge_of({4, 3, 2, 1, 0, 0}, 2, 0.5), 2 * 4.0);        // halfway between two middles
    EXPECT_DOUBLE_EQ(edge_of({4, 0, 0, 1, 0.2, 0.1}, 1, 0.6), 3.5 + 0.5);  // a gap behind the edge is no edge
    EXPECT_EQ(edge_of({0, 0}, 1, 0.5), 0);
    EXPECT_EQ(edge_of({1, 1}, 1, 0.5), 0) << "the profile ends before the deposit";
}

TEST(TimeMean, is_that_of_readings_with_straight_lines_between) {
    const std::vector<double> times{0, 1, 2, 4}, readings{0, 2, 2, 0};
    EXPECT_DOUBLE_EQ(time_mean(times, readings, 0, 1), 1);
    EXPECT_DOUBLE_EQ(time_mean(times, readings, 0.5, 1.5), (0.75 + 1) / 1);
    EXPECT_DOUBLE_EQ(time_mean(times, readings, 0, 4), (1 + 2 + 2) / 4.0);
    EXPECT_TRUE(std::isnan(time_mean(times, readings, 3, 5))) << "the run was over";
    EXPECT_TRUE(std::isnan(time_mean({}, {}, 0, 1)));
}

TEST(FirstTime, is_where_a_line_between_readings_reaches_the_value) {
    EXPECT_DOUBLE_EQ(first_time_of({0, 1, 2}, {0, 0, 4}, 1), 1.25);
    EXPECT_DOUBLE_EQ(first_time_of({0, 1, 2, 3}, {0, 4, 0, 4}, 2), 0.5);
    EXPECT_EQ(first_time_of({3, 4}, {2, 0}, 1), 3);
    EXPECT_TRUE(std::isnan(first_time_of({0, 1}, {0, 1}, 2)));
}

/// A box of particles on an incline: what is put in must be read off again.
class Box : public testing::Test {
  protected:
    Incline incline_{0.4, 40, 10};
    std::vector<LocalPoint> points_ = fill_lattice(incline_, 0.5, -3, 12, -1, 4, [](double, double) { return 2.0; });
    sim::Model model_ = sim::make_model({}, {}, 0.5);
    sim::State state_ = state_at_rest(points_);
};

TEST_F(Box, has_the_volume_that_was_asked_for) {
    EXPECT_EQ(points_.size(), 12U * 4 * 4);
    for (const LocalPoint& p : points_) {
        const terrain::GroundSample<float> ground = incline_.terrain().sample(p.x, p.y);
        EXPECT_NEAR(incline_.normal(p), (p.z - ground.height) * ground.normal.z, 1e-4);
        EXPECT_GT(incline_.normal(p), 0.249);
        EXPECT_LT(incline_.normal(p), 1.751);
        EXPECT_LT(std::abs(incline_.along(p)), 2.751);
    }
}

TEST_F(Box, has_its_thickness_in_every_cell) {
    const auto thickness =
        thickness_profile(model_, state_, -4, 1, 8, 2, [&](std::uint32_t i) { return incline_.along(points_[i]); });
    const std::vector<double> expected = {0, 2, 2, 2, 2, 2, 2, 0};
    ASSERT_EQ(thickness.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(thickness[k], expected[k], 1e-9) << k;
}

TEST_F(Box, under_its_weight_presses_as_deep_as_it_lies) {
    params::MaterialSpec smooth;
    smooth.building_friction_coefficient = 0;
    const auto walls = make_slice(incline_.terrain(), 2, 3);
    const sim::Model slice = sim::make_model(smooth, {}, 0.5);
    const sim::Ground ground(incline_.terrain(), walls, slice.support_radius);
    const sim::State loaded = state_under_weight(slice, ground, points_, incline_, [](double, double) { return 2.0; });
    ASSERT_EQ(loaded.count, state_.count);
    std::vector<double> by_layer(4, 0.0);
    for (std::uint32_t i = 0; i < loaded.count; ++i) {
        const LocalPoint p = points_[loaded.id[i]];
        EXPECT_EQ(length(loaded.position.at(i) - p), 0) << "it must not have moved";
        EXPECT_EQ(length(loaded.velocity.at(i)), 0);
        if (std::abs(incline_.along(p)) > 1) continue;  // the ends stand free
        const double steps = loaded.previous_time_step * loaded.previous_time_step;
        by_layer[static_cast<std::size_t>(incline_.normal(p) / 0.5)] -= loaded.multiplier[i] / steps / 16;
    }
    for (std::size_t k = 0; k < 3; ++k) EXPECT_GT(by_layer[k], by_layer[k + 1]) << k;
    const double weight = slice.gravity * std::cos(0.4) * 1.75;  // above the middle of the lowest layer
    EXPECT_NEAR(by_layer[0], weight, 0.2 * weight);
    EXPECT_EQ(loaded.time, 0);
}

TEST(FillLattice, rounds_so_that_the_volume_is_right) {
    const Incline flat(0, 60, 60);
    const auto points = fill_lattice(flat, 0.5, -20, 80, -20, 80, [](double, double) { return 0.8; });
    EXPECT_NEAR(static_cast<double>(points.size()) * 0.125, 0.8 * 40 * 40, 0.01 * 0.8 * 40 * 40);
}

TEST(TopOf, does_not_follow_one_particle_that_lies_on_top) {
    const Incline flat(0, 20, 20);
    const sim::Model model = sim::make_model({}, {}, 0.5);
    std::vector<LocalPoint> points = fill_lattice(flat, 0.5, -2, 8, -2, 8, [](double, double) { return 2.0; });
    EXPECT_NEAR(top_of(model, state_at_rest(points)), 2, 1e-6);
    points.push_back(flat.point(0, 0, 2.25));
    EXPECT_NEAR(top_of(model, state_at_rest(points)), 2.1, 1e-6);
}

TEST(Slice, is_open_between_its_walls_only) {
    const Incline incline(0.3, 20, 6);
    const sim::Model model = sim::make_model({}, {}, 0.5);
    const sim::Ground ground(incline.terrain(), make_slice(incline.terrain(), 2, 1), model.support_radius);
    EXPECT_FALSE(ground.solids.inside(incline.point(-8, 0.9, 0.5)));
    EXPECT_TRUE(ground.solids.inside(incline.point(-8, 1.1, 0.5)));
    EXPECT_TRUE(ground.solids.inside(incline.point(8, -1.1, 0.5)));
}

}  // namespace
}  // namespace talus::validate
