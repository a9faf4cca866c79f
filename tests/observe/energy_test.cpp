#include "observe/energy.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace talus::observe {
namespace {

constexpr double standard_gravity = 9.80665;

/// A slope from 100 m down to 0 in ten cells of 10 m, and the peak speed of each.
struct Slope {
    Slope() : ground(geometry) {
        for (int column = 0; column < 10; ++column) ground.at(column, 0) = static_cast<float>(95 - 10 * column);
        maps.peak_speed = Grid<float>(geometry);
    }
    GridGeometry geometry{0, 0, 10, 10, 1};
    Grid<float> ground;
    HazardMaps maps;
};

TimeSample row(double time, double kinetic, double potential) {
    TimeSample sample;
    sample.time = time;
    sample.kinetic_energy = kinetic;
    sample.potential_energy = potential;
    return sample;
}

TEST(Energy, of_free_fall_is_within_its_limits_and_of_more_is_not) {
    Slope slope;
    EnergyAccount account(standard_gravity);
    account.bring(1000, 1000 * standard_gravity * 96, 97, 2);  // 2 m thick on the uppermost cell
    for (int column = 0; column < 10; ++column) {
        slope.maps.peak_speed.at(column, 0) =
            static_cast<float>(std::sqrt(2 * standard_gravity * (97 - slope.ground.at(column, 0))));
    }
    const Energy fall = account.measure(slope.maps, slope.ground, 0);
    EXPECT_TRUE(fall.within_limits());
    EXPECT_EQ(fall.cells, 10);
    EXPECT_EQ(fall.cells_above, 0);
    EXPECT_GT(fall.share, 0.85) << "a slope's next cell is lower";
    EXPECT_LE(fall.share, 1);

    slope.maps.peak_speed.at(6, 0) = 60;
    const Energy spike = account.measure(slope.maps, slope.ground, 0);
    EXPECT_FALSE(spike.within_limits());
    EXPECT_EQ(spike.cells_above, 1);
    EXPECT_EQ(spike.at.x, 65);
    EXPECT_EQ(spike.speed, 60);
    EXPECT_EQ(spike.fall, 97 - 25) << "to the lowest of the neighbours";
    EXPECT_NEAR(spike.allowed_speed, std::sqrt(2 * standard_gravity * (72 + 2)), 1e-9);
    EXPECT_NEAR(spike.share, 60 * 60 / (2 * standard_gravity * 74), 1e-9);
}

TEST(Energy, lets_a_front_over_level_ground_run_twice_as_fast_as_its_waves) {
    Slope level;
    for (float& height : level.ground.values) height = 0;
    EnergyAccount account(standard_gravity);
    account.bring(1000, 1000 * standard_gravity * 0.5, 1, 1);
    level.maps.peak_speed.at(9, 0) = static_cast<float>(2 * std::sqrt(standard_gravity * 1));  // Ritter 1892
    EXPECT_NEAR(account.measure(level.maps, level.ground, 0).share, 1, 1e-6);
    level.maps.peak_speed.at(9, 0) = static_cast<float>(2.2 * std::sqrt(standard_gravity * 1));
    EXPECT_FALSE(account.measure(level.maps, level.ground, 0).within_limits());
}

TEST(Energy, counts_the_head_of_inflow) {
    Slope slope;
    EnergyAccount account(standard_gravity);
    account.bring(1000, 1000 * standard_gravity * 50, 50, 0);
    slope.maps.peak_speed.at(8, 0) = 40;
    EXPECT_FALSE(account.measure(slope.maps, slope.ground, 0).within_limits());
    account.bring(1000, 1000 * standard_gravity * 130, 130, 0);  // 40 m/s at 50 m
    EXPECT_TRUE(account.measure(slope.maps, slope.ground, 0).within_limits());
}

TEST(Energy, that_debris_gains_is_told_with_its_time) {
    Slope slope;
    const double start = 1000 * standard_gravity * 96;
    EnergyAccount account(standard_gravity);
    account.bring(1000, start, 97, 2);
    account.add(row(0, 0, start), 1000, 2000);
    account.add(row(1, 0.3 * start, 0.6 * start), 1000, 2000);
    EXPECT_EQ(account.measure(slope.maps, slope.ground, 0).gained, 0);
    account.add(row(2, 0.7 * start, 0.4 * start), 1000, 2000);
    account.add(row(3, 0.5 * start, 0.4 * start), 1000, 2000);
    const Energy made = account.measure(slope.maps, slope.ground, 0);
    EXPECT_NEAR(made.gained, 0.1 * 96 / (96 - 5), 1e-9) << "of the fall to the lowest cell that was reached";
    EXPECT_EQ(made.gained_time, 2);
    EXPECT_FALSE(made.within_limits());
}

TEST(Energy, that_inflow_and_the_bed_bring_is_not_gained) {
    Slope slope;
    const double start = 1000 * standard_gravity * 96;
    EnergyAccount account(standard_gravity);
    account.bring(1000, start, 97, 2);
    account.add(row(0, 0, start), 1000, 2000);
    account.bring(500, 500 * standard_gravity * 96, 97, 0);
    account.add(row(1, 0, 1.5 * start), 1500, 2000);
    TimeSample entrained = row(2, 0, 2 * start);
    entrained.volume_entrained = 0.25;  // 500 kg
    account.add(entrained, 2000, 2000);
    EXPECT_NEAR(account.measure(slope.maps, slope.ground, 0).gained, 0, 1e-9);
}

TEST(Energy, of_a_changed_setup_begins_with_what_is_there) {
    Slope slope;
    const double start = 1000 * standard_gravity * 96;
    EnergyAccount account(standard_gravity);
    account.bring(1000, start, 97, 2);
    account.add(row(0, 0, start), 1000, 2000);
    account.follow(row(1, 0.1 * start, 2.5 * start), 2600);
    account.add(row(2, 0.6 * start, 2 * start), 2600, 2000);
    EXPECT_NEAR(account.measure(slope.maps, slope.ground, 0).gained, 0, 1e-9);
}

TEST(Energy, is_not_known_where_debris_reached_nothing) {
    EnergyAccount account(standard_gravity);
    EXPECT_FALSE(account.measure({}, {}, 0).known());
    Slope slope;
    account.bring(1000, 1000 * standard_gravity * 96, 97, 2);
    for (float& height : slope.ground.values) height = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(account.measure(slope.maps, slope.ground, 0).known());
}

}  // namespace
}  // namespace talus::observe
