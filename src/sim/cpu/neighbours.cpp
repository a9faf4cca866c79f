#include "sim/cpu/neighbours.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <tbb/task_arena.h>

#include "simd/parallel.hpp"

namespace talus::sim::cpu {
namespace {

constexpr std::size_t cells_per_task = 64;
constexpr std::size_t usual_task_size = 65536;   // entries of lists; debris at rest density needs about half
constexpr std::size_t usual_candidates = 4096;   // debris at rest density has about 290 around a cell
constexpr std::size_t usual_neighbours = 48;     // per particle; debris at rest density has about 40
constexpr std::size_t window = 16 * block_size;  // particles that may be reordered among each other
constexpr std::uint32_t max_counted = 127;

}  // namespace

NeighbourLists::NeighbourLists(std::size_t capacity)
    : start(blocks_of(capacity)), length(blocks_of(capacity)), count(capacity + array_padding) {
    neighbour.resize(capacity * usual_neighbours);
    gradient.resize(neighbour.size());
}

NeighbourSearch::NeighbourSearch(std::size_t capacity)
    : find_in_cells_(find_in_cells_function()),
      start_(capacity),
      count_(capacity),
      found_(capacity * usual_neighbours + 1024),
      place_(capacity),
      source_(capacity),
      window_(capacity),
      order_(capacity) {
    asleep_.resize(capacity);
    sorted_.resize(capacity);
}

NeighbourSearch::Found NeighbourSearch::find(const VectorArray& points, std::span<const std::uint32_t> by_cell,
                                             const std::vector<std::uint8_t>& asleep, const CellGrid& grid,
                                             float radius) {
    particles_ = by_cell.size();
    simd::parallel_ranges(particles_, 4096, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            sorted_.set(i, points.at(by_cell[i]));
            asleep_[i] = asleep[by_cell[i]];
        }
    });
    // For every thread of the arena, in advance: a thread's first task must not allocate.
    const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    while (scratch_.size() < threads) {
        SearchScratch& scratch = scratch_.emplace_back();
        for (auto* array : {&scratch.x, &scratch.y, &scratch.z}) array->resize(usual_candidates);
        scratch.index.resize(usual_candidates);
        scratch.found.resize(usual_task_size);
    }
    // Growth is rare: only when debris is denser than ever before. Spare capacity keeps it rare.
    while (!try_find(grid, radius)) found_.resize(used_.load() + used_.load() / 2);
    move_sleeping_last();
    balance();
    simd::parallel_ranges(particles_, 4096, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) order_[i] = by_cell[source_[i]];
    });
    return {{order_.data(), particles_}, static_cast<std::uint32_t>(awake_)};
}

/// Sleeping debris goes to the end, so that awake particles form one range.
void NeighbourSearch::move_sleeping_last() {
    awake_ = 0;
    for (std::uint32_t i = 0; i < particles_; ++i) {
        window_[awake_] = i;  // replaced by the next one if this sleeps
        awake_ += asleep_[i] ? 0 : 1;
    }
    std::size_t next = awake_;
    for (std::uint32_t i = 0; next < particles_; ++i) {
        if (!asleep_[i]) continue;
        source_[next] = i;
        place_[i] = static_cast<std::uint32_t>(next++);
    }
}

bool NeighbourSearch::try_find(const CellGrid& grid, float radius) {
    used_.store(0);
    const std::size_t tasks = (grid.cell_count() + cells_per_task - 1) / cells_per_task;
    simd::parallel_ranges(tasks, 1, [&](std::size_t first_task, std::size_t last_task) {
        SearchScratch& scratch = scratch_[static_cast<std::size_t>(tbb::this_task_arena::current_thread_index())];
        for (std::size_t task = first_task; task < last_task; ++task) {
            const std::size_t first_cell = task * cells_per_task;
            const std::size_t last_cell = std::min(grid.cell_count(), first_cell + cells_per_task);
            find_in_cells_(sorted_, asleep_.data(), grid, first_cell, last_cell, radius * radius, scratch,
                           count_.data());
            const auto size = static_cast<std::uint32_t>(scratch.found_count);
            std::uint32_t at = used_.fetch_add(size);
            if (at + size > found_.size()) continue;  // the caller enlarges it and searches again
            std::copy_n(scratch.found.begin(), size, found_.begin() + at);
            for (std::uint32_t i = grid.start[first_cell]; i < grid.start[last_cell]; ++i) {
                start_[i] = at;
                at += count_[i];
            }
        }
    });
    return used_.load() <= found_.size();
}

