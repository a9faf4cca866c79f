// The inner part of the neighbour search. Compiled once per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/cpu/find_in_cells.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include <algorithm>
#include <array>
#include <cstdint>
#include <hwy/highway.h>
#include <utility>

#include "sim/cpu/neighbours.hpp"

#ifndef TALUS_ROW_SWEEP
#define TALUS_ROW_SWEEP
namespace talus::sim::cpu {
namespace {

constexpr int row_count = 9;  // a cell's 27 neighbours are 9 rows of 3 cells with consecutive keys

/// Walks the 9 neighbour rows of ascending cells. As keys ascend, both ends of a row only move forward, so a sweep
/// needs no hash table and visits occupied cells only.
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
                begin_[row] = end_[row] = static_cast<std::size_t>(from - grid.key.begin());
            }
        }
    }

    /// The particles [first, last) of a row of three cells around `cell`; cells must be requested in ascending order.
    std::pair<std::uint32_t, std::uint32_t> particles(std::size_t row, std::size_t cell) {
        const std::uint64_t* const key = grid_.key.data();
        const std::uint64_t low = key[cell] + offset_[row], high = low + 2;
        // By one or by none in most cases: without a branch, which could not be predicted.
        const auto advance = [key](std::size_t at, std::uint64_t past) {
            at += key[at] < past ? 1 : 0;
            while (key[at] < past) ++at;
            return at;
        };
        begin_[row] = advance(begin_[row], low);
        end_[row] = advance(end_[row], high + 1);
        return {grid_.start[begin_[row]], grid_.start[end_[row]]};
    }

  private:
    const CellGrid& grid_;
    std::array<std::uint64_t, row_count> offset_{};
    std::array<std::size_t, row_count> begin_{}, end_{};
};

/// For each mask of `lanes` bits: the lanes whose bits are set, in order, the others after them.
template <int lanes>
constexpr auto compress_table() {
    std::array<std::array<std::uint32_t, lanes>, 1U << lanes> table{};
    for (std::uint32_t mask = 0; mask < table.size(); ++mask) {
        std::uint32_t to = 0;
        for (const std::uint32_t set : {1U, 0U}) {
            for (std::uint32_t lane = 0; lane < lanes; ++lane) {
                if ((mask >> lane & 1U) == set) table[mask][to++] = lane;
            }
        }
    }
    return table;
}

/// The same table as bytes, for four lanes of 32 bits.
[[maybe_unused]] constexpr auto compress_bytes() {
    constexpr auto lanes = compress_table<4>();
    std::array<std::array<std::uint8_t, 16>, lanes.size()> bytes{};
    for (std::size_t mask = 0; mask < lanes.size(); ++mask) {
        for (std::size_t k = 0; k < 16; ++k) bytes[mask][k] = static_cast<std::uint8_t>(4 * lanes[mask][k / 4] + k % 4);
    }
    return bytes;
}

/// The candidates around a cell, and the index of the first particle of the cell itself.
struct Candidates {
    std::size_t count, own;
};

}  // namespace
}  // namespace talus::sim::cpu
#endif

HWY_BEFORE_NAMESPACE();
namespace talus::sim::cpu::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using DU = hn::RebindToUnsigned<D>;

constexpr float far_away = 1e18f;  // m; its square is a float

/// Copies the particles in the 9 rows around a cell to one contiguous array, which every particle of the cell searches
/// in turn. Padded by one vector of particles that are near nothing.
Candidates collect_candidates(const VectorArray& sorted, RowSweep& sweep, std::size_t cell, std::uint32_t begin,
                              SearchScratch& scratch) {
    constexpr hn::CappedTag<float, 8> d;  // a row seldom has more: a wider store would cross into another cache line
    constexpr hn::RebindToUnsigned<decltype(d)> du;
    constexpr D padding;
    const std::size_t lanes = hn::Lanes(d);
    // Once: Highway 1.0 writes it lane by lane into memory, from where a whole vector cannot be loaded at once.
    const auto ascending = hn::Iota(du, 0);
    std::size_t count = 0, own = 0;
    for (std::size_t row = 0; row < row_count; ++row) {
        const auto [first, last] = sweep.particles(row, cell);
        if (row == row_count / 2) own = count + (begin - first);
        const std::size_t room = count + (last - first) + 2 * hn::Lanes(padding);
        if (scratch.x.size() < room) {
            for (auto* array : {&scratch.x, &scratch.y, &scratch.z}) array->resize(2 * room);
            scratch.index.resize(2 * room);
        }
        for (std::uint32_t j = first; j < last; j += static_cast<std::uint32_t>(lanes)) {
            const std::size_t to = count + (j - first);
            hn::StoreU(hn::LoadU(d, sorted.x.data() + j), d, scratch.x.data() + to);
            hn::StoreU(hn::LoadU(d, sorted.y.data() + j), d, scratch.y.data() + to);
            hn::StoreU(hn::LoadU(d, sorted.z.data() + j), d, scratch.z.data() + to);
            hn::StoreU(hn::Add(ascending, hn::Set(du, j)), du, scratch.index.data() + to);
        }
        count += last - first;
    }
    hn::StoreU(hn::Set(padding, far_away), padding, scratch.x.data() + count);
    return {count, own};
}

