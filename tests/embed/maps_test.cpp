// Maps on the caller's cells, ground and surface.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "embed_fixtures.hpp"

namespace talus::embed::test {
namespace {

talus_map map_of(const Simulation& simulation, const char* name) {
    talus_error error = TALUS_SIZED(talus_error);
    talus_map map = TALUS_SIZED(talus_map);
    EXPECT_EQ(talus_get_map(simulation.get(), name, &map, &error), TALUS_OK) << error.text;
    return map;
}

talus_map map_on(const Simulation& simulation, const char* name, const talus_grid& grid) {
    talus_error error = TALUS_SIZED(talus_error);
    talus_map map = TALUS_SIZED(talus_map);
    EXPECT_EQ(talus_get_map_on(simulation.get(), name, &grid, &map, &error), TALUS_OK) << error.text;
    return map;
}

std::size_t cells_of(const talus_map& map) {
    return static_cast<std::size_t>(map.grid.columns) * static_cast<std::size_t>(map.grid.rows);
}

double sum_of(const talus_map& map) {
    double sum = 0;
    for (std::size_t k = 0; k < cells_of(map); ++k) sum += std::isnan(map.values[k]) ? 0 : map.values[k];
    return sum;
}

float largest_of(const talus_map& map) {
    float largest = 0;
    for (std::size_t k = 0; k < cells_of(map); ++k) largest = std::fmax(largest, map.values[k]);
    return largest;
}

double elevation_at(const Simulation& simulation, double x, double y) {
    talus_error error = TALUS_SIZED(talus_error);
    double z = 0;
    EXPECT_EQ(talus_get_elevation(simulation.get(), x, y, &z, &error), TALUS_OK) << error.text;
    return z;
}

TEST(Maps, of_speed_show_what_moves_now) {
    const Simulation simulation = Slope().open();
    EXPECT_EQ(largest_of(map_of(simulation, "speed")), 0) << "nothing moves yet";
    advance_to(simulation, 2);
    const talus_map speed = map_of(simulation, "speed"), peak = map_of(simulation, "peak_speed"),
                    depth = map_of(simulation, "depth");
    EXPECT_GT(largest_of(speed), 1);
    EXPECT_LE(largest_of(speed), largest_of(peak));
    ASSERT_EQ(cells_of(speed), cells_of(depth));
    std::size_t with_debris = 0;
    for (std::size_t k = 0; k < cells_of(speed); ++k) {
        EXPECT_EQ(std::isnan(speed.values[k]), std::isnan(depth.values[k]));
        if (!std::isnan(speed.values[k])) ++with_debris;
    }
    EXPECT_GT(with_debris, 10U);
    // Against the particles: the mean speed by volume.
    const talus_debris debris = debris_of(simulation);
    double by_particles = 0, by_cells = 0, volume = 0;
    for (std::size_t i = 0; i < debris.count; ++i) {
        by_particles += std::hypot(debris.velocity_x[i], debris.velocity_y[i], debris.velocity_z[i]);
    }
    by_particles /= static_cast<double>(debris.count);
    for (std::size_t k = 0; k < cells_of(speed); ++k) {
        if (std::isnan(speed.values[k])) continue;
        volume += depth.values[k];
        by_cells += depth.values[k] * speed.values[k];
    }
    EXPECT_NEAR(by_cells / volume, by_particles, 0.03 * by_particles);
}

TEST(Maps, on_the_cells_of_the_caller_keep_their_size_and_their_debris) {
    const Simulation simulation = Slope().open();
    const talus_grid fixed{-10, -10, 5, 20, 12};
    for (const double time : {0.5, 1.0, 3.0}) {
        advance_to(simulation, time);
        const talus_map own = map_of(simulation, "depth"), coarse = map_on(simulation, "depth", fixed);
        EXPECT_EQ(coarse.grid.columns, 20);
        EXPECT_EQ(coarse.grid.rows, 12);
        EXPECT_EQ(coarse.grid.x_min, -10);
        EXPECT_EQ(coarse.grid.cell, 5);
        ASSERT_LT(own.grid.cell, fixed.cell);
        EXPECT_GT(sum_of(own), 0);
        const double share = fixed.cell / own.grid.cell;
        EXPECT_NEAR(sum_of(coarse) * share * share, sum_of(own), 1e-4 * sum_of(own)) << "all debris, and no more";
        EXPECT_TRUE(std::isnan(coarse.values[0])) << "off the terrain";
    }
    EXPECT_EQ(largest_of(map_on(simulation, "peak_speed", fixed)), largest_of(map_of(simulation, "peak_speed")))
        << "no peak is lost";
    const talus_map own = map_of(simulation, "arrival_time"), arrival = map_on(simulation, "arrival_time", fixed);
    const auto first = [](const talus_map& map) {
        float least = std::numeric_limits<float>::infinity();
        for (std::size_t k = 0; k < cells_of(map); ++k) least = std::fmin(least, map.values[k]);
        return least;
    };
    EXPECT_EQ(first(arrival), first(own));
    // Its own cells give the map itself; finer ones the value of the cell that they lie in.
    const talus_map peak = map_of(simulation, "peak_depth"), same = map_on(simulation, "peak_depth", peak.grid);
    for (std::size_t k = 0; k < cells_of(peak); ++k) {
        EXPECT_TRUE(same.values[k] == peak.values[k] || (std::isnan(same.values[k]) && std::isnan(peak.values[k])));
    }
    talus_grid half = peak.grid;
    half.cell /= 2;
    half.columns *= 2;
    half.rows *= 2;
    const talus_map fine = map_on(simulation, "peak_depth", half);
    for (int row = 0; row < half.rows; ++row) {
        for (int column = 0; column < half.columns; ++column) {
            const float a = fine.values[row * half.columns + column],
                        b = peak.values[row / 2 * peak.grid.columns + column / 2];
            ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << column << ", " << row;
        }
    }
}

TEST(Maps, have_no_holes_where_edges_of_the_callers_cells_run_through_the_middles_of_their_own) {
    const Simulation simulation = Slope().open();
    advance_to(simulation, 1);
    const talus_map peak = map_of(simulation, "peak_depth");
    // Every fifth edge in two of its own cells is in the middle of one, as far as decimals can say that.
    const double own = peak.grid.cell, cell = 0.4 * own;
    const talus_grid fine{peak.grid.x_min - 0.7 * own, peak.grid.y_min - 0.7 * own, cell, peak.grid.columns * 5 / 2 + 3,
                          peak.grid.rows * 5 / 2 + 3};
    const talus_map map = map_on(simulation, "peak_depth", fine);
    for (int row = 0; row < fine.rows; ++row) {
        for (int column = 0; column < fine.columns; ++column) {
            const double x = (fine.x_min + (column + 0.5) * cell - peak.grid.x_min) / own;
            const double y = (fine.y_min + (row + 0.5) * cell - peak.grid.y_min) / own;
            if (!(x >= 0 && y >= 0 && x < peak.grid.columns && y < peak.grid.rows)) continue;
            const float a = map.values[row * fine.columns + column],
                        b = peak.values[static_cast<int>(y) * peak.grid.columns + static_cast<int>(x)];
            ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << column << ", " << row;
        }
    }
}

TEST(Maps, refuse_names_and_cells_that_are_none) {
    const Simulation simulation = Slope().open();
    talus_error error = TALUS_SIZED(talus_error);
    talus_map map = TALUS_SIZED(talus_map);
    EXPECT_EQ(talus_get_map(simulation.get(), "velocity", &map, &error), TALUS_BAD_INPUT);
    EXPECT_STREQ(error.text,
                 "name = \"velocity\": must be one of depth, speed, peak_depth, peak_speed, peak_pressure, "
                 "arrival_time, deposit_depth, erosion_depth");
    const talus_grid good{0, 0, 1, 10, 10};
    EXPECT_EQ(talus_get_map_on(simulation.get(), "velocity", &good, &map, &error), TALUS_BAD_INPUT);
    const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
    for (const auto& [grid, sentence] :
         {std::pair{talus_grid{nan, 0, 1, 10, 10}, "grid.x_min = nan: must be a finite number"},
          {talus_grid{0, infinite, 1, 10, 10}, "grid.y_min = inf: must be a finite number"},
          {talus_grid{0, 0, nan, 10, 10}, "grid.cell = nan: must be a finite number above 0"},
          {talus_grid{0, 0, 0, 10, 10}, "grid.cell = 0: must be a finite number above 0"},
          {talus_grid{0, 0, 1, 0, 10}, "grid.columns = 0: must be 1 to 1048576"},
          {talus_grid{0, 0, 1, 10, -1}, "grid.rows = -1: must be 1 to 1048576"},
          {talus_grid{0, 0, 1, 1 << 20, 1 << 20},
           "grid: has 1048576 x 1048576 cells; it must have at most 400000000"}}) {
        EXPECT_EQ(talus_get_map_on(simulation.get(), "depth", &grid, &map, &error), TALUS_BAD_INPUT);
        EXPECT_STREQ(error.text, sentence);
        EXPECT_EQ(map.values, nullptr) << "nothing is written";
    }
}

TEST(Ground, is_what_entrainment_has_left) {
    const Simulation simulation = Slope().open();
    talus_error error = TALUS_SIZED(talus_error);
    EXPECT_NEAR(elevation_at(simulation, 25.5, 15.5), 200 - 0.5 * 25, 1e-3) << "at the centre of a cell";
    EXPECT_NEAR(elevation_at(simulation, 26, 15.5), 200 - 0.5 * 25.5, 1e-3) << "between two";
    ASSERT_EQ(talus_apply(simulation.get(),
                          R"({"action": "put_bed", "polygon": [[16, 5], [36, 5], [36, 25], [16, 25]], "depth_m": 1,
                              "growth_rate_per_m": 0.1})",
                          nullptr, &error),
              TALUS_OK)
        << error.text;
    advance_to(simulation, 3);
    const talus_map erosion = map_of(simulation, "erosion_depth");
    ASSERT_EQ(erosion.grid.cell, 1);
    std::vector<double> x_y;
    std::vector<float> eroded;
    for (int row = 0; row < erosion.grid.rows; ++row) {
        for (int column = 0; column < erosion.grid.columns; ++column) {
            const float depth = erosion.values[row * erosion.grid.columns + column];
            if (!(depth > 0)) continue;
            x_y.push_back(erosion.grid.x_min + column + 0.5);
            x_y.push_back(erosion.grid.y_min + row + 0.5);
            eroded.push_back(depth);
        }
    }
    ASSERT_GT(eroded.size(), 5U);
    std::vector<double> elevations(eroded.size());
    ASSERT_EQ(talus_get_elevations(simulation.get(), x_y.data(), eroded.size(), elevations.data(), &error), TALUS_OK)
        << error.text;
    for (std::size_t k = 0; k < eroded.size(); ++k) {
        EXPECT_NEAR(elevations[k], 200 - 0.5 * (x_y[2 * k] - 0.5) - eroded[k], 1e-3);
        EXPECT_EQ(elevations[k], elevation_at(simulation, x_y[2 * k], x_y[2 * k + 1])) << "one at a time";
    }
}

