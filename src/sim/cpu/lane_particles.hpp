#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "sim/cpu/lane_access.hpp"
#include "sim/cpu/work.hpp"
#include "sim/physics/boundary.hpp"
#include "sim/physics/density.hpp"
#include "sim/physics/resistance.hpp"
#include "sim/stages/particle.hpp"
#include "simd/lanes.hpp"

/// Particles next to each other, a register full of each of their numbers, as the bodies of stages (sim/stages) ask
/// for them. Nothing here names an instruction set: all of it is inlined into a stage that does.
namespace talus::sim::cpu {

/// An entry of the lists: a neighbour of each particle.
template <int count>
struct LaneNeighbour {
    using Access = LaneAccess<count>;
    using Real = typename Access::Real;
    using Vector = typename Access::Vector;

    const Work& work;
    const LaneLists<count>& lists;
    std::uint32_t k;
    /// 0 or less past the end of a list that is shorter than its block's longest and is padded with the particle
    /// itself.
    Real remaining;

    TALUS_INLINE Real if_present(const Real& number) const { return select(remaining > Real(0), number, Real(0)); }
    TALUS_INLINE stages::Displaced<Real> displaced() const {
        const Octs<Real> row = lists.gather(work.displaced, k);
        return {Access::vector_of(row.low), Access::vector_of(row.high), row.high.w};
    }
    TALUS_INLINE Vector place() const { return Access::vector_of(lists.gather_low(work.displaced, k)); }
    TALUS_INLINE Vector moved() const { return Access::vector_of(lists.gather_high(work.displaced, k)); }
    TALUS_INLINE Real change() const { return lists.gather_high(work.displaced, k).w; }
    TALUS_INLINE Vector position_at_start() const { return Access::vector_of(lists.gather_low(work.motion, k)); }
    TALUS_INLINE stages::MotionOf<Real> motion() const {
        const Octs<Real> row = lists.gather(work.motion, k);
        return {Access::vector_of(row.low), Access::vector_of(row.high)};
    }
    TALUS_INLINE stages::StressChange<Real> stress_change() const {
        const auto [low, high] = lists.gather(work.stress, k);
        return {low.x, low.y, low.z, low.w, high.x, high.y, high.w};
    }
    TALUS_INLINE void keep_gradient(const Vector& gradient) const { lists.keep(k, gradient); }
};

/// The particles from `i` on; see stages/particle.hpp.
template <int count>
struct LaneParticles : LaneAccess<count> {
    using Access = LaneAccess<count>;
    using Access::flags, Access::vector_of, Access::with;
    using Access::load, Access::load_high, Access::load_low, Access::store, Access::store_high, Access::store_low;
    using typename Access::Mask, typename Access::Real, typename Access::Vector;

    const StageData& data;
    const StepConstants& constants;
    std::size_t i;

    TALUS_INLINE LaneParticles(const StageData& data_, const StepConstants& constants_, std::size_t first)
        : data(data_), constants(constants_), i(first) {}

    [[nodiscard]] TALUS_INLINE const Model& model() const { return data.model; }
    [[nodiscard]] TALUS_INLINE const Ground& ground() const { return data.ground; }
    [[nodiscard]] TALUS_INLINE const StepConstants& step() const { return constants; }

