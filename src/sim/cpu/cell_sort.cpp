#include "sim/cpu/cell_sort.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "simd/parallel.hpp"

namespace talus::sim::cpu {
namespace {

constexpr int max_digit_bits = 11;
constexpr std::size_t histogram_span =
    2048;  // particles per histogram; fixed, so the work does not depend on the number of threads

struct Bounds {
    float x_min = std::numeric_limits<float>::max(), y_min = x_min, z_min = x_min;
    float x_max = std::numeric_limits<float>::lowest(), y_max = x_max;
    float z_max = x_max;
};

Bounds bounds_of(const VectorArray& points, std::size_t count) {
    const auto join = [](const Bounds& a, const Bounds& b) {
        return Bounds{std::min(a.x_min, b.x_min), std::min(a.y_min, b.y_min), std::min(a.z_min, b.z_min),
                      std::max(a.x_max, b.x_max), std::max(a.y_max, b.y_max), std::max(a.z_max, b.z_max)};
    };
    return simd::reduce_ranges(
        count, 4096, Bounds{},
        [&](std::size_t first, std::size_t last, Bounds b) {
            for (std::size_t i = first; i < last; ++i) {
                b.x_min = std::min(b.x_min, points.x[i]);
                b.x_max = std::max(b.x_max, points.x[i]);
                b.y_min = std::min(b.y_min, points.y[i]);
                b.y_max = std::max(b.y_max, points.y[i]);
                b.z_min = std::min(b.z_min, points.z[i]);
                b.z_max = std::max(b.z_max, points.z[i]);
            }
            return b;
        },
        join);
}

}  // namespace

CellSort::CellSort(std::size_t capacity)
    : key_(capacity),
      key_swap_(capacity),
      order_(capacity),
      order_swap_(capacity),
      histogram_((capacity / histogram_span + 1) << max_digit_bits) {}

std::span<const std::uint32_t> CellSort::sort(const VectorArray& points, std::size_t count, double cell,
                                              CellGrid& grid) {
    const Bounds box = bounds_of(points, count);
    grid.inverse_cell = 1 / cell;
    // One empty cell of padding on each side: the key of a neighbour cell is then a plain sum that never wraps. The
    // extra quarter keeps rounding from placing the outermost particle in the padding.
    constexpr double padding = 1.25;
    grid.x_min = box.x_min - padding * cell;
    grid.y_min = box.y_min - padding * cell;
    grid.z_min = box.z_min - padding * cell;
    const auto cells_along = [&](float low, float high) {
        return static_cast<std::uint64_t>((double(high) - low) * grid.inverse_cell + padding) + 2;
    };
    grid.columns = cells_along(box.x_min, box.x_max);
    grid.rows = cells_along(box.y_min, box.y_max);
    const std::uint64_t layers = cells_along(box.z_min, box.z_max);

    simd::parallel_ranges(count, histogram_span, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const auto cx = static_cast<std::uint64_t>((points.x[i] - grid.x_min) * grid.inverse_cell);
            const auto cy = static_cast<std::uint64_t>((points.y[i] - grid.y_min) * grid.inverse_cell);
            const auto cz = static_cast<std::uint64_t>((points.z[i] - grid.z_min) * grid.inverse_cell);
            key_[i] = (cz * grid.rows + cy) * grid.columns + cx;
            order_[i] = static_cast<std::uint32_t>(i);
        }
    });
    radix_sort(count, grid.columns * grid.rows * layers);

    list_cells(count, grid);
    return {order_.data(), count};
}

/// Without a branch, which would be mispredicted at every cell: a cell's end moves on with each of its particles.
void CellSort::list_cells(std::size_t count, CellGrid& grid) const {
    grid.key.resize(count + 1);
    grid.start.resize(count + 1);
    std::uint64_t* const keys = grid.key.data();
    std::uint32_t* const starts = grid.start.data();
    std::size_t cell = 0;
    for (std::size_t i = 0; i < count; ++i) {
        cell += i > 0 && key_[i] != key_[i - 1] ? 1 : 0;
        keys[cell] = key_[i];
        starts[cell + 1] = static_cast<std::uint32_t>(i + 1);
    }
    const std::size_t cells = count > 0 ? cell + 1 : 0;
    starts[0] = 0;
    grid.key.resize(cells + 1);
    grid.key[cells] = std::numeric_limits<std::uint64_t>::max();
    grid.start.resize(cells + 1);
}

void CellSort::radix_sort(std::size_t count, std::uint64_t max_key) {
    const std::size_t histograms = (count + histogram_span - 1) / histogram_span;
    // As few passes as the keys need, and no wider digits than these: a histogram costs as much as it has digits.
    const int key_bits = std::bit_width(max_key), passes = (key_bits + max_digit_bits - 1) / max_digit_bits;
    const int digit_bits = passes > 0 ? (key_bits + passes - 1) / passes : 0;
    const std::size_t digit_count = std::size_t{1} << digit_bits;
    for (int pass = 0; pass < passes; ++pass) {
        const int shift = pass * digit_bits;
        const auto digit = [=](std::uint64_t key) {
            return static_cast<std::size_t>(key >> shift) & (digit_count - 1);
        };
        simd::parallel_ranges(histograms, 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t h = first; h < last; ++h) {
                std::uint32_t* histogram = histogram_.data() + h * digit_count;
                std::fill_n(histogram, digit_count, 0);
                const std::size_t end = std::min(count, (h + 1) * histogram_span);
                for (std::size_t i = h * histogram_span; i < end; ++i) ++histogram[digit(key_[i])];
            }
        });
        std::uint32_t sum = 0;
        for (std::size_t d = 0; d < digit_count; ++d) {
            for (std::size_t h = 0; h < histograms; ++h) {
                std::uint32_t& entry = histogram_[h * digit_count + d];
                const std::uint32_t here = entry;
                entry = sum;
                sum += here;
            }
        }
        simd::parallel_ranges(histograms, 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t h = first; h < last; ++h) {
                std::uint32_t* next = histogram_.data() + h * digit_count;
                const std::size_t end = std::min(count, (h + 1) * histogram_span);
                for (std::size_t i = h * histogram_span; i < end; ++i) {
                    const std::uint32_t to = next[digit(key_[i])]++;
                    key_swap_[to] = key_[i];
                    order_swap_[to] = order_[i];
                }
            }
        });
        key_.swap(key_swap_);
        order_.swap(order_swap_);
    }
}

}  // namespace talus::sim::cpu
