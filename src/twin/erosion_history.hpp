#pragma once

#include <cstdint>
#include <vector>

namespace talus::twin {

/// Erosion depth of the bed at the times of recorded frames: an entry per cell that changed since the previous frame.
/// There are at most as many entries as entrained particles, which need more memory in every frame.
class ErosionHistory {
  public:
    /// In the order of time. `eroded`: as Bed::eroded; searched only if `entrained`, the number of particles from it,
    /// has changed.
    void add(double time, std::uint32_t entrained, const std::vector<float>& eroded);
    /// The depths at the last add() at or before a time.
    [[nodiscard]] std::vector<float> at(double time) const;

  private:
    struct Entry {
        double time = 0;
        std::uint32_t cell = 0;
        float depth = 0;  // m, since the start
    };
    std::vector<Entry> entries_;
    std::vector<float> last_;  // by cell
    std::uint32_t entrained_ = 0;
};

}  // namespace talus::twin