    // What the state says of the particles.
    TALUS_INLINE Vector position() const { return load(data.state.position, i); }
    TALUS_INLINE Vector velocity() const { return load(data.state.velocity, i); }
    TALUS_INLINE void set_velocity(const Vector& velocity) const { store(velocity, data.state.velocity, i); }
    TALUS_INLINE Real multiplier() const { return load(data.state.multiplier, i); }
    TALUS_INLINE void set_multiplier(const Real& multiplier) const { store(multiplier, data.state.multiplier, i); }
    TALUS_INLINE Deviator<Real> stress() const { return load(data.state.stress, i); }
    TALUS_INLINE void set_stress(const Deviator<Real>& stress) const { store(stress, data.state.stress, i); }
    TALUS_INLINE Real still_time() const { return load(data.state.still_time, i); }
    TALUS_INLINE void set_still_time(const Real& time) const { store(time, data.state.still_time, i); }
    /// 1, or 0 for debris that is held.
    TALUS_INLINE Real released() const { return flags(data.state.held, i, 0, 1); }
    /// 1, or 0 for debris that is held or asleep, as the state says: before work.mobile is there.
    TALUS_INLINE Real mobility() const { return released() * flags(data.state.asleep, i, 0, 1); }
    /// The last block may extend beyond the number of particles.
    TALUS_INLINE Mask is_present() const {
        Real place;
        for (int lane = 0; lane < count; ++lane) place.set(lane, static_cast<float>(lane));
        return place < Real(data.state.count > i ? data.state.count - i : 0);
    }
    TALUS_INLINE Real share_of_grains() const {
        Real share(1);
        for (int lane = 0; lane < count; ++lane) {
            const std::uint32_t id = data.state.id[i + static_cast<std::size_t>(lane)];
            share.set(lane, static_cast<float>(sim::share_of_grains(data.model, data.state, id, data.state.time)));
        }
        return share;
    }
    TALUS_INLINE Soil<Real> soil() const {
        Soil<Real> soil;
        for (int lane = 0; lane < count; ++lane) {
            const std::uint32_t id = data.state.id[i + static_cast<std::size_t>(lane)];
            const Soil<float> one = soil_of(data.model, data.state.soil_of_id, data.state.entry_of_id, id);
            soil.solid_fraction.set(lane, one.solid_fraction);
            soil.pressure_ratio.set(lane, one.pressure_ratio);
            soil.thickness.set(lane, one.thickness);
            soil.dilatancy.set(lane, one.dilatancy);
        }
        return soil;
    }
    TALUS_INLINE stages::RisingWater<Real> water() const {
        stages::RisingWater<Real> rising{Real(-1), Real(0)};
        for (int lane = 0; lane < count; ++lane) {
            const std::uint32_t id = data.state.id[i + static_cast<std::size_t>(lane)];
            const Water water = water_of(data.model, data.state.water_of_release, id);
            if (!water.rises()) continue;
            rising.ratio.set(lane, water.ratio);
            rising.rise.set(lane, water.rise);
        }
        return rising;
    }
    /// Of those that `moves` says.
    TALUS_INLINE void set_soil(const Soil<Real>& soil, const Mask& moves) const {
        for (int lane = 0; lane < count; ++lane) {
            if (!moves.at(lane)) continue;
            data.state.soil_of_id[data.state.id[i + static_cast<std::size_t>(lane)]] = {
                soil.solid_fraction.at(lane), soil.pressure_ratio.at(lane), soil.thickness.at(lane),
                soil.dilatancy.at(lane)};
        }
    }

