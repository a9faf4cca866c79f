#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/geometry.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

/// Edits to a state between two steps, within Simulation::change().
namespace talus::sim {

/// Adds the particles of `more` (see seed_releases), their ids raised by `first_id`, and counts them as seeded.
void append_particles(State& state, const State& more, std::uint32_t first_id);

/// Adds a particle that is awake, at the end, and returns its index; the arrays must have room for it.
std::uint32_t add_particle(State& state, const LocalPoint& position, const LocalPoint& velocity, float multiplier);

/// Gives a particle a density of its own, kg/m3; see density_of().
void set_density(State& state, std::uint32_t particle, double density);

/// Says when a particle came in, s, and with which r_u (negative: the material's), if its pore pressure depends on it.
/// `solid_fraction`: of its soil, where pore pressure evolves.
void set_entry(const Model& model, State& state, std::uint32_t particle, double time, double pore_pressure_ratio = -1,
               std::optional<double> solid_fraction = {});

/// With evolving pore pressure, soil_of_id must have an element per particle ever added before a step.
void make_room_for_soil(const Model& model, State& state);
/// Pore pressure and solid fraction are those of the start again, as before the first step. Where steps only search for
/// the pressures between particles, nothing has flowed.
void forget_soil(const Model& model, State& state);

/// Removes the particles with ids [first, last); those that left the terrain remain counted as outflow.
void remove_particles(State& state, std::uint32_t first, std::uint32_t last);

/// Wakes sleeping debris that lies in a rectangle of local plan coordinates: it moves again if a force acts on it.
void wake(State& state, const Extent& local);

/// Moves debris out of solids placed where it lies, within a rectangle of local plan coordinates. No particle gains
/// speed: velocity into a wall is lost, and particles that are then too close are pushed apart without inertia. Held
/// particles are not moved.
void clear_solids(const Model& model, const Ground& ground, State& state, const Extent& local);

/// Removes a building's solid; debris resting on it or against it is woken.
void remove_building(const Model& model, Ground& ground, State& state, std::size_t building);

}  // namespace talus::sim
