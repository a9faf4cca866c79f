#include "sim/reference/reference.hpp"

#include <algorithm>
#include <cmath>

#include "sim/compression.hpp"
#include "sim/physics/viscosity.hpp"
#include "sim/reference/sums.hpp"

namespace talus::sim::reference {
namespace {

/// Debris whose soil no step has computed yet.
struct Started {
    const std::vector<Entry>& entry_of_id;
    const std::vector<Water>& water_of_release;
    std::vector<Soil<float>> soil_of_id = {};
};

Soil<double> wide(const Soil<float>& soil) {
    return {soil.solid_fraction, soil.pressure_ratio, soil.thickness, soil.dilatancy};
}

}  // namespace

State::State(const sim::State& state)
    : time(state.time), time_step(state.time_step), previous_time_step(state.previous_time_step), step(state.step) {
    entry_of_id = state.entry_of_id;
    water_of_release = state.water_of_release;
    for (const Soil<float>& soil : state.soil_of_id) soil_of_id.push_back(wide(soil));
    particles.resize(state.count);
    for (std::uint32_t i = 0; i < state.count; ++i) {
        Particle& p = particles[state.id[i]];
        const auto wide = [](const Vec3<float>& v) { return Vector{v.x, v.y, v.z}; };
        const Deviator<float> s = state.stress.at(i);
        p.position = wide(state.position.at(i));
        p.velocity = wide(state.velocity.at(i));
        p.multiplier = state.multiplier[i];
        p.stress = {s.xx, s.yy, s.xy, s.xz, s.yz};
        p.held = state.held[i] != 0;
    }
}

double constraint(const Model& model, const Ground& ground, const std::vector<Vector>& points, std::size_t i) {
    double density = own_value(model);
    for_each_neighbour(
        model, points.size(), i, [&](std::size_t k) { return points[k]; },
        [&](std::size_t, const Pair& pair) { density += pair.value; });
    return density + sample_boundary(model, ground, points[i]).density - 1;
}

Vector constraint_gradient(const Model& model, const Ground& ground, const std::vector<Vector>& points, std::size_t i,
                           std::size_t k) {
    if (k != i) return pair_of(model, points[i] - points[k]).gradient * -1.0;
    Vector gradient = sample_boundary(model, ground, points[i]).gradient;
    for_each_neighbour(
        model, points.size(), i, [&](std::size_t j) { return points[j]; },
        [&](std::size_t, const Pair& pair) { gradient += pair.gradient; });
    return gradient;
}

void Backend::release_held(const Model& model, State& state) {
    for (std::size_t id = 0; id < state.particles.size(); ++id) {
        for (const ReleaseGroup& release : model.releases) {
            const bool own = id >= release.first_particle && id < release.last_particle;
            if (own && state.time >= release.start_time) state.particles[id].held = false;
        }
    }
}

void Backend::apply_drag(const Model& model, const Ground& ground, State& state) {
    const bool slows = slows_by_speed(model), evolves = model.evolving_pressure.on;
    if (!slows && !evolves) return;
    if (evolves) state.soil_of_id.resize(state.particles.size());
    for (std::size_t id = 0; id < state.particles.size(); ++id) {
        Particle& p = state.particles[id];
        if (p.held) continue;
        const terrain::GroundSample<double> below = ground.terrain.sample(p.position.x, p.position.y);
        const double distance = (p.position.z - below.height) * below.normal.z;
        const double particles =
            particles_in_column(model, state, p.position) / open_share(model, ground, p.position, rank_of(id));
        const double thickness = flow_thickness(model, below, particles);
        if (evolves) {
            Soil<double>& soil = state.soil_of_id[id];
            const Vector along = p.velocity - below.normal * dot(p.velocity, below.normal);
            const bool started = soil.thickness > 0;
            if (!started) soil = wide(first_soil_of(model, state.entry_of_id, id));
            const Water water = water_of(model, state.water_of_release, id);
            if (water.rises()) soil.pressure_ratio = started ? soil.pressure_ratio + water.rise : water.ratio;
            soil = evolve(model.evolving_pressure, soil, model.gravity * below.normal.z, thickness, length(along),
                          state.time_step, water.rises() ? static_cast<double>(water.ratio) : -1.0);
        }
        if (!slows) continue;
        p.velocity = slowed_by_drag(model, ground_resistance(model, p.position), below, distance, thickness, p.velocity,
                                    state.time_step);
    }
}

void Backend::predict_positions(const Model& model, const Ground&, State& state) {
    for (Particle& p : state.particles) {
        p.displacement = {};
        if (p.held) continue;
        p.velocity.z -= model.gravity * state.time_step;
        p.displacement = p.velocity * state.time_step;
    }
}

void Backend::prepare_particles(const Model& model, const Ground& ground, State& state) {
    for (std::size_t id = 0; id < state.particles.size(); ++id) {
        Particle& p = state.particles[id];
        const bool evolved = id < state.soil_of_id.size() && state.soil_of_id[id].thickness > 0;
        p.effective_share =
            evolved ? friction_share(state.soil_of_id[id], model.internal_friction_coefficient)
                    : share_of_grains(model, Started{state.entry_of_id, state.water_of_release}, id, state.time);
        const GroundResistance<double> resistance = ground_resistance(model, p.position);
        const double before = state.previous_time_step;
        const double pressure = before > 0 ? -p.multiplier / (before * before) : 0;
        const double friction = moving_friction(model, ground.terrain, resistance.friction_coefficient, p.position,
                                                p.velocity, pressure, p.effective_share, state.time_step);
        p.ground_shear = model.inertial_friction.on ? shear_beside_ground(model, resistance.friction_coefficient) : 0;
        p.grip = {friction * p.effective_share, model.building_friction_coefficient * p.effective_share,
                  resistance.cohesion * strength_per_pascal(model, state.time_step)};
        p.contacts = {};
    }
}

namespace {

/// The pair sums of a particle at `point(k)`, for the displacements so far.
struct Sums {
    double density = 0, square = 0, divergence = 0;
    Vector gradient;
    DisplacementGradient<double> deformation;
};

template <class Points>
Sums sums_at(const Model& model, const State& state, const Points& point, std::size_t i) {
    Sums sums;
    sums.density = own_value(model);
    for_each_neighbour(model, state.particles.size(), i, point, [&](std::size_t j, const Pair& pair) {
        sums.density += pair.value;
        sums.square += dot(pair.gradient, pair.gradient);
        sums.gradient += pair.gradient;
        sums.deformation.add(state.particles[j].displacement - state.particles[i].displacement, pair.gradient);
    });
    sums.divergence = sums.deformation.divergence();
    return sums;
}

bool keeps_stress(const Model& model) {
    return model.solver.internal_friction == params::InternalFriction::stress;
}

/// u_i += sum_j [(d lambda_i + d lambda_j) I + ds_i + ds_j] V grad W at the linearised positions.
void apply_stress_changes(const Model& model, State& state) {
    const auto point = [&](std::size_t k) { return state.particles[k].linearised_at; };
    std::vector<Vector> corrections(state.particles.size());
    for (std::size_t i = 0; i < state.particles.size(); ++i) {
        const Particle& p = state.particles[i];
        if (p.held) continue;
        corrections[i] = boundary_correction(p.boundary.gradient, p.multiplier_change);
        for_each_neighbour(model, state.particles.size(), i, point, [&](std::size_t j, const Pair& pair) {
            const Particle& other = state.particles[j];
            corrections[i] += pair.gradient * (p.multiplier_change + other.multiplier_change) +
                              (p.stress_change + other.stress_change) * pair.gradient;
        });
    }
    for (std::size_t i = 0; i < corrections.size(); ++i) state.particles[i].displacement += corrections[i];
}

void apply_pair_corrections(const Model& model, State& state) {
    const double cap = pair_friction_cap(model.internal_friction_coefficient);
    std::vector<Vector> corrections(state.particles.size());
    const auto point = [&](std::size_t k) { return state.particles[k].predicted(); };
    for (std::size_t i = 0; i < state.particles.size(); ++i) {
        const Particle& p = state.particles[i];
        if (p.held) continue;
        corrections[i] = boundary_correction(p.boundary.gradient, p.multiplier_change);
        for_each_neighbour(model, state.particles.size(), i, point, [&](std::size_t j, const Pair& pair) {
            const Particle& other = state.particles[j];
            const double change = p.multiplier_change + other.multiplier_change;
            corrections[i] += pair.gradient * change;
            const double normal = -change * length(pair.gradient);
            if (normal > 0 && cap > 0) {
                const Vector separation = point(i) - point(j);
                corrections[i] += pair_friction(separation, dot(separation, separation),
                                                p.displacement - other.displacement, cap * normal, pair.value);
            }
        });
    }
    for (std::size_t i = 0; i < corrections.size(); ++i) state.particles[i].displacement += corrections[i];
}

void solve_stress(const Model& model, State& state) {
    const double factor = jacobi_factor(model.solver.under_relaxation, model.kernel);
    const auto point = [&](std::size_t k) { return state.particles[k].linearised_at; };
    for (std::size_t i = 0; i < state.particles.size(); ++i) {
        Particle& p = state.particles[i];
        p.multiplier_change = p.compression = 0;
        p.stress_change = {};
        if (p.held) continue;
        Sums sums = sums_at(model, state, point, i);
        const double density =
            p.constraint.start - sums.divergence + boundary_change(p.boundary.gradient, p.displacement);
        const double multiplier = next_multiplier(p.multiplier, density - std::max(0.0, p.constraint.start),
                                                  p.constraint.gradient_square, factor);
        const BoundaryFace<double>& ground = p.boundary.faces[0];
        add_ground_shear(sums.deformation, p.displacement, ground.normal, ground.slope, p.ground_shear);
        const Deviator<double> shear = sums.deformation.shear();
        const double pressure = -multiplier * p.effective_share;
        const InertialFriction& inertial = model.inertial_friction;
        const double friction = inertial_friction(model.internal_friction_coefficient, inertial.rise, inertial.half,
                                                  inertial.grain_size / model.kernel.gradient_moment, shear, pressure);
        const double cohesion = internal_strength(model, state.time_step);
        const Deviator<double> stress = next_stress(
            p.stress, shear, strength_limit_square(friction, pressure, cohesion), p.constraint.pair_square, factor);
        p.multiplier_change = multiplier - p.multiplier;
        p.stress_change = stress - p.stress;
        p.multiplier = multiplier;
        p.stress = stress;
        p.compression = std::max(0.0, density - p.constraint.surface_share);
    }
    apply_stress_changes(model, state);
}

void solve_pairs(const Model& model, const Ground& ground, State& state) {
    const double factor = jacobi_factor(model.solver.under_relaxation, model.kernel);
    const double softness = model.solver.constraint_relaxation * model.kernel.rest_gradient_sum;
    const auto point = [&](std::size_t k) { return state.particles[k].predicted(); };
    for (std::size_t i = 0; i < state.particles.size(); ++i) {
        Particle& p = state.particles[i];
        p.multiplier_change = 0;
        if (p.held) continue;
        p.boundary = sample_boundary(model, ground, p.predicted(), rank_of(i));
        p.sampled_at = p.displacement;
        const Sums sums = sums_at(model, state, point, i);
        const auto constraint = linearise_density(model, sums, p.boundary, p.displacement, softness);
        const double violation = sums.density + p.boundary.density - 1 - p.tolerated_compression;
        const double before = p.multiplier;
        p.multiplier = next_multiplier(before, violation, constraint.gradient_square, factor);
        p.multiplier_change = p.multiplier - before;
    }
    apply_pair_corrections(model, state);
}

}  // namespace

void Backend::warm_start(const Model& model, const Ground& ground, State& state) {
    const double ratio = state.previous_time_step > 0 ? state.time_step / state.previous_time_step : 0;
    const double scale = ratio * ratio;
    state.previous_time_step = state.time_step;
    for (std::size_t i = 0; i < state.particles.size(); ++i) {
        Particle& p = state.particles[i];
        p.sampled_at = p.displacement;
        p.linearised_at = p.predicted();
        p.boundary = sample_boundary(model, ground, p.linearised_at, rank_of(i));
    }
    if (keeps_stress(model)) {
        const double softness = model.solver.constraint_relaxation * model.kernel.rest_gradient_sum;
        const auto point = [&](std::size_t k) { return state.particles[k].linearised_at; };
        for (std::size_t i = 0; i < state.particles.size(); ++i) {
            Particle& p = state.particles[i];
            p.constraint =
                linearise_density(model, sums_at(model, state, point, i), p.boundary, p.displacement, softness);
            p.tolerated_compression = compression_before(p.constraint);
            p.multiplier *= scale;
            p.stress = p.stress * scale;
            p.stress_change = p.held ? Deviator<double>{} : p.stress;
            p.multiplier_change = p.held ? 0 : p.multiplier;
        }
        apply_stress_changes(model, state);
        return;
    }
    const double undone = model.solver.depenetration_speed * state.time_step / model.particle_spacing;
    std::vector<Vector> points;
    for (const Particle& p : state.particles) points.push_back(p.position);
    for (std::size_t i = 0; i < points.size(); ++i) {
        Particle& p = state.particles[i];
        p.multiplier = 0;
        p.tolerated_compression = std::max(0.0, constraint(model, ground, points, i) - undone);
    }
}

void Backend::solve_density(const Model& model, const Ground& ground, State& state) {
    if (keeps_stress(model)) {
        solve_stress(model, state);
    } else {
        solve_pairs(model, ground, state);
    }
}

void Backend::solve_contacts(const Model& model, const Ground&, State& state) {
    for (Particle& p : state.particles) {
        if (p.held) continue;
        p.displacement =
            resolve_contacts(model, p.boundary, p.sampled_at, p.displacement, p.multiplier, p.grip, p.contacts);
    }
}

void Backend::measure_compression(const Model&, State& state) {
    CompressionSum sum;
    for (const Particle& p : state.particles) {
        sum.add(static_cast<float>(p.compression), static_cast<float>(p.tolerated_compression));
    }
    sum.write(state, static_cast<double>(state.particles.size()));
}

void Backend::resolve_penetration(const Model& model, const Ground& ground, State& state) {
    const double factor = jacobi_factor(model.solver.under_relaxation, model.kernel);
    const double share = spreading_share(state.time_step), max_shift = model.particle_spacing / 4;
    const auto point = [&](std::size_t k) { return state.particles[k].linearised_at; };
    std::vector<double> spread(state.particles.size());
    for (std::size_t i = 0; i < spread.size(); ++i) {
        const Particle& p = state.particles[i];
        spread[i] = next_multiplier(0.0, spread_in_step(p.compression, share), p.constraint.gradient_square, factor);
    }
    for (std::size_t i = 0; i < spread.size(); ++i) {
        Particle& p = state.particles[i];
        p.shift = {};
        if (p.held) continue;
        if (keeps_stress(model)) {
            p.shift = boundary_correction(p.boundary.gradient, spread[i]);
            for_each_neighbour(model, spread.size(), i, point, [&](std::size_t j, const Pair& pair) {
                p.shift += pair.gradient * (spread[i] + spread[j]);
            });
        }
        p.shift += undo_overlap(model, ground, p.predicted(), max_shift, rank_of(i));
        const double size = length(p.shift);
        if (size > max_shift) p.shift = p.shift * (max_shift / size);
    }
}

void Backend::enforce_boundaries(const Model& model, const Ground& ground, State& state) {
    for (std::size_t i = 0; i < state.particles.size(); ++i) {
        Particle& p = state.particles[i];
        if (p.held) continue;
        p.displacement = free_end(model, ground, p.position, p.displacement, rank_of(i)) - p.position;
        p.shift = free_end(model, ground, p.predicted(), p.shift, rank_of(i)) - p.predicted();
    }
}

void Backend::update_velocities(const Model&, const Ground&, State& state) {
    for (Particle& p : state.particles) {
        if (p.held) continue;
        p.velocity = p.displacement * (1 / state.time_step);
        p.position = p.predicted() + p.shift;
    }
}

void Backend::apply_viscosity(const Model& model, const Ground& ground, State& state) {
    const double smoothing = step_smoothing(model.viscosity, state.time_step);
    std::vector<Vector> changes(state.particles.size());
    for (std::size_t i = 0; i < changes.size(); ++i) {
        if (state.particles[i].held) continue;
        for_each_neighbour(
            model, changes.size(), i, [&](std::size_t k) { return state.particles[k].position; },
            [&](std::size_t j, const Pair& pair) {
                changes[i] += (state.particles[j].velocity - state.particles[i].velocity) * (smoothing * pair.value);
            });
    }
    for (std::size_t i = 0; i < changes.size(); ++i) {
        Particle& p = state.particles[i];
        p.velocity += changes[i];
        if (p.held || !model.viscosity_on_ground) continue;
        const terrain::GroundSample<double> below = ground.terrain.sample(p.position.x, p.position.y);
        p.velocity =
            slowed_by_ground(model, below, (p.position.z - below.height) * below.normal.z, p.velocity, smoothing);
    }
}

}  // namespace talus::sim::reference
