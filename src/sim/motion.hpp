#pragma once

#include <cstdint>

#include "core/geometry.hpp"
#include "core/number.hpp"

namespace talus::sim {

/// How many particles are fast.
struct Motion {
    std::uint32_t moving = 0;  ///< faster than outputs.deposited_speed
    std::uint32_t fast = 0;    ///< ten times as fast: they may still climb, fall or strike something

    friend TALUS_DEVICE Motion operator+(const Motion& a, const Motion& b) {
        return {a.moving + b.moving, a.fast + b.fast};
    }
};

/// The motion of one particle.
class MotionCount {
  public:
    /// Debris slower than this times the deposited speed (1 m/s) rises by no more than 5 cm, and can fall only by
    /// becoming faster.
    static constexpr float fast_ratio = 10;

    MotionCount() = default;
    /// In m/s.
    explicit MotionCount(double deposited_speed)
        : slow_(static_cast<float>(deposited_speed * deposited_speed)), fast_(fast_ratio * fast_ratio * slow_) {}

    TALUS_DEVICE Motion operator()(const Vec3<float>& velocity) const {
        const float square = dot(velocity, velocity);
        return {square >= slow_ ? 1U : 0U, square >= fast_ ? 1U : 0U};
    }

  private:
    float slow_ = 0, fast_ = 0;
};

}  // namespace talus::sim
