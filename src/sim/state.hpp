#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry.hpp"
#include "sim/physics/stress.hpp"

namespace talus {

/// Three arrays of one coordinate each. They are longer than asked for: a vector load may begin at the last particle.
struct VectorArray {
    static constexpr std::size_t padding = 16;  ///< floats, the widest vector
    std::vector<float> x, y, z;

    void resize(std::size_t n) {
        x.resize(n + padding);
        y.resize(n + padding);
        z.resize(n + padding);
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
        for (auto* component : {&xx, &yy, &xy, &xz, &yz}) component->resize(n);
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

/// Everything that changes during a run, as a structure of arrays sorted by cell. Index = SortedIndex, valid until the
/// next step; `id` names a particle for good.
struct State {
    double time = 0;                ///< s
    double time_step = 0;           ///< s, of the last step
    double previous_time_step = 0;  ///< s, the step that multipliers and stresses belong to
    std::uint64_t step = 0;

    std::uint32_t count = 0;        ///< particles present, including those of releases that have not started
    std::uint32_t seeded = 0;       ///< particles at the start
    std::uint32_t left = 0;         ///< particles that left the terrain; seeded = count + left, always
    VectorArray position;           ///< local, m
    VectorArray velocity;           ///< m/s
    std::vector<float> multiplier;  ///< lambda of the density constraint in the last step, <= 0, m2 (scales with dt^2)
    DeviatorArray stress;           ///< deviatoric part, in the units of lambda
    std::vector<std::uint32_t> id;
    std::vector<std::uint8_t> held;  ///< 1: its release has not started

    void resize(std::size_t n) {
        position.resize(n);
        velocity.resize(n);
        multiplier.resize(n);
        stress.resize(n);
        id.resize(n);
        held.resize(n);
    }

    // Measured by the last step.
    double mean_compression = 0, max_compression = 0;  ///< of max(0, density / rest density - 1)
    double largest_speed = 0;                          ///< m/s
    std::vector<BuildingContact> building_contacts;
};

}  // namespace talus