/// Sorts the particles of a window by their number of neighbours, so that the lists of a block have about the same
/// length. A stable counting sort, so that the result does not depend on threads.
void NeighbourSearch::balance() {
    const std::size_t windows = (awake_ + window - 1) / window;
    simd::parallel_ranges(windows, 4, [&](std::size_t first_window, std::size_t last_window) {
        for (std::size_t w = first_window; w < last_window; ++w) {
            const std::size_t first = w * window, last = std::min(awake_, first + window);
            std::array<std::uint32_t, max_counted + 1> next{};
            const auto key = [&](std::size_t i) { return max_counted - std::min(count_[i], max_counted); };
            for (std::size_t i = first; i < last; ++i) ++next[key(window_[i])];
            auto sum = static_cast<std::uint32_t>(first);
            for (std::uint32_t& n : next) sum += std::exchange(n, sum);
            for (std::size_t i = first; i < last; ++i) {
                const std::uint32_t by_cell = window_[i];
                place_[by_cell] = next[key(by_cell)]++;
                source_[place_[by_cell]] = by_cell;
            }
        }
    });
}

void NeighbourSearch::write(NeighbourLists& lists) {
    const std::size_t blocks = blocks_of(awake_);
    std::uint32_t size = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
        lists.start[b] = size;
        lists.length[b] = longest_list(b);
        size += lists.length[b] * static_cast<std::uint32_t>(block_size);
    }
    if (lists.neighbour.size() < size) {
        lists.neighbour.resize(size + size / 2);
        lists.gradient.resize(lists.neighbour.size());
    }
    simd::parallel_ranges(blocks, 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t b = first; b < last; ++b) write_block(b, lists);
    });
}

std::uint32_t NeighbourSearch::longest_list(std::size_t block) const {
    const std::size_t first = block * block_size, last = std::min(awake_, first + block_size);
    std::uint32_t longest = count_[source_[first]];
    if (longest < max_counted) return longest;  // balance() put it first; beyond, it did not look
    for (std::size_t i = first + 1; i < last; ++i) longest = std::max(longest, count_[source_[i]]);
    return longest;
}

/// Entry by entry through all lists of the block as far as all have one, so that memory is written in order.
void NeighbourSearch::write_block(std::size_t block, NeighbourLists& lists) const {
    const std::size_t first = block * block_size;
    std::array<const std::uint32_t*, block_size> found{};
    std::array<std::uint32_t, block_size> count{};
    for (std::size_t lane = 0; lane < block_size; ++lane) {
        const bool listed = first + lane < awake_;
        const std::size_t from = listed ? source_[first + lane] : 0;
        found[lane] = found_.data() + start_[from];
        count[lane] = listed ? count_[from] : 0;
        lists.count[first + lane] = static_cast<float>(count[lane]);
    }
    const std::uint32_t shortest = *std::min_element(count.begin(), count.end());
    std::uint32_t* const to = lists.neighbour.data() + lists.start[block];
    const std::uint32_t* const place = place_.data();
    for (std::uint32_t k = 0; k < shortest; ++k) {
        for (std::size_t lane = 0; lane < block_size; ++lane) to[k * block_size + lane] = place[found[lane][k]];
    }
    for (std::uint32_t k = shortest; k < lists.length[block]; ++k) {
        for (std::size_t lane = 0; lane < block_size; ++lane) {
            to[k * block_size + lane] =
                k < count[lane] ? place[found[lane][k]] : static_cast<std::uint32_t>(first + lane);
        }
    }
}

}  // namespace talus::sim::cpu
