// The default method: density and internal friction as a stress per particle that persists between steps.
// Compiled once per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/cpu/stress_stages.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include "sim/cpu/lanes-inl.hpp"
#include "sim/cpu/stages.hpp"
#include "sim/physics/density.hpp"
#include "sim/physics/stress.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::sim::cpu::HWY_NAMESPACE {
namespace {

/// Packs the data of a particle that apply() reads; `pressing` is 1 or 0.
HWY_INLINE void pack_stress(Work& work, std::size_t i, const L& presses, const L& pressure, const Stress& s) {
    const L p = pressure * presses;
    const Stress t = s * presses;
    store_low({p + t.xx, t.xy, t.xz, p + t.yy}, work.stress, i);
    store_high({t.yz, p - t.xx - t.yy, L(0), p}, work.stress, i);
}

struct PairSums {
    L density, square, divergence;
    V3 gradient;
};

template <class Kernel>
HWY_INLINE PairSums sum_pairs(const PairScale& scale, const LaneLists& lists, const Work& work, const V3& p,
                              const V3& moved) {
    PairSums sums;
    lists.for_each([&](std::uint32_t k, const L& remaining) {
        const Octs<L> other = lists.gather(work.displaced, k);
        const V3 separation = p - vector_of(other.low);
        const L square = dot(separation, separation);
        const L q = scale.quotient(sqrt(square));
        const L slope = Kernel::slope_over_q(q) * L(-scale.gradient_scale);
        const V3 gradient = separation * slope;
        lists.keep(k, gradient);
        sums.density += select(remaining > L(0), Kernel::value(q), L(0));
        sums.square += slope * slope * square;
        sums.gradient += gradient;
        sums.divergence += dot(vector_of(other.high) - moved, gradient);
    });
    sums.density = L(scale.value_scale) * (sums.density + Kernel::value(L(0)));
    return sums;
}

/// This step starts from the multipliers and stresses of the last one: debris at rest needs the same ones again. They
/// are pressures times dt^2, so they scale with the step. Held debris keeps its values for its start and presses on
/// nothing.
HWY_INLINE void warm_start(State& state, Work& work, std::size_t i, const L& scale) {
    const L multiplier = load(state.multiplier, i) * scale;
    const Stress stress = load(state.stress, i) * scale;
    store(multiplier, state.multiplier, i);
    store(stress, state.stress, i);
    pack_stress(work, i, flags(state.held, i, 0, 1), multiplier, stress);
}

HWY_INLINE L warm_start_scale(const State& state) {
    const double ratio = state.previous_time_step > 0 ? state.time_step / state.previous_time_step : 0;
    return L(ratio * ratio);
}

TALUS_STAGE void press_asleep(const StageData& data, std::size_t first, std::size_t last) {
    State& state = data.state;
    Work& work = data.work;
    const L scale = warm_start_scale(state);
    for_each_lanes(first, last, [&](std::size_t i) { warm_start(state, work, i, scale); });
}

TALUS_STAGE void clear_asleep(const StageData& data, std::size_t first, std::size_t last) {
    Work& work = data.work;
    for_each_lanes(first, last, [&](std::size_t i) {
        store_low({}, work.stress, i);
        store_high({}, work.stress, i);
    });
}

template <class Kernel>
TALUS_STAGE void linearise(const StageData& data, std::size_t first, std::size_t last) {
    const Model& model = data.model;
    State& state = data.state;
    Work& work = data.work;
    NeighbourLists& neighbours = data.neighbours;
    const L scale_of_multipliers = warm_start_scale(state);
    const L softness(model.solver.constraint_relaxation * model.kernel.rest_gradient_sum);
    const PairScale scale(model.kernel);
    for_each_lanes(first, last, [&](std::size_t i) {
        const Octs<L> displaced = load(work.displaced, i);
        const V3 p = vector_of(displaced.low), moved = vector_of(displaced.high);
        const PairSums sums = sum_pairs<Kernel>(scale, LaneLists(neighbours, i), work, p, moved);
        const BoundaryShare boundary = sample_boundary_at(model, data.ground, state, work, i, p, moved);
        const DensityConstraint<L> constraint = linearise_density(model, sums, boundary, moved, softness);
        store(constraint.start, work.constraint_start, i);
        store(constraint.surface_share, work.surface_share, i);
        store(compression_before(constraint), work.tolerated_compression, i);
        store(constraint.gradient_square, work.gradient_square, i);
        store(constraint.pair_square, work.pair_square, i);
        warm_start(state, work, i, scale_of_multipliers);
    });
}

TALUS_STAGE void solve(const StageData& data, std::size_t first, std::size_t last) {
    const Model& model = data.model;
    State& state = data.state;
    Work& work = data.work;
    NeighbourLists& neighbours = data.neighbours;
    const L factor(jacobi_factor(model.solver.under_relaxation, model.kernel));
    const L internal_friction(model.internal_friction_coefficient);
    const L cohesion(internal_strength(model, state.time_step));
    const bool by_particle = resists_by_particle(model), cohesive = model.cohesion > 0;
    const InertialFriction& inertial = model.inertial_friction;
    const L grain_size(inertial.grain_size / model.kernel.gradient_moment);
    for_each_lanes(first, last, [&](std::size_t i) {
        const LaneLists lists(neighbours, i);
        const V3 moved = vector_of(load_high(work.displaced, i));
        DisplacementGradient<L> deformation;
        for (std::uint32_t k = 0; k < lists.length; ++k) {
            deformation.add(vector_of(lists.gather_high(work.displaced, k)) - moved, lists.gradient(k));
        }
        const L start = load(work.constraint_start, i);
        const L density = start - deformation.divergence() + boundary_change(load(work.boundary_gradient, i), moved);
        const L before = load(state.multiplier, i);
        const L after = next_multiplier(before, density - larger(L(0), start), load(work.gradient_square, i), factor);
        const Stress stress_before = load(state.stress, i);
        if (inertial.on) {
            add_ground_shear(deformation, moved, load(work.ground_normal, i), load(work.ground_slope, i),
                             load(work.ground_shear, i));
        }
        const Stress shear = deformation.shear();
        L friction = internal_friction, pressure = -after;
        if (by_particle) pressure = pressure * load(work.effective_share, i);
        if (inertial.on) {
            friction = inertial_friction(friction, L(inertial.rise), L(inertial.half), grain_size, shear, pressure);
        }
        const L limit =
            cohesive ? strength_limit_square(friction, pressure, cohesion) : friction_limit_square(friction, pressure);
        const Stress stress = next_stress(stress_before, shear, limit, load(work.pair_square, i), factor);
        const L mobile = load(work.mobile, i);
        const Mask moves = mobile > L(0);
        store(select(moves, after, before), state.multiplier, i);
        store(Stress{select(moves, stress.xx, stress_before.xx), select(moves, stress.yy, stress_before.yy),
                     select(moves, stress.xy, stress_before.xy), select(moves, stress.xz, stress_before.xz),
                     select(moves, stress.yz, stress_before.yz)},
              state.stress, i);
        store(larger(L(0), density - load(work.surface_share, i)) * mobile, work.compression, i);
        pack_stress(work, i, mobile, after - before, stress - stress_before);
    });
}

/// u_i += sum_j [(d lambda_i + d lambda_j) I + ds_i + ds_j] V grad W, equal and opposite for the two particles of a
/// pair.
TALUS_STAGE void apply(const StageData& data, std::size_t first, std::size_t last) {
    Work& work = data.work;
    NeighbourLists& neighbours = data.neighbours;
    for_each_lanes(first, last, [&](std::size_t i) {
        const LaneLists lists(neighbours, i);
        const auto [own, own_rest] = load(work.stress, i);
        V3 correction;
        for (std::uint32_t k = 0; k < lists.length; ++k) {
            const V3 gradient = lists.gradient(k);
            const auto [rows, rest] = lists.gather(work.stress, k);
            const L xy = own.y + rows.y, xz = own.z + rows.z, yz = own_rest.x + rest.x;
            correction += {dot({own.x + rows.x, xy, xz}, gradient), dot({xy, own.w + rows.w, yz}, gradient),
                           dot({xz, yz, own_rest.y + rest.y}, gradient)};
        }
        correction += boundary_correction(load(work.boundary_gradient, i), own_rest.w);
        store(vector_of(load_high(work.displaced, i)) + correction * load(work.mobile, i), work.corrected, i);
    });
}

TALUS_STAGE void find_spread(const StageData& data, std::size_t first, std::size_t last) {
    const Model& model = data.model;
    State& state = data.state;
    Work& work = data.work;
    const L factor(jacobi_factor(model.solver.under_relaxation, model.kernel));
    const L share(spreading_share(state.time_step));
    for_each_lanes(first, last, [&](std::size_t i) {
        const L excess = spread_in_step(load(work.compression, i), share);
        const L multiplier = next_multiplier(L(0), excess, load(work.gradient_square, i), factor);
        store_high(with(vector_of(load_high(work.displaced, i)), multiplier), work.displaced, i);
    });
}

TALUS_STAGE void spread(const StageData& data, std::size_t first, std::size_t last) {
    Work& work = data.work;
    NeighbourLists& neighbours = data.neighbours;
    for_each_lanes(first, last, [&](std::size_t i) {
        const LaneLists lists(neighbours, i);
        const L own = load_high(work.displaced, i).w;
        V3 shift = boundary_correction(load(work.boundary_gradient, i), own);
        for (std::uint32_t k = 0; k < lists.length; ++k) {
            shift += lists.gradient(k) * (own + lists.gather_high(work.displaced, k).w);
        }
        store(shift, work.shift, i);
    });
}

StressStages make_stages(params::KernelChoice kernel) {
    StressStages stages{nullptr, press_asleep, clear_asleep, solve, apply, find_spread, spread};
    with_kernel(kernel, [&](auto k) { stages.linearise = linearise<decltype(k)>; });
    return stages;
}

}  // namespace
}  // namespace talus::sim::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace talus::sim::cpu {

HWY_EXPORT(make_stages);

StressStages stress_stages_for(params::KernelChoice kernel) {
    return HWY_DYNAMIC_DISPATCH(make_stages)(kernel);
}

}  // namespace talus::sim::cpu
#endif
