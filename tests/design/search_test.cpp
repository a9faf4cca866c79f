#include "design/search.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "design/design.hpp"

namespace talus::design {
namespace {

using testing::HasSubstr;

TEST(SearchTest, finds_the_least_index_of_every_threshold_within_its_trials) {
    for (const std::size_t count : {1U, 2U, 3U, 7U, 19U, 64U}) {
        for (std::size_t least = 0; least < count; ++least) {
            std::size_t asked = 0;
            const auto found = least_index(count, [&](std::size_t k) -> Result<bool> {
                ++asked;
                return k >= least;
            });
            ASSERT_TRUE(found);
            EXPECT_EQ(*found, least);
            EXPECT_LE(asked, most_trials(count)) << count;
        }
        const auto none = least_index(count, [](std::size_t) -> Result<bool> { return false; });
        ASSERT_TRUE(none);
        EXPECT_FALSE(none->has_value());
    }
}

TEST(SearchTest, passes_an_error_on) {
    const auto found = least_index(5, [](std::size_t) -> Result<bool> { return Error{"broken"}; });
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().message, "broken");
}

TEST(SearchTest, makes_a_grid_of_heights_and_refuses_what_is_none) {
    const auto grid = height_grid(1, 2.2, 0.4);
    ASSERT_TRUE(grid);
    EXPECT_EQ(*grid, (std::vector<double>{1, 1.4, 1.8, 2.2}));
    EXPECT_THAT(height_grid(0, 5, 1).error().message, HasSubstr("--min-height 0 is refused; it must be above 0"));
    EXPECT_THAT(height_grid(3, 2, 1).error().message, HasSubstr("--max-height 2 is refused"));
    EXPECT_THAT(height_grid(1, 5, 0).error().message, HasSubstr("--height-step 0 is refused"));
    EXPECT_THAT(height_grid(1, 5, 1e-9).error().message, HasSubstr("--height-step 1e-09 is refused"));
    EXPECT_THAT(height_grid(std::nan(""), 5, 1).error().message, HasSubstr("--min-height nan is refused"));
}

TEST(SearchTest, percentiles_are_those_by_hand) {
    std::vector<double> values;
    for (int k = 20; k > 0; --k) values.push_back(k);  // 1 to 20
    const Spread spread = spread_of(values);
    EXPECT_EQ(spread.median, 10);
    EXPECT_EQ(spread.p84, 17);  // 0.84 x 20 = 16.8
    EXPECT_EQ(spread.p95, 19);
    EXPECT_EQ(spread.greatest, 20);
    EXPECT_EQ(spread_of({7}).p95, 7);
}

}  // namespace
}  // namespace talus::design
