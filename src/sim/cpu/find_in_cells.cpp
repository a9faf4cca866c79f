// The inner part of the neighbour search. Compiled once per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/cpu/find_in_cells.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include <algorithm>
#include <array>
#include <hwy/highway.h>
#include <utility>

#include "sim/cpu/neighbours.hpp"

#ifndef TALUS_ROW_SWEEP
#define TALUS_ROW_SWEEP
namespace talus::cpu {
namespace {

constexpr int row_count = 9;  // a cell's 27 neighbours are 9 rows of 3 cells with consecutive keys

/// Walks the 9 neighbour rows of ascending cells. As keys ascend, every row's position only moves forward, so that a
/// sweep needs no hash table and touches the occupied cells alone.
class RowSweep {
  public:
    RowSweep(const CellGrid& grid, std::size_t first_cell) : grid_(grid) {
        std::size_t row = 0;
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
    std::pair<std::uint32_t, std::uint32_t> particles(std::size_t row, std::size_t cell) {
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
}  // namespace talus::cpu
#endif

HWY_BEFORE_NAMESPACE();
namespace talus::cpu::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using DU = hn::RebindToUnsigned<D>;

/// Copies the particles in the 9 rows around a cell to one place: those of the cell look through all of them in turn.
/// Goes on for a vector with particles that are near nothing. Returns how many there are.
std::size_t collect_candidates(const VectorArray& sorted, RowSweep& sweep, std::size_t cell, SearchScratch& scratch) {
    constexpr D d;
    constexpr DU du;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t count = 0;
    for (std::size_t row = 0; row < row_count; ++row) {
        const auto [first, last] = sweep.particles(row, cell);
        const std::size_t room = count + (last - first) + 2 * lanes;
        if (scratch.x.size() < room) {
            for (auto* array : {&scratch.x, &scratch.y, &scratch.z}) array->resize(2 * room);
            scratch.index.resize(2 * room);
        }
        for (std::uint32_t j = first; j < last; j += static_cast<std::uint32_t>(lanes)) {
            const std::size_t to = count + (j - first);
            hn::StoreU(hn::LoadU(d, sorted.x.data() + j), d, scratch.x.data() + to);
            hn::StoreU(hn::LoadU(d, sorted.y.data() + j), d, scratch.y.data() + to);
            hn::StoreU(hn::LoadU(d, sorted.z.data() + j), d, scratch.z.data() + to);
            hn::StoreU(hn::Iota(du, j), du, scratch.index.data() + to);
        }
        count += last - first;
    }
    hn::StoreU(hn::Set(d, 1e30f), d, scratch.x.data() + count);
    return count;
}

void find_in_cells(const VectorArray& sorted, const std::uint8_t* asleep, const CellGrid& grid, std::size_t first,
                   std::size_t last, float square_radius, SearchScratch& scratch, std::uint32_t* count) {
    constexpr D d;
    constexpr DU du;
    const std::size_t lanes = hn::Lanes(d);
    const auto limit = hn::Set(d, square_radius);
    RowSweep sweep(grid, first);
    std::size_t size = 0;
    for (std::size_t cell = first; cell < last; ++cell) {
        const std::uint32_t begin = grid.start[cell], end = grid.start[cell + 1];
        std::fill(count + begin, count + end, 0);
        if (std::all_of(asleep + begin, asleep + end, [](std::uint8_t sleeps) { return sleeps != 0; })) continue;
        const std::size_t candidates = collect_candidates(sorted, sweep, cell, scratch);
        const std::uint32_t particles = end - begin;
        const std::size_t room = size + particles * candidates + lanes;
        if (scratch.found.size() < room) scratch.found.resize(2 * room);
        for (std::uint32_t i = begin; i < end; ++i) {
            if (asleep[i]) continue;
            const auto px = hn::Set(d, sorted.x[i]), py = hn::Set(d, sorted.y[i]), pz = hn::Set(d, sorted.z[i]);
            const auto own = hn::Set(du, i);
            const std::size_t before = size;
            for (std::size_t c = 0; c < candidates; c += lanes) {
                const auto dx = hn::Sub(hn::LoadU(d, scratch.x.data() + c), px);
                const auto dy = hn::Sub(hn::LoadU(d, scratch.y.data() + c), py);
                const auto dz = hn::Sub(hn::LoadU(d, scratch.z.data() + c), pz);
                const auto index = hn::LoadU(du, scratch.index.data() + c);
                const auto square = hn::Add(hn::Mul(dz, dz), hn::Add(hn::Mul(dy, dy), hn::Mul(dx, dx)));
                const auto near = hn::And(hn::RebindMask(du, hn::Lt(square, limit)), hn::Ne(index, own));
                // In a register and then stored whole: the instruction that compresses into memory is slow on AMD.
                hn::StoreU(hn::Compress(index, near), du, scratch.found.data() + size);
                size += hn::CountTrue(du, near);
            }
            count[i] = static_cast<std::uint32_t>(size - before);
        }
    }
    scratch.found_count = size;
}

NeighbourSearch::FindInCells make_find_in_cells() {
    return find_in_cells;
}

}  // namespace
}  // namespace talus::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace talus::cpu {

HWY_EXPORT(make_find_in_cells);

NeighbourSearch::FindInCells find_in_cells_function() {
    return HWY_DYNAMIC_DISPATCH(make_find_in_cells)();
}

}  // namespace talus::cpu
#endif
