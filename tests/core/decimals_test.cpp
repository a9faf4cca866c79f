#include "core/decimals.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace talus {
namespace {

TEST(Decimals, in_the_field_are_the_least) {
    for (const double size : {10.0, 84.0, 612.3, 1.2e6, -250.0}) {
        EXPECT_EQ(decimals_for(size, 0), 0) << size;
        EXPECT_EQ(decimals_for(size, 1), 1) << size;
    }
}

TEST(Decimals, in_a_laboratory_are_those_of_three_significant_digits) {
    EXPECT_EQ(decimals_for(2.47, 0), 2);
    EXPECT_EQ(decimals_for(-2.47, 0), 2);
    EXPECT_EQ(decimals_for(0.85, 0), 3);
    EXPECT_EQ(decimals_for(0.0112, 1), 4);
    EXPECT_EQ(decimals_for(2.47, 3), 3) << "never fewer than the least";
    EXPECT_EQ(decimals_for(1e-30, 1), 9);
}

TEST(Decimals, of_nothing_are_the_least) {
    for (const double size : {0.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        EXPECT_EQ(decimals_for(size, 1), 1);
    }
}

}  // namespace
}  // namespace talus
