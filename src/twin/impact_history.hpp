#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "observe/observation.hpp"

namespace talus::twin {

/// What an obstacle has met until some moment.
struct ObstacleRecord {
    BuildingImpact impact;
    // Of a barrier.
    double overtopped = 0;            ///< m3
    double first_overtopped = never;  ///< s
    double held = 0;                  ///< m3, upstream at that moment
};

/// The records of obstacles as they grew: an entry per change, so that what nothing touches takes no room.
class ImpactHistory {
  public:
    /// In the order of time.
    void add(std::size_t obstacle, double time, const ObstacleRecord& record);
    void forget(std::size_t obstacle);
    /// As of the last entry at or before a time; without its name.
    [[nodiscard]] ObstacleRecord at(std::size_t obstacle, double time) const;

  private:
    std::vector<std::vector<std::pair<double, ObstacleRecord>>> entries_;  // by obstacle
};

}  // namespace talus::twin
