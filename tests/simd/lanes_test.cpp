#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "simd/dispatch.hpp"
#include "simd/lane_kernels.hpp"

/// Every operation of simd/lanes.hpp and lane_pairs.hpp on every instruction set gives the bits of the same operation
/// on one number.
namespace talus::test {
namespace {

using Limits = std::numeric_limits<float>;

/// Zeros of both signs, infinities, NaN, the smallest and the largest numbers beside ordinary ones.
constexpr Floats special = {0.0F,
                            -0.0F,
                            1.0F,
                            -1.0F,
                            Limits::max(),
                            -Limits::max(),
                            1.5e-38F,
                            -3.25F,
                            Limits::min(),
                            -Limits::min(),
                            0.1F,
                            16777217.0F,
                            Limits::infinity(),
                            -Limits::infinity(),
                            Limits::quiet_NaN(),
                            Limits::denorm_min()};

Floats rotated(Floats numbers, std::size_t by) {
    std::rotate(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(by), numbers.end());
    return numbers;
}

/// NaN is one value; zeros have a sign.
bool same_bits(float a, float b) {
    return (std::isnan(a) && std::isnan(b)) || std::memcmp(&a, &b, sizeof a) == 0;
}

template <class Formula>
void expect_each(const char* name, const Floats& made, const Floats& a, const Floats& b, const Formula& formula) {
    for (std::size_t i = 0; i < block; ++i) {
        const float expected = formula(a[i], b[i]);
        EXPECT_TRUE(same_bits(made[i], expected))
            << fmt::format("{} of {} and {}: {} in lane {}, {} expected", name, a[i], b[i], made[i], i, expected);
    }
}
template <class Formula>
void expect_flags(const char* name, const Flags& made, const Floats& a, const Floats& b, const Formula& formula) {
    for (std::size_t i = 0; i < block; ++i) {
        EXPECT_EQ(made[i], formula(a[i], b[i])) << fmt::format("{} of {} and {} in lane {}", name, a[i], b[i], i);
    }
}

class Lanes : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        const Status chosen = simd::choose_instruction_set(GetParam());
        if (!chosen) GTEST_SKIP() << chosen.error().message;
        kernels = lane_kernels();
        ASSERT_EQ(std::string(kernels.instruction_set), GetParam());
    }
    void TearDown() override { ASSERT_TRUE(simd::choose_instruction_set(simd::instruction_sets().front())); }

    /// Every special number with every other one, in every lane.
    template <class Check>
    static void with_all_pairs(const Check& check) {
        for (std::size_t shift = 0; shift < block; ++shift) {
            for (std::size_t turn = 0; turn < block; turn += 5) {
                check(rotated(special, turn),
                      rotated(special, turn + shift < block ? turn + shift : turn + shift - block));
            }
        }
    }

    LaneKernels kernels{};
};

TEST_P(Lanes, have_the_width_of_the_registers) {
    const std::string set = GetParam();
    EXPECT_EQ(kernels.lanes, set == "AVX3" ? 16 : set == "AVX2" ? 8 : 4);
}

void expect_sums(const Arithmetic& made, const Floats& a, const Floats& b) {
    expect_each("+", made.sum, a, b, [](float x, float y) { return x + y; });
    expect_each("-", made.difference, a, b, [](float x, float y) { return x - y; });
    expect_each("*", made.product, a, b, [](float x, float y) { return x * y; });
    expect_each("/", made.quotient, a, b, [](float x, float y) { return x / y; });
    expect_each("unary -", made.negative, a, b, [](float x, float) { return -x; });
    expect_each("sqrt", made.root, a, b, [](float x, float) { return std::sqrt(x); });
    expect_each("opaque", made.same, a, b, [](float x, float) { return x; });
    // The first of two equal or unordered numbers.
    expect_each("larger", made.larger, a, b, [](float x, float y) { return std::max(x, y); });
    expect_each("smaller", made.smaller, a, b, [](float x, float y) { return std::min(x, y); });
}

void expect_comparisons(const Comparisons& made, const Floats& a, const Floats& b) {
    expect_flags("<", made.less, a, b, [](float x, float y) { return x < y; });
    expect_flags(">", made.greater, a, b, [](float x, float y) { return x > y; });
    expect_flags("<=", made.at_most, a, b, [](float x, float y) { return x <= y; });
    expect_flags(">=", made.at_least, a, b, [](float x, float y) { return x >= y; });
    expect_flags("==", made.equal, a, b, [](float x, float y) { return x == y; });
    expect_flags("&", made.both, a, b, [](float x, float y) { return x == y; });
    expect_flags("|", made.either, a, b, [](float x, float y) { return x <= y; });
    expect_flags("!", made.no, a, b, [](float x, float y) { return !(x < y); });
    expect_each("select", made.chosen, a, b, [](float x, float y) { return x < y ? x : y; });
}

TEST_P(Lanes, calculate_as_single_numbers_do) {
    with_all_pairs([&](const Floats& a, const Floats& b) {
        Arithmetic made;
        kernels.calculate(a, b, made);
        expect_sums(made, a, b);
        expect_each("+=", made.added_to, a, b, [](float x, float y) { return x + y; });
        expect_each("*=", made.multiplied_by, a, b, [](float x, float y) { return x * y; });
    });
}

TEST_P(Lanes, calculate_in_pairs_of_registers_as_single_numbers_do) {
    with_all_pairs([&](const Floats& a, const Floats& b) {
        Arithmetic made;
        kernels.calculate_pairs(a, b, made);
        expect_sums(made, a, b);
    });
}

