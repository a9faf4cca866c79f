// Compiled once per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/calibration.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include <array>
#include <cstddef>
#include <cstdint>
#include <hwy/highway.h>

#include "bench/calibration.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;
constexpr D d;
using Row = Calibration::Row;

struct V4 {
    V x, y, z, w;
};

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET <= HWY_AVX3
HWY_INLINE V4 transposed(V r0, V r1, V r2, V r3) {
    const V xy01 = hn::InterleaveLower(d, r0, r1), zw01 = hn::InterleaveUpper(d, r0, r1);
    const V xy23 = hn::InterleaveLower(d, r2, r3), zw23 = hn::InterleaveUpper(d, r2, r3);
    const hn::Repartition<double, D> pairs;
    const auto low = [&](V a, V b) {
        return hn::BitCast(d, hn::InterleaveLower(pairs, hn::BitCast(pairs, a), hn::BitCast(pairs, b)));
    };
    const auto high = [&](V a, V b) {
        return hn::BitCast(d, hn::InterleaveUpper(pairs, hn::BitCast(pairs, a), hn::BitCast(pairs, b)));
    };
    return {low(xy01, xy23), high(xy01, xy23), low(zw01, zw23), high(zw01, zw23)};
}

HWY_INLINE V4 gather(const Row* from, const std::uint32_t* j) {
    const auto row = [&](std::size_t lane) { return _mm_loadu_ps(from[j[lane]].data()); };
    const auto rows = [&](std::size_t first) {
#if HWY_TARGET == HWY_AVX2
        return V{_mm256_insertf128_ps(_mm256_castps128_ps256(row(first)), row(first + 4), 1)};
#else
        __m512 four = _mm512_castps128_ps512(row(first));
        four = _mm512_insertf32x4(four, row(first + 4), 1);
        four = _mm512_insertf32x4(four, row(first + 8), 2);
        return V{_mm512_insertf32x4(four, row(first + 12), 3)};
#endif
    };
    return transposed(rows(0), rows(1), rows(2), rows(3));
}
#else
HWY_INLINE V4 gather(const Row* from, const std::uint32_t* j) {
    HWY_ALIGN float x[hn::MaxLanes(d)], y[hn::MaxLanes(d)], z[hn::MaxLanes(d)], w[hn::MaxLanes(d)];
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
        const Row& row = from[j[lane]];
        x[lane] = row[0];
        y[lane] = row[1];
        z[lane] = row[2];
        w[lane] = row[3];
    }
    return {hn::Load(d, x), hn::Load(d, y), hn::Load(d, z), hn::Load(d, w)};
}
#endif

/// Per row: a distance, a polynomial of it, and three sums weighted with that, as in a sum over neighbours.
void sum_units(const Row* rows, const std::uint32_t* index, std::size_t first, std::size_t last, float* sums) {
    const V one = hn::Set(d, 1.0F);
    for (std::size_t unit = first; unit < last; ++unit) {
        const std::uint32_t* list = index + unit * Calibration::rows_per_unit;
        const Row& own = rows[list[0]];
        const V own_x = hn::Set(d, own[0]), own_y = hn::Set(d, own[1]), own_z = hn::Set(d, own[2]);
        V sum_x = hn::Zero(d), sum_y = hn::Zero(d), sum_z = hn::Zero(d);
        for (std::size_t k = 0; k < Calibration::rows_per_unit; k += hn::Lanes(d)) {
            const V4 other = gather(rows, list + k);
            const V x = hn::Sub(own_x, other.x), y = hn::Sub(own_y, other.y), z = hn::Sub(own_z, other.z);
            const V square = hn::MulAdd(z, z, hn::MulAdd(y, y, hn::Mul(x, x)));
            const V t = hn::Sub(one, hn::Min(one, hn::Sqrt(square)));
            const V weight = hn::Mul(hn::Mul(hn::Mul(t, t), t), other.w);
            sum_x = hn::MulAdd(weight, x, sum_x);
            sum_y = hn::MulAdd(weight, y, sum_y);
            sum_z = hn::MulAdd(weight, z, sum_z);
        }
        sums[unit] = hn::GetLane(hn::SumOfLanes(d, hn::Add(sum_x, hn::Add(sum_y, sum_z))));
    }
}

Calibration::Kernel make_kernel() {
    return {sum_units, hwy::TargetName(HWY_TARGET)};
}

}  // namespace talus::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <chrono>
#include <numeric>

#include "simd/parallel.hpp"

namespace talus::bench {
namespace {

constexpr std::size_t row_count = 8192, unit_count = 1024;  // 128 and 192 KiB
constexpr std::size_t rounds = 16;                          // per parallel loop, as long as one of the solver's
constexpr double duration = 0.015;                          // s

}  // namespace

HWY_EXPORT(make_kernel);

Calibration::Calibration()
    : kernel_(HWY_DYNAMIC_DISPATCH(make_kernel)()),
      rows_(row_count),
      index_(unit_count * rows_per_unit),
      sums_(rounds * unit_count) {
    // The generator of Lehmer (1951): any fixed numbers would do.
    std::uint64_t random = 1;
    const auto next = [&random] { return random = random * 48271 % 2147483647; };
    for (Row& row : rows_) {
        for (float& value : row) value = static_cast<float>(next() % 1024) / 1024;
    }
    // Neighbours of a particle lie in clusters, about its own place in the order.
    for (std::size_t unit = 0; unit < unit_count; ++unit) {
        const std::size_t own = unit * row_count / unit_count;
        for (std::size_t k = 0; k < rows_per_unit; k += 4) {
            const std::size_t cluster = own + next() % 1024;
            for (std::size_t i = k; i < k + 4; ++i) {
                index_[unit * rows_per_unit + i] = static_cast<std::uint32_t>((cluster + i - k) % row_count);
            }
        }
    }
}

double Calibration::measure() {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    std::size_t units = 0;
    double elapsed = 0;
    do {
        simd::parallel_ranges(rounds, 1, [this](std::size_t first, std::size_t last) {
            for (std::size_t round = first; round < last; ++round) {
                kernel_.sum_units(rows_.data(), index_.data(), 0, unit_count, sums_.data() + round * unit_count);
            }
        });
        units += rounds * unit_count;
        elapsed = std::chrono::duration<double>(Clock::now() - start).count();
    } while (elapsed < duration);
    return static_cast<double>(units) / elapsed;
}

double Calibration::total() const {
    return std::accumulate(sums_.begin(), sums_.end(), 0.0);
}

}  // namespace talus::bench
#endif
