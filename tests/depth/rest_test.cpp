#include <cmath>

#include "grids.hpp"

namespace talus::test {
namespace {

/// A multiple of 2^-16, as all elevations of these tests: sums of bed and depth are exact.
double whole(double z) {
    return std::round(z * 65536) / 65536;
}
double rough(double x, double y) {
    return whole(6 + 3 * std::sin(x / 5) + 2 * std::cos(y / 3) +
                 (std::fmod(std::floor(x / 8) + std::floor(y / 6), 2) > 0 ? 1.5 : 0));
}

TEST(Rest, keeps_a_lake_on_rough_stepped_ground_to_the_bit) {
    // With islands and a shore, without friction.
    const auto basin = [](double x, double y) {
        return rough(x, y) + (std::max(std::abs(x - 60), std::abs(y - 50)) > 40 ? 20 : 0);
    };
    const auto bed = grid_of(60, 50, 2, basin);
    double lowest = 1e9;
    for (const double z : bed.values) lowest = std::min(lowest, z);
    const double level = lowest + 5.5;
    const auto water =
        grid_of<float>(60, 50, 2, [&](double x, double y) { return std::max(0.0, level - basin(x, y)); });
    depth::Solver solver(bed, {});
    solver.add(water);
    advance_until(solver, 20);
    EXPECT_TRUE(as_at_start(solver, water));
}

TEST(Rest, keeps_a_lake_while_another_moves) {
    // Two basins; in the eastern one a dam breaks.
    const auto basins = [](double x, double y) {
        return std::abs(y - 20) < 15 && std::abs(std::abs(x - 40) - 18) < 15 ? 0.0 : 6.0;
    };
    depth::Solver solver(grid_of(80, 40, 1, basins), {});
    solver.add(grid_of<float>(80, 40, 1, [&](double x, double y) {
        return basins(x, y) > 0 || x > 58 ? 0 : x < 40 ? 3 : 2;
    }));
    advance_until(solver, 1);
    for (int column = 8; column < 36; ++column) EXPECT_EQ(solver.depth_at(column, 20), 3) << column;
    EXPECT_LT(solver.depth_at(57, 20), 1.5);
}

double moved_by(double steepness, double bed_slope) {
    const double friction = 0.5;
    const auto bed = grid_of(100, 100, 1, [&](double x, double) { return bed_slope * x; });
    depth::Material material;
    material.friction_coefficient = friction;
    // On a slope, a cone of debris whose surface is as steep as friction allows where it is steepest.
    const double cone = steepness * (friction - bed_slope);
    const auto debris = grid_of<float>(
        100, 100, 1, [&](double x, double y) { return std::max(0.0, 12 - std::hypot(x - 50, y - 50) * cone); });
    depth::Solver solver(bed, material);
    solver.add(debris);
    advance_until(solver, 5);
    double moved = 0;
    for (int row = 0; row < 100; ++row) {
        for (int column = 0; column < 100; ++column) {
            moved = std::max(moved, std::abs(double{solver.depth_at(column, row)} - debris.at(column, row)));
        }
    }
    return moved;
}

TEST(Rest, keeps_a_heap_below_its_friction_angle_to_the_bit) {
    EXPECT_EQ(moved_by(0.99, 0), 0);
    EXPECT_EQ(moved_by(0.95, 0.2), 0);
}

TEST(Rest, lets_a_heap_above_its_friction_angle_go) {
    EXPECT_GT(moved_by(1.1, 0), 0.1);
}

TEST(Rest, is_kept_by_cohesion) {
    const auto bed = grid_of(60, 20, 1, [](double x, double) { return -0.5 * x; });
    // A sheet yields above c / (rho g sin cos) of vertical depth: 0.1275 m per kPa here.
    const auto runs = [&](double depth) {
        depth::Material material;
        material.cohesion = 4000;
        depth::Solver solver(bed, material);
        solver.add(grid_of<float>(60, 20, 1, [&](double x, double) {
            return depth * std::min(1.0, std::max(0.0, std::min(x - 5, 45 - x) / 20));
        }));
        advance_until(solver, 2);
        return solver.u_at(25, 10) > 0;
    };
    EXPECT_FALSE(runs(0.45));
    EXPECT_TRUE(runs(0.60));
}

TEST(Rest, costs_nothing) {
    const auto bed = grid_of(200, 200, 1, [](double, double) { return 0.0; });
    depth::Material material;
    material.friction_coefficient = 0.5;
    depth::Solver solver(bed, material);
    solver.add(
        grid_of<float>(200, 200, 1, [](double x, double y) { return std::hypot(x - 100, y - 100) < 20 ? 2 : 0; }));
    const double start = solver.volume();
    advance_until(solver, 20);
    const auto before = solver.cell_updates();
    advance_until(solver, 30);
    EXPECT_FALSE(solver.active());
    EXPECT_EQ(solver.cell_updates(), before);
    EXPECT_NEAR(solver.volume() / start, 1, 1e-6);
}

}  // namespace
}  // namespace talus::test
