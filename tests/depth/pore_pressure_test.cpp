#include <cmath>

#include "depth/entrainment.hpp"
#include "depth/inflow.hpp"
#include "grids.hpp"
#include "same_bits.hpp"

namespace talus::test {
namespace {

constexpr double decay_time = 2;

depth::Material draining(double ratio = 0.6) {
    depth::Material material;
    material.friction_coefficient = 0.4;
    material.pore_pressure_ratio = ratio;
    material.pore_pressure_decay_time = decay_time;
    return material;
}

/// Speed in the middle of a sheet that is added at `start`, 1 s later, m/s.
double speed_after_a_second(double start) {
    const double slope = 0.4, s = std::tan(slope);
    depth::Solver solver(grid_of(160, 1, 1, [&](double x, double) { return -s * x; }), draining(), {},
                         depth::Edges::continued);
    advance_until(solver, start);
    solver.add(grid_of<float>(160, 1, 1, [&](double, double) { return 1 / std::cos(slope); }));
    advance_until(solver, start + 1);
    return std::hypot(solver.u_at(80, 0), s * solver.u_at(80, 0));
}

TEST(PorePressure, decays_from_when_debris_is_added) {
    // mu (1 - r exp(-t / T)), integrated.
    const double relief = 0.6 * decay_time * (1 - std::exp(-1 / decay_time));
    const double exact = gravity * (std::sin(0.4) - 0.4 * std::cos(0.4) * (1 - relief));
    EXPECT_NEAR(speed_after_a_second(0), exact, 0.01 * exact);
    EXPECT_NEAR(speed_after_a_second(60), exact, 0.01 * exact);
    EXPECT_NEAR(speed_after_a_second(1000), exact, 0.01 * exact) << "500 times as late as it takes to drain";
}

/// Two releases with pore pressures of their own that run into each other in a valley.
depth::Solver two_in_a_valley(const depth::Material& material, double first = 0.8, double second = 0.2) {
    depth::Solver solver(
        grid_of(100, 60, 1, [](double x, double y) { return 0.3 * std::abs(x - 50) + 0.3 * std::abs(y - 30); }),
        material);
    const auto heap = [](double x_0) {
        return grid_of<float>(100, 60, 1, [&](double x, double y) { return std::hypot(x - x_0, y - 30) < 9 ? 2 : 0; });
    };
    solver.add(heap(30), first);
    solver.add(heap(70), second);
    return solver;
}

/// Sum of depth times r_u, m.
double water_pressure(const depth::Solver& solver) {
    double sum = 0;
    for (int row = 0; row < solver.geometry().rows; ++row) {
        for (int column = 0; column < solver.geometry().columns; ++column) {
            sum += double{solver.depth_at(column, row)} * double{solver.pore_pressure_ratio_at(column, row)};
        }
    }
    return sum;
}

TEST(PorePressure, goes_with_the_mass_and_stays_between_the_values_that_mix) {
    depth::Material material;
    material.friction_coefficient = 0.2;
    depth::Solver solver = two_in_a_valley(material);
    const double before = water_pressure(solver);
    int mixed = 0;
    for (int k = 0; k < 60; ++k) {
        advance_until(solver, 0.1 * (k + 1));
        mixed = 0;
        for (int row = 0; row < 60; ++row) {
            for (int column = 0; column < 100; ++column) {
                if (!(solver.depth_at(column, row) > 0)) continue;
                const float ratio = solver.pore_pressure_ratio_at(column, row);
                ASSERT_GE(ratio, 0.2F) << column << ", " << row;
                ASSERT_LE(ratio, 0.8F) << column << ", " << row;
                mixed += ratio > 0.3F && ratio < 0.7F ? 1 : 0;
            }
        }
    }
    EXPECT_GT(mixed, 20) << "the heaps have met";
    EXPECT_EQ(solver.volume_left(), 0);
    EXPECT_NEAR(water_pressure(solver) / before, 1, 1e-5);
}

TEST(PorePressure, stays_constant_on_ugly_ground) {
    depth::Material material;
    material.friction_coefficient = 0.1;
    const auto bed = [](double x, double y) {
        const double valley = 0.25 * std::abs(y - 30) + 0.3 * std::abs(x - 50) + std::sin(x / 4) * std::cos(y / 5);
        const bool spike = std::lround(x) % 9 == 4 && std::lround(y) % 7 == 3, island = std::hypot(x - 50, y - 30) < 4;
        return valley + (std::fmod(x, 20) < 10 ? 2 : 0) + (spike ? 8 : 0) + (island ? 5 : 0);
    };
    depth::Solver solver(grid_of(100, 60, 1, bed), material);
    solver.add(grid_of<float>(100, 60, 1, [](double x, double y) { return std::hypot(x - 30, y - 30) < 9 ? 2 : 0; }),
               0.7);
    advance_until(solver, 4);
    int wet = 0;
    for (int row = 0; row < 60; ++row) {
        for (int column = 0; column < 100; ++column) {
            if (!(solver.depth_at(column, row) > 0)) continue;
            ASSERT_EQ(solver.pore_pressure_ratio_at(column, row), 0.7F) << column << ", " << row;
            ++wet;
        }
    }
    EXPECT_GT(wet, 300);
}

TEST(PorePressure, falls_alike_in_debris_that_moves_and_in_debris_that_rests) {
    depth::Material material = draining(0.5);
    material.friction_coefficient = 2;  // holds the second heap
    depth::GroundValues ground;
    ground.friction_coefficient.assign(6000, 2);
    for (std::size_t row = 0; row < 60; ++row) {
        for (std::size_t column = 0; column < 50; ++column) ground.friction_coefficient[row * 100 + column] = 0.05F;
    }
    const auto bed = grid_of(100, 60, 1, [](double x, double y) { return 0.3 * std::hypot(x - 50, y - 30); });
    depth::Solver solver(bed, material, ground);
    solver.add(grid_of<float>(100, 60, 1, [](double x, double y) {
        return std::hypot(x - 25, y - 40) < 9 || std::hypot(x - 85, y - 20) < 7 ? 0.8 : 0;
    }));
    const double before = water_pressure(solver);
    for (const double time : {1.0, 20.0, 90.0}) {  // 45 times the decay time: reckoned anew on the way
        advance_until(solver, time);
        EXPECT_NEAR(water_pressure(solver) / (before * std::exp(-time / decay_time)), 1, 1e-4) << time;
        EXPECT_NEAR(solver.pore_pressure_ratio_at(85, 20) / (0.5 * std::exp(-time / decay_time)), 1, 1e-5) << time;
    }
    EXPECT_EQ(solver.u_at(85, 20), 0);
}

TEST(PorePressure, is_that_of_the_material_in_debris_that_comes_in_and_falls_from_then) {
    for (const bool over_area : {false, true}) {
        depth::Solver solver(grid_of(80, 20, 1, [](double x, double) { return -0.2 * x; }), draining());
        solver.add(grid_of<float>(80, 20, 1, [](double x, double) { return x > 50 && x < 60 ? 0.5 : 0; }));
        terrain::Inflow late;
        late.hydrograph = {{30, 8, 2}, {31, 8, 2}};
        late.from = {10.5, 5};
        late.to = {10.5, 15};
        if (over_area) late.area = {{{{10, 5}, {14, 5}, {14, 15}, {10, 15}}, {}}};
        depth::Inflows inflows(solver, {late});
        Grid<float> added(solver.geometry());
        while (solver.time() < 31 - 1e-9) ASSERT_TRUE(inflows.advance(solver, 0.02, added));
        double fresh = 0, depth = 0;
        for (int row = 0; row < 20; ++row) {
            for (int column = 5; column < 30; ++column) {
                depth += double{solver.depth_at(column, row)};
                fresh += double{solver.depth_at(column, row)} * double{solver.pore_pressure_ratio_at(column, row)};
            }
        }
        // It came evenly over the second before.
        const double mean = 0.6 * decay_time * (1 - std::exp(-1 / decay_time));
        EXPECT_NEAR(depth, 8, 0.1);
        EXPECT_NEAR(fresh / depth, mean, 0.02 * mean) << over_area;
        EXPECT_LT(water_pressure(solver) - fresh, 1e-4) << "what was there is drained";
    }
}

TEST(PorePressure, is_full_in_ground_that_comes_loose) {
    depth::Solver solver(grid_of(40, 40, 1, [](double x, double) { return -0.3 * x; }), draining());
    solver.add(grid_of<float>(40, 40, 1, [](double x, double y) { return std::hypot(x - 15, y - 20) < 6 ? 1 : 0; }));
    advance_until(solver, 6 * decay_time);
    int column = 0;
    while (column < 40 && !(solver.depth_at(column, 20) > 0.1F)) ++column;
    ASSERT_LT(column, 40);
    const double there = solver.depth_at(column, 20), before = solver.pore_pressure_ratio_at(column, 20);
    const double eroded = solver.erode(column, 20, there);
    ASSERT_GT(eroded, 0.9 * there);
    EXPECT_LT(before, 0.01);
    EXPECT_NEAR(solver.pore_pressure_ratio_at(column, 20), (there * before + eroded * 0.6) / (there + eroded), 1e-5);
}

TEST(PorePressure, has_the_same_bits_on_any_number_of_threads_and_any_instruction_set) {
    expect_same_bits([] {
        depth::Solver solver = two_in_a_valley(draining());
        advance_until(solver, 3);
        return solver;
    });
}

TEST(PorePressure, is_carried_only_where_it_differs) {
    depth::Material material;
    material.pore_pressure_ratio = 0.4;
    const depth::Solver same = two_in_a_valley(material, 0.4, 0.4);
    EXPECT_FALSE(same.carries_pore_pressure());
    EXPECT_FLOAT_EQ(same.pore_pressure_ratio_at(30, 40), 0.4F);
    const depth::Solver own = two_in_a_valley(material);
    EXPECT_TRUE(own.carries_pore_pressure());
    EXPECT_NEAR(own.bytes_per_cell() - same.bytes_per_cell(), 8, 3);
    material.pore_pressure_decay_time = 4;
    EXPECT_TRUE(two_in_a_valley(material, 0.4, 0.4).carries_pore_pressure());
    material.pore_pressure_ratio = 0;
    EXPECT_FALSE(two_in_a_valley(material, 0, 0).carries_pore_pressure());
}

}  // namespace
}  // namespace talus::test
