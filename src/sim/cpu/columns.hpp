#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "sim/state.hpp"

namespace talus::sim::cpu {

/// The number of particles above each place in plan: a sparse grid of columns, rebuilt in each step. Shares of
/// particles are whole numbers, so that sums do not depend on the number of threads.
class Columns {
  public:
    explicit Columns(std::size_t capacity) : capacity_(capacity) {}

    /// Distributes finite `points` over the centres of columns that are `width` wide, m. The first call allocates the
    /// memory.
    void count(const VectorArray& points, std::size_t count, double width);
    /// Particles in a column at a place, interpolated between the centres of columns.
    [[nodiscard]] float particles_at(float x, float y) const;

  private:
    struct Slot {
        std::atomic<std::uint64_t> key{};  // 0: empty
        std::atomic<std::uint32_t> sum{};
    };

    template <class F>
    void for_each_column(float x, float y, const F& f) const;
    [[nodiscard]] std::size_t first_slot(std::uint64_t key) const;
    void add(std::uint64_t key, std::uint32_t share);
    [[nodiscard]] std::uint32_t sum_of(std::uint64_t key) const;

    std::size_t capacity_;
    double inverse_width_ = 1;
    std::vector<Slot> slots_;  // their number is a power of two; a single particle takes four
};

}  // namespace talus::sim::cpu
