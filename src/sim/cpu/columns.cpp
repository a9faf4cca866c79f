#include "sim/cpu/columns.hpp"

#include <bit>
#include <cmath>

#include "simd/parallel.hpp"

namespace talus::sim::cpu {
namespace {

constexpr float one = 65536;  // a whole particle

/// Never 0, which marks an empty slot: columns are numbered from far outside.
std::uint64_t key_of(std::int64_t column, std::int64_t row) {
    constexpr std::int64_t outside = std::int64_t{1} << 31;
    return (static_cast<std::uint64_t>(row + outside) << 32) | static_cast<std::uint64_t>(column + outside);
}

}  // namespace

/// The four columns whose centres surround a place, each with its share by bilinear interpolation.
template <class F>
void Columns::for_each_column(float x, float y, const F& f) const {
    const double u = x * inverse_width_ - 0.5, v = y * inverse_width_ - 0.5;
    const double column = std::floor(u), row = std::floor(v);
    const auto right = static_cast<float>(u - column), upper = static_cast<float>(v - row);
    for (int dy = 0; dy < 2; ++dy) {
        for (int dx = 0; dx < 2; ++dx) {
            const float share = (dx == 1 ? right : 1 - right) * (dy == 1 ? upper : 1 - upper);
            f(key_of(static_cast<std::int64_t>(column) + dx, static_cast<std::int64_t>(row) + dy), share);
        }
    }
}

void Columns::count(const VectorArray& points, std::size_t count, double width) {
    if (slots_.empty()) slots_ = std::vector<Slot>(std::bit_ceil(5 * capacity_ + 1));
    inverse_width_ = 1 / width;
    simd::parallel_ranges(slots_.size(), 16384, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            slots_[k].key.store(0, std::memory_order_relaxed);
            slots_[k].sum.store(0, std::memory_order_relaxed);
        }
    });
    simd::parallel_ranges(count, 4096, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            for_each_column(points.x[i], points.y[i], [&](std::uint64_t key, float share) {
                add(key, static_cast<std::uint32_t>(std::lround(share * one)));
            });
        }
    });
}

float Columns::particles_at(float x, float y) const {
    float sum = 0;
    for_each_column(
        x, y, [&](std::uint64_t key, float share) { sum += share * static_cast<float>(sum_of(key)) * (1 / one); });
    return sum;
}

/// Fibonacci hashing (Knuth, "The Art of Computer Programming", vol. 3, 6.4): neighbouring keys end up far apart.
std::size_t Columns::first_slot(std::uint64_t key) const {
    return (key * 0x9E3779B97F4A7C15U) >> (65 - std::bit_width(slots_.size()));
}

void Columns::add(std::uint64_t key, std::uint32_t share) {
    if (share == 0) return;
    for (std::size_t k = first_slot(key);; k = (k + 1) & (slots_.size() - 1)) {
        std::uint64_t there = slots_[k].key.load(std::memory_order_relaxed);
        if (there == 0 && slots_[k].key.compare_exchange_strong(there, key, std::memory_order_relaxed)) there = key;
        if (there != key) continue;
        slots_[k].sum.fetch_add(share, std::memory_order_relaxed);
        return;
    }
}

std::uint32_t Columns::sum_of(std::uint64_t key) const {
    for (std::size_t k = first_slot(key);; k = (k + 1) & (slots_.size() - 1)) {
        const std::uint64_t there = slots_[k].key.load(std::memory_order_relaxed);
        if (there == key) return slots_[k].sum.load(std::memory_order_relaxed);
        if (there == 0) return 0;
    }
}

}  // namespace talus::sim::cpu
