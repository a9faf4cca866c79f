#include "depth/inflow.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "grids.hpp"

namespace talus::depth {
namespace {

/// A plane that falls to the east.
Grid<double> plane(int columns, int rows, double cell, double slope) {
    Grid<double> bed({100, 200, cell, columns, rows});
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) bed.at(column, row) = 500 - column * cell * slope;
    }
    return bed;
}

/// Across the rows of a grid, towards the east.
terrain::Inflow across(const GridGeometry& g, double chainage, std::vector<params::InflowSample> hydrograph) {
    terrain::Inflow inflow;
    inflow.from = {g.x_min + chainage, g.y_min};
    inflow.to = {g.x_min + chainage, g.y_min + g.rows * g.cell};
    inflow.hydrograph = std::move(hydrograph);
    return inflow;
}

double run(Solver& solver, Inflows& inflows, double end) {
    Grid<float> added(solver.geometry());
    double volume = 0;
    while (solver.time() < end - 1e-9) {
        const Result<double> came = inflows.advance(solver, end - solver.time(), added);
        EXPECT_TRUE(came);
        volume += came ? *came : 0;
    }
    double of_cells = 0;
    for (const float depth : added.values) of_cells += depth;
    EXPECT_NEAR(of_cells * solver.geometry().cell * solver.geometry().cell, volume, 1e-4 * volume);
    return volume;
}

TEST(Inflow, brings_the_volume_of_its_hydrograph) {
    const Grid<double> bed = plane(80, 20, 2, 0.3);
    Material material;
    material.friction_coefficient = 0.2;
    Solver solver(bed, material);
    const terrain::Inflow inflow = across(bed.geometry, 11, {{1, 0, 2}, {3, 90, 4}, {5.5, 10, 3}});
    Inflows inflows(solver, {inflow});
    const double volume = run(solver, inflows, 7);
    EXPECT_FALSE(inflows.to_come());
    // What rounding of depths keeps back: half of a float's spacing in each of the 20 cells of the line.
    EXPECT_NEAR(volume, inflow.volume(), 20 * 4 * 1e-7);
    EXPECT_NEAR(solver.volume() + solver.volume_left(), volume, 2e-6 * volume);
}

TEST(Inflow, stays_as_thick_and_fast_as_it_comes_where_friction_balances_gravity) {
    const double slope = std::tan(25 * std::numbers::pi / 180), cosine = std::cos(std::atan(slope));
    Material material;
    material.friction_coefficient = slope;
    const double thickness = 0.6, time = 4;
    // Also against what lies in front, at 1.3 times the speed of its waves, and on cells of a sixth of its depth.
    for (const double velocity : {6.0, 3.0}) {
        for (const double cell : {0.5, 0.1}) {
            const Grid<double> bed = plane(static_cast<int>(40 / cell), 4, cell, slope);
            Solver solver(bed, material, {}, Edges::continued);
            const double discharge = thickness * velocity * 4 * cell;
            Inflows inflows(solver, {across(bed.geometry, 5, {{0, discharge, velocity}, {9, discharge, velocity}})});
            run(solver, inflows, time);
            EXPECT_LT(solver.steps(), 3 * time * 15 / cell);
            const double wave = std::sqrt(test::gravity * cosine * thickness);
            const int first = static_cast<int>(5 / cell) + 3,
                      last = static_cast<int>((5 + 0.6 * (velocity - wave) * cosine * time) / cell);
            for (int column = first; column < last; ++column) {  // the front is not heard of there
                EXPECT_NEAR(solver.depth_at(column, 2) * cosine, thickness, 0.002 * thickness) << cell << ' ' << column;
                EXPECT_NEAR(solver.u_at(column, 2) / cosine, velocity, 0.002 * velocity) << cell << ' ' << column;
            }
        }
    }
}

