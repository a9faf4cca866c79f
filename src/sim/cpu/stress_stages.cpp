// The default method: density and internal friction as a stress per particle that persists between steps.
// Compiled once per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/cpu/stress_stages.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include "sim/cpu/lanes-inl.hpp"
#include "sim/cpu/stages.hpp"
#include "sim/stages/stress.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::sim::cpu::HWY_NAMESPACE {
namespace {

TALUS_STAGE void press_asleep(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(data, first, last, [](const Particles& at) TALUS_INLINE_LAMBDA { stages::warm_start(at); });
}

TALUS_STAGE void clear_asleep(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(data, first, last, [](const Particles& at) TALUS_INLINE_LAMBDA { at.set_stress_change({}); });
}

template <class Kernel>
TALUS_STAGE void linearise(const StageData& data, std::size_t first, std::size_t last) {
    const stages::PairKernel<Kernel> kernel{{}, PairScale(data.model.kernel)};
    for_each_lanes(data, first, last, [&](const Particles& at) TALUS_INLINE_LAMBDA { stages::linearise(at, kernel); });
}

TALUS_STAGE void solve(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(data, first, last, [](const Particles& at) TALUS_INLINE_LAMBDA { stages::solve_stress(at); });
}

TALUS_STAGE void apply(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(data, first, last, [](const Particles& at) TALUS_INLINE_LAMBDA { stages::apply_stress(at); });
}

TALUS_STAGE void find_spread(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(data, first, last, [](const Particles& at) TALUS_INLINE_LAMBDA { stages::find_spread(at); });
}

TALUS_STAGE void spread(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(data, first, last, [](const Particles& at) TALUS_INLINE_LAMBDA { stages::spread(at); });
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