TEST_P(Lanes, compare_as_single_numbers_do) {
    with_all_pairs([&](const Floats& a, const Floats& b) {
        Comparisons made;
        kernels.compare(a, b, made);
        expect_comparisons(made, a, b);
        expect_flags("!=", made.unequal, a, b, [](float x, float y) { return x != y; });
    });
}

TEST_P(Lanes, compare_in_pairs_of_registers_as_single_numbers_do) {
    with_all_pairs([&](const Floats& a, const Floats& b) {
        Comparisons made;
        kernels.compare_pairs(a, b, made);
        expect_comparisons(made, a, b);
    });
}

TEST_P(Lanes, any_sees_a_single_lane) {
    const auto expect_one = [](const auto& compare, int lanes_of_any) {
        const auto lanes = static_cast<std::size_t>(lanes_of_any);
        Comparisons made;
        compare(Floats{}, Floats{}, made);
        EXPECT_EQ(made.any, Flags{});
        for (std::size_t one = 0; one < block; ++one) {
            Floats above{};
            above[one] = Limits::denorm_min();
            compare(Floats{}, above, made);
            for (std::size_t i = 0; i < block; ++i) {
                EXPECT_EQ(made.any[i], i / lanes == one / lanes) << "lane " << one << " is set, register of lane " << i;
            }
        }
    };
    expect_one(kernels.compare, kernels.lanes);
    expect_one(kernels.compare_pairs, kernels.lanes_of_pairs);
}

TEST_P(Lanes, are_filled_with_one_number_or_one_by_one) {
    for (const float number : special) {
        Numbers made;
        kernels.spread(number, 2147483, special, made);
        for (std::size_t i = 0; i < block; ++i) {
            EXPECT_TRUE(same_bits(made.zero[i], 0.0F)) << i;
            EXPECT_TRUE(same_bits(made.of_float[i], number)) << number << " in lane " << i;
            EXPECT_TRUE(same_bits(made.of_double[i], number)) << number << " in lane " << i;
            EXPECT_EQ(made.of_int[i], 2147483.0F) << i;
            EXPECT_EQ(made.of_size[i], 2147483.0F) << i;
            EXPECT_TRUE(same_bits(made.set_one_by_one[i], special[i])) << i;
            EXPECT_TRUE(same_bits(made.read_one_by_one[i], special[i])) << i;
        }
    }
}

TEST_P(Lanes, count_towards_zero) {
    const Floats a = {0.0F,   -0.0F,   0.99F, -0.99F,      1.0F,         -1.5F, 2.5F,     -2.5F,
                      1e-40F, 8191.9F, -7.0F, 16777217.0F, -16777216.0F, 3e8F,  -4.75e8F, 123456.7F};
    const Floats b = rotated(a, 3);
    WholeNumbers made;
    kernels.count(a, b, made);
    for (std::size_t i = 0; i < block; ++i) {
        const auto x = static_cast<std::int32_t>(a[i]), y = static_cast<std::int32_t>(b[i]);
        EXPECT_EQ(made.truncated[i], x) << a[i];
        EXPECT_EQ(made.sum[i], x + y) << a[i] << " + " << b[i];
        EXPECT_EQ(made.threefold[i], 3 * x) << a[i];
        EXPECT_TRUE(same_bits(made.back[i], static_cast<float>(x))) << a[i];
        EXPECT_TRUE(same_bits(made.from_index[i], static_cast<float>(x))) << a[i];
    }
}

TEST_P(Lanes, gather_rows_and_put_them_back) {
    Rows rows;
    QuadRows quads;
    for (std::size_t i = 0; i < block; ++i) {
        for (std::size_t k = 0; k < 8; ++k) rows[i].v[k] = static_cast<float>(10 * i + k);
    }
    for (std::size_t i = 0; i < quads.size(); ++i) {
        for (std::size_t k = 0; k < 4; ++k) quads[i][k] = static_cast<float>(1000 + 10 * i + k);
    }
    rows[5].v = {0.0F, -0.0F, Limits::infinity(), -Limits::infinity(), Limits::denorm_min(), Limits::max(), 1, 2};
    // Scattered, some more than once.
    const Places places = {15, 0, 5, 5, 3, 14, 1, 2, 13, 12, 5, 4, 0, 9, 7, 8};
    Gathers made;
    kernels.gather(rows, quads, places, made);
    for (std::size_t i = 0; i < block; ++i) {
        const std::size_t at = places[i];
        for (std::size_t k = 0; k < 8; ++k) {
            const std::string where = fmt::format("number {} of lane {}", k, i);
            EXPECT_TRUE(same_bits(made.octs_at[i].v[k], rows[at].v[k])) << where;
            EXPECT_TRUE(same_bits(made.quads_at[i].v[k], rows[at].v[k])) << where;
            EXPECT_TRUE(same_bits(made.load_octs[i].v[k], rows[i].v[k])) << where;
            EXPECT_TRUE(same_bits(made.load_quads[i].v[k], rows[i].v[k])) << where;
            EXPECT_TRUE(same_bits(made.stored[i].v[k], rows[i].v[k])) << where;
            EXPECT_TRUE(same_bits(made.transposed_twice[i].v[k], rows[i].v[k])) << where;
            EXPECT_EQ(made.pairs_of_quads[i].v[k], quads[at + k / 4][k % 4]) << where;
        }
        for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(made.quads_of_quads[i][k], quads[at][k]) << k << ", " << i;
    }
}

INSTANTIATE_TEST_SUITE_P(EveryInstructionSet, Lanes, ::testing::Values("AVX3", "AVX2", "SSE4", "SCALAR"),
                         [](const auto& set) { return std::string(set.param); });

}  // namespace
}  // namespace talus::test
