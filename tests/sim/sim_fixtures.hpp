#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "sim/simulation.hpp"
#include "sim/sources/seed.hpp"
#include "terrain/release.hpp"

/// Small worlds for tests of the solver.
namespace talus::testing {

inline constexpr double coarse_spacing = 0.5, fine_spacing = 0.4;  ///< m

/// A terrain of `columns` x `rows` cells with elevations from a function of world x, y.
inline terrain::Terrain terrain_of(int columns, int rows, double cell,
                                   const std::function<double(double, double)>& elevation) {
    Grid<float> grid(GridGeometry{0, 0, cell, columns, rows});
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const PlanPoint p = grid.geometry.centre(column, row);
            grid.at(column, row) = static_cast<float>(elevation(p.x, p.y));
        }
    }
    return terrain::Terrain(std::move(grid));
}

/// A plane that falls towards +x at an angle in degrees.
inline terrain::Terrain inclined_plane(double degrees, int columns = 80, int rows = 40) {
    const double slope = std::tan(degrees * M_PI / 180);
    return terrain_of(columns, rows, 1, [=](double x, double) { return 200 - slope * x; });
}

inline Polygon rectangle(double x_min, double y_min, double x_max, double y_max) {
    return {{{x_min, y_min}, {x_max, y_min}, {x_max, y_max}, {x_min, y_max}}, {}};
}

inline terrain::Release block(const terrain::Terrain& terrain, const Polygon& polygon, double thickness,
                              double start_time = 0) {
    terrain::Release release;
    release.name = "block";
    release.spec.start_time = start_time;
    release.patches.push_back({polygon, thickness});
    release.volume = release_volume(terrain, release);
    return release;
}

/// A simulation of releases on a terrain.
inline sim::Simulation simulate(const params::MaterialSpec& material, const params::SolverSpec& solver,
                                const terrain::Terrain& terrain, const std::vector<terrain::Release>& releases,
                                double spacing, std::vector<terrain::Building> buildings = {}) {
    place_buildings(terrain, buildings);
    sim::Model model = sim::make_model(material, solver, spacing);
    sim::Ground ground(terrain, std::move(buildings), model.support_radius);
    Result<sim::State> state = seed_releases(model, ground, releases);
    return {std::move(model), std::move(ground), *std::move(state)};
}

/// A state of given particles, without any release.
inline sim::State state_of(const std::vector<LocalPoint>& points, const std::vector<LocalPoint>& velocities = {}) {
    sim::State state;
    state.resize(points.size());
    state.count = state.seeded = static_cast<std::uint32_t>(points.size());
    for (std::uint32_t i = 0; i < state.count; ++i) {
        state.position.set(i, points[i]);
        state.velocity.set(i, velocities.empty() ? LocalPoint{} : velocities[i]);
        state.id[i] = i;
    }
    return state;
}

inline std::vector<LocalPoint> random_points(std::size_t count, LocalPoint low, LocalPoint high, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<LocalPoint> points(count);
    for (LocalPoint& p : points) {
        p = {low.x + unit(random) * (high.x - low.x), low.y + unit(random) * (high.y - low.y),
             low.z + unit(random) * (high.z - low.z)};
    }
    return points;
}

}  // namespace talus::testing
