// The published method, eqs. (1) to (4): density and pair friction, both built up from nothing in every step.
#include <algorithm>

#include "sim/cpu/backend.hpp"
#include "sim/cpu/parallel.hpp"
#include "sim/physics/friction.hpp"

namespace talus::cpu {

/// What a step starts with compressed may be undone only slowly, since a correction turns into velocity: the density
/// constraint tolerates the rest.
void Backend::start_pairs(const Model& model, State& state) {
    const auto undone = static_cast<float>(model.solver.depenetration_speed * state.time_step / model.particle_spacing);
    state.previous_time_step = state.time_step;
    pack(state.position, state.count, packed_points_);
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const float density = sums_.density(scale_, neighbours_.pairs_of(i), packed_points_, i).density;
            const auto boundary = sample_boundary(model, state.position.at(i));
            boundary_[i] = sample_boundary(model, predicted_.at(i));
            sampled_at_.set(i, displacement_.at(i));
            tolerated_compression_[i] = std::max(0.0f, density + boundary.density - 1 - undone);
            state.multiplier[i] = 0;
        }
    });
}

void Backend::solve_pairs(const Model& model, State& state) {
    update_pair_multipliers(model, state);
    apply_pairs(model, state);
}

/// Eqs. (1) and (2): the density constraint G and its multiplier lambda, unilateral: debris resists compression only.
void Backend::update_pair_multipliers(const Model& model, State& state) {
    const auto softness = static_cast<float>(model.solver.constraint_relaxation * model.kernel.rest_gradient_sum);
    const auto factor = static_cast<float>(jacobi_factor(model.solver.under_relaxation, model.kernel));
    pack(predicted_, state.count, packed_points_);
    pack(displacement_, state.count, packed_vectors_);
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            multiplier_change_[i] = compression_[i] = 0;
            if (state.held[i]) continue;
            const DensitySums sums =
                sums_.density_and_divergence(scale_, neighbours_.pairs_of(i), packed_points_, packed_vectors_, i);
            const Boundary<float>& boundary = boundary_[i] = sample_boundary(model, predicted_.at(i));
            sampled_at_.set(i, displacement_.at(i));
            const auto constraint = linearise_density(model, sums, boundary, displacement_.at(i), softness);
            const float compression = sums.density + boundary.density - 1;
            const float before = state.multiplier[i];
            state.multiplier[i] =
                next_multiplier(before, compression - tolerated_compression_[i], constraint.gradient_square, factor);
            multiplier_change_[i] = state.multiplier[i] - before;
            compression_[i] = std::max(0.0f, compression);
        }
    });
}

/// Eqs. (3) and (4): pairs pressed together rub against each other. Equal and opposite for the two of a pair.
void Backend::apply_pairs(const Model& model, const State& state) {
    const auto cap = static_cast<float>(pair_friction_cap(model.internal_friction_coefficient));
    pack(predicted_, state.count, packed_points_);  // again: multipliers have changed
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (state.held[i]) continue;
            displacement_.set(
                i, displacement_.at(i) + boundary_correction(boundary_[i].gradient, multiplier_change_[i]) +
                       sums_.pair_correction(scale_, neighbours_.pairs_of(i), packed_points_, packed_vectors_, cap, i));
        }
    });
}

}  // namespace talus::cpu
