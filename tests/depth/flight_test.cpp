#include <cmath>
#include <numbers>

#include "grids.hpp"
#include "same_bits.hpp"

namespace talus::test {
namespace {

using ProfileFunction = std::function<double(double)>;

constexpr double released_from = 20, released_to = 30;  // m

/// What came past a place, and what happened on the way.
struct Passage {
    double speed = 0;         ///< m/s, by energy and mass
    double energy_gain = 0;   ///< over that of the fall
    double volume_error = 0;  ///< over the volume
    double highest = 0;       ///< m, of flight
};

/// A block without friction, 1 m deep, slides down a profile of `length` m.
Passage slide_past(const ProfileFunction& profile, double length, double probe, double cell, bool flies) {
    const int columns = static_cast<int>(length / cell);
    depth::Solver solver(grid_of(columns, 1, cell, [&](double x, double) { return profile(x); }), {}, {},
                         depth::Edges::continued);
    if (flies) solver.let_fly();
    solver.add(grid_of<float>(columns, 1, cell,
                              [](double x, double) { return x > released_from && x < released_to ? 1 : 0; }));
    const double volume = solver.volume();
    Passage passage;
    double passed = 0, square_passed = 0, start = 0, first_potential = 0, fall = 0;
    while (solver.time() < 20 && !(solver.volume_left() > 0)) {
        EXPECT_TRUE(solver.advance(20).ok());
        double energy = 0, potential = 0, mass = 0;
        for (int c = 0; c < columns; ++c) {
            const double h = solver.depth_at(c, 0), u = solver.u_at(c, 0), height = solver.height_at(c, 0);
            if (!(h > 0)) continue;
            const double w = u * solver.slope_x_at(c, 0) + solver.climb_at(c, 0), square = u * u + w * w;
            mass += h;
            potential += h * gravity * (solver.bed_at(c, 0) + height + h / 2);
            energy += h * square / 2;
            passage.highest = std::max(passage.highest, height);
            if (std::abs((c + 0.5) * cell - probe) > 1) continue;
            passed += h * u * solver.time_step();
            square_passed += h * u * square * solver.time_step();
        }
        energy = (energy + potential) / mass;
        potential /= mass;
        if (start == 0) {
            start = energy;
            first_potential = potential;
        }
        fall = std::max(fall, first_potential - potential);
        passage.energy_gain = std::max(passage.energy_gain, energy - start);
        passage.volume_error =
            std::max(passage.volume_error, std::abs((solver.volume() + solver.volume_left()) / volume - 1));
    }
    passage.energy_gain /= fall;
    passage.speed = std::sqrt(square_passed / passed);
    return passage;
}

constexpr double brow = 100, gentle = 0.3;

/// m/s, of a point mass from the middle of the release at the brow.
double speed_at_brow() {
    return std::sqrt(2 * gravity * gentle * (brow - (released_from + released_to) / 2));
}

TEST(Flight, from_a_cliff_keeps_the_horizontal_velocity_and_loses_the_vertical_one) {
    const ProfileFunction cliff = [](double x) { return -gentle * std::min(x, brow) - (x > brow ? 20 : 0); };
    const double exact = speed_at_brow() / std::hypot(1, gentle);
    for (const double cell : {2.0, 1.0, 0.5}) {
        const Passage passage = slide_past(cliff, 300, 200, cell, true);
        EXPECT_NEAR(passage.speed / exact, 1, 0.02) << "cells of " << cell << " m";
        EXPECT_LE(passage.highest, 20) << "nothing is thrown up";
        EXPECT_LE(passage.energy_gain, 1e-3);
        EXPECT_LE(passage.volume_error, 1e-6);
    }
}

/// Ground that falls by 1.2 below the brow, and by 0.2 from 30 m behind it.
double steep_face(double x) {
    return -gentle * std::min(x, brow) - 1.2 * std::clamp(x - brow, 0.0, 30.0) - 0.2 * std::max(0.0, x - brow - 30);
}

TEST(Flight, loses_the_velocity_normal_to_the_ground_where_debris_lands) {
    // A point mass that flies from the brow, as if the face were no part of its way.
    const double before = speed_at_brow(), u = before / std::hypot(1, gentle);
    const auto above = [&](double x) {
        const double t = (x - brow) / u;
        return -gentle * x - gravity * t * t / 2 - steep_face(x);
    };
    double lands = brow + 1;
    while (above(lands) > 0) lands += 1e-3;
    ASSERT_GT(lands, brow + 31) << "beyond the face";
    const double w = -gentle * u - gravity * (lands - brow) / u, along = (u - 0.2 * w) / std::hypot(1, 0.2);
    const double probe = 200;
    const double exact = std::sqrt(along * along + 2 * gravity * 0.2 * (probe - lands));
    const double energy_line = std::sqrt(before * before + 2 * gravity * (-gentle * brow - steep_face(probe)));
    ASSERT_LT(exact, 0.9 * energy_line);
    for (const double cell : {2.0, 1.0, 0.5}) {
        EXPECT_NEAR(slide_past(steep_face, 400, probe, cell, true).speed / exact, 1, 0.03)
            << "cells of " << cell << " m";
    }
    EXPECT_GT(slide_past(steep_face, 400, probe, 1, false).speed, 1.05 * exact) << "on the ground nothing is lost";
}

TEST(Flight, does_not_begin_where_the_ground_holds_the_debris) {
    // 20 to 30 degrees on an arc of 400 m radius: v^2 / R is 3 m/s2 where the ground's pull is 8.5.
    const ProfileFunction arc = [](double x) {
        const double radius = 400, first = radius * std::sin(20 * std::numbers::pi / 180), last = radius / 2;
        const double on_arc = std::clamp(first + x - 100, first, last), end = 100 + last - first;
        return -std::min(x, 100.0) * std::tan(20 * std::numbers::pi / 180) +
               std::sqrt(radius * radius - on_arc * on_arc) - std::max(0.0, x - end) / std::sqrt(3.0);
    };
    const Passage flies = slide_past(arc, 300, 250, 1, true), follows = slide_past(arc, 300, 250, 1, false);
    EXPECT_EQ(flies.highest, 0);
    EXPECT_EQ(flies.speed, follows.speed);
}

/// Debris that comes down a valley side askew and flies over a step across it.
depth::Solver over_a_step(bool flies) {
    depth::Material material;
    material.friction_coefficient = 0.1;
    depth::Solver solver(grid_of(120, 50, 1,
                                 [](double x, double y) {
                                     return -0.4 * x + 0.02 * std::abs(y - 25) -
                                            10 * std::clamp(x - 45 - y / 5, 0.0, 1.0);
                                 }),
                         material);
    if (flies) solver.let_fly();
    solver.add(grid_of<float>(120, 50, 1, [](double x, double y) { return std::hypot(x - 20, y - 22) < 9 ? 1.5 : 0; }));
    return solver;
}

TEST(Flight, has_the_same_bits_on_any_number_of_threads_and_any_instruction_set) {
    expect_same_bits([] {
        depth::Solver solver = over_a_step(true);
        float highest = 0;
        while (solver.time() < 5 - 1e-9) {
            EXPECT_TRUE(solver.advance(5 - solver.time()).ok());
            for (int c = 0; c < 120; ++c) highest = std::max(highest, solver.height_at(c, 25));
        }
        EXPECT_GT(highest, 2);
        return solver;
    });
}

TEST(Flight, costs_memory_only_where_it_is_wanted) {
    const depth::Solver flies = over_a_step(true), follows = over_a_step(false);
    EXPECT_FALSE(follows.flies());
    EXPECT_TRUE(flies.flies());
    EXPECT_GE(flies.bytes_per_cell(), follows.bytes_per_cell() + 16);
}

TEST(Flight, leaves_a_heap_that_rests_alone) {
    depth::Material material;
    material.friction_coefficient = 0.5;
    const auto heap = grid_of<float>(
        40, 40, 1, [](double x, double y) { return std::max(0.0, 3 - 0.3 * std::hypot(x - 20, y - 20)); });
    depth::Solver solver(grid_of(40, 40, 1, [](double x, double) { return -0.1 * x; }), material);
    solver.let_fly();
    solver.add(heap);
    advance_until(solver, 3);
    EXPECT_TRUE(as_at_start(solver, heap));
}

}  // namespace
}  // namespace talus::test
