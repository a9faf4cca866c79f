// The stages that treat each particle by itself, and viscosity. Compiled once per instruction set by Highway's
// foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/cpu/particle_stages.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "sim/cpu/lanes-inl.hpp"
#include "sim/cpu/stages.hpp"
#include "sim/physics/viscosity.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::sim::cpu::HWY_NAMESPACE {
namespace {

/// 1 for particles that may move, 0 for those that are held or asleep.
HWY_INLINE L mobility(const State& state, std::size_t i) {
    return flags(state.held, i, 0, 1) * flags(state.asleep, i, 0, 1);
}

/// Speed-dependent drag, with the thickness of the flow before the step.
TALUS_STAGE void drag(const StageData& data, std::size_t first, std::size_t last) {
    const Model& model = data.model;
    State& state = data.state;
    const L dt(state.time_step);
    for_each_lanes(first, last, [&](std::size_t i) {
        const Mask moves = mobility(state, i) > L(0);
        if (!any(moves)) return;
        const V3 velocity = load(state.velocity, i), p = load(state.position, i);
        const terrain::GroundSample<L> below = data.ground.terrain.sample(p.x, p.y);
        const L distance = (p.z - below.height) * below.normal.z;
        const L thickness = flow_thickness(model, below, load(data.work.column_particles, i));
        const V3 slower = slowed_by_drag(model, ground_resistance(model, p), below, distance, thickness, velocity, dt);
        store(select(moves, slower, velocity), state.velocity, i);
    });
}

TALUS_STAGE void predict(const StageData& data, std::size_t first, std::size_t last) {
    const Model& model = data.model;
    State& state = data.state;
    Work& work = data.work;
    const L dt(state.time_step), fall(model.gravity * state.time_step);
    for_each_lanes(first, last, [&](std::size_t i) {
        const Mask moves = mobility(state, i) > L(0);
        V3 velocity = load(state.velocity, i);
        velocity.z = select(moves, velocity.z - fall, velocity.z);
        store(velocity.z, state.velocity.z, i);
        store(load(state.position, i) + select(moves, velocity * dt, V3{}), work.predicted, i);
    });
}

TALUS_STAGE void begin(const StageData& data, std::size_t first, std::size_t last) {
    State& state = data.state;
    Work& work = data.work;
    const L dt(state.time_step);
    for_each_lanes(first, last, [&](std::size_t i) {
        const L mobile = mobility(state, i);
        const V3 displacement = select(mobile > L(0), load(state.velocity, i) * dt, V3{});
        const V3 predicted = load(state.position, i) + displacement;
        store(mobile, work.mobile, i);
        store_low(with(predicted, L(0)), work.displaced, i);
        store_high(with(displacement, L(0)), work.displaced, i);
        store(displacement, work.corrected, i);
        store(L(0), work.contact_normal, i);
        store(V3{}, work.contact_friction, i);
        if (data.ground.solids.empty()) return;
        for (std::size_t lane = 0; lane < lane_count; ++lane) work.walls[i + lane].contacts = {};
    });
}

TALUS_STAGE void pack_motion(const StageData& data, std::size_t first, std::size_t last) {
    for_each_lanes(first, last, [&](std::size_t i) {
        store_low(with(load(data.state.position, i), L(0)), data.work.motion, i);
        store_high(with(load(data.state.velocity, i), L(0)), data.work.motion, i);
    });
}

TALUS_STAGE void resist(const StageData& data, std::size_t first, std::size_t last) {
    const Model& model = data.model;
    State& state = data.state;
    Work& work = data.work;
    const L strength(strength_per_pascal(model, state.time_step));
    const double before = state.previous_time_step;
    const L pressure_scale(before > 0 ? -1 / (before * before) : 0);  // multipliers are still those of the last step
    for_each_lanes(first, last, [&](std::size_t i) {
        L share(1);
        for (int lane = 0; lane < lane_count; ++lane) {
            const std::uint32_t id = state.id[i + static_cast<std::size_t>(lane)];
            share.set(lane, static_cast<float>(effective_share(model, state.entry_of_id, id, state.time)));
        }
        const V3 p = load(state.position, i), velocity = load(state.velocity, i);
        const GroundResistance<L> ground = ground_resistance(model, p);
        const L friction = moving_friction(model, data.ground.terrain, ground.friction_coefficient, p, velocity,
                                           load(state.multiplier, i) * pressure_scale, share, L(state.time_step));
        if (model.inertial_friction.on) {
            store(shear_beside_ground(model, ground.friction_coefficient), work.ground_shear, i);
        }
        store(share, work.effective_share, i);
        store(friction * share, work.ground_friction, i);
        store(ground.cohesion * strength, work.ground_strength, i);
    });
}

/// Contact with ground and buildings, and the basal part of eq. (4).
TALUS_STAGE void contacts(const StageData& data, std::size_t first, std::size_t last) {
    const Model& model = data.model;
    State& state = data.state;
    Work& work = data.work;
    const bool by_particle = resists_by_particle(model);

    for_each_lanes(first, last, [&](std::size_t i) {
        const L mobile = load(work.mobile, i), multiplier = load(state.multiplier, i);
        const V3 displacement = load(work.corrected, i), normal = load(work.ground_normal, i);
        ContactMemory<L> contact{load(work.contact_normal, i), load(work.contact_friction, i)};
        const L distance = load(work.ground_distance, i) + dot(displacement, normal);
        L friction(model.friction_coefficient), strength(0);
        if (by_particle) {
            friction = load(work.ground_friction, i);
            strength = load(work.ground_strength, i) * basal_share(model, distance);
        }
        V3 after = displacement + resolve_face(model, distance, normal, displacement,
                                               boundary_push(load(work.ground_slope, i), multiplier), friction,
                                               strength, contact);
        store(contact.normal, work.contact_normal, i);
        store(contact.friction, work.contact_friction, i);
        for (std::size_t lane = 0; lane < lane_count; ++lane) {
            if (!work.has_walls[i + lane]) continue;
            const int l = static_cast<int>(lane);
            const Vec3<float> end = resolve_wall_contacts(model, work, i + lane, multiplier.at(l),
                                                          {after.x.at(l), after.y.at(l), after.z.at(l)});
            after.x.set(l, end.x);
            after.y.set(l, end.y);
            after.z.set(l, end.z);
        }
        after = select(mobile > L(0), after, displacement);
        store_low(with(load(state.position, i) + after, L(0)), work.displaced, i);
        store_high(with(after, L(0)), work.displaced, i);
    });
}

/// Moves overlapping particles apart without changing their velocity: debris that is too dense (with stresses, its
/// shift is already computed), and debris too close to ground or walls.
TALUS_STAGE void resolve_penetration(const StageData& data, std::size_t first, std::size_t last) {
    const Model& model = data.model;
    Work& work = data.work;
    const bool spread = model.solver.internal_friction == params::InternalFriction::stress;
    const L max_shift(model.particle_spacing / 4), touching(model.contact_distance());
    for_each_lanes(first, last, [&](std::size_t i) {
        const V3 p = vector_of(load_low(work.displaced, i));
        const terrain::GroundSample<L> ground = data.ground.terrain.sample(p.x, p.y);
        const L overlap = touching - (p.z - ground.height) * ground.normal.z;
        V3 shift = ground.normal * select(overlap > L(0), smaller(overlap, max_shift), L(0));
        const Mask near = near_walls(data.ground, p);
        if (any(near)) {
            for (int l = 0; l < lane_count; ++l) {
                if (!near.at(l)) continue;
                const Vec3<float> one =
                    undo_overlap_near_walls(model, data.ground, data.state, i + static_cast<std::size_t>(l),
                                            {p.x.at(l), p.y.at(l), p.z.at(l)}, max_shift.at(l));
                shift.x.set(l, one.x);
                shift.y.set(l, one.y);
                shift.z.set(l, one.z);
            }
        }
        if (spread) shift += load(work.shift, i);
        const L size = length(shift);
        shift = shift * select(size > max_shift, max_shift / size, L(1));
        store(select(load(work.mobile, i) > L(0), shift, V3{}), work.shift, i);
    });
}

/// Most particles end their step at their displaced position, without coming near a wall or below ground. The others
/// are handled one by one.
TALUS_STAGE void enforce_boundaries(const StageData& data, std::size_t first, std::size_t last) {
    const Model& model = data.model;
    State& state = data.state;
    Work& work = data.work;
    constexpr int max_parts = 4;
    const L max_part(model.particle_spacing / 4);
    const auto below_ground = [&](const V3& p) { return p.z < data.ground.terrain.sample(p.x, p.y).height; };
    for_each_lanes(first, last, [&](std::size_t i) {
        const V3 start = load(state.position, i), displacement = vector_of(load_high(work.displaced, i));
        const V3 end = start + displacement, shift = load(work.shift, i);
        const L distance = length(displacement);
        const L parts = select(distance > max_part,
                               from_index<L>(truncated(smaller(L(max_parts), distance / max_part))) + L(1), L(1));
        Mask doubtful = (parts > L(max_parts)) | (length(shift) > max_part) | !(distance == distance);
        for (int part = 1; part <= max_parts; ++part) {
            const Mask on_the_way = L(part) <= parts;
            if (!any(on_the_way)) break;
            const V3 p = start + displacement * (L(part) / parts);
            doubtful = doubtful | (on_the_way & below_ground(select(L(part) == parts, end, p)));
        }
        const V3 shifted = end + shift;
        doubtful = doubtful | below_ground(shifted) | near_walls(data.ground, end);
        const L mobile = load(work.mobile, i);
        doubtful = doubtful & (mobile > L(0));
        store(select(mobile > L(0), shifted, start), work.end, i);
        if (!any(doubtful)) return;
        for (int lane = 0; lane < lane_count; ++lane) {
            if (doubtful.at(lane))
                enforce_particle(model, data.ground, state, work, i + static_cast<std::size_t>(lane));
        }
    });
}

TALUS_STAGE float update_velocities(const StageData& data, std::size_t first, std::size_t last) {
    State& state = data.state;
    Work& work = data.work;
    const L inverse_dt(1 / state.time_step);
    L max_square(0), unknown(0);
    for_each_lanes(first, last, [&](std::size_t i) {
        const Mask moves = load(work.mobile, i) > L(0);
        const V3 velocity =
            select(moves, vector_of(load_high(work.displaced, i)) * inverse_dt, load(state.velocity, i));
        const V3 position = load(work.end, i);
        store(velocity, state.velocity, i);
        store(position, state.position, i);
        store_low(with(position, L(0)), work.motion, i);
        store_high(with(velocity, L(0)), work.motion, i);
        const L square = select(is_present(state, i), dot(velocity, velocity), L(0));
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

/// Eq. (5) as XSPH smoothing; the sum weights both particles of a pair equally, so momentum is conserved.
template <class Kernel>
TALUS_STAGE void apply_viscosity(const StageData& data, std::size_t first, std::size_t last) {
    const Model& model = data.model;
    State& state = data.state;
    Work& work = data.work;
    NeighbourLists& neighbours = data.neighbours;
    const PairScale scale(model.kernel);
    const L smoothing(step_smoothing(model.viscosity, state.time_step));
    for_each_lanes(first, last, [&](std::size_t i) {
        const LaneLists lists(neighbours, i);
        const Octs<L> motion = load(work.motion, i);
        const V3 p = vector_of(motion.low), own = vector_of(motion.high);
        V3 change;
        for (std::uint32_t k = 0; k < lists.length; ++k) {
            const Octs<L> other = lists.gather(work.motion, k);
            const L weight = Kernel::value(scale.quotient(length(p - vector_of(other.low)))) * L(scale.value_scale);
            change += (vector_of(other.high) - own) * weight;
        }
        const L mobile = load(work.mobile, i);
        V3 after = own + change * (smoothing * mobile);
        if (model.viscosity_on_ground) {
            const terrain::GroundSample<L> below = data.ground.terrain.sample(p.x, p.y);
            after = slowed_by_ground(model, below, (p.z - below.height) * below.normal.z, after, smoothing * mobile);
        }
        store(after, state.velocity, i);
    });
}

/// Debris that has hardly moved for the rest duration sleeps: it keeps its position and pressure until something moves
/// beside it. The threshold is a hundredth of the speed of a fall through its own size; waking takes twice that, so
/// that particles do not alternate between the two. Debris against walls stays awake, since the forces on them are
/// measured.
TALUS_STAGE void update_sleep(const StageData& data, std::size_t first, std::size_t last) {
    const Model& model = data.model;
    State& state = data.state;
    Work& work = data.work;
    NeighbourLists& neighbours = data.neighbours;
    const double sleep_speed = 0.01 * std::sqrt(model.gravity * model.particle_spacing), wake_speed = 2 * sleep_speed;
    const L dt(state.time_step), rest_duration(model.solver.rest_duration);
    for_each_lanes(first, last, [&](std::size_t i) {
        const V3 velocity = load(state.velocity, i);
        const L square = dot(velocity, velocity);
        const Mask moves = load(work.mobile, i) > L(0);
        const L still = select(moves & (square < L(sleep_speed * sleep_speed)), load(state.still_time, i) + dt, L(0));
        store(still, state.still_time, i);
        const Mask sleeps = moves & (still > rest_duration);
        if (any(sleeps)) {
            for (int l = 0; l < lane_count; ++l) {
                const std::size_t particle = i + static_cast<std::size_t>(l);
                if (!sleeps.at(l) || work.has_walls[particle]) continue;
                state.asleep[particle] = 1;
                state.still_time[particle] = 0;
                state.velocity.set(particle, {});
            }
        }
        const Mask wakes = moves & (square > L(wake_speed * wake_speed));
        if (state.awake == state.count || !any(wakes)) return;
        const LaneLists lists(neighbours, i);
        Mask finds;
        for (std::uint32_t k = 0; k < lists.length; ++k) finds = finds | lists.from_on(k, state.awake);
        if (!any(finds & wakes)) return;
        for (int l = 0; l < lane_count; ++l) {
            const std::size_t particle = i + static_cast<std::size_t>(l);
            for (std::uint32_t k = 0; wakes.at(l) && k < neighbours.count_of(particle); ++k) {
                const std::uint32_t j = neighbours.neighbour_of(particle, k);
                if (j < state.awake) continue;
                // Several threads may wake the same particle at once; all store the same value.
                std::atomic_ref(state.asleep[j]).store(0, std::memory_order_relaxed);
            }
        }
    });
}

ParticleStages make_stages(params::KernelChoice kernel) {
    ParticleStages stages{drag,
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
