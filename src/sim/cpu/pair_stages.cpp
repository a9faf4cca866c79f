// Pairwise position-based dynamics (docs/equations.md), eqs. (1) to (4): density and pair friction, both start from
// zero in every step. Compiled once per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/cpu/pair_stages.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include "sim/cpu/lanes-inl.hpp"
#include "sim/cpu/stages.hpp"
#include "sim/physics/density.hpp"
#include "sim/physics/friction.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::sim::cpu::HWY_NAMESPACE {
namespace {

/// Compression present at the step's start may be undone only slowly, since a correction becomes velocity: the density
/// constraint tolerates the rest.
template <class Kernel>
TALUS_STAGE void find_tolerated(const StageData& data, std::size_t first, std::size_t last) {
    const Model& model = data.model;
    State& state = data.state;
    Work& work = data.work;
    NeighbourLists& neighbours = data.neighbours;
    const L undone(model.solver.depenetration_speed * state.time_step / model.particle_spacing);
    const PairScale scale(model.kernel);
    for_each_lanes(first, last, [&](std::size_t i) {
        const LaneLists lists(neighbours, i);
        const V3 p = vector_of(load_low(work.motion, i));
        L density;
        lists.for_each([&](std::uint32_t k, const L& remaining) {
            const L q = scale.quotient(length(p - vector_of(lists.gather_low(work.motion, k))));
            density += select(remaining > L(0), Kernel::value(q), L(0));
        });
        density = L(scale.value_scale) * (density + Kernel::value(L(0)));
        const L start = density + sample_boundary_at(model, data.ground, state, work, i, p, V3{}).density - L(1);
        store(larger(L(0), start - undone), work.tolerated_compression, i);
        store(L(0), state.multiplier, i);
        // The first contacts are resolved before the first iteration.
        const auto [predicted, moved] = load(work.displaced, i);
        sample_boundary_at(model, data.ground, state, work, i, vector_of(predicted), vector_of(moved));
    });
}

struct PairSums {
    L density, square;
    V3 gradient;
};

/// Debris resists compression only.
template <class Kernel>
TALUS_STAGE void update_multipliers(const StageData& data, std::size_t first, std::size_t last) {
    const Model& model = data.model;
    State& state = data.state;
    Work& work = data.work;
    NeighbourLists& neighbours = data.neighbours;
    const L softness(model.solver.constraint_relaxation * model.kernel.rest_gradient_sum);
    const L factor(jacobi_factor(model.solver.under_relaxation, model.kernel));
    const PairScale scale(model.kernel);
    for_each_lanes(first, last, [&](std::size_t i) {
        const LaneLists lists(neighbours, i);
        auto [point, moved] = load(work.displaced, i);
        const V3 p = vector_of(point);
        PairSums sums;
        lists.for_each([&](std::uint32_t k, const L& remaining) {
            const V3 separation = p - vector_of(lists.gather_low(work.displaced, k));
            const L square = dot(separation, separation);
            const L q = scale.quotient(sqrt(square));
            const L slope = Kernel::slope_over_q(q) * L(-scale.gradient_scale);
            sums.density += select(remaining > L(0), Kernel::value(q), L(0));
            sums.square += slope * slope * square;
            sums.gradient += separation * slope;
        });
        sums.density = L(scale.value_scale) * (sums.density + Kernel::value(L(0)));

        const BoundaryShare boundary = sample_boundary_at(model, data.ground, state, work, i, p, vector_of(moved));
        const L compression = sums.density + boundary.density - L(1);
        const L before = load(state.multiplier, i), mobile = load(work.mobile, i);
        const L after = next_multiplier(before, compression - load(work.tolerated_compression, i),
                                        gradient_square(sums, boundary, softness), factor);
        moved.w = (after - before) * mobile;
        store(select(mobile > L(0), after, before), state.multiplier, i);
        store(larger(L(0), compression) * mobile, work.compression, i);
        store_high(moved, work.displaced, i);
    });
}

/// Friction between particles pressed together; equal and opposite for the two of a pair.
template <class Kernel>
TALUS_STAGE void apply(const StageData& data, std::size_t first, std::size_t last) {
    const Model& model = data.model;
    Work& work = data.work;
    NeighbourLists& neighbours = data.neighbours;
    const L cap(pair_friction_cap(model.internal_friction_coefficient));
    const PairScale scale(model.kernel);
    for_each_lanes(first, last, [&](std::size_t i) {
        const LaneLists lists(neighbours, i);
        const auto [point, moved] = load(work.displaced, i);
        const V3 p = vector_of(point);
        V3 correction = boundary_correction(load(work.boundary_gradient, i), moved.w);
        for (std::uint32_t k = 0; k < lists.length; ++k) {
            const auto [place, other] = lists.gather(work.displaced, k);
            const V3 separation = p - vector_of(place);
            const L square = dot(separation, separation), distance = sqrt(square);
            const L q = scale.quotient(distance);
            const L push = (moved.w + other.w) * L(-scale.gradient_scale) * Kernel::slope_over_q(q);
            const L limit = larger(L(0), push * distance) * cap;  // none between separating particles
            correction += separation * push + pair_friction(separation, square, vector_of(moved) - vector_of(other),
                                                            limit, Kernel::value(q) * L(scale.value_scale));
        }
        store(vector_of(moved) + correction * load(work.mobile, i), work.corrected, i);
    });
}

PairStages make_stages(params::KernelChoice kernel) {
    return with_kernel(kernel, [&](auto k) {
        using Kernel = decltype(k);
        return PairStages{find_tolerated<Kernel>, update_multipliers<Kernel>, apply<Kernel>};
    });
}

}  // namespace
}  // namespace talus::sim::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace talus::sim::cpu {

HWY_EXPORT(make_stages);

PairStages pair_stages_for(params::KernelChoice kernel) {
    return HWY_DYNAMIC_DISPATCH(make_stages)(kernel);
}

}  // namespace talus::sim::cpu
#endif