    // What the step knows of them.
    TALUS_INLINE Real mobile() const { return load(data.work.mobile, i); }
    TALUS_INLINE Mask moves() const { return mobile() > Real(0); }
    TALUS_INLINE stages::Displaced<Real> displaced() const {
        const Octs<Real> row = load(data.work.displaced, i);
        return {vector_of(row.low), vector_of(row.high), row.high.w};
    }
    TALUS_INLINE Vector moved() const { return vector_of(load_high(data.work.displaced, i)); }
    TALUS_INLINE void set_moved(const Vector& moved) const {
        store_low(with(position() + moved, Real(0)), data.work.displaced, i);
        store_high(with(moved, Real(0)), data.work.displaced, i);
    }
    TALUS_INLINE Real change() const { return load_high(data.work.displaced, i).w; }
    TALUS_INLINE void set_change(const Real& change) const {
        store_high(with(moved(), change), data.work.displaced, i);
    }
    TALUS_INLINE Vector contact_place() const { return vector_of(load_low(data.work.displaced, i)); }
    TALUS_INLINE Vector corrected() const { return load(data.work.corrected, i); }
    TALUS_INLINE void set_corrected(const Vector& corrected) const { store(corrected, data.work.corrected, i); }
    TALUS_INLINE Vector shift() const { return load(data.work.shift, i); }
    TALUS_INLINE void set_shift(const Vector& shift) const { store(shift, data.work.shift, i); }
    TALUS_INLINE Vector position_at_start() const { return vector_of(load_low(data.work.motion, i)); }
    TALUS_INLINE stages::MotionOf<Real> motion() const {
        const Octs<Real> row = load(data.work.motion, i);
        return {vector_of(row.low), vector_of(row.high)};
    }
    TALUS_INLINE stages::GroundPlane<Real> plane() const {
        return {load(data.work.ground_distance, i), load(data.work.ground_slope, i), load(data.work.ground_normal, i)};
    }
    TALUS_INLINE Vector boundary_gradient() const { return load(data.work.boundary_gradient, i); }
    TALUS_INLINE DensityConstraint<Real> constraint() const {
        return {load(data.work.constraint_start, i), load(data.work.surface_share, i), gradient_square(),
                load(data.work.pair_square, i)};
    }
    TALUS_INLINE void set_constraint(const DensityConstraint<Real>& constraint) const {
        store(constraint.start, data.work.constraint_start, i);
        store(constraint.surface_share, data.work.surface_share, i);
        store(constraint.gradient_square, data.work.gradient_square, i);
        store(constraint.pair_square, data.work.pair_square, i);
        set_tolerated_compression(compression_before(constraint));
    }
    TALUS_INLINE Real gradient_square() const { return load(data.work.gradient_square, i); }
    TALUS_INLINE Real compression() const { return load(data.work.compression, i); }
    TALUS_INLINE void set_compression(const Real& compression) const { store(compression, data.work.compression, i); }
    TALUS_INLINE Real tolerated_compression() const { return load(data.work.tolerated_compression, i); }
    TALUS_INLINE void set_tolerated_compression(const Real& tolerated) const {
        store(tolerated, data.work.tolerated_compression, i);
    }
    TALUS_INLINE stages::StressChange<Real> stress_change() const {
        const auto [low, high] = load(data.work.stress, i);
        return {low.x, low.y, low.z, low.w, high.x, high.y, high.w};
    }
    TALUS_INLINE void set_stress_change(const stages::StressChange<Real>& s) const {
        store_low({s.xx, s.xy, s.xz, s.yy}, data.work.stress, i);
        store_high({s.yz, s.zz, Real(0), s.pressure}, data.work.stress, i);
    }
    TALUS_INLINE Real ground_friction() const { return load(data.work.ground_friction, i); }
    TALUS_INLINE Real ground_strength() const { return load(data.work.ground_strength, i); }
    TALUS_INLINE Real effective_share() const { return load(data.work.effective_share, i); }
    TALUS_INLINE Real ground_shear() const { return load(data.work.ground_shear, i); }
    TALUS_INLINE void set_resistance(const stages::Resistance<Real>& resistance) const {
        if (data.model.inertial_friction.on) store(resistance.ground_shear, data.work.ground_shear, i);
        store(resistance.effective_share, data.work.effective_share, i);
        store(resistance.friction, data.work.ground_friction, i);
        store(resistance.strength, data.work.ground_strength, i);
    }
    TALUS_INLINE ContactMemory<Real> contact() const {
        return {load(data.work.contact_normal, i), load(data.work.contact_friction, i)};
    }
    TALUS_INLINE void set_contact(const ContactMemory<Real>& contact) const {
        store(contact.normal, data.work.contact_normal, i);
        store(contact.friction, data.work.contact_friction, i);
    }

    // Neighbours.
    template <class F>
    TALUS_INLINE void for_each_neighbour(const F& f) const {
        const LaneLists<count> lists(data.neighbours, i);
        Real remaining = lists.entries;
        const Real one(1);
        for (std::uint32_t k = 0; k < lists.length; ++k) {
            f(LaneNeighbour<count>{data.work, lists, k, remaining});
            remaining = remaining - one;
        }
    }
    /// With the gradients that linearise() kept; those of padding are 0.
    template <class F>
    TALUS_INLINE void for_each_gradient(const F& f) const {
        const LaneLists<count> lists(data.neighbours, i);
        for (std::uint32_t k = 0; k < lists.length; ++k) {
            f(LaneNeighbour<count>{data.work, lists, k, Real(0)}, lists.gradient(k));
        }
    }