TEST(Ground, is_refused_where_there_is_none) {
    const Simulation simulation = Slope().open();
    talus_error error = TALUS_SIZED(talus_error);
    double z = 7;
    EXPECT_EQ(talus_get_elevation(simulation.get(), 1000, 15, &z, &error), TALUS_BAD_INPUT);
    EXPECT_STREQ(error.text, "x = 1000, y = 15: the ground is not known there; the terrain has x 0 to 60, y 0 to 30");
    EXPECT_EQ(talus_get_elevation(simulation.get(), std::nan(""), 15, &z, &error), TALUS_BAD_INPUT);
    EXPECT_STREQ(error.text, "x = nan: must be a finite number");
    EXPECT_EQ(z, 7) << "nothing is written";
    const double some[] = {10, 15, 1000, 15};
    double heights[] = {0, 0};
    ASSERT_EQ(talus_get_elevations(simulation.get(), some, 2, heights, &error), TALUS_OK) << error.text;
    EXPECT_GT(heights[0], 100);
    EXPECT_TRUE(std::isnan(heights[1])) << "off the terrain";
    EXPECT_EQ(talus_get_elevations(simulation.get(), some, 0, heights, &error), TALUS_OK) << "of no place";
    const double wrong[] = {10, 15, 20, std::nan("")};
    heights[0] = 7;
    EXPECT_EQ(talus_get_elevations(simulation.get(), wrong, 2, heights, &error), TALUS_BAD_INPUT);
    EXPECT_STREQ(error.text, "x_y[3] = nan: must be a finite number");
    EXPECT_EQ(heights[0], 7);
    EXPECT_EQ(talus_get_elevations(simulation.get(), some, std::size_t{1} << 40U, heights, &error), TALUS_BAD_INPUT);
    EXPECT_STREQ(error.text, "count = 1099511627776: must be at most 100000000");
}

