#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry.hpp"
#include "sim/physics/pore_pressure.hpp"
#include "sim/physics/stress.hpp"
#include "sim/rising_water.hpp"

namespace talus::sim {

/// Number of particles processed together, in one or several vector registers.
inline constexpr std::size_t block_size = 16;
constexpr std::size_t blocks_of(std::size_t particles) {
    return (particles + block_size - 1) / block_size;
}

/// Arrays of particles are longer by this: the last block is read and written whole.
inline constexpr std::size_t array_padding = block_size;

/// Three arrays of one coordinate each.
struct VectorArray {
    std::vector<float> x, y, z;

    template <class Archive>
    void keep(Archive& archive) {
        archive(x, y, z);
    }

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

    template <class Archive>
    void keep(Archive& archive) {
        archive(xx, yy, xy, xz, yz);
    }

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

// Common operations on the arrays of particles, for any type of element.
inline void resize(VectorArray& array, std::size_t n) {
    array.resize(n);
}
inline void resize(DeviatorArray& array, std::size_t n) {
    array.resize(n);
}
template <class T>
void resize(std::vector<T>& array, std::size_t n) {
    array.resize(n + array_padding);
}
template <class F>
void for_each_component(VectorArray& a, VectorArray& b, const F& f) {
    f(a.x, b.x);
    f(a.y, b.y);
    f(a.z, b.z);
}
template <class F>
void for_each_component(DeviatorArray& a, DeviatorArray& b, const F& f) {
    f(a.xx, b.xx);
    f(a.yy, b.yy);
    f(a.xy, b.xy);
    f(a.xz, b.xz);
    f(a.yz, b.yz);
}
template <class T, class F>
void for_each_component(std::vector<T>& a, std::vector<T>& b, const F& f) {
    f(a, b);
}

// clang-format off
/// Everything that a state holds per particle: X(array, element, name). All that goes through the arrays (resize, copy,
/// reorder, append, remove) comes from this list.
#define TALUS_PARTICLE_ARRAYS(X)                                                                                       \
    X(VectorArray, LocalPoint, position)                    /* local, m */                                             \
    X(VectorArray, LocalPoint, velocity)                    /* m/s */                                                  \
    X(std::vector<float>, float, multiplier)                /* lambda of the density constraint in the last step, */   \
                                                            /* <= 0, m2 (scales with dt^2) */                          \
    X(DeviatorArray, Deviator<float>, stress)               /* deviatoric part, in the units of lambda */              \
    X(std::vector<std::uint32_t>, std::uint32_t, id)        /* names the particle for good */                          \
    X(std::vector<std::uint8_t>, std::uint8_t, held)        /* 1: its release has not started */                       \
    X(std::vector<float>, float, still_time)                /* s, for how long it has hardly moved; 0 asleep */        \
    X(std::vector<std::uint8_t>, std::uint8_t, asleep)      /* 1: it stays where it is until something moves beside */
// clang-format on

/// The data of one particle in a state.
struct Particle {
#define TALUS_MEMBER(array, element, name) element name{};
    TALUS_PARTICLE_ARRAYS(TALUS_MEMBER)
#undef TALUS_MEMBER
};

/// When debris came in or was entrained, and with which pore pressure.
struct Entry {
    float time = 0;                  ///< s
    float pore_pressure_ratio = -1;  ///< r_u then; negative: that of the material
    float solid_fraction = -1;       ///< with evolving pore pressure; negative: that of the material
};

/// What a wall or roof took from a particle in the last step; a particle in a corner has two.
struct BuildingContact {
    std::uint32_t particle = 0;  ///< sorted index
    std::int32_t building = 0;
    float impulse = 0;   ///< kg m/s, normal to the wall
    LocalPoint place{};  ///< where on the wall
    float speed = 0;     ///< m/s, of the particle as it would be without this impulse
};

/// What a state knows of all its particles together.
struct StateSummary {
    double time = 0;                ///< s
    double time_step = 0;           ///< s, of the last step
    double previous_time_step = 0;  ///< s, the step for which multipliers and stresses were computed
    std::uint64_t step = 0;

    std::uint32_t count = 0;      ///< particles present, including those of releases that have not started
    std::uint32_t awake = 0;      ///< of these, the first ones, which a step processes; the others are asleep
    std::uint32_t seeded = 0;     ///< particles ever added
    std::uint32_t entrained = 0;  ///< of these, those entrained from the bed
    std::uint32_t outflow = 0;    ///< particles that left over the edge of the terrain; seeded = count + outflow +
                                  ///< removed
    std::uint32_t removed = 0;    ///< particles that were removed between two steps (remove_particles())
    /// Particles from releases, less those that were removed.
    [[nodiscard]] std::uint32_t released() const { return seeded - entrained - removed; }

