#include "sim/cpu/columns.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "sim/physics/columns.hpp"
#include "simd/parallel.hpp"

namespace talus::sim::cpu {
namespace {

constexpr std::size_t nowhere = std::numeric_limits<std::size_t>::max();
constexpr std::size_t grain = 2048;               // particles per task
constexpr std::size_t columns_per_particle = 16;  // of the box; with more of them, columns are hashed

/// Never 0, which marks an empty slot: columns are numbered from far outside.
std::uint64_t key_of(std::int64_t column, std::int64_t row) {
    constexpr std::int64_t outside = std::int64_t{1} << 31;
    return (static_cast<std::uint64_t>(row + outside) << 32) | static_cast<std::uint64_t>(column + outside);
}

template <class Array>
void clear(Array& array, std::size_t count) {
    simd::parallel_ranges(count, 131072, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) array[k].store(0, std::memory_order_relaxed);
    });
}

/// Around finite points that are not asleep; from high to low where all are.
struct Box {
    float x_min = std::numeric_limits<float>::max(), x_max = -x_min, y_min = x_min, y_max = -x_min;
};

Box box_of(const VectorArray& points, std::span<const std::uint8_t> asleep) {
    // Few points are not worth waking another thread.
    return simd::reduce_ranges(
        asleep.size(), 16384, Box{},
        [&](std::size_t first, std::size_t last, Box box) {
            for (std::size_t i = first; i < last; ++i) {
                if (asleep[i] != 0) continue;
                const float x = points.x[i], y = points.y[i];
                box = {std::min(box.x_min, x), std::max(box.x_max, x), std::min(box.y_min, y), std::max(box.y_max, y)};
            }
            return box;
        },
        [](const Box& a, const Box& b) {
            return Box{std::min(a.x_min, b.x_min), std::max(a.x_max, b.x_max), std::min(a.y_min, b.y_min),
                       std::max(a.y_max, b.y_max)};
        });
}

}  // namespace

inline std::size_t Columns::in_box(Place place) const {
    const std::int64_t column = place.column - first_.column, row = place.row - first_.row;
    const bool inside = column >= 0 && row >= 0 && column < size_.column && row < size_.row;
    return inside ? static_cast<std::size_t>(row * size_.column + column) : nowhere;
}

/// Chooses between box and hash, and empties the columns.
void Columns::frame(const VectorArray& points, std::span<const std::uint8_t> asleep) {
    const auto along = [&](float low, float high, std::int64_t& first, std::int64_t& size) {
        if (low > high) return;
        first = floor_to_int(low * inverse_width_ - 0.5);
        size = floor_to_int(high * inverse_width_ - 0.5) + 2 - first;
    };
    const Box box = box_of(points, asleep);
    along(box.x_min, box.x_max, first_.column, size_.column);
    along(box.y_min, box.y_max, first_.row, size_.row);
    hashed_ = static_cast<double>(size_.column) * static_cast<double>(size_.row) >
              static_cast<double>(columns_per_particle * capacity_);
    if (hashed_ && keys_.empty()) keys_ = std::vector<std::atomic<std::uint64_t>>(std::bit_ceil(5 * capacity_ + 1));
    if (hashed_) clear(keys_, keys_.size());
    clear(sums_, hashed_ ? keys_.size() : static_cast<std::size_t>(size_.column * size_.row));
}

void Columns::count(const VectorArray& points, std::span<const std::uint8_t> asleep, double width) {
    if (sums_.empty()) sums_ = std::vector<std::atomic<std::uint32_t>>(columns_per_particle * capacity_);
    inverse_width_ = 1 / width;
    size_ = {};
    hashed_ = false;
    frame(points, asleep);
    if (size_.column == 0) return;
    simd::parallel_ranges(asleep.size(), grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            for_each_column(points.x[i], points.y[i], inverse_width_,
                            [&](std::int64_t column, std::int64_t row, float share) {
                                std::size_t at = in_box({column, row});
                                if (asleep[i] != 0 && at == nowhere) return;
                                const std::uint32_t units = column_units(share);
                                if (units == 0) return;
                                if (hashed_) at = find_or_keep({column, row});
                                sums_[at].fetch_add(units, std::memory_order_relaxed);
                            });
        }
    });
}

float Columns::particles_at(float x, float y) const {
    float sum = 0;
    for_each_column(x, y, inverse_width_, [&](std::int64_t column, std::int64_t row, float share) {
        const std::size_t at = hashed_ ? find({column, row}) : in_box({column, row});
        const std::uint32_t units = at == nowhere ? 0 : sums_[at].load(std::memory_order_relaxed);
        sum += share * static_cast<float>(units) * (1 / units_per_particle);
    });
    return sum;
}

/// Fibonacci hashing (Knuth, "The Art of Computer Programming", vol. 3, 6.4): neighbouring keys end up far apart.
std::size_t Columns::first_slot(std::uint64_t key) const {
    return (key * 0x9E3779B97F4A7C15U) >> (65 - std::bit_width(keys_.size()));
}

std::size_t Columns::find_or_keep(Place place) {
    const std::uint64_t key = key_of(place.column, place.row);
    for (std::size_t k = first_slot(key);; k = (k + 1) & (keys_.size() - 1)) {
        std::uint64_t there = keys_[k].load(std::memory_order_relaxed);
        if (there == 0 && keys_[k].compare_exchange_strong(there, key, std::memory_order_relaxed)) return k;
        if (there == key) return k;
    }
}

std::size_t Columns::find(Place place) const {
    const std::uint64_t key = key_of(place.column, place.row);
    for (std::size_t k = first_slot(key);; k = (k + 1) & (keys_.size() - 1)) {
        const std::uint64_t there = keys_[k].load(std::memory_order_relaxed);
        if (there == key) return k;
        if (there == 0) return nowhere;
    }
}

}  // namespace talus::sim::cpu
