#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "sim/state.hpp"

namespace talus::cpu {

/// How many particles stand above each place in plan: a sparse grid of columns, counted anew in each step. Counts are
/// whole numbers, so that they do not depend on the number of threads.
class Columns {
  public:
    explicit Columns(std::size_t capacity) : capacity_(capacity) {}

    /// Counts finite `points` in columns that are `cell` wide, m. The first call gets the memory.
    void count(const VectorArray& points, std::size_t count, double cell);
    /// Particles in the column at a place, between the middles of columns by bilinear interpolation.
    [[nodiscard]] float particles_at(float x, float y) const;

  private:
    struct Slot {
        std::atomic<std::uint64_t> key{};       // 0: empty
        std::atomic<std::uint32_t> particles{};
    };

    [[nodiscard]] std::uint64_t key_of(std::int64_t column, std::int64_t row) const;
    [[nodiscard]] std::size_t first_slot(std::uint64_t key) const;
    void add(std::uint64_t key);
    [[nodiscard]] std::uint32_t particles_in(std::uint64_t key) const;

    std::size_t capacity_;
    double inverse_cell_ = 1;
    std::vector<Slot> slots_;  // a power of two of them, at least twice as many as particles
};

}  // namespace talus::cpu
