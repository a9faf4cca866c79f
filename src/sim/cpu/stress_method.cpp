// The default method: density and internal friction as a stress per particle that persists between steps.
#include <algorithm>

#include "sim/cpu/backend.hpp"
#include "sim/cpu/parallel.hpp"
#include "sim/physics/stress.hpp"

namespace talus::cpu {

/// Multipliers and stresses of the last step are where this one begins: debris at rest needs the same ones again. They
/// are pressures times dt^2, so they scale with the step.
void Backend::warm_start_stress(const Model& model, State& state) {
    const double ratio = state.previous_time_step > 0 ? state.time_step / state.previous_time_step : 0;
    const auto scale = static_cast<float>(ratio * ratio);
    state.previous_time_step = state.time_step;
    linearise(model, state);
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            state.multiplier[i] *= scale;
            const Deviator<float> stress = state.stress.at(i) * scale;
            state.stress.set(i, stress);
            // Debris that is held keeps what it carries, ready for its start, and presses on nothing.
            pack_stress(i, state.held[i] ? 0 : state.multiplier[i], state.held[i] ? Deviator<float>{} : stress);
        }
    });
    apply_stress(state);
}

/// Density constraints and pair gradients at the predicted positions: the iterations work with those.
void Backend::linearise(const Model& model, const State& state) {
    const auto softness = static_cast<float>(model.solver.constraint_relaxation * model.kernel.rest_gradient_sum);
    pack(predicted_, state.count, packed_points_);
    pack(displacement_, state.count, packed_vectors_);
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const DensitySums sums =
                sums_.density_and_divergence(scale_, neighbours_.pairs_of(i), packed_points_, packed_vectors_, i);
            boundary_[i] = sample_boundary(model, predicted_.at(i));
            sampled_at_.set(i, displacement_.at(i));
            constraint_[i] = linearise_density(model, sums, boundary_[i], displacement_.at(i), softness);
        }
    });
}

/// Eqs. (1) and (2), and the stress that resists the shear of this step as far as friction goes.
void Backend::solve_stress(const Model& model, State& state) {
    const auto factor = static_cast<float>(jacobi_factor(model.solver.under_relaxation, model.kernel));
    const auto internal_friction = static_cast<float>(model.internal_friction_coefficient);
    pack(displacement_, state.count, packed_vectors_);
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (state.held[i]) {
                pack_stress(i, 0, {});
                compression_[i] = 0;
                continue;
            }
            const DisplacementGradient<float> deformation =
                sums_.deformation(neighbours_.pairs_of(i), packed_vectors_, i);
            const DensityConstraint<float>& constraint = constraint_[i];
            const float density = constraint.start - deformation.divergence() +
                                  boundary_change(boundary_[i].gradient, displacement_.at(i));
            const float before = state.multiplier[i];
            const float after =
                next_multiplier(before, density - std::max(0.0f, constraint.start), constraint.gradient_square, factor);
            const Deviator<float> stress_before = state.stress.at(i);
            const Deviator<float> stress =
                next_stress(stress_before, deformation, internal_friction, after, constraint.pair_square, factor);
            state.multiplier[i] = after;
            state.stress.set(i, stress);
            compression_[i] = std::max(0.0f, density - constraint.surface_share);
            pack_stress(i, after - before, stress - stress_before);
        }
    });
    apply_stress(state);
}

/// Lays out what apply_stress() reads of a particle.
void Backend::pack_stress(std::size_t i, float pressure, const Deviator<float>& s) {
    packed_rows_[i] = {pressure + s.xx, s.xy, s.xz, pressure + s.yy};
    packed_rest_[i] = {s.yz, pressure - s.xx - s.yy, 0, pressure};
}

/// Eq. (3) with the full stress: u_i += sum_j [(d lambda_i + d lambda_j) I + ds_i + ds_j] V grad W, equal and opposite
/// for the two particles of a pair.
void Backend::apply_stress(const State& state) {
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (state.held[i]) continue;
            displacement_.set(i, displacement_.at(i) + boundary_correction(boundary_[i].gradient, packed_rest_[i][3]) +
                                     sums_.stress_correction(neighbours_.pairs_of(i), packed_rows_, packed_rest_, i));
        }
    });
}

/// Spreads what is denser than at rest, as a shift of positions.
void Backend::spread(const Model& model, const State& state) {
    const auto factor = static_cast<float>(jacobi_factor(model.solver.under_relaxation, model.kernel));
    const auto share = static_cast<float>(spreading_share(state.time_step));
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            packed_points_[i][3] =
                next_multiplier(0.0f, spread_in_step(compression_[i], share), constraint_[i].gradient_square, factor);
        }
    });
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            shift_.set(i, boundary_correction(boundary_[i].gradient, packed_points_[i][3]) +
                              sums_.scalar_correction(neighbours_.pairs_of(i), packed_points_, i));
        }
    });
}

}  // namespace talus::cpu
