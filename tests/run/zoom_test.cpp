#include "run/zoom.hpp"

#include <cmath>
#include <stdexcept>

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
    BoundaryFlow flow(solver, area, 1);
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
}

class ZoomedRun : public scene::SceneFolder {
  protected:
    [[nodiscard]] scene::Scene loaded(const std::string& more, const std::vector<std::string>& overrides = {}) const {
        write_valley(more);
        std::vector<std::string> all{"solver.end_time_s=12"};
        all.insert(all.end(), overrides.begin(), overrides.end());
        auto scene = scene::load_scene(folder / "scene.toml", all);
        if (!scene) throw std::runtime_error(scene.error().message);
        return std::move(*scene);
    }
    [[nodiscard]] static std::string dam(double x) {
        return fmt::format(
            "[[barrier]]\nname = \"dam\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nthickness_m = 1\nheight_m = 25\n",
            west + x, south + 10, south + 190);
    }
};

TEST_F(ZoomedRun, brings_what_crosses_the_boundary_to_the_structure) {
    scene::Scene scene = loaded(dam(150), {"solver.particle_spacing_m=1"});
    const scene::Scene grid = loaded(dam(150), {"solver.model=depth_averaged"});
    const auto area = zoom_around(grid, "dam", 20);
    ASSERT_TRUE(area);
    const auto zoom = record_zoom(grid, *area, 1, {});
    ASSERT_TRUE(zoom) << zoom.error().message;
    EXPECT_EQ(zoom->volumes.out, 0) << "the dam holds all";
    zoom_in(scene, *zoom, 1);
    scene.spec.solver.end_time = 20;  // until the last row is in
    const auto result = run_scene(scene, {});
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_NEAR(result->observation.volume_released, zoom->volumes.in, 0.51);
    ASSERT_EQ(result->observation.buildings.size(), 1U);
    EXPECT_TRUE(result->observation.buildings[0].hit);
    EXPECT_LT(result->particles, 1.001 * grid.releases[0].volume);
    EXPECT_THAT(scene.notes.back(), HasSubstr("not fed back"));
}

TEST_F(ZoomedRun, is_refused_where_nothing_arrives_or_debris_starts) {
    const auto far = loaded(dam(190), {"solver.model=depth_averaged", "material.friction_coefficient=2"});
    EXPECT_THAT(record_zoom(far, zoom_around(far, "dam", 5).value(), 1, {}).error().message,
                HasSubstr("no debris of the depth-averaged model reaches its area"));
    EXPECT_THAT(record_zoom(far, zoom_around(far, "dam", 300).value(), 1, {}).error().message,
                HasSubstr("lies in its area"));
    EXPECT_THAT(zoom_around(far, "mill", 5).error().message, HasSubstr("--zoom \"mill\" is refused"));
}

}  // namespace
}  // namespace talus::run
