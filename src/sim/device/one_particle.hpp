#pragma once

#include <cstdint>

#include "sim/device/atomics.hpp"
#include "sim/device/views.hpp"
#include "sim/physics/boundary.hpp"
#include "sim/physics/contact.hpp"
#include "sim/physics/resistance.hpp"
#include "sim/stages/pairs.hpp"
#include "sim/stages/particle.hpp"

namespace talus::sim::device {

/// A neighbour of a particle.
struct OneNeighbour {
    const Data& d;
    std::uint32_t j;

    [[nodiscard]] TALUS_DEVICE float if_present(float number) const { return number; }
    [[nodiscard]] TALUS_DEVICE stages::Displaced<float> displaced() const {
        const Row row = d.work.moved[j];
        return {d.work.place[j].vector(), row.vector(), row.w};
    }
    [[nodiscard]] TALUS_DEVICE Vec3<float> place() const { return d.work.place[j].vector(); }
    [[nodiscard]] TALUS_DEVICE Vec3<float> moved() const { return d.work.moved[j].vector(); }
    [[nodiscard]] TALUS_DEVICE float change() const { return d.work.moved[j].w; }
    [[nodiscard]] TALUS_DEVICE Vec3<float> position_at_start() const { return d.state.position[j]; }
    [[nodiscard]] TALUS_DEVICE stages::MotionOf<float> motion() const {
        return {d.state.position[j], d.work.velocity_before[j]};
    }
    [[nodiscard]] TALUS_DEVICE stages::StressChange<float> stress_change() const { return d.work.change[j].stress(); }
    TALUS_DEVICE void keep_gradient(const Vec3<float>& /*computed anew in each sum*/) const {}
};

/// A particle as the bodies of stages see it; see stages/particle.hpp.
struct OneParticle {
    using Real = float;
    using Vector = Vec3<float>;

    const Data& d;
    std::uint32_t i;

    [[nodiscard]] TALUS_DEVICE const ModelView& model() const { return d.model; }
    [[nodiscard]] TALUS_DEVICE const GroundView& ground() const { return d.ground; }
    [[nodiscard]] TALUS_DEVICE const StepConstants& step() const { return d.step; }

    // What the state says of it.
    [[nodiscard]] TALUS_DEVICE Vector position() const { return d.state.position[i]; }
    [[nodiscard]] TALUS_DEVICE Vector velocity() const { return d.state.velocity[i]; }
    TALUS_DEVICE void set_velocity(const Vector& velocity) const { d.state.velocity[i] = velocity; }
    [[nodiscard]] TALUS_DEVICE float multiplier() const { return d.state.multiplier[i]; }
    TALUS_DEVICE void set_multiplier(float multiplier) const { d.state.multiplier[i] = multiplier; }
    [[nodiscard]] TALUS_DEVICE Deviator<float> stress() const { return d.state.stress[i]; }
    TALUS_DEVICE void set_stress(const Deviator<float>& stress) const { d.state.stress[i] = stress; }
    [[nodiscard]] TALUS_DEVICE float still_time() const { return d.state.still_time[i]; }
    TALUS_DEVICE void set_still_time(float time) const { d.state.still_time[i] = time; }
    [[nodiscard]] TALUS_DEVICE float released() const { return d.state.held[i] != 0 ? 0.0f : 1.0f; }
    [[nodiscard]] TALUS_DEVICE float share_of_grains() const {
        return static_cast<float>(sim::share_of_grains(d.model, d.state, d.state.id[i], d.time));
    }
    [[nodiscard]] TALUS_DEVICE Soil<float> soil() const {
        return soil_of(d.model, d.state.soil_of_id, d.state.entry_of_id, d.state.id[i]);
    }
    [[nodiscard]] TALUS_DEVICE stages::RisingWater<float> water() const {
        const Water water = water_of(d.model, d.state.water_of_release, d.state.id[i]);
        if (!water.rises()) return {};
        return {water.ratio, water.rise};
    }
    TALUS_DEVICE void set_soil(const Soil<float>& soil) const { d.state.soil_of_id[d.state.id[i]] = soil; }

