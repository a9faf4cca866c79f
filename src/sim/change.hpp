#pragma once

#include <cstddef>
#include <cstdint>

#include "core/geometry.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

/// What can be done to a state between two steps, within Simulation::change().
namespace talus {

/// Adds the particles of `more` (see seed_releases), their ids raised by `first_id`, and counts them as seeded.
void append_particles(State& state, const State& more, std::uint32_t first_id);

/// Adds a particle that is awake, behind the others, and returns its index; the arrays have room for it.
std::uint32_t add_particle(State& state, const LocalPoint& position, const LocalPoint& velocity, float multiplier);

/// Gives a particle a density of its own, kg/m3; see density_of().
void set_density(State& state, std::uint32_t particle, double density);

/// Removes the particles with ids [first, last); those that ran over the terrain's edge stay counted as outflow.
void remove_particles(State& state, std::uint32_t first, std::uint32_t last);

/// Wakes sleeping debris that lies in a rectangle of local plan coordinates: it moves if anything moves it.
void wake(State& state, const Extent& local);

/// Moves debris out of solids that came to stand where it lies, within a rectangle of local plan coordinates. Nothing
/// gains speed: velocity into a wall is lost, and what then lies too close is pushed apart without inertia. Held
/// particles stay.
void clear_solids(const Model& model, const Ground& ground, State& state, const Extent& local);

/// Removes a building's solid; debris that rested on it or against it wakes.
void remove_building(const Model& model, Ground& ground, State& state, std::size_t building);

}  // namespace talus
