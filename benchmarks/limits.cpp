// Peak rates of this machine on one thread: the roofline for sums over neighbours in docs/performance.md. Compiled once
// per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "limits.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include <cstdint>
#include <vector>

#include "sim/cpu/lanes-inl.hpp"

#ifndef TALUS_LIMITS
#define TALUS_LIMITS
namespace talus::sim::cpu {
namespace {

struct Limits {
    float (*gather_quads)(const std::vector<simd::Oct>&, const std::vector<std::uint32_t>&);
    float (*gather_octs)(const std::vector<simd::Oct>&, const std::vector<std::uint32_t>&);
    float (*stream)(const std::vector<float>&);
    float (*arithmetic)(std::int64_t);
    int lanes;
};

}  // namespace
}  // namespace talus::sim::cpu
#endif

HWY_BEFORE_NAMESPACE();
namespace talus::sim::cpu::HWY_NAMESPACE {
namespace {

HWY_INLINE float total(const L& lanes) {
    float sum = 0;
    for (int lane = 0; lane < lane_count; ++lane) sum += lanes.at(lane);
    return sum;
}

/// Rows of 16 bytes by index, transposed and added up.
TALUS_STAGE float gather_quads(const std::vector<simd::Oct>& rows, const std::vector<std::uint32_t>& index) {
    L sum(0);
    for (std::size_t i = 0; i + lane_count <= index.size(); i += lane_count) {
        const Quads<L> row = quads_at<lane_count, 0>(rows.data(), &index[i]);
        sum += row.x + row.y + row.z + row.w;
    }
    return total(sum);
}

/// Rows of 32 bytes.
TALUS_STAGE float gather_octs(const std::vector<simd::Oct>& rows, const std::vector<std::uint32_t>& index) {
    L sum(0);
    for (std::size_t i = 0; i + lane_count <= index.size(); i += lane_count) {
        const Octs<L> row = octs_at<lane_count>(rows.data(), &index[i]);
        sum += row.low.x + row.low.y + row.low.z + row.low.w + (row.high.x + row.high.y + row.high.z + row.high.w);
    }
    return total(sum);
}

/// One array from end to end.
TALUS_STAGE float stream(const std::vector<float>& numbers) {
    L a(0), b(0), c(0), d(0);
    for (std::size_t i = 0; i + 4 * lane_count <= numbers.size(); i += 4 * lane_count) {
        a += Particles::load(numbers, i);
        b += Particles::load(numbers, i + lane_count);
        c += Particles::load(numbers, i + 2 * lane_count);
        d += Particles::load(numbers, i + 3 * lane_count);
    }
    return total(a + b + (c + d));
}

/// Eight independent chains of a product and a sum.
TALUS_STAGE float arithmetic(std::int64_t rounds) {
    const L factor(0.999F), more(0.001F);
    L a(1), b(2), c(3), d(4), e(5), f(6), g(7), h(8);
    for (std::int64_t i = 0; i < rounds; ++i) {
        a = a * factor + more;
        b = b * factor + more;
        c = c * factor + more;
        d = d * factor + more;
        e = e * factor + more;
        f = f * factor + more;
        g = g * factor + more;
        h = h * factor + more;
    }
    return total(a + b + c + d + (e + f + g + h));
}

Limits make_limits() {
    return {gather_quads, gather_octs, stream, arithmetic, lane_count};
}

}  // namespace
}  // namespace talus::sim::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <benchmark/benchmark.h>

namespace talus::sim::cpu {

HWY_EXPORT(make_limits);

namespace {

auto limits() {
    return HWY_DYNAMIC_DISPATCH(make_limits)();
}

/// As in a sum over neighbours: close together, unordered. `rows` of them fit into a cache, or do not.
void gather(benchmark::State& run, bool wide) {
    const auto row_count = static_cast<std::uint32_t>(run.range(0));
    const std::vector<simd::Oct> rows(row_count);
    std::vector<std::uint32_t> index(1 << 16);
    for (std::uint32_t i = 0; i < index.size(); ++i) {
        const std::uint64_t scattered = (i / 32) * (row_count / 2048) + i * 2654435761U % 1024;
        index[i] = static_cast<std::uint32_t>(scattered % row_count);
    }
    const auto of_target = limits();
    for (auto _ : run) {
        benchmark::DoNotOptimize(wide ? of_target.gather_octs(rows, index) : of_target.gather_quads(rows, index));
    }
    run.SetItemsProcessed(run.iterations() * static_cast<std::int64_t>(index.size()));
}

void limit_gather_16_bytes(benchmark::State& run) {
    gather(run, false);
}
BENCHMARK(limit_gather_16_bytes)->Arg(2000)->Arg(20000)->Arg(300000);

void limit_gather_32_bytes(benchmark::State& run) {
    gather(run, true);
}
BENCHMARK(limit_gather_32_bytes)->Arg(2000)->Arg(20000)->Arg(300000);

/// Numbers that fit into a cache, or do not.
void limit_stream(benchmark::State& run) {
    const std::vector<float> numbers(static_cast<std::size_t>(run.range(0)), 1.0F);
    const auto of_target = limits();
    for (auto _ : run) benchmark::DoNotOptimize(of_target.stream(numbers));
    run.SetBytesProcessed(run.iterations() * run.range(0) * static_cast<std::int64_t>(sizeof(float)));
}
BENCHMARK(limit_stream)->Arg(2000)->Arg(2 << 20)->Arg(64 << 20);

void limit_arithmetic(benchmark::State& run) {
    const auto of_target = limits();
    constexpr std::int64_t rounds = 10000;
    for (auto _ : run) benchmark::DoNotOptimize(of_target.arithmetic(rounds));
    run.SetItemsProcessed(run.iterations() * rounds * 16 * of_target.lanes);
}
BENCHMARK(limit_arithmetic)->Arg(2000);

}  // namespace
}  // namespace talus::sim::cpu
#endif
