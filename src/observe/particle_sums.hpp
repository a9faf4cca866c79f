#pragma once

#include <cmath>
#include <cstdint>

#include "core/geometry.hpp"
#include "core/number.hpp"
#include "sim/particle_density.hpp"
#include "terrain/flow_path.hpp"
#include "terrain/plan_bins.hpp"

/// What observers take from single particles, whether their arrays are those of a state or of a device.
namespace talus::observe {

/// Counts and energies over the particles, as far as they are summed for every row.
struct ParticleSums {
    std::uint32_t held = 0, moving = 0, deposited = 0;
    // Sums over the particles, weighed by density over rest density.
    double speed_squared = 0;  ///< m2/s2
    double speed = 0;          ///< m/s
    double height = 0;         ///< m above the lowest terrain

    /// `held` and `weight` of the particle.
    TALUS_DEVICE void add(const LocalPoint& velocity, float z, bool is_held, double weight, double deposited_speed) {
        const double square = dot(velocity, velocity);
        speed_squared += weight * square;
        speed += weight * std::sqrt(square);
        height += weight * static_cast<double>(z);
        if (is_held) {
            ++held;
        } else if (square < deposited_speed * deposited_speed) {
            ++deposited;
        } else {
            ++moving;
        }
    }
    friend TALUS_DEVICE ParticleSums operator+(const ParticleSums& a, const ParticleSums& b) {
        return {a.held + b.held,   a.moving + b.moving, a.deposited + b.deposited, a.speed_squared + b.speed_squared,
                a.speed + b.speed, a.height + b.height};
    }
};

/// A particle on the flow path, not far behind the front.
struct PathParticle {
    std::uint32_t particle;
    float chainage, speed;
};

/// The chainage of particles at `from` or beyond; -1 of others, and outside the corridor.
struct ChainageBeyond {
    terrain::PathField path;
    PlanPoint origin;  ///< of local positions
    double from = 0;

    [[nodiscard]] TALUS_DEVICE float of(float x, float y) const {
        const PlanPoint p{origin.x + static_cast<double>(x), origin.y + static_cast<double>(y)};
        const float bound = path.chainage_bound(p);
        if (bound < 0 || static_cast<double>(bound) < from) return -1;
        const auto at = path.locate(p);
        const float chainage = at ? static_cast<float>(at->chainage) : -1;
        return chainage >= 0 && static_cast<double>(chainage) >= from ? chainage : -1;
    }
};

/// A particle near a wall.
struct WallParticle {
    LocalPoint position, velocity;
    double density = 0;  ///< kg/m3
};

/// A particle and where it is.
struct PlacedParticle {
    LocalPoint position;
    std::uint32_t id = 0;
    float speed = 0;  ///< m/s
};

/// A local plan rectangle.
struct PlanRectangle {
    double x_min, y_min, x_max, y_max;

    [[nodiscard]] TALUS_DEVICE bool contains(float x, float y) const {
        const double u = x, v = y;
        return u >= x_min && u <= x_max && v >= y_min && v <= y_max;  // false for NaN
    }
};

}  // namespace talus::observe