    // What the step knows of it.
    [[nodiscard]] TALUS_DEVICE float mobile() const { return 1; }
    [[nodiscard]] TALUS_DEVICE bool moves() const { return true; }
    [[nodiscard]] TALUS_DEVICE stages::Displaced<float> displaced() const { return OneNeighbour{d, i}.displaced(); }
    [[nodiscard]] TALUS_DEVICE Vector moved() const { return d.work.moved[i].vector(); }
    TALUS_DEVICE void set_moved(const Vector& moved) const {
        d.work.moved[i] = row_of(moved);
        // Gradients are taken there with pair friction; with stresses, where they were linearised.
        if (!d.step.keeps_stress) d.work.place[i] = row_of(d.state.position[i] + moved);
    }
    [[nodiscard]] TALUS_DEVICE float change() const { return d.work.moved[i].w; }
    TALUS_DEVICE void set_change(float change) const { d.work.moved[i].w = change; }
    [[nodiscard]] TALUS_DEVICE Vector contact_place() const { return d.state.position[i] + moved(); }
    [[nodiscard]] TALUS_DEVICE Vector corrected() const { return d.work.corrected[i]; }
    TALUS_DEVICE void set_corrected(const Vector& corrected) const { d.work.corrected[i] = corrected; }
    [[nodiscard]] TALUS_DEVICE Vector shift() const { return d.work.shift[i]; }
    TALUS_DEVICE void set_shift(const Vector& shift) const { d.work.shift[i] = shift; }
    [[nodiscard]] TALUS_DEVICE Vector position_at_start() const { return d.state.position[i]; }
    [[nodiscard]] TALUS_DEVICE stages::MotionOf<float> motion() const { return OneNeighbour{d, i}.motion(); }
    [[nodiscard]] TALUS_DEVICE stages::GroundPlane<float> plane() const { return d.work.plane[i]; }
    [[nodiscard]] TALUS_DEVICE Vector boundary_gradient() const { return d.work.boundary_gradient[i]; }
    [[nodiscard]] TALUS_DEVICE DensityConstraint<float> constraint() const { return d.work.constraint[i]; }
    TALUS_DEVICE void set_constraint(const DensityConstraint<float>& constraint) const {
        d.work.constraint[i] = constraint;
        d.work.tolerated_compression[i] = compression_before(constraint);
    }
    [[nodiscard]] TALUS_DEVICE float gradient_square() const { return d.work.constraint[i].gradient_square; }
    [[nodiscard]] TALUS_DEVICE float compression() const { return d.work.compression[i]; }
    TALUS_DEVICE void set_compression(float compression) const { d.work.compression[i] = compression; }
    [[nodiscard]] TALUS_DEVICE float tolerated_compression() const { return d.work.tolerated_compression[i]; }
    TALUS_DEVICE void set_tolerated_compression(float tolerated) const { d.work.tolerated_compression[i] = tolerated; }
    [[nodiscard]] TALUS_DEVICE stages::StressChange<float> stress_change() const { return d.work.change[i].stress(); }
    TALUS_DEVICE void set_stress_change(const stages::StressChange<float>& s) const {
        d.work.change[i] = {s.xx, s.xy, s.xz, s.yy, s.yz, s.zz, 0, s.pressure};
    }
    [[nodiscard]] TALUS_DEVICE float ground_friction() const { return d.work.resistance[i].friction; }
    [[nodiscard]] TALUS_DEVICE float ground_strength() const { return d.work.resistance[i].strength; }
    [[nodiscard]] TALUS_DEVICE float effective_share() const { return d.work.resistance[i].effective_share; }
    [[nodiscard]] TALUS_DEVICE float ground_shear() const { return d.work.resistance[i].ground_shear; }
    TALUS_DEVICE void set_resistance(const stages::Resistance<float>& resistance) const {
        d.work.resistance[i] = resistance;
    }
    [[nodiscard]] TALUS_DEVICE ContactMemory<float> contact() const { return d.work.contact[i]; }
    TALUS_DEVICE void set_contact(const ContactMemory<float>& contact) const { d.work.contact[i] = contact; }

