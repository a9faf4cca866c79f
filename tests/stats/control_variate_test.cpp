#include "stats/control_variate.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "stats/sampler.hpp"

namespace talus::stats {
namespace {

/// Slow numbers of mean 3 whose correlation with the fast ones, of mean 10, is `related`.
struct Sample {
    std::vector<double> slow, fast, more;
};
Sample sample_of(std::uint64_t seed, std::size_t pairs, std::size_t more, double related) {
    Sample s;
    for (std::size_t i = 0; i < pairs + more; ++i) {
        const double common = normal_draw(seed, i, 0);
        if (i >= pairs) {
            s.more.push_back(10 + 4 * common);
            continue;
        }
        s.fast.push_back(10 + 4 * common);
        s.slow.push_back(3 + related * common + std::sqrt(1 - related * related) * normal_draw(seed, i, 1));
    }
    return s;
}

struct Trial {
    double bias = 0, spread = 0, plain_spread = 0, error = 0, within = 0;
};
Trial trial_of(double related) {
    constexpr std::size_t seeds = 400;
    Trial t;
    for (std::size_t seed = 1; seed <= seeds; ++seed) {
        const Sample s = sample_of(seed, 20, 180, related);
        const ControlledMean m = controlled_mean(s.slow, s.fast, s.more);
        t.bias += (m.mean - 3) / seeds;
        t.spread += (m.mean - 3) * (m.mean - 3) / seeds;
        t.plain_spread += (m.plain - 3) * (m.plain - 3) / seeds;
        t.error += m.error / seeds;
        t.within += std::abs(m.mean - 3) <= 2.09 * m.error ? 1.0 / seeds : 0;  // Student's t of 19
    }
    t.spread = std::sqrt(t.spread);
    t.plain_spread = std::sqrt(t.plain_spread);
    return t;
}

TEST(ControlledMean, is_closer_where_the_fast_model_is_related_and_says_by_how_much) {
    const Trial t = trial_of(0.95);
    EXPECT_NEAR(t.bias, 0, 0.02);
    EXPECT_LT(t.spread, 0.5 * t.plain_spread);
    EXPECT_NEAR(t.error / t.spread, 1, 0.1);
    EXPECT_GT(t.within, 0.92);
}

TEST(ControlledMean, does_little_harm_where_the_fast_model_tells_nothing) {
    const Trial t = trial_of(0);
    EXPECT_NEAR(t.bias, 0, 0.03);
    EXPECT_LT(t.spread, 1.05 * t.plain_spread);
    EXPECT_GT(t.within, 0.9);
}

TEST(ControlledMean, is_the_plain_one_with_too_few_pairs_or_nothing_more) {
    const Sample s = sample_of(1, 20, 0, 0.95);
    const ControlledMean alone = controlled_mean(s.slow, s.fast, s.more);
    EXPECT_EQ(alone.mean, alone.plain);
    EXPECT_EQ(alone.factor, 0);
    const ControlledMean few = controlled_mean({1, 2, 3}, {1, 2, 3}, {4, 5});
    EXPECT_DOUBLE_EQ(few.mean, 2);
    EXPECT_NEAR(few.error, 1 / std::sqrt(3), 1e-12);
    const ControlledMean same = controlled_mean(s.slow, std::vector<double>(20, 1.0), {1, 1});
    EXPECT_EQ(same.mean, same.plain);
}

}  // namespace
}  // namespace talus::stats
