#include "sim/reference/reference.hpp"

#include <algorithm>
#include <cmath>

#include "sim/physics/viscosity.hpp"

namespace talus::reference {
namespace {

/// V W and V grad_i W of a pair.
struct Pair {
    double value = 0;
    Vector gradient;
};

Pair pair_of(const Model& model, const Vector& separation) {
    const double r = model.support_radius, q = length(separation) / r;
    if (q >= 1) return {};
    return with_kernel(model.kernel.choice, [&](auto kernel) {
        const double scale = model.kernel.particle_volume / (r * r * r);
        return Pair{scale * kernel.value(q), separation * (-scale / (r * r) * kernel.slope_over_q(q))};
    });
}

double own_value(const Model& model) {
    return pair_of(model, {}).value;
}

/// Calls f(j, pair) for every other particle within the support radius.
template <class Points, class F>
void for_each_neighbour(const Model& model, std::size_t count, std::size_t i, const Points& point, const F& f) {
    for (std::size_t j = 0; j < count; ++j) {
        const Vector separation = point(i) - point(j);
        if (j != i && length(separation) < model.support_radius) f(j, pair_of(model, separation));
    }
}

}  // namespace

State::State(const talus::State& state)
    : time(state.time), time_step(state.time_step), previous_time_step(state.previous_time_step), step(state.step) {
    particles.resize(state.count);
    for (std::uint32_t i = 0; i < state.count; ++i) {
        Particle& p = particles[state.id[i]];
        const auto wide = [](const Vec3<float>& v) { return Vector{v.x, v.y, v.z}; };
        const Deviator<float> s = state.stress.at(i);
        p.position = wide(state.position.at(i));
        p.velocity = wide(state.velocity.at(i));
        p.multiplier = state.multiplier[i];
        p.pressure = state.pressure[i];
        p.stress = {s.xx, s.yy, s.xy, s.xz, s.yz};
        p.held = state.held[i] != 0;
    }
}

double constraint(const Model& model, const std::vector<Vector>& points, std::size_t i) {
    double density = own_value(model);
    for_each_neighbour(
        model, points.size(), i, [&](std::size_t k) { return points[k]; },
        [&](std::size_t, const Pair& pair) { density += pair.value; });
    return density + boundary_density(model, sample_boundary(model, points[i])).density - 1;
}

Vector constraint_gradient(const Model& model, const std::vector<Vector>& points, std::size_t i, std::size_t k) {
    if (k != i) return pair_of(model, points[i] - points[k]).gradient * -1.0;
    const auto boundary = boundary_density(model, sample_boundary(model, points[i]));
    Vector gradient = boundary.ground_gradient + boundary.building_gradient;
    for_each_neighbour(
        model, points.size(), i, [&](std::size_t j) { return points[j]; },
        [&](std::size_t, const Pair& pair) { gradient += pair.gradient; });
    return gradient;
}

void Backend::predict_positions(const Model& model, State& state) {
    for (std::size_t id = 0; id < state.particles.size(); ++id) {
        Particle& p = state.particles[id];
        for (const ReleaseGroup& release : model.releases) {
            const bool own = id >= release.first_particle && id < release.last_particle;
            if (own && state.time >= release.start_time) p.held = false;
        }
        p.displacement = {};
        if (!p.held) {
            p.velocity.z -= model.gravity * state.time_step;
            p.displacement = p.velocity * state.time_step;
        }
        p.ground = p.wall = {};
        p.building = -1;
    }
}

namespace {

/// x_i += sum_j [(d lambda_i + d lambda_j) I + ds_i + ds_j] V grad W at the given positions.
template <class Points>
void apply_stress_changes(const Model& model, State& state, const Points& point) {
    std::vector<Vector> corrections(state.particles.size());
    for (std::size_t i = 0; i < state.particles.size(); ++i) {
        const Particle& p = state.particles[i];
        if (p.held) continue;
        corrections[i] = (p.boundary.ground_gradient + p.boundary.building_gradient) * p.multiplier_change;
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
        corrections[i] = (p.boundary.ground_gradient + p.boundary.building_gradient) * p.multiplier_change;
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

}  // namespace

void Backend::warm_start(const Model& model, State& state) {
    const bool keeps_stress = model.solver.internal_friction == InternalFriction::stress;
    const double ratio = state.previous_time_step > 0 ? state.time_step / state.previous_time_step : 0;
    const double scale = keeps_stress ? ratio * ratio : 0;
    state.previous_time_step = state.time_step;
    std::vector<Vector> points;
    for (const Particle& p : state.particles) points.push_back(p.position);
    const double undone = model.solver.depenetration_speed * state.time_step / model.particle_spacing;
    for (std::size_t i = 0; i < points.size(); ++i) {
        Particle& p = state.particles[i];
        p.boundary = boundary_density(model, sample_boundary(model, points[i]));
        p.tolerated_compression = std::max(0.0, constraint(model, points, i) - undone);
        p.multiplier *= scale * (p.held ? 1 : StressConstants::warm_start);
        p.pressure *= scale;
        p.stress = p.stress_start = p.stress * scale;
        p.stress_change = p.held ? Deviator<double>{} : p.stress;
        p.multiplier_change = p.held ? 0 : p.multiplier;
    }
    if (keeps_stress) apply_stress_changes(model, state, [&](std::size_t k) { return points[k]; });
}

void Backend::solve_density(const Model& model, State& state) {
    const bool keeps_stress = model.solver.internal_friction == InternalFriction::stress;
    const double softness = model.solver.constraint_relaxation * model.kernel.rest_gradient_sum;
    std::vector<Vector> points;
    for (const Particle& p : state.particles) points.push_back(p.predicted());
    for (std::size_t i = 0; i < points.size(); ++i) {
        Particle& p = state.particles[i];
        p.multiplier_change = 0;
        p.stress_change = {};
        if (p.held) continue;
        p.boundary = boundary_density(model, sample_boundary(model, points[i]));
        double pair_square = softness;
        DisplacementGradient<double> deformation;
        for_each_neighbour(
            model, points.size(), i, [&](std::size_t k) { return points[k]; },
            [&](std::size_t j, const Pair& pair) {
                pair_square += dot(pair.gradient, pair.gradient);
                deformation.add(state.particles[j].displacement - p.displacement, pair.gradient);
            });
        const Vector own_gradient = constraint_gradient(model, points, i, i);
        const double gradient_square = pair_square + dot(own_gradient, own_gradient);
        const double violation = constraint(model, points, i) - p.tolerated_compression;
        const double before = p.multiplier;
        if (gradient_square > 0) {
            p.multiplier = std::min(0.0, before - model.solver.under_relaxation * violation / gradient_square);
        }
        p.multiplier_change = p.multiplier - before;
        if (!keeps_stress) continue;
        Deviator<double> stress = p.stress_start;
        if (pair_square > 0) stress = stress + deformation.shear() * (StressConstants::stiffness / pair_square);
        stress = limit_to_friction(stress, model.internal_friction_coefficient, p.pressure);
        p.stress_change = stress - p.stress;
        p.stress = stress;
    }
    if (keeps_stress) {
        apply_stress_changes(model, state, [&](std::size_t k) { return points[k]; });
    } else {
        apply_pair_corrections(model, state);
    }
}

void Backend::solve_contacts(const Model& model, State& state) {
    const double depenetration = model.solver.depenetration_speed * state.time_step;
    for (Particle& p : state.particles) {
        if (p.held) continue;
        const double ground_push = -p.multiplier * length(p.boundary.ground_gradient);
        const double building_push = -p.multiplier * length(p.boundary.building_gradient);
        p.displacement = resolve_contacts(model, p.position, p.displacement, depenetration, ground_push, building_push,
                                          p.ground, p.wall, p.building);
    }
}

void Backend::enforce_boundaries(const Model& model, State& state) {
    for (Particle& p : state.particles) {
        if (!p.held) p.displacement = free_end(model, p.position, p.displacement) - p.position;
    }
}

void Backend::update_velocities(const Model&, State& state) {
    for (Particle& p : state.particles) {
        if (p.held) continue;
        p.velocity = p.displacement * (1 / state.time_step);
        p.position = p.predicted();
        p.pressure += StressConstants::pressure_smoothing * (-p.multiplier - p.pressure);
    }
}

void Backend::apply_viscosity(const Model& model, State& state) {
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
    for (std::size_t i = 0; i < changes.size(); ++i) state.particles[i].velocity += changes[i];
}

}  // namespace talus::reference
