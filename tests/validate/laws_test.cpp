#include "validate/laws.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace talus::validate {
namespace {

constexpr double degrees = std::numbers::pi / 180;
constexpr double gravity = 9.80665;

TEST(ColumnLaws, have_the_values_of_their_papers) {
    EXPECT_NEAR(column_run_out_axisymmetric(1), 1.24, 1e-12);
    EXPECT_NEAR(column_run_out_axisymmetric(4), 3.2, 1e-12);
    EXPECT_NEAR(column_run_out_planar(1), 1.2, 1e-12);
    EXPECT_NEAR(column_run_out_planar(8), 7.6, 1e-12);
    EXPECT_NEAR(column_run_out_planar(4), 4.79, 0.005);
    EXPECT_NEAR(column_heights_axisymmetric(0.5).lube, 0.5, 1e-12);
    EXPECT_NEAR(column_heights_axisymmetric(1).lube, 0.74, 1e-12);
    EXPECT_NEAR(column_heights_axisymmetric(64).lube, 1.76, 1e-12);
    EXPECT_NEAR(column_heights_axisymmetric(64).lajeunesse, 0.74, 1e-12);
    EXPECT_NEAR(column_height_planar(1), 1, 1e-12);
    EXPECT_NEAR(column_height_planar(2), 1.3195, 1e-4);
    EXPECT_NEAR(column_height_planar(0.5), 0.5, 1e-12);
}

TEST(SheetFlow, has_the_velocities_of_its_laws) {
    const SheetFlow sheet{30 * degrees, 2, gravity};
    EXPECT_NEAR(sheet.with_drag(0.2, 500, 0), std::sqrt(1000 * (0.5 - 0.2 * 0.8660254)), 1e-6);
    EXPECT_EQ(sheet.with_drag(0.6, 500, 0), 0);
    // samosAT, of 2 m with a drag of rho v^2 / 100: what it takes is what gravity gives, also where it can stand as
    // well.
    for (const double slope : {30 * degrees, 12 * degrees}) {
        const SheetFlow snow{slope, 2, gravity};
        const double speed = snow.with_samosat(0.155, 0.222, 0.01), normal = 2 * gravity * std::cos(slope);
        const double share = 0.222 / (0.222 + speed * speed / normal);
        EXPECT_NEAR(0.155 * (1 + share) * normal + 0.01 * speed * speed, 2 * gravity * std::sin(slope), 1e-9);
        EXPECT_GT(speed, 4) << "the faster of the two";
    }
    EXPECT_NEAR(sheet.with_samosat(0.2, 0, gravity / 500), sheet.with_drag(0.2, 500, 0), 1e-9);
    EXPECT_EQ(sheet.with_samosat(0.6, 0.222, 0.01), 0);
    // A yield stress of half the weight's pull: the upper half is a plug.
    const double yield = gravity * 0.5, viscosity = 0.3;
    EXPECT_NEAR(sheet.bingham(0.5, yield, viscosity), gravity * 0.5 / 0.3 * (0.5 - 0.125), 1e-9);
    EXPECT_NEAR(sheet.bingham(1, yield, viscosity), gravity * 0.5 / 0.3 * 0.5, 1e-9);
    EXPECT_NEAR(sheet.bingham(2, yield, viscosity), sheet.bingham(1, yield, viscosity), 1e-12);
    EXPECT_EQ(sheet.bingham(2, 3 * gravity, viscosity), 0);
    // mu(I) = tan 30 half way between 0.4 and 0.7547: I = I_0.
    const double fast = 2 * std::tan(30 * degrees) - 0.4;
    EXPECT_NEAR(sheet.bagnold(2, 0.4, fast, 0.3, 0.05, 0.6),
                2.0 / 3 * 6 * std::sqrt(0.6 * gravity * std::cos(30 * degrees)) * std::pow(2, 1.5), 1e-9);
    EXPECT_EQ(sheet.bagnold(0, 0.4, fast, 0.3, 0.05, 0.6), 0);
    EXPECT_TRUE(std::isnan(sheet.bagnold(1, 0.6, 0.9, 0.3, 0.05, 0.6))) << "it stands";
    EXPECT_TRUE(std::isnan(sheet.bagnold(1, 0.2, 0.5, 0.3, 0.05, 0.6))) << "it never gets steady";
}

TEST(DamBreak, is_ritters_without_slope_and_friction) {
    const DamBreak dam(0, 0, 2, gravity);
    const double c = std::sqrt(gravity * 2);
    EXPECT_NEAR(dam.wave_speed(), c, 1e-12);
    EXPECT_NEAR(dam.back(3), -3 * c, 1e-12);
    EXPECT_NEAR(dam.front(3), 6 * c, 1e-12);
    // At the dam's place depth and velocity never change.
    for (const double t : {0.5, 1.0, 7.0}) {
        EXPECT_NEAR(dam.thickness(0, t), 2 * 4.0 / 9, 1e-12);
        EXPECT_NEAR(dam.velocity(0, t), 2.0 / 3 * c, 1e-12);
    }
    EXPECT_EQ(dam.thickness(-3 * c - 1, 3), 2);
    EXPECT_EQ(dam.thickness(6 * c + 1, 3), 0);
}

TEST(DamBreak, on_a_slope_is_ritters_seen_from_a_frame_that_accelerates) {
    const DamBreak slope(22 * degrees, 21 * degrees, 1, gravity);
    const double normal = gravity * std::cos(22 * degrees);
    const double acceleration = normal * (std::tan(22 * degrees) - std::tan(21 * degrees));
    EXPECT_NEAR(acceleration, 0.1834, 1e-4);
    EXPECT_NEAR(slope.wave_speed(), 3.0154, 1e-4);
    EXPECT_NEAR(slope.front(5), acceleration * 12.5 + 10 * slope.wave_speed(), 1e-9);
    EXPECT_NEAR(slope.thickness(acceleration * 12.5, 5), 4.0 / 9, 1e-12);
    EXPECT_NEAR(slope.velocity(slope.back(5), 5), acceleration * 5, 1e-9);
}

TEST(DamBreak, conserves_volume) {
    const DamBreak dam(22 * degrees, 21 * degrees, 1, gravity);
    const double time = 5, moved = dam.back(time) + dam.wave_speed() * time;  // of what is not disturbed
    double volume = 0;
    const double step = 1e-3;
    for (double x = dam.back(time) + step / 2; x < dam.front(time); x += step) volume += dam.thickness(x, time) * step;
    EXPECT_NEAR(volume, moved - dam.back(time), 1e-3);
}

TEST(SpreadingCap, starts_as_it_was_and_conserves_volume) {
    const SpreadingCap cap(35 * degrees, 25 * degrees, 80, 4, gravity, 6);
    EXPECT_NEAR(cap.thickness(0, 0, 0), 4, 1e-9);
    EXPECT_NEAR(cap.thickness(40, 0, 0), 3, 1e-9);
    EXPECT_EQ(cap.thickness(81, 0, 0), 0);
    EXPECT_EQ(cap.travelled(0), 0);
    const double start = std::numbers::pi / 2 * 80 * 80 * 4;
    for (const double time : {1.0, 5.0}) {
        const double top = cap.thickness(cap.travelled(time), 0, time);
        EXPECT_NEAR(std::numbers::pi / 2 * cap.half_length(time) * cap.half_width(time) * top, start, 1e-6 * start);
    }
}

TEST(SpreadingCap, slides_by_the_law_of_coulomb_and_spreads_more_along_than_across) {
    const SpreadingCap cap(35 * degrees, 25 * degrees, 80, 4, gravity, 6);
    const double acceleration = gravity * (std::sin(35 * degrees) - std::cos(35 * degrees) * std::tan(25 * degrees));
    EXPECT_NEAR(cap.travelled(5), acceleration * 12.5, 1e-9);
    EXPECT_GT(cap.half_length(5), cap.half_width(5));
    EXPECT_GT(cap.half_width(5), 80);
    // To second order in time each side moves by B g t^2 / L and, sideways, by the share E of it.
    const double grown = 0.05 * std::cos(35 * degrees) * gravity / 80;  // B g / L
    EXPECT_NEAR(cap.half_length(0.2) / 80 - 1, grown * 0.04, 1e-4 * grown);
}

TEST(SpreadingCap, without_friction_spreads_alike_in_all_directions) {
    const SpreadingCap cap(35 * degrees, 0, 80, 4, gravity, 6);
    EXPECT_NEAR(cap.half_length(5), cap.half_width(5), 1e-6);
}

TEST(MomentumJump, solves_its_equation) {
    EXPECT_NEAR(momentum_jump(0), 1, 1e-6);
    EXPECT_NEAR(momentum_jump(1), 2.170, 1e-3);
    for (const double froude : {0.5, 2.0, 6.0}) {
        const double x = momentum_jump(froude);
        EXPECT_NEAR((x - 1) * (x * x - 1), 2 * froude * froude * x, 1e-9 * x * x * x);
        EXPECT_GT(x, 1);
    }
}

}  // namespace
}  // namespace talus::validate
