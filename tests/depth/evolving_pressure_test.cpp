#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/archive.hpp"
#include "depth/inflow.hpp"
#include "grids.hpp"
#include "same_bits.hpp"
#include "sim/physics/pore_pressure.hpp"

namespace talus::test {
namespace {

/// Soil of debris; undrained and stiff it keeps its state, whatever it does.
depth::Material wet_soil(double permeability = 1e-10, double compressibility = 0.015) {
    depth::Material material;
    material.friction_coefficient = 0.4;
    material.soil = {true, permeability, 0.62, 0.64, 0.005, 1100, 2700, compressibility};
    return material;
}

depth::Material unchanging() {
    return wet_soil(0, 1e30);
}

double bulk_density(double fraction) {
    return 1100 + 1600 * fraction;
}

/// Natural ground, with steps, spikes and islands.
double ugly(double x, double y) {
    const double natural = 0.25 * std::abs(y - 30) + 0.3 * std::abs(x - 50) + std::sin(x / 4) * std::cos(y / 5);
    const double step = std::fmod(x, 20) < 10 ? 2 : 0;
    const bool spike = std::lround(x) % 9 == 4 && std::lround(y) % 7 == 3, island = std::hypot(x - 50, y - 30) < 4;
    return natural + step + (spike ? 8 : 0) + (island ? 5 : 0);
}

Grid<float> heap_at(double x_0, double depth = 2) {
    return grid_of<float>(100, 60, 1, [&](double x, double y) { return std::hypot(x - x_0, y - 30) < 9 ? depth : 0; });
}

/// Calls f(column, row) for the cells with debris.
template <class F>
void for_each_wet(const depth::Solver& solver, const F& f) {
    for (int row = 0; row < solver.geometry().rows; ++row) {
        for (int column = 0; column < solver.geometry().columns; ++column) {
            if (solver.depth_at(column, row) > 0) f(column, row);
        }
    }
}

double grains(const depth::Solver& solver) {
    double sum = 0;
    for_each_wet(solver, [&](int column, int row) {
        sum += double{solver.depth_at(column, row)} * double{solver.solid_fraction_at(column, row)};
    });
    return sum;
}

TEST(EvolvingPressure, keeps_a_constant_solid_fraction_on_ugly_ground) {
    depth::Material material = unchanging();
    material.friction_coefficient = 0.1;
    depth::Solver solver(grid_of(100, 60, 1, ugly), material);
    solver.add(heap_at(30));
    solver.add(heap_at(70));
    int wet = 0;
    for (int k = 1; k <= 5; ++k) {
        advance_until(solver, k);
        wet = 0;
        for_each_wet(solver, [&](int column, int row) {
            ASSERT_EQ(solver.solid_fraction_at(column, row), 0.62F) << column << ", " << row;
            ++wet;
        });
    }
    EXPECT_GT(wet, 600);
}

TEST(EvolvingPressure, moves_grains_with_the_mass_and_mixes_between_what_meets) {
    depth::Material material = unchanging();
    material.friction_coefficient = 0.4;
    depth::Solver solver(
        grid_of(100, 60, 1, [](double x, double y) { return 0.3 * std::abs(x - 50) + 0.3 * std::abs(y - 30); }),
        material);
    solver.add(heap_at(30), 0.5, 0.5);
    solver.add(heap_at(70), 0.5, 0.7);
    const double before = grains(solver);
    advance_until(solver, 6);
    int mixed = 0;
    for_each_wet(solver, [&](int column, int row) {
        const float fraction = solver.solid_fraction_at(column, row);
        ASSERT_GE(fraction, 0.5F);
        ASSERT_LE(fraction, 0.7F);
        mixed += fraction > 0.55F && fraction < 0.65F ? 1 : 0;
    });
    EXPECT_GT(mixed, 20);
    EXPECT_EQ(solver.volume_left(), 0);
    EXPECT_NEAR(grains(solver) / before, 1, 1e-5);
}

TEST(EvolvingPressure, is_bounded_on_ugly_ground) {
    const auto low = static_cast<float>(sim::loosest), high = static_cast<float>(sim::densest);
    for (const auto& [permeability, compressibility] : {std::pair{1e-13, 0.003}, std::pair{1e-8, 0.3}}) {
        depth::Solver solver(grid_of(100, 60, 1, ugly), wet_soil(permeability, compressibility));
        solver.add(heap_at(30, 3), 0.95, 0.5);
        solver.add(heap_at(70, 0.5), {}, 0.72);
        for (int k = 1; k <= 6; ++k) {
            advance_until(solver, 0.5 * k);
            for_each_wet(solver, [&](int column, int row) {
                const float ratio = solver.pore_pressure_ratio_at(column, row);
                const float fraction = solver.solid_fraction_at(column, row);
                ASSERT_TRUE(ratio >= 0 && ratio <= 1) << ratio;
                ASSERT_TRUE(fraction >= low && fraction <= high) << fraction;
            });
        }
    }
}

TEST(EvolvingPressure, consolidates_at_rest_by_the_law_of_particles) {
    const depth::Material material = wet_soil(1e-9);
    sim::Soil<double> soil{0.62, 0.8, 1, 0};
    const double start = soil.pressure_ratio, step = 1e-3;
    depth::Solver lake(grid_of(20, 20, 1, [](double x, double y) { return std::hypot(x - 10, y - 10) < 6 ? 0 : 2; }),
                       material);
    lake.add(grid_of<float>(20, 20, 1, [](double x, double y) { return std::hypot(x - 10, y - 10) < 6 ? 1 : 0; }), 0.8);
    for (int k = 1; k <= 4; ++k) {
        advance_until(lake, 0.5 * k);
        for (int n = 0; n < 500; ++n) soil = sim::evolve(material.soil, soil, gravity, 1.0, 0.0, step);
        EXPECT_NEAR(lake.pore_pressure_ratio_at(10, 10), soil.pressure_ratio, 0.002) << 0.5 * k;
        EXPECT_NEAR(lake.solid_fraction_at(10, 10), soil.solid_fraction, 1e-5);
        EXPECT_EQ(lake.u_at(10, 10), 0);
    }
    EXPECT_LT(soil.pressure_ratio, start - 0.05) << "it falls";
}

/// The middle of a sheet 1 m thick on a slope, after a time.
depth::Solver sheet(const depth::Material& material, double fraction, double time) {
    const double slope = 0.4, s = std::tan(slope);
    depth::Solver solver(grid_of(160, 1, 1, [&](double x, double) { return -s * x; }), material, {},
                         depth::Edges::continued);
    solver.add(grid_of<float>(160, 1, 1, [&](double, double) { return 1 / std::cos(slope); }), 0.5, fraction);
    advance_until(solver, time);
    return solver;
}

TEST(EvolvingPressure, liquefies_loose_debris_and_stiffens_dense_debris_that_does_not_drain) {
    const depth::Solver loose = sheet(wet_soil(0), 0.5, 1.5), dense = sheet(wet_soil(0), 0.72, 1.5);
    EXPECT_GT(loose.pore_pressure_ratio_at(80, 0), 0.99);
    EXPECT_GT(loose.u_at(80, 0), 4);
    EXPECT_LT(dense.pore_pressure_ratio_at(80, 0), 0.4);
    EXPECT_LT(dense.u_at(80, 0), 0.2);
    EXPECT_EQ(loose.solid_fraction_at(80, 0), 0.5F) << "no water moves";
}

TEST(EvolvingPressure, is_hydrostatic_where_water_moves_freely) {
    const depth::Solver solver = sheet(wet_soil(1e-3), 0.62, 1);
    const double fraction = double{solver.solid_fraction_at(80, 0)};
    EXPECT_NEAR(solver.pore_pressure_ratio_at(80, 0), 1100 / bulk_density(fraction), 0.003);
}

TEST(EvolvingPressure, accelerates_a_sheet_as_a_block_with_the_law_of_particles) {
    for (const double fraction : {0.56, 0.62}) {
        const depth::Material material = wet_soil(1e-10);
        sim::Soil<double> soil{fraction, 0.5, 1, fraction - 0.64};
        double speed = 0;
        const double slope = 0.4, step = 1e-4, normal = gravity * std::cos(slope);
        for (int k = 0; k < 10000; ++k) {
            speed +=
                std::max(-speed, (gravity * std::sin(slope) - normal * 0.4 * sim::friction_share(soil, 0.4)) * step);
            soil = sim::evolve(material.soil, soil, normal, 1.0, speed, step);
        }
        const depth::Solver solver = sheet(material, fraction, 1);
        const double u = double{solver.u_at(80, 0)} / std::cos(slope);
        EXPECT_NEAR(u, speed, 0.02 * speed + 0.02) << fraction;
        EXPECT_NEAR(solver.pore_pressure_ratio_at(80, 0), soil.pressure_ratio, 0.01) << fraction;
    }
}

TEST(EvolvingPressure, starts_with_the_solid_fraction_of_what_comes_in) {
    for (const bool over_area : {false, true}) {
        depth::Solver solver(grid_of(80, 20, 1, [](double x, double) { return -0.2 * x; }), unchanging());
        terrain::Inflow inflow;
        inflow.hydrograph = {{0, 8, 2}, {1, 8, 2}};
        inflow.from = {10.5, 5};
        inflow.to = {10.5, 15};
        inflow.spec.solid_fraction = 0.5;
        if (over_area) inflow.area = {{{{10, 5}, {14, 5}, {14, 15}, {10, 15}}, {}}};
        depth::Inflows inflows(solver, {inflow});
        Grid<float> added(solver.geometry());
        while (solver.time() < 1 - 1e-9) ASSERT_TRUE(inflows.advance(solver, 0.02, added));
        int wet = 0;
        for_each_wet(solver, [&](int column, int row) {
            ASSERT_NEAR(solver.solid_fraction_at(column, row), 0.5, 1e-6) << over_area;
            ++wet;
        });
        EXPECT_GT(wet, 10);
    }
}

depth::Solver two_heaps() {
    depth::Solver solver(grid_of(100, 60, 1, ugly), wet_soil());
    solver.add(heap_at(30), {}, 0.56);
    solver.add(heap_at(70), 0.8, 0.66);
    return solver;
}

TEST(EvolvingPressure, has_the_same_bits_on_any_number_of_threads_and_any_instruction_set) {
    expect_same_bits([] {
        depth::Solver solver = two_heaps();
        advance_until(solver, 1);
        return solver;
    });
}

TEST(EvolvingPressure, goes_on_from_a_saved_state) {
    depth::Solver solver = two_heaps();
    advance_until(solver, 1);
    ArchiveWriter saved;
    solver.keep(saved);
    const std::string bytes = saved.take();
    depth::Solver other = two_heaps();
    ArchiveReader reader(bytes);
    other.keep(reader);
    ASSERT_FALSE(reader.failed());
    for (depth::Solver* one : {&solver, &other}) advance_until(*one, 2);
    EXPECT_EQ(solver.hash(), other.hash());
}

TEST(EvolvingPressure, needs_no_memory_where_it_is_prescribed) {
    depth::Material prescribed = wet_soil();
    prescribed.soil = {};
    const Grid<double> bed = grid_of(100, 60, 1, ugly);
    const depth::Solver off(bed, prescribed), on(bed, wet_soil());
    EXPECT_FALSE(off.carries_pore_pressure());
    EXPECT_FALSE(off.pore_pressure_evolves());
    EXPECT_EQ(off.solid_fraction_at(30, 30), 0);
    EXPECT_NEAR(on.bytes_per_cell() - off.bytes_per_cell(), 16, 6);
}

}  // namespace
}  // namespace talus::test
