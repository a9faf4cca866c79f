#include "products/debris_surface.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "products/view_fixture.hpp"

namespace talus::products {
namespace {

class Surface : public ViewOfARun {
  protected:
    void add_frames(std::size_t count) {
        for (std::size_t k = 0; k < count; ++k) {
            run::Frame frame = frame_at(2);
            frame.time = static_cast<double>(k);
            ASSERT_TRUE(frames.add(frame, 2000).ok());
        }
    }
    SeriesFrames frames{folder.path() / ".frames"};
};

TEST_F(Surface, lies_on_the_cells_of_the_map_around_all_that_debris_reached) {
    add_frames(1);
    const GridGeometry& map = result.observation.maps.peak_depth.geometry;
    const auto surface = DebrisSurface::make(scene.terrain, result.observation.maps.peak_depth, frames);
    ASSERT_TRUE(surface);
    const GridGeometry& lattice = surface->lattice();
    EXPECT_EQ(lattice.cell, map.cell);
    const double cells = (lattice.x_min - map.x_min) / map.cell;
    EXPECT_NEAR(cells, std::round(cells), 1e-6);
    const Extent terrain = scene.terrain.elevation().geometry.extent(), shown = lattice.extent();
    EXPECT_GE(shown.x_min, terrain.x_min);
    EXPECT_LE(shown.x_max, terrain.x_max);
    EXPECT_GE(shown.y_min, terrain.y_min);
    EXPECT_LE(shown.y_max, terrain.y_max);
}

TEST_F(Surface, takes_at_most_so_many_frames_with_the_first_and_the_last) {
    add_frames(357);
    const auto surface = DebrisSurface::make(scene.terrain, result.observation.maps.peak_depth, frames);
    ASSERT_TRUE(surface);
    const auto& chosen = surface->animated();
    EXPECT_EQ(chosen.size(), DebrisSurface::max_frames);
    EXPECT_EQ(chosen.front(), 0U);
    EXPECT_EQ(chosen.back(), 356U);
    for (std::size_t k = 1; k < chosen.size(); ++k) {
        EXPECT_GE(chosen[k] - chosen[k - 1], 3U);
        EXPECT_LE(chosen[k] - chosen[k - 1], 4U);
    }
}

TEST_F(Surface, of_a_large_map_is_coarser_and_keeps_the_volume) {
    // 1.4 km of plain with cells of 1 m, all of it reached.
    scene.terrain = terrain::Terrain(Grid<float>({824000, 825000, 10, 140, 140}, 7));
    const Grid<float> peak({824100, 825100, 1, 1200, 1200}, 1);
    run::Frame frame;
    frame.debris.depth = frame.debris.speed = Grid<float>({824400, 825400, 1, 99, 60}, 3);
    ASSERT_TRUE(frames.add(frame, 2000).ok());
    const auto surface = DebrisSurface::make(scene.terrain, peak, frames);
    ASSERT_TRUE(surface);
    EXPECT_LE(surface->lattice().size(), DebrisSurface::max_ground_points);
    EXPECT_GT(surface->lattice().size(), DebrisSurface::max_ground_points / 3);
    const auto mesh = surface->debris(0);
    ASSERT_TRUE(mesh);
    double volume = 0;
    for (const float depth : mesh->depth) volume += depth * surface->lattice().cell * surface->lattice().cell;
    EXPECT_NEAR(volume, 3.0 * 99 * 60, 1);
    for (std::size_t i = 0; i < mesh->depth.size(); ++i) {
        if (mesh->depth[i] <= 0) continue;
        EXPECT_NEAR(mesh->speed[i], 3, 1e-5);
    }
}

}  // namespace
}  // namespace talus::products