    // Neighbours.
    template <class F>
    TALUS_DEVICE void for_each_neighbour(const F& f) const {
        d.neighbours.for_each(i, [&](std::uint32_t j) { f(OneNeighbour{d, j}); });
    }

    // Walls.
    /// Samples ground and walls at `p`, displaced by `displacement` from where the step started; keeps them in the work
    /// arrays.
    TALUS_DEVICE stages::BoundaryShare<float> sample_boundary(const Vector& p, const Vector& displacement) const {
        const auto keep = [&](float distance, float slope, const Vector& normal, const Vector& gradient) {
            d.work.plane[i] = {distance - dot(displacement, normal), slope, normal};
            d.work.boundary_gradient[i] = gradient;
        };
        if (d.ground.solids.empty() || !d.ground.solids.near(p.x, p.y)) {
            const GroundFace<float> base = sample_ground(d.model, d.ground.terrain, p);
            keep(base.distance, base.slope, base.normal, base.normal * base.slope);
            if (!d.ground.solids.empty()) {
                for (BoundaryFace<float>& face : d.work.walls[i].faces) face.building = -1;
            }
            return {base.density, base.normal * base.slope};
        }
        const Boundary<float> boundary = sample_boundary_at(p);
        const BoundaryFace<float>& base = boundary.faces[0];
        keep(base.distance, base.slope, base.normal, boundary.gradient);
        WallContacts& walls = d.work.walls[i];
        for (std::size_t f = 0; f < walls.faces.size(); ++f) {
            walls.faces[f] = boundary.faces[f + 1];
            walls.faces[f].distance -= dot(displacement, walls.faces[f].normal);
        }
        return {boundary.density, boundary.gradient};
    }
    [[nodiscard]] TALUS_DEVICE Vector after_walls(const Vector& after, float multiplier) const {
        if (d.ground.solids.empty()) return after;
        const float share = d.step.resists_by_particle ? effective_share() : 1;
        return resolve_walls(d.model, d.work.walls[i], multiplier, share, after);
    }
    [[nodiscard]] TALUS_DEVICE Vector overlap_shift(const Vector& p, float max_shift) const {
        return undo_overlap(d.model, d.ground, p, max_shift, rank());
    }

    // Sleep.
    TALUS_DEVICE void put_to_sleep(bool /*sleeps*/) const {
        if (!d.ground.solids.empty() && d.work.walls[i].faces[0].building >= 0) return;
        d.state.asleep[i] = 1;
        d.state.still_time[i] = 0;
        d.state.velocity[i] = {};
    }
    TALUS_DEVICE void wake_neighbours(bool /*wakes*/) const {
        if (d.awake == d.count) return;
        d.neighbours.for_each(i, [&](std::uint32_t j) {
            if (j >= d.awake) store_shared(d.state.asleep[j], std::uint8_t{0});
        });
    }

    /// See net.hpp.
    [[nodiscard]] TALUS_DEVICE float rank() const { return grain_rank(d.state.id[i]); }

  private:
    [[nodiscard]] TALUS_DEVICE Boundary<float> sample_boundary_at(const Vector& p) const {
        return sim::sample_boundary(d.model, d.ground, p, rank());
    }
};

/// The same with the kernel of pairs, for stages that take gradients: these are computed anew, which on a card costs
/// less than reading them, and a tenth of the memory.
template <class Smoothing>
struct PairedParticle : OneParticle {
    const stages::PairKernel<Smoothing>& kernel;

    template <class F>
    TALUS_DEVICE void for_each_gradient(const F& f) const {
        const Vec3<float> p = d.work.place[i].vector();
        d.neighbours.for_each(i, [&](std::uint32_t j) {
            const OneNeighbour neighbour{d, j};
            f(neighbour, kernel.gradient(p - neighbour.place()));
        });
    }
};

}  // namespace talus::sim::device
