#pragma once

#include <cstdint>
#include <vector>

namespace talus::twin {

/// How deep debris had eroded its bed at the times of recorded frames: an entry per cell that changed since the one
/// before. There are no more entries than particles that were picked up, which take more room in every frame.
class ErosionHistory {
  public:
    /// In the order of time. `eroded`: as Bed::eroded; it is looked through only if `entrained`, the particles that it
    /// became, differs from the time before.
    void add(double time, std::uint32_t entrained, const std::vector<float>& eroded);
    /// As of the last add() at or before a time.
    [[nodiscard]] std::vector<float> at(double time) const;

  private:
    struct Entry {
        double time = 0;
        std::uint32_t cell = 0;
        float depth = 0;  // m, since the beginning
    };
    std::vector<Entry> entries_;
    std::vector<float> last_;  // by cell
    std::uint32_t entrained_ = 0;
};

}  // namespace talus::twin
