#include "observe/grid_structures.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "terrain/barrier.hpp"

namespace talus::observe {
namespace {

constexpr double gravity = 9.80665, density = 1000;

/// Level ground of 40 x 30 m at 10 m with a wall from south to north at x = 20.5 m, a metre thick, on cells of a size.
struct Flume {
    explicit Flume(double cell, double height = 3, std::vector<params::BarrierOpeningSpec> openings = {})
        : terrain(level(1, 40, 30)) {
        params::BarrierSpec shape{{{20.5, 0.5}, {20.5, 29.5}}, height, {}, 1, std::move(openings)};
        auto barrier = terrain::make_barrier(terrain, "wall", shape);
        EXPECT_TRUE(barrier) << barrier.error().message;
        buildings.push_back(*barrier);
        const int columns = static_cast<int>(40 / cell), rows = static_cast<int>(30 / cell);
        bed = Grid<double>({0, 0, cell, columns, rows}, 10.0);
        values.structure.assign(bed.geometry.size(), 0);
        StructureCells of_wall{"wall", true, {}};
        for (int row = 0; row < rows; ++row) {
            const PlanPoint centre = bed.geometry.centre(0, row);
            bool open = false;
            for (const auto& o : shape.openings) open = open || std::abs(centre.y - 0.5 - o.position) < o.width / 2;
            if (open) continue;
            const std::size_t k = bed.geometry.index(static_cast<int>(20.5 / cell), row);
            bed.values[k] = 10 + height;
            values.structure[k] = 1;
            of_wall.cells.push_back(k);
        }
        cells.push_back(of_wall);
    }
    static Grid<float> level(double cell, int columns, int rows) {
        return Grid<float>({0, 0, cell, columns, rows}, 10.0F);
    }
    [[nodiscard]] depth::Solver solver() const {
        depth::Material material;
        material.rest_density = density;
        return depth::Solver(bed, material, values, depth::Edges::continued);
    }
    /// Debris west of the wall at a velocity.
    static void fill(depth::Solver& solver, double depth, double u = 0, double v = 0) {
        const GridGeometry& g = solver.geometry();
        for (int row = 0; row < g.rows; ++row) {
            for (int column = 0; g.centre(column, row).x < 20 && !solver.built(column, row); ++column) {
                solver.inject(column, row, depth, u, v);
            }
        }
    }
    [[nodiscard]] GridStructures watch(depth::Solver& solver) const {
        GridStructures structures(solver, terrain, buildings, cells, outputs);
        solver.watch(structures.faces());
        return structures;
    }

