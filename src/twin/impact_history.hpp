#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "observe/observation.hpp"

namespace talus::twin {

/// What obstacles met, as it grew: an entry per change, so that what nothing touches takes no room.
class ImpactHistory {
  public:
    /// In the order of time.
    void add(std::size_t obstacle, double time, const BuildingImpact& impact);
    void forget(std::size_t obstacle);
    /// As of the last entry at or before a time; without its name and its samples.
    [[nodiscard]] BuildingImpact at(std::size_t obstacle, double time) const;

  private:
    std::vector<std::vector<std::pair<double, BuildingImpact>>> entries_;  // by obstacle
};

}  // namespace talus::twin
