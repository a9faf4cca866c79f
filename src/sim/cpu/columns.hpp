#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/state.hpp"

namespace talus::sim::cpu {

/// The number of particles above each place in plan: a grid of columns, rebuilt in each step. Shares of particles are
/// whole numbers, so that sums do not depend on the number of threads.
///
/// Debris that moves is near together in plan as a rule: the grid is then an array over its bounding box, and debris
/// at rest outside it is not counted. Where the box has many more columns than there are particles, the columns that
/// hold any are found by hashing.
class Columns {
  public:
    explicit Columns(std::size_t capacity) : capacity_(capacity) {}

    /// Distributes the first asleep.size() points, which are finite, over the centres of columns that are `width` wide,
    /// m. `asleep`: 1 for points at which nobody asks for the sum. The first call allocates the memory.
    void count(const VectorArray& points, std::span<const std::uint8_t> asleep, double width);
    /// Particles in a column at a place, interpolated between the centres of columns; of a place within the bounding
    /// box of the points that are not asleep.
    [[nodiscard]] float particles_at(float x, float y) const;

  private:
    /// Column and row, counted from the frame's origin.
    struct Place {
        std::int64_t column, row;
    };

    void frame(const VectorArray& points, std::span<const std::uint8_t> asleep);
    /// If the columns are hashed, where the sum of a column is kept, or `nowhere`.
    [[nodiscard]] std::size_t find(Place place) const;
    /// The same; it is kept from now on.
    [[nodiscard]] std::size_t find_or_keep(Place place);
    /// Where the sum of a column of the box is kept, or `nowhere`.
    [[nodiscard]] inline std::size_t in_box(Place place) const;
    [[nodiscard]] std::size_t first_slot(std::uint64_t key) const;

    std::size_t capacity_;
    double inverse_width_ = 1;
    bool hashed_ = false;
    Place first_{}, size_{};  // of the box
    std::vector<std::atomic<std::uint32_t>> sums_;
    std::vector<std::atomic<std::uint64_t>>
        keys_;  // if hashed; a power of two, as a single particle takes four. 0: empty
};

}  // namespace talus::sim::cpu