TEST(Surface, lies_on_the_ground_as_high_as_the_debris_is_deep) {
    const Simulation simulation = Slope().open();
    advance_to(simulation, 1);
    talus_error error = TALUS_SIZED(talus_error);
    talus_surface surface = TALUS_SIZED(talus_surface);
    ASSERT_EQ(talus_get_surface(simulation.get(), &surface, &error), TALUS_OK) << error.text;
    ASSERT_GT(surface.vertex_count, 20U);
    ASSERT_GT(surface.index_count, 60U);
    ASSERT_EQ(surface.index_count % 3, 0U);
    const talus_state state = state_of(simulation);
    double fastest = 0;
    for (std::size_t v = 0; v < surface.vertex_count; ++v) {
        const float *p = surface.positions + 3 * v, *n = surface.normals + 3 * v;
        const double ground =
            elevation_at(simulation, p[0] + state.origin[0], p[1] + state.origin[1]) - state.origin[2];
        EXPECT_NEAR(p[2], ground + surface.depth[v], 1e-3);
        EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-5);
        EXPECT_GT(n[2], 0);
        fastest = std::fmax(fastest, surface.speed[v]);
    }
    EXPECT_NEAR(fastest, largest_of(map_of(simulation, "speed")), 0.5);
    // Above every triangle: counterclockwise in plan. Below it: the debris.
    double volume = 0;
    for (std::size_t k = 0; k < surface.index_count; k += 3) {
        std::uint32_t i[3];
        for (int c = 0; c < 3; ++c) {
            i[c] = surface.indices[k + c];
            ASSERT_LT(i[c], surface.vertex_count);
        }
        const float *a = surface.positions + 3 * i[0], *b = surface.positions + 3 * i[1],
                    *c = surface.positions + 3 * i[2];
        const double area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
        ASSERT_GT(area, 0);
        volume += area * (surface.depth[i[0]] + surface.depth[i[1]] + surface.depth[i[2]]) / 3;
    }
    EXPECT_NEAR(volume, 100, 5) << "of the debris, m3";
}

TEST(Surface, of_no_debris_is_empty) {
    Slope slope;
    slope.arrays.buildings = nullptr;
    slope.arrays.building_count = 0;
    const Simulation simulation = slope.open();
    talus_error error = TALUS_SIZED(talus_error);
    // All of it leaves: without friction, over the lower edge.
    ASSERT_EQ(talus_set(simulation.get(), "material.friction_coefficient", 0, &error), TALUS_OK) << error.text;
    advance_to(simulation, std::numeric_limits<double>::infinity());
    ASSERT_EQ(debris_of(simulation).count, 0U);
    talus_surface surface = TALUS_SIZED(talus_surface);
    ASSERT_EQ(talus_get_surface(simulation.get(), &surface, &error), TALUS_OK) << error.text;
    EXPECT_EQ(surface.vertex_count, 0U);
    EXPECT_EQ(surface.index_count, 0U);
    const talus_map map = map_on(simulation, "speed", {0, 0, 10, 6, 3});
    for (std::size_t k = 0; k < cells_of(map); ++k) EXPECT_TRUE(std::isnan(map.values[k]));
}

}  // namespace
}  // namespace talus::embed::test
