#include "stats/design.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace talus::stats {
namespace {

TEST(Design, points_hang_on_the_seed_and_the_run_alone) {
    for (const DesignKind kind : {DesignKind::monte_carlo, DesignKind::sobol}) {
        const Points few = sample_points(kind, 10, 3, 7), many = sample_points(kind, 100, 3, 7);
        EXPECT_TRUE(std::equal(few.begin(), few.end(), many.begin()));  // more runs leave the first ones alone
        EXPECT_NE(few, sample_points(kind, 10, 3, 8));
    }
    EXPECT_EQ(sample_points(DesignKind::latin_hypercube, 10, 3, 7),
              sample_points(DesignKind::latin_hypercube, 10, 3, 7));
}

TEST(Design, monte_carlo_is_uniform) {
    const Points points = sample_points(DesignKind::monte_carlo, 20000, 2, 1);
    double mean = 0, square = 0, product = 0;
    for (const auto& p : points) {
        mean += p[0] / 20000;
        square += p[0] * p[0] / 20000;
        product += p[0] * p[1] / 20000;
        EXPECT_TRUE(p[0] > 0 && p[0] < 1);
    }
    EXPECT_NEAR(mean, 0.5, 0.01);
    EXPECT_NEAR(square, 1.0 / 3, 0.01);
    EXPECT_NEAR(product, 0.25, 0.01);
}

TEST(Design, a_latin_hypercube_takes_every_share_once) {
    const Points points = sample_points(DesignKind::latin_hypercube, 50, 4, 3);
    for (std::size_t k = 0; k < 4; ++k) {
        std::set<int> shares;
        for (const auto& p : points) shares.insert(static_cast<int>(p[k] * 50));
        EXPECT_EQ(shares.size(), 50u) << k;
    }
}

TEST(Design, a_sobol_sequence_fills_every_binary_share_evenly_in_every_dimension) {
    const Points points = sample_points(DesignKind::sobol, 256, sobol_dimensions, 5);
    for (std::size_t k = 0; k < sobol_dimensions; ++k) {
        std::vector<int> counts(256, 0);
        for (const auto& p : points) ++counts[static_cast<std::size_t>(p[k] * 256)];
        EXPECT_EQ(std::count(counts.begin(), counts.end(), 1), 256) << "dimension " << k;
    }
}

TEST(Design, a_sobol_sequence_fills_squares_evenly_in_its_first_two_dimensions) {
    std::vector<int> counts(256, 0);
    for (const auto& p : sample_points(DesignKind::sobol, 256, 2, 9)) {
        ++counts[static_cast<std::size_t>(p[0] * 16) * 16 + static_cast<std::size_t>(p[1] * 16)];
    }
    EXPECT_EQ(std::count(counts.begin(), counts.end(), 1), 256);
}

TEST(Design, a_sobol_sequence_integrates_better_than_chance) {
    const auto error_of = [](DesignKind kind) {
        double sum = 0;
        for (const auto& p : sample_points(kind, 1024, 6, 2)) {
            double product = 1;
            for (const double u : p) product *= 1.5 * std::sqrt(u);  // each factor's integral is 1
            sum += product / 1024;
        }
        return std::abs(sum - 1);
    };
    EXPECT_LT(error_of(DesignKind::sobol), 0.01);
    EXPECT_LT(error_of(DesignKind::sobol), error_of(DesignKind::monte_carlo));
}

TEST(Design, a_grid_has_every_combination_once) {
    const Points points = grid_points({2, 3});
    ASSERT_EQ(points.size(), 6u);
    EXPECT_EQ(points[0], (std::vector<double>{0.25, 0.5 / 3}));
    EXPECT_EQ(points[5], (std::vector<double>{0.75, 2.5 / 3}));
    EXPECT_EQ(std::set<std::vector<double>>(points.begin(), points.end()).size(), 6u);
}

TEST(Design, a_saltelli_block_mixes_one_factor_at_a_time) {
    const Points points = saltelli_points(5, 3, 1);
    ASSERT_EQ(points.size(), 25u);
    for (std::size_t block = 0; block < 25; block += 5) {
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t j = 0; j < 3; ++j)
                EXPECT_EQ(points[block + 2 + k][j], points[block + (j == k ? 1 : 0)][j]);
        }
    }
}

TEST(Design, a_morris_trajectory_changes_every_factor_once_by_half_the_range) {
    const Points points = morris_points(20, 4, 1);
    ASSERT_EQ(points.size(), 100u);
    for (std::size_t first = 0; first < 100; first += 5) {
        std::set<std::size_t> changed;
        for (std::size_t i = first; i < first + 4; ++i) {
            for (std::size_t k = 0; k < 4; ++k) {
                const double step = std::abs(points[i + 1][k] - points[i][k]);
                if (step == 0) continue;
                EXPECT_DOUBLE_EQ(step, 0.5);
                changed.insert(k);
            }
        }
        EXPECT_EQ(changed.size(), 4u);
    }
}

}  // namespace
}  // namespace talus::stats