    terrain::Terrain terrain;
    std::vector<terrain::Building> buildings;
    Grid<double> bed;
    depth::GroundValues values;
    std::vector<StructureCells> cells;
    params::OutputSpec outputs;
};

/// After one step so short that nothing moves.
BuildingImpact struck(const Flume& flume, double depth, double u, double v) {
    depth::Solver solver = flume.solver();
    GridStructures structures = flume.watch(solver);
    Flume::fill(solver, depth, u, v);
    EXPECT_TRUE(solver.advance(1e-7));
    structures.after_step(solver, true);
    BuildingImpact impact = structures.impacts(solver)[0];
    // The filter spreads what a step brings over its window.
    const double steps = flume.outputs.impact_filter_window / solver.time_step();
    impact.peak_force *= steps;
    impact.peak_impact_pressure *= steps;
    return impact;
}

TEST(GridStructures, water_at_rest_presses_with_its_weight_on_the_patch) {
    for (const double cell : {0.5, 1.0, 2.5}) {
        for (const double depth : {0.36, 0.8, 2.0}) {
            const BuildingImpact impact = struck(Flume(cell), depth, 0, 0);
            const double wet = std::min(depth, 1.0);
            const double patch = density * gravity * wet * (depth - wet / 2);
            EXPECT_NEAR(impact.peak_impact_pressure, patch, 1e-4 * patch) << cell << " " << depth;
            const double force = density * gravity * depth * depth / 2 * 29;
            EXPECT_NEAR(impact.peak_force, force, 1e-4 * force) << cell << " " << depth;
            EXPECT_NEAR(impact.peak_depth, depth, 1e-5);
            EXPECT_LT(impact.peak_dynamic_pressure, 1e-6);
        }
    }
}

TEST(GridStructures, only_the_velocity_towards_a_wall_strikes_it) {
    const double along = struck(Flume(1), 0.5, 0, 8).peak_impact_pressure;
    const double away = struck(Flume(1), 0.5, -8, 0).peak_impact_pressure;
    const BuildingImpact towards = struck(Flume(1, 8), 0.5, 8, 3);  // too high to pass
    const double weight = density * gravity * 0.5 * 0.5 / 2;
    EXPECT_NEAR(along, weight, 1e-3 * weight);
    EXPECT_NEAR(away, weight, 1e-3 * weight);
    EXPECT_NEAR(towards.peak_dynamic_pressure, density * 64, 1e-3 * density * 64);
    EXPECT_NEAR(towards.peak_impact_pressure, weight + density * 64 * 0.5, 1e-3 * density * 64) << "half of the patch";
    EXPECT_NEAR(towards.peak_speed, std::hypot(8, 3), 1e-3);
}

/// Runs water of a depth against a wall for some seconds.
BuildingImpact run(const Flume& flume, depth::Solver& solver, double depth, double u, double until) {
    GridStructures structures = flume.watch(solver);
    Flume::fill(solver, depth, u, 0);
    while (solver.time() < until) {
        EXPECT_TRUE(solver.advance(0.1));
        structures.after_step(solver, true);
    }
    return structures.impacts(solver)[0];
}

/// On the line and beyond it; the northernmost row passes its end.
double volume_east(const depth::Solver& solver) {
    const GridGeometry& g = solver.geometry();
    double sum = 0;
    for (int row = 0; row < g.rows - 1; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            if (g.centre(column, row).x >= 20.5) sum += solver.depth_at(column, row) * g.cell * g.cell;
        }
    }
    return sum;
}

TEST(GridStructures, what_went_over_the_crest_is_what_lies_beyond) {
    const Flume flume(1, 0.6);
    depth::Solver solver = flume.solver();
    const BuildingImpact impact = run(flume, solver, 1, 3, 1.5);
    EXPECT_GT(impact.overtopped_volume, 30);
    EXPECT_NEAR(impact.overtopped_volume, volume_east(solver), 1e-4 * impact.overtopped_volume);
    EXPECT_EQ(impact.passed_volume, 0);
    EXPECT_GE(impact.first_overtopping_time, impact.first_hit_time);
}

TEST(GridStructures, what_goes_through_an_opening_has_not_gone_over) {
    const Flume flume(1, 3, {{14.5, 6, 0}});
    depth::Solver solver = flume.solver();
    const BuildingImpact impact = run(flume, solver, 1, 0, 2);
    EXPECT_GT(impact.passed_volume, 5);
    EXPECT_NEAR(impact.passed_volume, volume_east(solver), 1e-4 * impact.passed_volume);
    EXPECT_EQ(impact.overtopped_volume, 0);
}

TEST(GridStructures, the_height_of_a_dam_has_no_part_in_what_it_retains) {
    std::vector<double> retained;
    for (const double height : {3.0, 6.0, 20.0}) {
        const Flume flume(1, height);
        depth::Solver solver = flume.solver();
        retained.push_back(run(flume, solver, 0.5, 2, 2).retained_volume);
    }
    EXPECT_NEAR(retained[0], 0.5 * 20 * 30, 4) << "all but what left over the western edge";
    EXPECT_NEAR(retained[0], retained[1], 1e-4 * retained[0]);
    EXPECT_NEAR(retained[0], retained[2], 1e-4 * retained[0]);
}

}  // namespace
}  // namespace talus::observe
