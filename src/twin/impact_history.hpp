#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "observe/observation.hpp"

namespace talus::twin {

/// Impact on obstacles over time: an entry per change, so that an obstacle that is not hit needs no memory.
class ImpactHistory {
  public:
    /// In the order of time.
    void add(std::size_t obstacle, double time, const observe::BuildingImpact& impact);
    void forget(std::size_t obstacle);
    /// The last entry at or before a time, without name and samples.
    [[nodiscard]] observe::BuildingImpact at(std::size_t obstacle, double time) const;

  private:
    std::vector<std::vector<std::pair<double, observe::BuildingImpact>>> entries_;  // by obstacle
};

}  // namespace talus::twin
