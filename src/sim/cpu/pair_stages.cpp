// Pairwise position-based dynamics (docs/equations.md), eqs. (1) to (4): density and pair friction, both start from
// zero in every step. Compiled once per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/cpu/pair_stages.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include "sim/cpu/lanes-inl.hpp"
#include "sim/cpu/stages.hpp"
#include "sim/stages/pair_friction.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::sim::cpu::HWY_NAMESPACE {
namespace {

template <class Kernel>
TALUS_STAGE void find_tolerated(const StageData& data, std::size_t first, std::size_t last) {
    const stages::PairKernel<Kernel> kernel{{}, PairScale(data.model.kernel)};
    for_each_lanes(data, first, last,
                   [&](const Particles& at) TALUS_INLINE_LAMBDA { stages::find_tolerated(at, kernel); });
}

template <class Kernel>
TALUS_STAGE void update_multipliers(const StageData& data, std::size_t first, std::size_t last) {
    const stages::PairKernel<Kernel> kernel{{}, PairScale(data.model.kernel)};
    for_each_lanes(data, first, last,
                   [&](const Particles& at) TALUS_INLINE_LAMBDA { stages::update_multipliers(at, kernel); });
}

template <class Kernel>
TALUS_STAGE void apply(const StageData& data, std::size_t first, std::size_t last) {
    const stages::PairKernel<Kernel> kernel{{}, PairScale(data.model.kernel)};
    for_each_lanes(data, first, last,
                   [&](const Particles& at) TALUS_INLINE_LAMBDA { stages::apply_pairs(at, kernel); });
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
