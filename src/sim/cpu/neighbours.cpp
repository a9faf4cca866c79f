#include "sim/cpu/neighbours.hpp"

#include <algorithm>
#include <array>

#include <tbb/task_arena.h>

#include "sim/cpu/parallel.hpp"

namespace talus::cpu {
namespace {

constexpr std::size_t cells_per_task = 64;
constexpr std::size_t usual_task_size = 65536;  // entries of lists; debris at rest density needs about half
constexpr std::size_t longest_vector = 2 * PairList::padding;  // what may be written beyond what was found
constexpr int row_count = 9;  // a cell's 27 neighbours are 9 rows of 3 cells with consecutive keys

/// Walks the 9 neighbour rows of ascending cells. As keys ascend, every row's position only moves forward, so that a
/// sweep needs no hash table and touches the occupied cells alone.
class RowSweep {
  public:
    RowSweep(const CellGrid& grid, std::size_t first_cell) : grid_(grid) {
        int row = 0;
        for (int dz = -1; dz <= 1; ++dz) {
            for (int dy = -1; dy <= 1; ++dy, ++row) {
                // Unsigned wrap-around is intended: padding makes every sum below non-negative.
                const std::uint64_t offset =
                    (static_cast<std::uint64_t>(dz) * grid.rows + static_cast<std::uint64_t>(dy)) * grid.columns - 1;
                offset_[row] = offset;
                const auto from = std::lower_bound(grid.key.begin(), grid.key.end(), grid.key[first_cell] + offset);
                cell_[row] = static_cast<std::size_t>(from - grid.key.begin());
            }
        }
    }

    /// The particles [first, last) of a row of three cells around `cell`; cells must be asked for in ascending order.
    std::pair<std::uint32_t, std::uint32_t> particles(int row, std::size_t cell) {
        const std::uint64_t low = grid_.key[cell] + offset_[row];
        std::size_t& at = cell_[row];
        while (at < grid_.key.size() && grid_.key[at] < low) ++at;
        std::size_t end = at;
        while (end < grid_.key.size() && grid_.key[end] <= low + 2) ++end;
        return {grid_.start[at], grid_.start[end]};
    }

  private:
    const CellGrid& grid_;
    std::array<std::uint64_t, row_count> offset_{};
    std::array<std::size_t, row_count> cell_{};
};

}  // namespace

NeighbourLists::NeighbourLists(std::size_t capacity, const PairSums& sums)
    : start_(capacity), count_(capacity), neighbours_(capacity * 72 + 1024), select_near_(sums.select_near) {
    gradient_.resize(neighbours_.size());
}

void NeighbourLists::build(const VectorArray& points, const CellGrid& grid, float radius) {
    // For every thread that may come, before it comes: a thread's first task must not have to allocate.
    const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    if (found_.size() < threads) found_.resize(threads, std::vector<std::uint32_t>(usual_task_size));
    while (!try_build(points, grid, radius)) {
        // Rare: debris denser than ever before. Room to spare, so that it stays rare.
        neighbours_.resize(used_.load() + used_.load() / 2);
        gradient_.resize(neighbours_.size());
    }
}

bool NeighbourLists::try_build(const VectorArray& points, const CellGrid& grid, float radius) {
    used_.store(0);
    const float square_radius = radius * radius;
    const std::size_t tasks = (grid.cell_count() + cells_per_task - 1) / cells_per_task;
    const Coordinates coordinates{points.x.data(), points.y.data(), points.z.data()};
    parallel_ranges(tasks, 1, [&](std::size_t first_task, std::size_t last_task) {
        std::vector<std::uint32_t>& found =
            found_[static_cast<std::size_t>(tbb::this_task_arena::current_thread_index())];
        for (std::size_t task = first_task; task < last_task; ++task) {
            const std::size_t first_cell = task * cells_per_task;
            const std::size_t last_cell = std::min(grid.cell_count(), first_cell + cells_per_task);
            const std::uint32_t first_particle = grid.start[first_cell];
            std::size_t size = 0;
            RowSweep sweep(grid, first_cell);
            for (std::size_t cell = first_cell; cell < last_cell; ++cell) {
                std::array<std::pair<std::uint32_t, std::uint32_t>, row_count> rows;
                for (int row = 0; row < row_count; ++row)
                    rows[static_cast<std::size_t>(row)] = sweep.particles(row, cell);
                std::size_t candidates = 0;
                for (const auto& [first, last] : rows) candidates += last - first;
                for (std::uint32_t i = grid.start[cell]; i < grid.start[cell + 1]; ++i) {
                    if (found.size() < size + candidates + longest_vector) found.resize(2 * (size + candidates) + 1024);
                    const std::size_t before = size;
                    for (const auto& [first, last] : rows) {
                        // The particle itself is left out by looking on either side of it.
                        const bool own = first <= i && i < last;
                        size += select_near_(coordinates, first, own ? i : last, points.at(i), square_radius,
                                             found.data() + size);
                        if (!own) continue;
                        size +=
                            select_near_(coordinates, i + 1, last, points.at(i), square_radius, found.data() + size);
                    }
                    start_[i] = static_cast<std::uint32_t>(before);
                    count_[i] = static_cast<std::uint32_t>(size - before);
                    while (size % PairList::padding != 0) found[size++] = i;
                }
            }
            const std::uint32_t base = used_.fetch_add(static_cast<std::uint32_t>(size));
            if (base + size > neighbours_.size()) continue;  // grown and built again
            std::copy_n(found.begin(), size, neighbours_.begin() + base);
            for (std::uint32_t i = first_particle; i < grid.start[last_cell]; ++i) start_[i] += base;
        }
    });
    return used_.load() <= neighbours_.size();
}

}  // namespace talus::cpu
