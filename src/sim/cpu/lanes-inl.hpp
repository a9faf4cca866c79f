// Shared by every file of stages; included once per instruction set.
#if defined(TALUS_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TALUS_LANES_INL
#undef TALUS_LANES_INL
#else
#define TALUS_LANES_INL
#endif

#include <hwy/highway.h>

#include "sim/cpu/lane_particles.hpp"

/// Everything that a stage calls is inlined into it, so formulas of any header are compiled for its instruction set.
#define TALUS_STAGE [[gnu::flatten]]

HWY_BEFORE_NAMESPACE();
namespace talus::sim::cpu::HWY_NAMESPACE {

constexpr int lane_count = HWY_MAX_BYTES >= 64 ? 16 : HWY_MAX_BYTES >= 32 ? 8 : 4;
static_assert(block_size % lane_count == 0);
using Particles = LaneParticles<lane_count>;
using L = Particles::Real;
using V3 = Particles::Vector;
using Mask = Particles::Mask;

/// Calls f(particles) for every lane_count particles of the blocks.
template <class F>
HWY_INLINE void for_each_lanes(const StageData& data, std::size_t first_block, std::size_t last_block, const F& f) {
    const StepConstants constants = data.step;  // a copy, which no store of a stage can change
    for (std::size_t i = first_block * block_size; i < last_block * block_size; i += lane_count) {
        f(Particles(data, constants, i));
    }
}

}  // namespace talus::sim::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
