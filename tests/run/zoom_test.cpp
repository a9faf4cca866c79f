#include "run/zoom.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "depth/inflow.hpp"
#include "scene/scene_folder.hpp"

namespace talus::run {
namespace {

using testing::HasSubstr;

/// Integral of discharge times velocity over time, m4/s2: momentum per density.
double momentum_of(const terrain::Inflow& inflow) {
    double sum = 0;
    for (std::size_t k = 0; k + 1 < inflow.hydrograph.size(); ++k) {
        const params::InflowSample &a = inflow.hydrograph[k], &b = inflow.hydrograph[k + 1];
        sum += (b.time - a.time) *
               (2 * a.discharge * a.velocity + 2 * b.discharge * b.velocity + a.discharge * b.velocity +
                b.discharge * a.velocity) /
               6;
    }
    return sum;
}

TEST(BoundaryFlow, brings_debris_with_the_pore_pressure_that_is_left_in_it) {
    const Grid<double> bed({0, 0, 0.5, 160, 40});
    depth::Material material;
    material.gravity = 0.01;
    material.pore_pressure_ratio = 0.8;
    for (const double decay : {0.0, 4.0}) {
        material.pore_pressure_decay_time = decay;
        depth::Solver solver(bed, material);
        terrain::Inflow source;
        source.from = {5, 5};
        source.to = {5, 15};
        source.hydrograph = {{0, 30, 6}, {8, 30, 6}};
        depth::Inflows inflows(solver, {source});
        BoundaryFlow flow(solver, {{{35, -5}, {60, -5}, {60, 25}, {35, 25}}, {}});
        Grid<float> added(bed.geometry);
        while (solver.time() < 12) {
            ASSERT_TRUE(inflows.advance(solver, 12 - solver.time(), added));
            flow.record(solver);
        }
        const double on_the_way = 30.0 / 6;  // s
        for (const terrain::Inflow& piece : flow.inflows(0.5)) {
            const double ratio = piece.pore_pressure_ratio_at(8);
            if (decay > 0) {
                EXPECT_NEAR(ratio, 0.8 * std::exp(-on_the_way / decay), 0.015);
            } else {
                EXPECT_LT(ratio, 0) << "that of the material";
            }
        }
    }
}

TEST(BoundaryFlow, has_the_mass_and_momentum_of_a_stream_that_crosses_it_obliquely) {
    // Level ground without friction: a stream of 0.5 m at 6 m/s stays as it comes.
    const Grid<double> bed({0, 0, 0.5, 160, 40});
    depth::Material material;
    material.gravity = 0.01;  // a stream that hardly spreads
    depth::Solver solver(bed, material);
    terrain::Inflow source;
    source.from = {5, 5};
    source.to = {5, 15};
    source.hydrograph = {{0, 30, 6}, {8, 30, 6}};
    depth::Inflows inflows(solver, {source});
    // A square on its corner, all in the way of the stream, which leaves it at the other side.
    const Polygon area{{{30, 10}, {45, -5}, {60, 10}, {45, 25}}, {}};
    BoundaryFlow flow(solver, area);
    Grid<float> added(bed.geometry);
    while (solver.time() < 20) {
        ASSERT_TRUE(inflows.advance(solver, 20 - solver.time(), added));
        flow.record(solver);
    }
    const BoundaryFlow::Volumes volumes = flow.volumes();
    EXPECT_NEAR(volumes.in, 240, 0.01 * 240);
    EXPECT_NEAR(volumes.in - volumes.out, 0, 0.01 * 240) << "it has gone through";
    EXPECT_NEAR(volumes.sampled_in, volumes.in, 0.05 * volumes.in) << "cells of 0.5 m, at 45 degrees";

    const double spacing = 0.25;
    double volume = 0, east = 0, north = 0, whole = 0;
    for (const terrain::Inflow& piece : flow.inflows(spacing)) {
        const double length = std::hypot(piece.to.x - piece.from.x, piece.to.y - piece.from.y);
        const double momentum = momentum_of(piece);
        volume += piece.volume();
        east += momentum * (piece.to.y - piece.from.y) / length;
        north -= momentum * (piece.to.x - piece.from.x) / length;
        whole = std::max(whole, std::abs(std::remainder(piece.volume() / std::pow(spacing, 3), 1)));
        EXPECT_TRUE(contains(area, {(piece.from.x + piece.to.x) / 2 + 0.1, (piece.from.y + piece.to.y) / 2}));
    }
    EXPECT_LT(whole, 1e-6) << "particles";
    EXPECT_NEAR(volume, volumes.in, 0.51 * std::pow(spacing, 3));
    EXPECT_NEAR(east, 6 * volumes.in, 0.01 * 6 * volumes.in);
    EXPECT_NEAR(north, 0, 0.01 * 6 * volumes.in);
    EXPECT_NEAR(flow.momentum().x, east, 0.005 * east);
    EXPECT_NEAR(flow.momentum().y, 0, 0.01 * east);
    EXPECT_NEAR(flow.thickness(), 0.5, 0.1) << "30 m3/s at 6 m/s, 10 m wide";
    double came = 0;
    for (const double discharge : flow.discharge()) came += discharge * BoundaryFlow::interval;
    EXPECT_NEAR(came, volumes.in, 1e-9 * volumes.in);
}

TEST(BoundaryFlow, comes_in_longer_pieces_where_particles_are_larger) {
    const Grid<double> bed({0, 0, 0.5, 120, 60});
    depth::Material material;
    material.gravity = 0.01;
    depth::Solver solver(bed, material);
    terrain::Inflow source;
    source.from = {5, 5};
    source.to = {5, 25};
    source.hydrograph = {{0, 60, 6}, {4, 60, 6}};
    depth::Inflows inflows(solver, {source});
    BoundaryFlow flow(solver, {{{20, 2}, {50, 2}, {50, 28}, {20, 28}}, {}});
    Grid<float> added(bed.geometry);
    while (solver.time() < 8) {
        ASSERT_TRUE(inflows.advance(solver, 8 - solver.time(), added));
        flow.record(solver);
    }
    const auto longest = [&](double spacing) {
        double length = 0, volume = 0;
        for (const terrain::Inflow& piece : flow.inflows(spacing)) {
            length = std::max(length, std::hypot(piece.to.x - piece.from.x, piece.to.y - piece.from.y));
            volume += piece.volume();
        }
        EXPECT_NEAR(volume, flow.volumes().in, 0.51 * std::pow(spacing, 3));
        return length;
    };
    EXPECT_NEAR(longest(0.1), 2, 0.1);
    EXPECT_GE(longest(1), 8 * 0.99);
    EXPECT_LT(longest(1), 16);
}

class ZoomedRun : public scene::SceneFolder {
  protected:
    [[nodiscard]] scene::Scene loaded(const std::string& more, std::vector<std::string> overrides = {}) const {
        write_valley(more);
        overrides.insert(overrides.begin(), "solver.end_time_s=12");
        return SceneFolder::loaded(overrides);
    }
    [[nodiscard]] static std::string dam(double x) {
        return fmt::format(
            "[[barrier]]\nname = \"dam\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nthickness_m = 1\nheight_m = 25\n",
            west + x, south + 10, south + 190);
    }
};

TEST_F(ZoomedRun, brings_what_crosses_the_boundary_to_the_structure) {
    const scene::Scene scene = loaded(
        dam(150), {"solver.end_time_s=30", "zoom.structure=dam", "zoom.margin_m=20", "zoom.particle_spacing_m=1"});
    const auto result = run_scene(scene, {});
    ASSERT_TRUE(result) << result.error().message;
    ASSERT_TRUE(result->zoom);
    const ZoomRecord& zoom = *result->zoom;
    EXPECT_EQ(zoom.volumes.out, 0) << "the dam holds all";
    EXPECT_NEAR(result->observation.volume_released, zoom.volumes.in, 0.005 * zoom.volumes.in)
        << "but for the last row";
    EXPECT_NEAR(zoom.brought_volume, zoom.volumes.in, 0.51);
    const double momentum = std::hypot(zoom.momentum.x, zoom.momentum.y);
    EXPECT_GT(momentum, 0);
    EXPECT_NEAR(std::hypot(zoom.brought_momentum.x, zoom.brought_momentum.y), momentum, 0.02 * momentum);
    EXPECT_EQ(result->particle_spacing, 1);
    EXPECT_NEAR(zoom.event_volume, scene.releases[0].volume, 1e-9);
    ASSERT_EQ(result->observation.buildings.size(), 1U);
    EXPECT_TRUE(result->observation.buildings[0].hit);
    EXPECT_GE(result->observation.buildings[0].first_hit_time, zoom.first_time());
    EXPECT_LT(result->particles, 1.001 * scene.releases[0].volume);
}

TEST_F(ZoomedRun, measures_at_its_gauges_and_cross_sections) {
    const std::string measured = fmt::format(
        "[[gauge]]\nname = \"before the dam\"\nx_m = {}\ny_m = {}\n"
        "[[cross_section]]\nname = \"way to the dam\"\nline_m = [[{}, {}], [{}, {}]]\n",
        west + 148, south + 100, west + 140, south + 10, west + 140, south + 190);
    const scene::Scene scene = loaded(dam(150) + measured, {"solver.end_time_s=30", "zoom.structure=dam",
                                                            "zoom.margin_m=20", "zoom.particle_spacing_m=1"});
    const RunResult result = test::value_of(run_scene(scene, {}));
    ASSERT_EQ(result.observation.gauges.size(), 1U);
    EXPECT_GT(result.observation.gauges[0].peak_depth, 0.1);
    ASSERT_EQ(result.observation.cross_sections.size(), 1U);
    EXPECT_GT(std::abs(result.observation.cross_sections[0].passed), 0.1 * result.zoom->volumes.in);
}

TEST_F(ZoomedRun, is_fed_by_debris_with_the_friction_inside_of_the_particles) {
    const auto first_time = [&](const char* coefficient) {
        const scene::Scene scene =
            loaded(dam(150), {"zoom.structure=dam", "zoom.margin_m=20", "zoom.particle_spacing_m=1",
                              std::string("material.internal_friction_coefficient=") + coefficient});
        return test::value_of(zoom_in(scene, {})).record.first_time();
    };
    const double frictionless = first_time("0"), as_the_ground = first_time("none"), more = first_time("0.8");
    EXPECT_GT(as_the_ground, frictionless + 0.05);
    EXPECT_GT(more, as_the_ground);
}

TEST_F(ZoomedRun, has_so_many_layers_over_what_crosses_the_boundary) {
    const scene::Scene scene = loaded(dam(150), {"zoom.structure=dam", "zoom.margin_m=20", "zoom.target_layers=2"});
    const auto zoomed = zoom_in(scene, {});
    ASSERT_TRUE(zoomed) << zoomed.error().message;
    EXPECT_NEAR(zoomed->record.layers(), 2, 0.01);
    EXPECT_GT(zoomed->record.thickness, 0.1);
    EXPECT_LT(zoomed->record.thickness, 2);
}

TEST_F(ZoomedRun, removes_particles_beyond_the_surroundings) {
    // Half-way down the valley without anything in the way.
    const std::vector<std::string> area{"solver.end_time_s=20", "zoom.particle_spacing_m=1",
                                        fmt::format("zoom.polygon_m=[[{0}, {2}], [{1}, {2}], [{1}, {3}], [{0}, {3}]]",
                                                    west + 100, west + 130, south + 60, south + 140)};
    const auto farthest = [&](double surroundings) {
        auto overrides = area;
        overrides.push_back(fmt::format("zoom.surroundings_m={}", surroundings));
        const RunResult result = test::value_of(run_scene(loaded("", overrides), {}));
        const Grid<float>& depth = result.observation.maps.peak_depth;
        double east = 0;
        for (int row = 0; row < depth.geometry.rows; ++row) {
            for (int column = 0; column < depth.geometry.columns; ++column) {
                if (depth.at(column, row) > 0) east = std::max(east, depth.geometry.centre(column, row).x - west);
            }
        }
        EXPECT_GT(result.observation.timeseries.back().volume_left, 0.5 * result.zoom->volumes.in);
        return east;
    };
    EXPECT_LT(farthest(5), 130 + 5 + 2 * 5 + 5) << "two cells of the terrain, one of the map";
    EXPECT_GT(farthest(40), 165);
}

TEST_F(ZoomedRun, is_refused_where_nothing_arrives) {
    const auto far = loaded(dam(190), {"material.friction_coefficient=2", "zoom.structure=dam", "zoom.margin_m=5"});
    EXPECT_THAT(run_scene(far, {}).error().message,
                HasSubstr("no debris of the depth-averaged model crosses its boundary"));
}

}  // namespace
}  // namespace talus::run
