#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry.hpp"
#include "sim/physics/stress.hpp"

namespace talus {

/// Particles that are worked on together, side by side in vector registers or one register after another.
inline constexpr std::size_t bundle_size = 16;
constexpr std::size_t bundles_of(std::size_t particles) {
    return (particles + bundle_size - 1) / bundle_size;
}

/// Arrays of particles are that much longer than asked for: the last bundle is read and written whole.
inline constexpr std::size_t array_padding = bundle_size;

/// Three arrays of one coordinate each.
struct VectorArray {
    std::vector<float> x, y, z;

    void resize(std::size_t n) {
        for (auto* component : {&x, &y, &z}) component->resize(n + array_padding);
    }
    [[nodiscard]] LocalPoint at(std::size_t i) const { return {x[i], y[i], z[i]}; }
    void set(std::size_t i, const LocalPoint& p) {
        x[i] = p.x;
        y[i] = p.y;
        z[i] = p.z;
    }
};

/// A traceless symmetric tensor per particle; zz = -xx - yy.
struct DeviatorArray {
    std::vector<float> xx, yy, xy, xz, yz;

    void resize(std::size_t n) {
        for (auto* component : {&xx, &yy, &xy, &xz, &yz}) component->resize(n + array_padding);
    }
    [[nodiscard]] Deviator<float> at(std::size_t i) const { return {xx[i], yy[i], xy[i], xz[i], yz[i]}; }
    void set(std::size_t i, const Deviator<float>& s) {
        xx[i] = s.xx;
        yy[i] = s.yy;
        xy[i] = s.xy;
        xz[i] = s.xz;
        yz[i] = s.yz;
    }
};

/// What a wall or roof took from a particle in the last step; a particle in a corner has two.
struct BuildingContact {
    std::uint32_t particle;  ///< sorted index
    std::int32_t building;
    float impulse;  ///< kg m/s, normal to the wall
};

/// Everything that changes during a run, as a structure of arrays in an order that every step finds anew: neighbours
/// lie near each other. `id` names a particle for good.
struct State {
    double time = 0;                ///< s
    double time_step = 0;           ///< s, of the last step
    double previous_time_step = 0;  ///< s, the step that multipliers and stresses belong to
    std::uint64_t step = 0;

    std::uint32_t count = 0;      ///< particles present, including those of releases that have not started
    std::uint32_t awake = 0;      ///< the first of them, which a step works on; the others are at rest
    std::uint32_t seeded = 0;     ///< particles that were ever there
    std::uint32_t entrained = 0;  ///< of them, those that debris picked up from the bed
    std::uint32_t left = 0;       ///< particles that left the terrain; seeded = count + left + taken, always
    std::uint32_t taken = 0;      ///< particles that were taken away between two steps (take_away())
    /// Of all that were ever there, those that releases brought and that nobody took away again.
    [[nodiscard]] std::uint32_t released() const { return seeded - entrained - taken; }
    VectorArray position;           ///< local, m
    VectorArray velocity;           ///< m/s
    std::vector<float> multiplier;  ///< lambda of the density constraint in the last step, <= 0, m2 (scales with dt^2)
    DeviatorArray stress;           ///< deviatoric part, in the units of lambda
    std::vector<std::uint32_t> id;
    std::vector<std::uint8_t> held;     ///< 1: its release has not started
    std::vector<float> calm_time;       ///< s, for how long the particle has hardly moved; 0 at rest
    std::vector<float> density_of_id;   ///< kg/m3, by id; 0 and beyond its end: the rest density
    std::vector<std::uint8_t> resting;  ///< 1: it stays where it is until something moves beside it

    void resize(std::size_t n) {
        position.resize(n);
        velocity.resize(n);
        stress.resize(n);
        multiplier.resize(n + array_padding);
        id.resize(n + array_padding);
        held.resize(n + array_padding);
        calm_time.resize(n + array_padding);
        resting.resize(n + array_padding);
    }

    // Measured by the last step.
    double mean_compression = 0, max_compression = 0;  ///< of max(0, density / rest density - 1)
    double largest_speed = 0;                          ///< m/s
    std::vector<BuildingContact> building_contacts;
};

/// Calls f(array of a, the same of b) for everything that a state holds per particle.
template <class F>
void for_each_array(State& a, State& b, const F& f) {
    for (auto array : {&VectorArray::x, &VectorArray::y, &VectorArray::z}) {
        f(a.position.*array, b.position.*array);
        f(a.velocity.*array, b.velocity.*array);
    }
    for (auto array :
         {&DeviatorArray::xx, &DeviatorArray::yy, &DeviatorArray::xy, &DeviatorArray::xz, &DeviatorArray::yz}) {
        f(a.stress.*array, b.stress.*array);
    }
    f(a.multiplier, b.multiplier);
    f(a.id, b.id);
    f(a.held, b.held);
    f(a.calm_time, b.calm_time);
    f(a.resting, b.resting);
}

}  // namespace talus
