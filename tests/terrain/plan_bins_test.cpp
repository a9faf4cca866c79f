#include "terrain/plan_bins.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace talus::terrain {
namespace {

TEST(PlanBins, find_every_item_whose_extent_holds_the_position_once_and_in_order) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-40, 40), length(0, 15);
    std::vector<Extent> extents;
    for (int i = 0; i < 60; ++i) {
        const double x = place(random), y = place(random);
        extents.push_back({x, y, x + length(random), y + length(random)});
    }
    const PlanBins bins(extents, 3);
    int held = 0;
    for (int k = 0; k < 2000; ++k) {
        const double x = 1.5 * place(random), y = 1.5 * place(random);
        const auto near = bins.near(x, y);
        EXPECT_TRUE(std::is_sorted(near.begin(), near.end()));
        EXPECT_EQ(std::adjacent_find(near.begin(), near.end()), near.end());
        for (std::uint32_t i = 0; i < extents.size(); ++i) {
            if (!extents[i].contains({x, y})) continue;
            ++held;
            EXPECT_NE(std::find(near.begin(), near.end(), i), near.end()) << x << ", " << y;
        }
    }
    EXPECT_GT(held, 400);
}

TEST(PlanBins, are_a_million_at_most) {
    const std::vector<Extent> extents = {{0, 0, 1, 1}, {1e6, 1e6, 1e6 + 1, 1e6 + 1}};
    const PlanBins bins(extents, 0.1);
    EXPECT_EQ(bins.near(0.5, 0.5).size(), 1U);
    EXPECT_EQ(bins.near(900, 900).front(), 0U) << "in the same bin of a kilometre";
    EXPECT_TRUE(bins.near(5e5, 5e5).empty());
    EXPECT_EQ(bins.near(1e6 + 0.5, 1e6 + 0.5).front(), 1U);
}

TEST(PlanBins, have_nothing_outside_of_all_items_nor_for_nan_nor_without_items) {
    const std::vector<Extent> extents = {{0, 0, 4, 4}};
    const PlanBins bins(extents, 1);
    EXPECT_TRUE(bins.near(-0.1, 1).empty());
    EXPECT_TRUE(bins.near(1, 5.1).empty());
    EXPECT_TRUE(bins.near(std::numeric_limits<double>::quiet_NaN(), 1).empty());
    EXPECT_TRUE(PlanBins().near(0, 0).empty());
    EXPECT_TRUE(PlanBins({}, 1).near(0, 0).empty());
}

}  // namespace
}  // namespace talus::terrain
