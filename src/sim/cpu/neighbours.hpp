#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/cpu/cell_sort.hpp"
#include "sim/state.hpp"

namespace talus::sim::cpu {

/// For every particle the other particles within the support radius. The lists of a block lie side by side, entry after
/// entry, so that its particles are processed together; a list that is shorter than the block's longest is filled with
/// the particle itself, which is at distance zero and so contributes to density only.
struct NeighbourLists {
    explicit NeighbourLists(std::size_t capacity);

    std::vector<std::uint32_t> start, length;  ///< per block: where its lists begin, how many entries its longest has
    std::vector<float> count;                  ///< per particle: entries that are neighbours
    std::vector<std::uint32_t> neighbour;      ///< of particle i, entry k: at start + k * block_size + i % block_size
    VectorArray gradient;                      ///< V grad W per entry, reused between sums over pairs

    [[nodiscard]] std::uint32_t count_of(std::size_t i) const { return static_cast<std::uint32_t>(count[i]); }
    [[nodiscard]] std::uint32_t neighbour_of(std::size_t i, std::size_t k) const {
        return neighbour[start[i / block_size] + k * block_size + i % block_size];
    }
};

/// One thread's buffers for the candidates around a cell and the neighbours found.
struct SearchScratch {
    std::vector<float> x, y, z;
    std::vector<std::uint32_t> index, found;
    std::size_t found_count = 0;  ///< of `found`, which is longer
};

/// Finds the neighbours of particles sorted by cell, and an order in which the lists of a block are about equally
/// long.
class NeighbourSearch {
  public:
    explicit NeighbourSearch(std::size_t capacity);

    /// The new order of the particles: entry i is the current index of the particle to place at i. Awake particles come
    /// first.
    struct Found {
        std::span<const std::uint32_t> order;
        std::uint32_t awake;
    };

    /// `points` in any order, `by_cell` the permutation that sorts them by `grid`, whose cells are at least `radius`
    /// wide. Those that are `asleep` (1 or 0, like `points`) are neighbours of others and have no lists themselves.
    Found find(const VectorArray& points, std::span<const std::uint32_t> by_cell,
               const std::vector<std::uint8_t>& asleep, const CellGrid& grid, float radius);
    /// Writes the result of find() in the new order.
    void write(NeighbourLists& lists);

    /// Finds the neighbours of the particles in cells [first, last) that are not asleep: writes them to `scratch.found`
    /// and their numbers to `count`. Compiled per instruction set.
    using FindInCells = void (*)(const VectorArray& sorted, const std::uint8_t* asleep, const CellGrid& grid,
                                 std::size_t first, std::size_t last, float square_radius, SearchScratch& scratch,
                                 std::uint32_t* count);

  private:
    bool try_find(const CellGrid& grid, float radius);
    void move_sleeping_last();
    void balance();
    [[nodiscard]] std::uint32_t longest_list(std::size_t block) const;
    void write_block(std::size_t block, NeighbourLists& lists) const;

    FindInCells find_in_cells_;
    std::size_t particles_ = 0;
    std::size_t awake_ = 0;
    VectorArray sorted_;                        // points by cell
    std::vector<std::uint8_t> asleep_;          // by cell
    std::vector<std::uint32_t> start_, count_;  // by cell
    std::vector<std::uint32_t> found_;          // indices by cell
    std::vector<std::uint32_t> place_;          // by cell: the new index
    std::vector<std::uint32_t> source_;         // by new index: the index by cell
    std::vector<std::uint32_t> window_;         // by new index, before the order within windows: the index by cell
    std::vector<std::uint32_t> order_;
    std::atomic<std::uint32_t> used_{0};
    std::vector<SearchScratch> scratch_;  // one per thread of the arena
};

/// For the chosen instruction set (dispatch.hpp).
[[nodiscard]] NeighbourSearch::FindInCells find_in_cells_function();

}  // namespace talus::sim::cpu
