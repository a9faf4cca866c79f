#include <cmath>
#include <limits>

#include <tbb/global_control.h>

#include "grids.hpp"
#include "same_bits.hpp"
#include "simd/dispatch.hpp"
#include "support/allocations.hpp"

namespace talus::test {
namespace {

double valley(double x, double y) {
    return 0.02 * std::pow(std::hypot(x - 60, y - 60), 1.5) + 0.5 * std::sin(x / 9) * std::cos(y / 7);
}

depth::Solver in_a_valley() {
    depth::Material material;
    material.friction_coefficient = 0.1;
    material.laws.turbulent_friction = 500;
    material.laws.turbulent_thickness = 1;
    depth::Solver solver(grid_of(120, 120, 1, valley), material);
    solver.add(grid_of<float>(120, 120, 1, [](double x, double y) { return std::hypot(x - 42, y - 50) < 20 ? 4 : 0; }));
    return solver;
}

TEST(Solver, keeps_volume_to_rounding) {
    depth::Solver solver = in_a_valley();
    const double start = solver.volume();
    advance_until(solver, 15);
    EXPECT_EQ(solver.volume_left(), 0);
    EXPECT_NEAR(solver.volume() / start, 1, 1e-6);
}

TEST(Solver, counts_what_leaves_over_edges_and_unknown_ground) {
    auto bed = grid_of(80, 60, 1, [](double x, double) { return -0.3 * x; });
    for (int row = 20; row < 30; ++row) {
        for (int column = 50; column < 54; ++column) bed.at(column, row) = std::numeric_limits<double>::quiet_NaN();
    }
    depth::Solver solver(bed, {});
    solver.add(grid_of<float>(80, 60, 1, [](double x, double y) { return std::hypot(x - 30, y - 25) < 10 ? 2 : 0; }));
    const double start = solver.volume();
    advance_until(solver, 4);
    EXPECT_GT(solver.volume_left(), 1);
    advance_until(solver, 20);
    EXPECT_GT(solver.volume_left(), 0.9 * start);
    EXPECT_NEAR((solver.volume() + solver.volume_left()) / start, 1, 1e-6);
}

TEST(Solver, counts_what_passes_faces_as_cells_gain_and_lose_it) {
    depth::Solver solver = in_a_valley();
    std::vector<depth::Face> faces;  // a line across the valley, south to north and back east
    for (int row = 0; row < 120; ++row) faces.push_back({59, row, false});
    for (int column = 60; column < 120; ++column) faces.push_back({column, 63, true});
    solver.watch(faces);
    const auto quarter = [&] {
        double sum = 0;
        for (int row = 0; row < 64; ++row) {
            for (int column = 60; column < 120; ++column) sum += solver.depth_at(column, row);
        }
        return sum;
    };
    double gained = -quarter(), into = 0;
    const double volume = solver.volume();
    while (solver.time() < 12) {
        ASSERT_TRUE(solver.advance(0.2).ok());
        for (std::size_t k = 0; k < 64; ++k) into += solver.passed()[k];
        for (std::size_t k = 120; k < 180; ++k) into -= solver.passed()[k];
    }
    gained += quarter();
    EXPECT_GT(gained, 0.05 * volume);
    EXPECT_NEAR(into, gained, 1e-6 * volume);
}

TEST(Solver, never_has_a_negative_depth_or_a_wild_speed) {
    depth::Solver solver = in_a_valley();
    for (int k = 0; k < 300; ++k) {
        ASSERT_TRUE(solver.advance(0.1).ok());
        for (int row = 0; row < 120; ++row) {
            for (int column = 0; column < 120; ++column) {
                ASSERT_GE(solver.depth_at(column, row), 0);
                ASSERT_LT(std::hypot(solver.u_at(column, row), solver.v_at(column, row)), 25);
            }
        }
    }
}

TEST(Solver, has_the_same_bits_on_any_number_of_threads_and_any_instruction_set) {
    expect_same_bits([] {
        depth::Solver solver = in_a_valley();
        advance_until(solver, 5);
        return solver;
    });
}

TEST(Solver, meets_a_structure_beyond_the_edge_of_a_tile_as_any_other) {
    // A stream against a row of structures, which is the first of a tile or not, according to where all of it lies.
    const auto depths_before = [](int wall) {
        constexpr int edge = 48;
        depth::GroundValues ground;
        for (int k = 0; k < edge * edge; ++k) ground.structure.push_back(k / edge == wall ? 1.0F : 0.0F);
        depth::Solver solver(
            grid_of(edge, edge, 1, [&](double, double y) { return static_cast<int>(y) == wall ? 5.0 : 0.0; }), {},
            ground);
        for (int row = wall - 8; row < wall; ++row) {
            for (int column = 10; column < 38; ++column) solver.inject(column, row, 0.5, 0, 4);
        }
        advance_until(solver, 1);
        std::vector<float> depths;
        for (int row = wall - 12; row <= wall + 2; ++row) {
            for (int column = 8; column < 40; ++column) depths.push_back(solver.depth_at(column, row));
        }
        return depths;
    };
    const std::vector<float> within = depths_before(22);
    EXPECT_EQ(depths_before(30), within) << "in the first row of a tile";
    EXPECT_EQ(depths_before(29), within) << "in the last";
}

TEST(Solver, names_the_instruction_set_that_was_chosen) {
    for (const std::string& set : simd::instruction_sets()) {
        ASSERT_TRUE(simd::choose_instruction_set(set));
        EXPECT_EQ(in_a_valley().instruction_set(), set);
    }
    ASSERT_TRUE(simd::choose_instruction_set(simd::instruction_sets().front()));
}

TEST(Solver, allocates_nothing_in_a_step_and_little_per_cell) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    depth::Solver solver = in_a_valley();
    EXPECT_LT(solver.bytes_per_cell(), 100);
    advance_until(solver, 0.5);
    const long before = allocation_count();
    for (int k = 0; k < 50; ++k) ASSERT_TRUE(solver.advance(0.1).ok());
    EXPECT_EQ(allocation_count(), before);
}

TEST(Solver, costs_what_moves) {
    depth::Solver solver(grid_of(400, 400, 1, [](double, double) { return 0.0; }), {});
    solver.add(
        grid_of<float>(400, 400, 1, [](double x, double y) { return std::hypot(x - 200, y - 200) < 10 ? 1 : 0; }));
    ASSERT_TRUE(solver.advance(0.01).ok());
    EXPECT_LE(solver.cell_updates(), 25u * 3u * 16u);  // rows within two cells of it, by strips of 16
}

/// Two islands of debris that run into a bowl, all of it `shift` cells further east and north.
depth::Solver shifted(int shift) {
    constexpr int edge = 96;
    const double middle = 40 + shift;
    depth::Material material;
    material.friction_coefficient = 0.1;
    material.laws.turbulent_friction = 500;
    depth::Solver solver(grid_of(edge, edge, 1,
                                 [&](double x, double y) {
                                     const double r = std::hypot(x - middle, y - middle);
                                     return 0.01 * r * r +
                                            0.3 * std::sin((x - middle) / 3) * std::cos((y - middle) / 2);
                                 }),
                         material);
    solver.add(grid_of<float>(edge, edge, 1, [&](double x, double y) {
        return std::hypot(x - middle + 14, y - middle - 3) < 4 || std::hypot(x - middle - 17, y - middle + 9) < 2 ? 2
                                                                                                                  : 0;
    }));
    return solver;
}

TEST(Solver, computes_cells_near_debris_alone_with_the_same_bits_wherever_tiles_begin) {
    depth::Solver reference = shifted(0);
    const double start = reference.volume();
    advance_until(reference, 6);
    EXPECT_NEAR(reference.volume() / start, 1, 1e-6);
    EXPECT_LT(static_cast<double>(reference.cell_updates()), 0.4 * static_cast<double>(reference.steps()) * 80 * 80);
    for (const int shift : {1, 2, 3, 7, 13, 14, 15}) {
        depth::Solver solver = shifted(shift);
        advance_until(solver, 6);
        ASSERT_EQ(solver.steps(), reference.steps()) << shift;
        int different = 0;
        for (int row = 0; row < 80; ++row) {
            for (int column = 0; column < 80; ++column) {
                different += solver.depth_at(column + shift, row + shift) != reference.depth_at(column, row) ? 1 : 0;
            }
        }
        EXPECT_EQ(different, 0) << shift;
    }
}

TEST(Solver, takes_debris_with_momentum) {
    depth::Solver solver(grid_of(20, 20, 1, [](double, double) { return 0.0; }), {});
    solver.inject(10, 10, 1, 4, 0);
    solver.inject(10, 10, 1, 0, 2);
    EXPECT_FLOAT_EQ(solver.depth_at(10, 10), 2);
    EXPECT_FLOAT_EQ(solver.u_at(10, 10), 2);
    EXPECT_FLOAT_EQ(solver.v_at(10, 10), 1);
}

TEST(Solver, feels_zones) {
    const auto bed = grid_of(100, 40, 1, [](double x, double) { return -0.3 * x; });
    depth::GroundValues ground;
    ground.friction_coefficient.assign(4000, std::numeric_limits<float>::quiet_NaN());
    for (int row = 0; row < 20; ++row) {
        for (int column = 0; column < 100; ++column)
            ground.friction_coefficient[static_cast<std::size_t>(row * 100 + column)] = 0.5F;
    }
    depth::Material material;
    material.friction_coefficient = 0.05;
    depth::Solver solver(bed, material, ground);
    solver.add(grid_of<float>(100, 40, 1, [](double x, double) { return x > 20 && x < 40 ? 1 : 0; }));
    advance_until(solver, 2);
    EXPECT_EQ(solver.u_at(30, 8), 0);
    EXPECT_GT(solver.u_at(35, 32), 3);
}

/// Debris that slides against a wall across its way; returns the solver after `time`.
depth::Solver against_a_wall(double height, double time) {
    depth::GroundValues ground;
    ground.structure.assign(100, 0);
    ground.structure[60] = 1;
    const auto bed =
        grid_of(100, 1, 1, [&](double x, double) { return 100 - 0.5 * x + (x > 60 && x < 61 ? height : 0); });
    depth::Material material;
    material.friction_coefficient = 0.2;
    depth::Solver solver(bed, material, ground, depth::Edges::continued);
    solver.add(grid_of<float>(100, 1, 1, [](double x, double) { return x > 10 && x < 30 ? 2 : 0; }));
    advance_until(solver, time);
    return solver;
}

TEST(Structure, stops_debris_that_has_not_the_energy_to_pass_it) {
    const depth::Solver solver = against_a_wall(20, 20);
    double before = 0, beyond = 0;
    for (int column = 0; column < 100; ++column) (column < 60 ? before : beyond) += solver.depth_at(column, 0);
    EXPECT_EQ(beyond, 0);
    EXPECT_NEAR(before, 40, 1e-3);
    EXPECT_GT(solver.depth_at(59, 0), 3) << "it piles up";
}

TEST(Structure, lets_debris_over_it) {
    const depth::Solver solver = against_a_wall(0.5, 20);
    double beyond = solver.volume_left();
    for (int column = 61; column < 100; ++column) beyond += solver.depth_at(column, 0);
    EXPECT_GT(beyond, 30);
}

TEST(Structure, is_no_slope_for_a_lake_beside_it) {
    depth::GroundValues ground;
    ground.structure.assign(400, 0);
    for (int row = 8; row < 12; ++row) {
        for (int column = 8; column < 12; ++column) ground.structure[static_cast<std::size_t>(row * 20 + column)] = 1;
    }
    const auto bed = grid_of(20, 20, 1, [&](double x, double y) {
        const bool house = std::max(std::abs(x - 10), std::abs(y - 10)) < 2;
        return house || std::max(std::abs(x - 10), std::abs(y - 10)) > 9 ? 8.0 : std::round(x) / 4;
    });
    const auto water = grid_of<float>(20, 20, 1, [&](double x, double y) {
        return std::max(0.0, 6 - bed.at(static_cast<int>(x), static_cast<int>(y)));
    });
    depth::Solver solver(bed, {}, ground);
    solver.add(water);
    advance_until(solver, 10);
    EXPECT_TRUE(as_at_start(solver, water));
}

}  // namespace
}  // namespace talus::test
