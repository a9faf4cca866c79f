// Compiled once per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/lane_kernels.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include <hwy/highway.h>
#include <type_traits>

#include "simd/lane_kernels.hpp"
#include "simd/lane_pairs.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::test::HWY_NAMESPACE {
namespace {

// As in src/sim/cpu and src/depth.
constexpr int lane_count = HWY_MAX_BYTES >= 64 ? 16 : HWY_MAX_BYTES >= 32 ? 8 : 4;
static_assert(block % lane_count == 0);
using L = simd::Lanes<lane_count>;
using Mask = simd::LaneMask<lane_count>;
using I = simd::LaneInts<lane_count>;
using Pair = simd::LanePair<(lane_count > 8 ? 8 : lane_count)>;
static_assert(block % Pair::size == 0);

HWY_INLINE L load(const Floats& from, std::size_t i) {
    return L::load(from.data() + i);
}
template <class Number>
requires(!std::is_same_v<Number, Mask> && !std::is_same_v<Number, I>) HWY_INLINE
    void put(const Number& numbers, Floats& to, std::size_t i) {
    numbers.store(to.data() + i);
}
HWY_INLINE void put(const Mask& mask, Flags& to, std::size_t i) {
    for (int lane = 0; lane < lane_count; ++lane) to[i + static_cast<std::size_t>(lane)] = mask.at(lane);
}
HWY_INLINE void put(const I& ints, Ints& to, std::size_t i) {
    for (int lane = 0; lane < lane_count; ++lane) to[i + static_cast<std::size_t>(lane)] = ints[lane];
}
HWY_INLINE void put(const Quads<L>& quads, float* first, std::size_t stride) {
    for (int lane = 0; lane < lane_count; ++lane) {
        float* const to = first + static_cast<std::size_t>(lane) * stride;
        to[0] = quads.x.at(lane);
        to[1] = quads.y.at(lane);
        to[2] = quads.z.at(lane);
        to[3] = quads.w.at(lane);
    }
}
HWY_INLINE void put(const Quads<L>& quads, Rows& to, std::size_t i, std::size_t part) {
    put(quads, to[i].v.data() + 4 * part, 8);
}
HWY_INLINE void put(const Octs<L>& octs, Rows& to, std::size_t i) {
    put(octs.low, to, i, 0);
    put(octs.high, to, i, 1);
}

template <class Number>
HWY_INLINE void calculate_as(const Number& x, const Number& y, Arithmetic& to, std::size_t i) {
    put(x + y, to.sum, i);
    put(x - y, to.difference, i);
    put(x * y, to.product, i);
    put(x / y, to.quotient, i);
    put(-x, to.negative, i);
    put(sqrt(x), to.root, i);
    put(opaque(x), to.same, i);
    put(larger(x, y), to.larger, i);
    put(smaller(x, y), to.smaller, i);
}

void calculate(const Floats& a, const Floats& b, Arithmetic& to) {
    for (std::size_t i = 0; i < block; i += lane_count) {
        const L x = load(a, i), y = load(b, i);
        calculate_as(x, y, to, i);
        L sum = x, product = x;
        sum += y;
        product *= y;
        put(sum, to.added_to, i);
        put(product, to.multiplied_by, i);
    }
}

void calculate_pairs(const Floats& a, const Floats& b, Arithmetic& to) {
    for (std::size_t i = 0; i < block; i += Pair::size) {
        calculate_as(Pair::load(a.data() + i), Pair::load(b.data() + i), to, i);
    }
}

void compare(const Floats& a, const Floats& b, Comparisons& to) {
    for (std::size_t i = 0; i < block; i += lane_count) {
        const L x = load(a, i), y = load(b, i);
        const Mask less = x < y, equal = x == y;
        put(less, to.less, i);
        put(x > y, to.greater, i);
        put(x <= y, to.at_most, i);
        put(x >= y, to.at_least, i);
        put(equal, to.equal, i);
        put(x != y, to.unequal, i);
        put((x <= y) & (x >= y), to.both, i);
        put(less | equal, to.either, i);
        put(!less, to.no, i);
        put(select(less, x, y), to.chosen, i);
        const bool one = any(less);
        for (std::size_t lane = 0; lane < lane_count; ++lane) to.any[i + lane] = one;
    }
}

void compare_pairs(const Floats& a, const Floats& b, Comparisons& to) {
    for (std::size_t i = 0; i < block; i += Pair::size) {
        const Pair x = Pair::load(a.data() + i), y = Pair::load(b.data() + i);
        const auto less = x < y, equal = x == y;
        const auto put_flags = [&](const auto& mask, Flags& flags) HWY_ATTR {
            const Pair flag = select(mask, Pair(1), Pair(0));
            for (int lane = 0; lane < Pair::size; ++lane) flags[i + static_cast<std::size_t>(lane)] = flag.at(lane) > 0;
        };
        put_flags(less, to.less);
        put_flags(x > y, to.greater);
        put_flags(x <= y, to.at_most);
        put_flags(x >= y, to.at_least);
        put_flags(equal, to.equal);
        put_flags((x <= y) & (x >= y), to.both);
        put_flags(less | equal, to.either);
        put_flags(!less, to.no);
        put(select(less, x, y), to.chosen, i);
        const bool one = any(less);
        for (std::size_t lane = 0; lane < Pair::size; ++lane) to.any[i + lane] = one;
    }
}

void spread(float number, std::int32_t whole, const Floats& numbers, Numbers& to) {
    for (std::size_t i = 0; i < block; i += lane_count) {
        put(L(), to.zero, i);
        put(L(number), to.of_float, i);
        put(L(static_cast<double>(number)), to.of_double, i);
        put(L(whole), to.of_int, i);
        put(L(static_cast<std::size_t>(whole)), to.of_size, i);
        const L read = load(numbers, i);
        L set;
        for (int lane = 0; lane < lane_count; ++lane) {
            set.set(lane, numbers[i + static_cast<std::size_t>(lane)]);
            to.read_one_by_one[i + static_cast<std::size_t>(lane)] = read.at(lane);
        }
        put(set, to.set_one_by_one, i);
    }
}

void count(const Floats& a, const Floats& b, WholeNumbers& to) {
    for (std::size_t i = 0; i < block; i += lane_count) {
        const I x = truncated(load(a, i)), y = truncated(load(b, i));
        put(x, to.truncated, i);
        put(x + y, to.sum, i);
        put(x * 3, to.threefold, i);
        put(L::from(x), to.back, i);
        put(from_index<L>(x), to.from_index, i);
    }
}

void gather(const Rows& rows, const QuadRows& quads, const Places& places, Gathers& to) {
    for (std::size_t i = 0; i < block; i += lane_count) {
        const std::uint32_t* const at = places.data() + i;
        put(simd::octs_at<lane_count>(rows.data(), at), to.octs_at, i);
        put(simd::quads_at<lane_count, 0>(rows.data(), at), to.quads_at, i, 0);
        put(simd::quads_at<lane_count, 1>(rows.data(), at), to.quads_at, i, 1);
        put(simd::load_octs<lane_count>(rows.data() + i), to.load_octs, i);
        const Quads<L> low = simd::load_quads<lane_count, 0>(rows.data() + i);
        const Quads<L> high = simd::load_quads<lane_count, 1>(rows.data() + i);
        put(low, to.load_quads, i, 0);
        put(high, to.load_quads, i, 1);
        simd::store_quads<lane_count, 0>(low, to.stored.data() + i);
        simd::store_quads<lane_count, 1>(high, to.stored.data() + i);
        put(simd::transposed(simd::transposed(low)), to.transposed_twice, i, 0);
        put(simd::transposed(simd::transposed(high)), to.transposed_twice, i, 1);
        L index;
        for (int lane = 0; lane < lane_count; ++lane) index.set(lane, static_cast<float>(at[lane]));
        const I of_quads = truncated(index);
        put(quads_at(quads.data(), of_quads), to.quads_of_quads[i].v.data(), 4);
        put(quad_pairs_at(quads.data(), of_quads), to.pairs_of_quads, i);
    }
}

LaneKernels make_kernels() {
    return {hwy::TargetName(HWY_TARGET),
            lane_count,
            calculate,
            compare,
            spread,
            count,
            gather,
            Pair::size,
            calculate_pairs,
            compare_pairs};
}

}  // namespace
}  // namespace talus::test::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace talus::test {

HWY_EXPORT(make_kernels);

LaneKernels lane_kernels() {
    return HWY_DYNAMIC_DISPATCH(make_kernels)();
}

}  // namespace talus::test
#endif
