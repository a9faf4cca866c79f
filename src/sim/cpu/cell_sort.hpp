#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/state.hpp"

namespace talus::sim::cpu {

/// The occupied cells of a sparse grid over the particles, in the order of their keys. Empty cells cost neither memory
/// nor time: a dense grid over the bounding box of a valley would cost more than the solver.
struct CellGrid {
    double x_min = 0, y_min = 0, z_min = 0, inverse_cell = 0;
    std::uint64_t columns = 1, rows = 1;     // of the padded box: keys run x first, then y, then z
    std::vector<std::uint64_t> key;          // one per occupied cell, ascending; one beyond all at the end
    std::vector<std::uint32_t> start = {0};  // first particle of the cell; one more at the end

    [[nodiscard]] std::size_t cell_count() const { return start.size() - 1; }
};

/// Computes the order that sorts the particles by cell. A stable radix sort: equal cells keep their earlier order.
class CellSort {
  public:
    explicit CellSort(std::size_t capacity);

    /// `points`: finite positions. Returns the permutation: entry i is the current index of the particle to place at i.
    std::span<const std::uint32_t> sort(const VectorArray& points, std::size_t count, double cell, CellGrid& grid);

  private:
    void radix_sort(std::size_t count, std::uint64_t max_key);
    void list_cells(std::size_t count, CellGrid& grid) const;

    std::vector<std::uint64_t> key_, key_swap_;
    std::vector<std::uint32_t> order_, order_swap_;
    std::vector<std::uint32_t> histogram_;
};

}  // namespace talus::sim::cpu
