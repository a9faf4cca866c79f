#include "sim/cpu/columns.hpp"

#include <bit>
#include <cmath>

#include "sim/cpu/parallel.hpp"

namespace talus::cpu {

void Columns::count(const VectorArray& points, std::size_t count, double cell) {
    if (slots_.empty()) slots_ = std::vector<Slot>(std::bit_ceil(2 * capacity_ + 2));
    inverse_cell_ = 1 / cell;
    parallel_ranges(slots_.size(), 16384, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            slots_[k].key.store(0, std::memory_order_relaxed);
            slots_[k].particles.store(0, std::memory_order_relaxed);
        }
    });
    parallel_ranges(count, 4096, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            add(key_of(static_cast<std::int64_t>(std::floor(points.x[i] * inverse_cell_)),
                       static_cast<std::int64_t>(std::floor(points.y[i] * inverse_cell_))));
        }
    });
}

float Columns::particles_at(float x, float y) const {
    // From middle to middle of columns.
    const double u = x * inverse_cell_ - 0.5, v = y * inverse_cell_ - 0.5;
    const double column = std::floor(u), row = std::floor(v);
    const auto share_x = static_cast<float>(u - column), share_y = static_cast<float>(v - row);
    float sum = 0;
    for (int dy = 0; dy < 2; ++dy) {
        for (int dx = 0; dx < 2; ++dx) {
            const float share = (dx == 1 ? share_x : 1 - share_x) * (dy == 1 ? share_y : 1 - share_y);
            sum += share * static_cast<float>(particles_in(
                               key_of(static_cast<std::int64_t>(column) + dx, static_cast<std::int64_t>(row) + dy)));
        }
    }
    return sum;
}

/// Never 0, which marks an empty slot; columns are counted from the middle of the world.
std::uint64_t Columns::key_of(std::int64_t column, std::int64_t row) const {
    constexpr std::int64_t middle = std::int64_t{1} << 31;
    return (static_cast<std::uint64_t>(row + middle) << 32) | static_cast<std::uint64_t>(column + middle);
}

/// Fibonacci hashing (Knuth, "The Art of Computer Programming", vol. 3, 6.4): neighbouring keys end up far apart.
std::size_t Columns::first_slot(std::uint64_t key) const {
    return (key * 0x9E3779B97F4A7C15U) >> (65 - std::bit_width(slots_.size()));
}

void Columns::add(std::uint64_t key) {
    for (std::size_t k = first_slot(key);; k = (k + 1) & (slots_.size() - 1)) {
        std::uint64_t there = slots_[k].key.load(std::memory_order_relaxed);
        if (there == 0 && slots_[k].key.compare_exchange_strong(there, key, std::memory_order_relaxed)) there = key;
        if (there != key) continue;
        slots_[k].particles.fetch_add(1, std::memory_order_relaxed);
        return;
    }
}

std::uint32_t Columns::particles_in(std::uint64_t key) const {
    for (std::size_t k = first_slot(key);; k = (k + 1) & (slots_.size() - 1)) {
        const std::uint64_t there = slots_[k].key.load(std::memory_order_relaxed);
        if (there == key) return slots_[k].particles.load(std::memory_order_relaxed);
        if (there == 0) return 0;
    }
}

}  // namespace talus::cpu
