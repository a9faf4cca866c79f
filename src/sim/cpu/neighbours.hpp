#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/cpu/cell_sort.hpp"
#include "sim/cpu/pair_sums.hpp"
#include "sim/state.hpp"

namespace talus::cpu {

/// For every particle the particles nearer than the support radius, itself left out, in one flat buffer; lists are
/// padded to whole vectors as PairList says. Where in the buffer a list lies depends on the threads; what it holds, and
/// in which order, does not.
class NeighbourLists {
  public:
    NeighbourLists(std::size_t capacity, const PairSums& sums);

    /// `points` sorted by `grid`, whose cells are at least `radius` wide.
    void build(const VectorArray& points, const CellGrid& grid, float radius);

    [[nodiscard]] std::span<const std::uint32_t> of(std::size_t i) const {
        return {neighbours_.data() + start_[i], count_[i]};
    }
    /// The same list, with room for a pair gradient per neighbour.
    [[nodiscard]] PairList pairs_of(std::size_t i) {
        const std::size_t at = start_[i];
        return {neighbours_.data() + at, count_[i], gradient_.x.data() + at, gradient_.y.data() + at,
                gradient_.z.data() + at};
    }

  private:
    bool try_build(const VectorArray& points, const CellGrid& grid, float radius);

    std::vector<std::uint32_t> start_, count_, neighbours_;
    VectorArray gradient_;  // V grad W per entry of neighbours_
    decltype(PairSums::select_near) select_near_;
    std::atomic<std::uint32_t> used_{0};
    std::vector<std::vector<std::uint32_t>> found_;  // of a task, one per thread of the arena
};

}  // namespace talus::cpu
