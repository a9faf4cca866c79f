#include "twin/erosion_history.hpp"

namespace talus::twin {

void ErosionHistory::add(double time, std::uint32_t entrained, const std::vector<float>& eroded) {
    if (entrained == entrained_) return;
    entrained_ = entrained;
    last_.resize(eroded.size(), 0);
    for (std::uint32_t cell = 0; cell < eroded.size(); ++cell) {
        if (eroded[cell] == last_[cell]) continue;
        last_[cell] = eroded[cell];
        entries_.push_back({time, cell, eroded[cell]});
    }
}

std::vector<float> ErosionHistory::at(double time) const {
    std::vector<float> eroded(last_.size(), 0);
    for (const Entry& entry : entries_) {
        if (entry.time > time + 1e-9) break;
        eroded[entry.cell] = entry.depth;
    }
    return eroded;
}

}  // namespace talus::twin