    // Measured by the last step.
    double mean_compression = 0, max_compression = 0;      ///< of max(0, density / rest density - 1)
    double mean_added_compression = 0;                     ///< by the step, to what it started with
    double overcompressed_share = 0, squeezing_share = 0;  ///< of the particles; see compression.hpp
    int iterations = 0;                                    ///< of the step
    double max_speed = 0;                                  ///< m/s
    std::vector<BuildingContact> building_contacts;
    std::vector<Water> water_of_release;  ///< as Model::releases; empty: no water rises

    template <class Archive>
    void keep(Archive& archive) {
        archive(time, time_step, previous_time_step, step, count, awake, seeded, entrained, outflow, removed,
                mean_compression, max_compression, mean_added_compression, overcompressed_share, squeezing_share,
                iterations, max_speed, building_contacts, water_of_release);
    }
};

/// Everything that changes during a run, as a structure of arrays in an order that every step recomputes so that
/// neighbours are close in memory.
struct State : StateSummary {
#define TALUS_MEMBER(array, element, name) array name;
    TALUS_PARTICLE_ARRAYS(TALUS_MEMBER)
#undef TALUS_MEMBER
    std::vector<float> density_of_id;     ///< kg/m3, by id; 0 and beyond its end: the rest density
    std::vector<Entry> entry_of_id;       ///< by id, as far as r_u depends on it; not of releases, which have a start
    std::vector<Soil<float>> soil_of_id;  ///< by id, with evolving pore pressure; see make_room_for_soil()

    void resize(std::size_t n) {
#define TALUS_RESIZE(array, element, name) sim::resize(name, n);
        TALUS_PARTICLE_ARRAYS(TALUS_RESIZE)
#undef TALUS_RESIZE
    }
    template <class Archive>
    void keep(Archive& archive) {
        StateSummary::keep(archive);
#define TALUS_KEEP(array, element, name) archive(name);
        TALUS_PARTICLE_ARRAYS(TALUS_KEEP)
#undef TALUS_KEEP
        archive(density_of_id, entry_of_id, soil_of_id);
    }
    /// Particles that the arrays have room for.
    [[nodiscard]] std::size_t room() const {
        return id.size() < array_padding ? 0 : id.size() - array_padding;
    }

    [[nodiscard]] Particle particle(std::size_t i) const;
    void set_particle(std::size_t i, const Particle& values);

    /// Removes the particles for which gone(i) is true; the others keep their order. Calls `on_kept(i, k)` when
    /// particle i becomes k. Returns how many were removed.
    template <class Gone, class OnKept>
    std::uint32_t remove_if(const Gone& gone, const OnKept& on_kept);
};

/// Calls f(array of a, the same of b) for everything that a state holds per particle, number by number.
template <class F>
void for_each_array(State& a, State& b, const F& f) {
#define TALUS_EACH(array, element, name) for_each_component(a.name, b.name, f);
    TALUS_PARTICLE_ARRAYS(TALUS_EACH)
#undef TALUS_EACH
}

inline Particle State::particle(std::size_t i) const {
    Particle result;
#define TALUS_GET(array, element, name) result.name = (name).at(i);
    TALUS_PARTICLE_ARRAYS(TALUS_GET)
#undef TALUS_GET
    return result;
}

inline void State::set_particle(std::size_t i, const Particle& values) {
    const auto set = [i](auto& array, const auto& value) {
        if constexpr (requires { array.set(i, value); }) {
            array.set(i, value);
        } else {
            array[i] = value;
        }
    };
#define TALUS_SET(array, element, name) set(name, values.name);
    TALUS_PARTICLE_ARRAYS(TALUS_SET)
#undef TALUS_SET
}

template <class Gone, class OnKept>
std::uint32_t State::remove_if(const Gone& gone, const OnKept& on_kept) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (gone(i)) continue;
        on_kept(i, kept);
        for_each_array(*this, *this, [&](auto& array, auto&) { array[kept] = array[i]; });
        ++kept;
    }
    const std::uint32_t gone_count = count - kept;
    count = kept;
    return gone_count;
}

}  // namespace talus::sim
