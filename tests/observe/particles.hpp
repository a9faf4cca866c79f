#pragma once

#include <cstdint>

#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"
#include "terrain/flow_path.hpp"

namespace talus::test {

/// Ground of 200 x 200 m at `slope` (rising westward, so that debris runs east), its middle the world's (1000, 2000).
inline sim::Ground make_ground(double slope = 0, double cell = 2) {
    const int cells = static_cast<int>(200 / cell);
    Grid<float> grid(GridGeometry{900, 1900, cell, cells, cells});
    for (int r = 0; r < cells; ++r) {
        for (int c = 0; c < cells; ++c)
            grid.at(c, r) = static_cast<float>(50 + slope * (1100 - grid.geometry.centre(c, r).x));
    }
    return sim::Ground(terrain::Terrain(grid));
}

/// Eastward along that ground's middle.
inline terrain::FlowPath straight_path() {
    return terrain::FlowPath({{910, 2000}, {1090, 2000}}, 40);
}

inline sim::Model make_model(double spacing = 0.4) {
    sim::Model model;
    model.particle_spacing = spacing;
    model.support_radius = 2.2 * spacing;
    model.rest_density = 2000;
    return model;
}

inline void add_particle(sim::State& state, const LocalPoint& p, const LocalPoint& v = {}, bool held = false) {
    state.id.push_back(state.count);
    state.held.push_back(held ? 1 : 0);
    ++state.count;
    ++state.seeded;
    state.position.resize(state.count);
    state.velocity.resize(state.count);
    state.position.set(state.count - 1, p);
    state.velocity.set(state.count - 1, v);
}

/// A block of particles on the lattice of the spacing, from (x, y) eastward, northward and up from z = 0.
inline sim::State block(double spacing, double x, double y, int columns, int rows, int layers,
                        const LocalPoint& velocity = {}) {
    sim::State state;
    for (int k = 0; k < layers; ++k) {
        for (int j = 0; j < rows; ++j) {
            for (int i = 0; i < columns; ++i) {
                add_particle(state,
                             {static_cast<float>(x + (i + 0.5) * spacing), static_cast<float>(y + (j + 0.5) * spacing),
                              static_cast<float>((k + 0.5) * spacing)},
                             velocity);
            }
        }
    }
    return state;
}

/// Free flight for one step: positions follow velocities.
inline void advance(sim::State& state, double time_step) {
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (state.held[i] != 0) continue;
        state.position.set(i, state.position.at(i) + static_cast<float>(time_step) * state.velocity.at(i));
    }
    state.time_step = time_step;
    state.time += time_step;
    ++state.step;
}

}  // namespace talus::test
