#include "validate/point_mass.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace talus::validate {
namespace {

constexpr double point_gravity = 9.80665;

Profile plane(double slope) {
    return [slope](double x) { return ProfilePoint{-std::tan(slope) * x, -std::tan(slope), 0}; };
}

TEST(PointMass, slides_down_a_plane_as_coulomb_says) {
    const double slope = 0.5, friction = 0.3, time = 3;
    PointMass mass(plane(slope), friction, point_gravity, 0, 2);
    mass.advance_to(time);
    const double acceleration = point_gravity * (std::sin(slope) - friction * std::cos(slope));
    EXPECT_NEAR(mass.speed(), 2 + acceleration * time, 1e-6);
    EXPECT_NEAR(mass.x(), (2 * time + acceleration * time * time / 2) * std::cos(slope), 1e-5);
    EXPECT_EQ(mass.landing_loss(), 0);
}

TEST(PointMass, stops_where_friction_exceeds_the_slope_and_stays) {
    PointMass mass(plane(0.2), 0.5, point_gravity, 0, 1);
    mass.advance_to(2);
    const double stopped = mass.x();
    EXPECT_EQ(mass.speed(), 0);
    mass.advance_to(4);
    EXPECT_EQ(mass.x(), stopped);
}

TEST(PointMass, keeps_its_energy_on_waves_that_it_follows_without_friction) {
    const double k = 2 * std::numbers::pi / 20;
    const Profile waves = [k](double x) {
        return ProfilePoint{0.3 * std::sin(k * x), 0.3 * k * std::cos(k * x), -0.3 * k * k * std::sin(k * x)};
    };
    PointMass mass(waves, 0, point_gravity, 0, 8);
    mass.advance_to(5);
    EXPECT_FALSE(mass.flies());
    EXPECT_NEAR(mass.speed() * mass.speed() / 2 + point_gravity * mass.elevation(), 32, 1e-4);
}

TEST(PointMass, friction_in_a_hollow_includes_the_force_that_turns_it) {
    // v falls by f v per radian; the weight takes f g / v per metre besides, 0.01 m/s, and the end is found to 0.1 m/s.
    constexpr double radius = 10, speed = 1000, friction = 0.1;
    const Profile circle = [](double x) {
        const double height = std::sqrt(radius * radius - x * x);
        return ProfilePoint{radius - height, x / height, radius * radius / (height * height * height)};
    };
    const double start = -radius * std::sin(0.5);
    PointMass mass(circle, friction, point_gravity, start, speed);
    double time = 0;
    while (mass.x() < -start) mass.advance_to(time += 1e-5);
    EXPECT_NEAR(mass.speed(), speed * std::exp(-friction), 0.2);
}

TEST(PointMass, flies_over_a_brow_and_loses_the_part_normal_to_the_ground_where_it_lands) {
    // A ledge 5 m high: level, and level below it.
    const Profile ledge = [](double x) {
        if (x < 0) return ProfilePoint{5, 0, 0};
        if (x > 1) return ProfilePoint{0, 0, 0};
        return ProfilePoint{2.5 * (1 + std::cos(std::numbers::pi * x)),
                            -2.5 * std::numbers::pi * std::sin(std::numbers::pi * x),
                            -2.5 * std::numbers::pi * std::numbers::pi * std::cos(std::numbers::pi * x)};
    };
    const double friction = 0.2, speed = 10;
    PointMass mass(ledge, friction, point_gravity, 1e-6, speed);
    mass.advance_to(0.5);
    EXPECT_TRUE(mass.flies());
    const double fall_time = std::sqrt(2 * 5 / point_gravity), blow = point_gravity * fall_time;
    mass.advance_to(fall_time + 0.01);
    EXPECT_FALSE(mass.flies());
    EXPECT_NEAR(mass.speed(), speed - friction * blow - friction * point_gravity * 0.01, 0.05);
    const double after = speed - friction * blow;
    EXPECT_NEAR(mass.landing_loss(), (speed * speed + blow * blow - after * after) / 2, 1);
}

}  // namespace
}  // namespace talus::validate