    // Walls: particles near them are treated one at a time.
    TALUS_INLINE Mask near_walls(const Vector& p) const {
        Mask near;
        if (data.ground.solids.empty()) return near;
        for (int lane = 0; lane < count; ++lane) {
            near.bits[lane] = data.ground.solids.near(p.x.at(lane), p.y.at(lane)) ? -1 : 0;
        }
        return near;
    }
    /// Samples ground and walls at `p`, which is `displacement` from the position at the step's start.
    TALUS_INLINE stages::BoundaryShare<Real> sample_boundary(const Vector& p, const Vector& displacement) const {
        Work& work = data.work;
        const GroundFace<Real> base = sample_ground(data.model, data.ground.terrain, p);
        stages::BoundaryShare<Real> share{base.density, base.normal * base.slope};
        store(base.distance - dot(displacement, base.normal), work.ground_distance, i);
        store(base.slope, work.ground_slope, i);
        store(base.normal, work.ground_normal, i);
        store(share.gradient, work.boundary_gradient, i);
        if (data.ground.solids.empty()) return share;
        const Mask near = near_walls(p);
        std::fill_n(work.has_walls.begin() + static_cast<std::ptrdiff_t>(i), count, std::uint8_t{0});
        store(p, work.wall_place, i);
        store(Real(data.ground.solids.range()), work.wall_distance, i);
        if (!any(near)) return share;
        for (int lane = 0; lane < count; ++lane) {
            if (!near.at(lane)) continue;
            share.density.set(
                lane, sample_walls(data.model, data.ground, data.state, work, i + static_cast<std::size_t>(lane),
                                   {base.distance.at(lane), Access::at(base.normal, lane), base.density.at(lane),
                                    base.slope.at(lane)},
                                   Access::at(p, lane), Access::at(displacement, lane)));
        }
        share.gradient = boundary_gradient();
        return share;
    }
    /// The displacement after contacts with walls.
    TALUS_INLINE Vector after_walls(Vector after, const Real& multiplier) const {
        for (int lane = 0; lane < count; ++lane) {
            const std::size_t particle = i + static_cast<std::size_t>(lane);
            if (!data.work.has_walls[particle]) continue;
            Access::set(after, lane,
                        resolve_wall_contacts(data.model, constants, data.work, particle, multiplier.at(lane),
                                              Access::at(after, lane)));
        }
        return after;
    }
    /// The shift back to touching ground and walls.
    TALUS_INLINE Vector overlap_shift(const Vector& p, const Real& max_shift) const {
        const terrain::GroundSample<Real> below = data.ground.terrain.sample(p.x, p.y);
        const Real overlap = Real(data.model.contact_distance()) - (p.z - below.height) * below.normal.z;
        Vector shift = below.normal * select(overlap > Real(0), smaller(overlap, max_shift), Real(0));
        const Mask near = near_walls(p);
        if (!any(near)) return shift;
        for (int lane = 0; lane < count; ++lane) {
            if (!near.at(lane)) continue;
            Access::set(shift, lane,
                        undo_overlap_near_walls(data.model, data.ground, data.state, data.work,
                                                i + static_cast<std::size_t>(lane), Access::at(p, lane),
                                                max_shift.at(lane), Access::at(shift, lane)));
        }
        return shift;
    }

    // Sleep.
    TALUS_INLINE void put_to_sleep(const Mask& sleeps) const {
        for (int lane = 0; lane < count; ++lane) {
            const std::size_t particle = i + static_cast<std::size_t>(lane);
            if (!sleeps.at(lane) || data.work.has_walls[particle]) continue;
            data.state.asleep[particle] = 1;
            data.state.still_time[particle] = 0;
            data.state.velocity.set(particle, {});
        }
    }
    TALUS_INLINE void wake_neighbours(const Mask& wakes) const {
        if (data.state.awake == data.state.count) return;
        const LaneLists<count> lists(data.neighbours, i);
        Mask finds;
        for (std::uint32_t k = 0; k < lists.length; ++k) finds = finds | lists.from_on(k, data.state.awake);
        if (!any(finds & wakes)) return;
        for (int lane = 0; lane < count; ++lane) {
            const std::size_t particle = i + static_cast<std::size_t>(lane);
            for (std::uint32_t k = 0; wakes.at(lane) && k < data.neighbours.count_of(particle); ++k) {
                const std::uint32_t j = data.neighbours.neighbour_of(particle, k);
                if (j < data.state.awake) continue;
                // Several threads may wake the same particle at once; all store the same value.
                std::atomic_ref(data.state.asleep[j]).store(0, std::memory_order_relaxed);
            }
        }
    }
};

}  // namespace talus::sim::cpu
