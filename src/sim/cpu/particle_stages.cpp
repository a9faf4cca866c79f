// The stages that treat each particle by itself, and viscosity. Compiled once per instruction set by Highway's
// foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/cpu/particle_stages.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/cpu/lanes-inl.hpp"
#include "sim/cpu/stages.hpp"
#include "sim/stages/motion.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::sim::cpu::HWY_NAMESPACE {
namespace {

/// Speed-dependent drag.
TALUS_STAGE void drag(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(data, first, last, [&](const Particles& at) TALUS_INLINE_LAMBDA {
        const Mask moves = at.mobility() > L(0);
        if (!any(moves)) return;
        const V3 slower = stages::slowed_velocity(at, at.load(data.work.column_particles, at.i));
        at.set_velocity(select(moves, slower, at.velocity()));
    });
}

/// Pore pressure and solid fraction, where they evolve.
TALUS_STAGE void evolve_soil(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(data, first, last, [&](const Particles& at) TALUS_INLINE_LAMBDA {
        const Mask moves = (at.mobility() > L(0)) & at.is_present();
        if (!any(moves)) return;
        at.set_soil(stages::evolved_soil(at, at.load(data.work.column_particles, at.i)), moves);
    });
}

TALUS_STAGE void predict(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(data, first, last, [&](const Particles& at) TALUS_INLINE_LAMBDA {
        const Mask moves = at.mobility() > L(0);
        V3 velocity = at.velocity();
        velocity.z = select(moves, velocity.z - L(at.step().fall), velocity.z);
        at.store(velocity.z, data.state.velocity.z, at.i);
        at.store(at.position() + select(moves, velocity * L(at.step().time_step), V3{}), data.work.predicted, at.i);
    });
}

TALUS_STAGE void begin(const StageData& data, std::size_t first, std::size_t last) {
    Work& work = data.work;
    for_each_lanes(data, first, last, [&](const Particles& at) TALUS_INLINE_LAMBDA {
        const L mobile = at.mobility();
        const V3 displacement = select(mobile > L(0), at.velocity() * L(at.step().time_step), V3{});
        at.store(mobile, work.mobile, at.i);
        at.set_moved(displacement);
        at.set_corrected(displacement);
        at.set_contact({L(0), V3{}});
        if (data.ground.solids.empty()) return;
        for (std::size_t lane = 0; lane < lane_count; ++lane) work.walls[at.i + lane].contacts = {};
    });
}

TALUS_STAGE void pack_motion(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(data, first, last, [&](const Particles& at) TALUS_INLINE_LAMBDA {
        at.store_low(at.with(at.position(), L(0)), data.work.motion, at.i);
        at.store_high(at.with(at.velocity(), L(0)), data.work.motion, at.i);
    });
}

TALUS_STAGE void resist(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(data, first, last, [](const Particles& at) TALUS_INLINE_LAMBDA { stages::resist(at); });
}

TALUS_STAGE void contacts(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(data, first, last, [](const Particles& at) TALUS_INLINE_LAMBDA { stages::contacts(at); });
}

TALUS_STAGE void resolve_penetration(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(data, first, last, [](const Particles& at) TALUS_INLINE_LAMBDA { stages::resolve_penetration(at); });
}

/// Most particles end their step at their displaced position, without coming to a wall or below ground. The others are
/// handled one by one.
TALUS_STAGE void enforce_boundaries(const StageData& data, std::size_t first, std::size_t last) {
    constexpr int max_parts = 4;
    const auto below_ground = [&](const V3& p)
                                  TALUS_INLINE_LAMBDA { return p.z < data.ground.terrain.sample(p.x, p.y).height; };
    for_each_lanes(data, first, last, [&](const Particles& at) TALUS_INLINE_LAMBDA {
        const L max_part(at.step().max_shift);
        const V3 start = at.position(), displacement = at.moved();
        const V3 end = start + displacement, shift = at.shift();
        const L distance = length(displacement);
        const L parts = select(distance > max_part,
                               from_index<L>(truncated(smaller(L(max_parts), distance / max_part))) + L(1), L(1));
        // As numbers: masks that are combined are taken apart lane by lane (see opaque).
        const auto flag = [](const Mask& mask) TALUS_INLINE_LAMBDA { return opaque(select(mask, L(1), L(0))); };
        L doubtful =
            larger(larger(flag(parts > L(max_parts)), flag(length(shift) > max_part)), flag(distance != distance));
        for (int part = 1; part <= max_parts; ++part) {
            const Mask on_the_way = L(part) <= parts;
            if (!any(on_the_way)) break;
            const V3 p = start + displacement * (L(part) / parts);
            doubtful = larger(doubtful, flag(on_the_way) * flag(below_ground(select(L(part) == parts, end, p))));
        }
        const V3 shifted = end + shift;
        doubtful = larger(doubtful, flag(below_ground(shifted))) * at.mobile();
        const L near = flag(at.near_walls(end)) * at.mobile();
        at.store(select(at.moves(), shifted, start), data.work.end, at.i);
        if (!any(doubtful + near > L(0))) return;
        for (int lane = 0; lane < lane_count; ++lane) {
            const std::size_t particle = at.i + static_cast<std::size_t>(lane);
            const bool clear =
                !(near.at(lane) > 0) || sweeps_clear_of_walls(data.model, data.state, data.work, particle);
            if (clear && !(doubtful.at(lane) > 0)) continue;
            enforce_particle(data.model, data.ground, data.state, data.work, particle);
        }
    });
}

TALUS_STAGE float update_velocities(const StageData& data, std::size_t first, std::size_t last) {
    L max_square(0), unknown(0);
    for_each_lanes(data, first, last, [&](const Particles& at) TALUS_INLINE_LAMBDA {
        const V3 velocity = select(at.moves(), at.moved() * L(at.step().inverse_time_step), at.velocity());
        const V3 position = at.load(data.work.end, at.i);
        at.set_velocity(velocity);
        at.store(position, data.state.position, at.i);
        at.store_low(at.with(position, L(0)), data.work.motion, at.i);
        at.store_high(at.with(velocity, L(0)), data.work.motion, at.i);
        const L square = select(at.is_present(), dot(velocity, velocity), L(0));
        max_square = larger(max_square, square);
        unknown = select(square == square, unknown, L(1));
    });
    float result = 0;
    for (int lane = 0; lane < lane_count; ++lane) {
        if (unknown.at(lane) > 0) return std::numeric_limits<float>::quiet_NaN();
        result = std::max(result, max_square.at(lane));
    }
    return std::sqrt(result);
}

template <class Kernel>
TALUS_STAGE void apply_viscosity(const StageData& data, std::size_t first, std::size_t last) {
    const stages::PairKernel<Kernel> kernel{{}, PairScale(data.model.kernel)};
    for_each_lanes(data, first, last,
                   [&](const Particles& at) TALUS_INLINE_LAMBDA { stages::apply_viscosity(at, kernel); });
}

TALUS_STAGE void update_sleep(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(data, first, last, [](const Particles& at) TALUS_INLINE_LAMBDA { stages::update_sleep(at); });
}

ParticleStages make_stages(params::KernelChoice kernel) {
    ParticleStages stages{drag,
                          evolve_soil,
                          predict,
                          begin,
                          pack_motion,
                          resist,
                          contacts,
                          resolve_penetration,
                          enforce_boundaries,
                          update_velocities,
                          nullptr,
                          update_sleep,
                          hwy::TargetName(HWY_TARGET)};
    with_kernel(kernel, [&](auto k) { stages.apply_viscosity = apply_viscosity<decltype(k)>; });
    return stages;
}

}  // namespace
}  // namespace talus::sim::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace talus::sim::cpu {

HWY_EXPORT(make_stages);

ParticleStages particle_stages_for(params::KernelChoice kernel) {
    return HWY_DYNAMIC_DISPATCH(make_stages)(kernel);
}

}  // namespace talus::sim::cpu
#endif
