#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry.hpp"
#include "observe/observation.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::twin {

/// How much debris gets over a barrier: particles that cross its line between two steps, net of those that come back,
/// each counted once. Around its ends is not over it. Looks at debris in a rectangle around the line only.
class Overtopping {
  public:
    /// `line`: world. `height` of the barrier, m.
    Overtopping(const Model& model, const std::vector<PlanPoint>& line, double height);

    /// `jumped`: particles may have been moved since the last call; nothing counts as a crossing.
    void after_step(const State& state, bool jumped = false);

    [[nodiscard]] double volume() const;                             ///< m3
    [[nodiscard]] double first_time() const { return first_time_; }  ///< s; NaN: never

    /// Debris upstream now, m3: within five heights of the line and between its ends, on the side from which it has
    /// crossed, or where there is more of it.
    [[nodiscard]] double held_volume(const State& state) const;

  private:
    struct Point {
        float x, y;
    };
    struct Track {
        Point last{};
        std::uint64_t step = 0;  ///< call after that of the last position; 0: none
        std::int8_t net = 0;     ///< crossings from left to right less those back
    };
    /// Crossings of the line on the way from `a` to `b`: 1 from its left to its right, -1 back, 0.
    [[nodiscard]] int crossings(const Point& a, const Point& b) const;

    std::vector<Point> line_;  // local
    Extent near_;              // local
    double particle_volume_ = 0, reach_ = 0;
    std::vector<Track> tracks_;                // by particle id
    std::int64_t to_right_ = 0, to_left_ = 0;  // particles
    double first_time_ = never;
    std::uint64_t calls_ = 0;
};

}  // namespace talus::twin