/// Stores the lanes of `index` that are `near` at `to`, in order, followed by others that fill the vector. Returns the
/// number that are near.
HWY_INLINE std::size_t store_compressed(hn::Vec<DU> index, hn::Mask<DU> near, std::uint32_t* to) {
    [[maybe_unused]] constexpr DU du;
#if HWY_TARGET <= HWY_AVX3 || HWY_TARGET == HWY_SCALAR
    // In a register and then stored whole: the instruction that compresses into memory is slow on AMD.
    hn::StoreU(hn::Compress(index, near), du, to);
    return hn::CountTrue(du, near);
#elif HWY_TARGET == HWY_WASM
    // Highway 1.0 makes the mask's bits and the lookup of many instructions: a third of a whole step.
    static constexpr auto table = compress_bytes();
    const std::uint32_t mask = wasm_i32x4_bitmask(reinterpret_cast<v128_t>(near.raw));
    wasm_v128_store(to, wasm_i8x16_swizzle(reinterpret_cast<v128_t>(index.raw), wasm_v128_load(table[mask].data())));
    return static_cast<std::size_t>(__builtin_popcount(mask));
#else
    // Highway 1.0's Compress keeps its table in a constexpr that is not static, and GCC 12 copies that to the stack for
    // every vector (google/highway issue 1139): three quarters of the search time.
    constexpr int lanes = hn::MaxLanes(du);
    static constexpr auto table = compress_table<lanes>();
    std::array<std::uint8_t, 8> bits{};
    hn::StoreMaskBits(du, near, bits.data());
    const std::uint32_t mask = bits[0];
    hn::StoreU(hn::TableLookupLanes(index, hn::SetTableIndices(du, table[mask].data())), du, to);
    return static_cast<std::size_t>(__builtin_popcount(mask));
#endif
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
        const Candidates candidates = collect_candidates(sorted, sweep, cell, begin, scratch);
        const std::uint32_t particles = end - begin;
        const std::size_t room = size + particles * candidates.count + lanes;
        if (scratch.found.size() < room) scratch.found.resize(2 * room);
        // Raw pointers: the compiler must otherwise assume that the stores below change the vectors themselves.
        float* const x = scratch.x.data();
        const float *const y = scratch.y.data(), *const z = scratch.z.data();
        const std::uint32_t* const index = scratch.index.data();
        std::uint32_t* const found = scratch.found.data();
        for (std::uint32_t i = begin; i < end; ++i) {
            if (asleep[i]) continue;
            float& own_x = x[candidates.own + (i - begin)];
            const float mine = std::exchange(own_x, far_away);  // not its own neighbour
            // Not Set(d, mine): Clang 14 loads that for WebAssembly from own_x, after it was replaced.
            const auto px = hn::Set(d, sorted.x[i]), py = hn::Set(d, sorted.y[i]), pz = hn::Set(d, sorted.z[i]);
            const std::size_t before = size;
            for (std::size_t c = 0; c < candidates.count; c += lanes) {
                const auto dx = hn::Sub(hn::LoadU(d, x + c), px);
                const auto dy = hn::Sub(hn::LoadU(d, y + c), py);
                const auto dz = hn::Sub(hn::LoadU(d, z + c), pz);
                const auto square = hn::Add(hn::Mul(dz, dz), hn::Add(hn::Mul(dy, dy), hn::Mul(dx, dx)));
                const auto near = hn::RebindMask(du, hn::Lt(square, limit));
                size += store_compressed(hn::LoadU(du, index + c), near, found + size);
            }
            own_x = mine;
            count[i] = static_cast<std::uint32_t>(size - before);
        }
    }
    scratch.found_count = size;
}

NeighbourSearch::FindInCells make_find_in_cells() {
    return find_in_cells;
}

}  // namespace
}  // namespace talus::sim::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace talus::sim::cpu {

HWY_EXPORT(make_find_in_cells);

NeighbourSearch::FindInCells find_in_cells_function() {
    return HWY_DYNAMIC_DISPATCH(make_find_in_cells)();
}

}  // namespace talus::sim::cpu
#endif
