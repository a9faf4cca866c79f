#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "sim/cpu/cell_sort.hpp"
#include "sim/state.hpp"

namespace talus::cpu {

/// For every particle the particles nearer than the support radius, itself left out, in one flat buffer.
/// Where in the buffer a list lies depends on the threads; what it holds, and in which order, does not.
class NeighbourLists {
  public:
    explicit NeighbourLists(std::size_t capacity);

    /// `points` sorted by `grid`, whose cells are at least `radius` wide.
    void build(const VectorArray& points, const CellGrid& grid, float radius);

    [[nodiscard]] std::span<const std::uint32_t> of(std::size_t i) const {
        return {neighbours_.data() + start_[i], count_[i]};
    }
    /// Room for a vector per neighbour of a particle, in the order of `of`: what a pass over pairs keeps for the next.
    [[nodiscard]] Vec3<float>* pair_vectors_of(std::size_t i) { return pair_vectors_.data() + start_[i]; }
    [[nodiscard]] std::size_t total() const { return used_.load(std::memory_order_relaxed); }

  private:
    bool try_build(const VectorArray& points, const CellGrid& grid, float radius);

    std::vector<std::uint32_t> start_, count_, neighbours_;
    std::vector<Vec3<float>> pair_vectors_;
    std::atomic<std::uint32_t> used_{0};
    tbb::enumerable_thread_specific<std::vector<std::uint32_t>> local_;
};

}  // namespace talus::cpu