TEST(Inflow, across_the_cells_goes_on_straight) {
    const Grid<double> bed = plane(80, 80, 0.5, 0);
    Solver solver(bed, {});
    terrain::Inflow inflow;
    inflow.from = {113, 206};
    inflow.to = {105, 222};
    const double width = std::hypot(8, 16), thickness = 0.4, velocity = 6;
    inflow.hydrograph = {{0, thickness * velocity * width, velocity}, {3, thickness * velocity * width, velocity}};
    Inflows inflows(solver, {inflow});
    const double volume = run(solver, inflows, 2);
    double east = 0, north = 0, back = 0;
    for (int row = 0; row < 80; ++row) {
        for (int column = 0; column < 80; ++column) {
            const double h = solver.depth_at(column, row);
            east += h * solver.u_at(column, row) * 0.25;
            north += h * solver.v_at(column, row) * 0.25;
            const PlanPoint p = bed.geometry.centre(column, row);
            if ((p.x - 105) * 16 + (p.y - 222) * 8 < -12) back += h * 0.25;
        }
    }
    // The momentum that it brings, and the push of the stream behind the line, in the direction across it.
    const double push = 2 * width * test::gravity * thickness * thickness / 2;
    EXPECT_NEAR(std::hypot(east, north), volume * velocity + push, 0.01 * volume * velocity);
    EXPECT_NEAR(std::atan2(north, east), std::atan2(8, 16), 0.01);
    EXPECT_LT(back, 1e-6 * volume);
}

TEST(Inflow, tends_to_the_normal_depth_of_voellmys_law) {
    const double slope = 0.3, angle = std::atan(slope), xi = 400, friction = 0.1;
    const Grid<double> bed = plane(300, 4, 1, slope);
    Material material;
    material.friction_coefficient = friction;
    material.laws.turbulent_friction = xi;
    Solver solver(bed, material, {}, Edges::continued);
    const double per_width = 3, drive = std::sin(angle) - friction * std::cos(angle);
    const double normal_depth = std::cbrt(per_width * per_width / (xi * drive)),
                 normal_velocity = per_width / normal_depth;
    // In at half of that velocity.
    Inflows inflows(solver,
                    {across(bed.geometry, 5,
                            {{0, 4 * per_width, normal_velocity / 2}, {100, 4 * per_width, normal_velocity / 2}})});
    run(solver, inflows, 60);
    for (int column = 150; column < 250; ++column) {
        EXPECT_NEAR(solver.depth_at(column, 1) * std::cos(angle), normal_depth, 0.01 * normal_depth) << column;
        EXPECT_NEAR(solver.u_at(column, 1) / std::cos(angle), normal_velocity, 0.01 * normal_velocity) << column;
    }
    EXPECT_LT(test::gravity * std::cos(angle) * normal_depth, normal_velocity * normal_velocity)
        << "no influence from below";
}

TEST(Inflow, over_an_area_comes_evenly_down_the_slope_or_where_it_is_told) {
    const Grid<double> bed = plane(20, 20, 2, 0.2);
    const auto after_a_step = [&](std::optional<double> direction) {
        Solver solver(bed, {});
        terrain::Inflow inflow;
        inflow.area = {Polygon{{{110, 210}, {117, 210}, {117, 218}, {110, 218}}, {}}};
        inflow.spec.direction = direction;
        inflow.hydrograph = {{0, 56, 3}, {10, 56, 3}};
        Inflows inflows(solver, {inflow});
        Grid<float> added(bed.geometry);
        const Result<double> came = inflows.advance(solver, 0.1, added);
        EXPECT_TRUE(came);
        EXPECT_NEAR(came ? *came : 0, 5.6, 1e-5);
        return solver;
    };
    const Solver down = after_a_step({}), north = after_a_step(0);
    EXPECT_NEAR(down.depth_at(5, 5), 0.1, 1e-6);
    EXPECT_NEAR(down.depth_at(8, 8), 0.05, 1e-6) << "half a cell";
    EXPECT_EQ(down.depth_at(9, 5), 0);
    EXPECT_NEAR(down.u_at(5, 5), 3 / std::sqrt(1.04), 1e-5);
    EXPECT_EQ(down.v_at(5, 5), 0);
    EXPECT_NEAR(north.v_at(5, 5), 3, 1e-5);
}

}  // namespace
}  // namespace talus::depth
