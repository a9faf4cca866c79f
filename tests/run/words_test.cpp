#include "run/words.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace talus::run {
namespace {

TEST(Words, round_to_significant_digits_without_an_exponent) {
    EXPECT_EQ(rounded(99.97, 2), "100");
    EXPECT_EQ(rounded(1234.5, 2), "1234");
    EXPECT_EQ(rounded(15.64, 3), "15.6");
    EXPECT_EQ(rounded(12, 3), "12");
    EXPECT_EQ(rounded(0.25, 2), "0.25");
    EXPECT_EQ(rounded(0.1, 2), "0.1");
    EXPECT_EQ(rounded(0.00032, 2), "0.0003");
    EXPECT_EQ(rounded(1e-9, 2), "0");
    EXPECT_EQ(rounded(0, 2), "0");
    EXPECT_EQ(rounded(-0.251, 2), "-0.25");
    EXPECT_EQ(rounded(3e6, 2), "3000000");
    EXPECT_EQ(rounded(std::numeric_limits<double>::quiet_NaN(), 3), "unknown");
}

TEST(Words, begin_with_or_without_a_capital) {
    EXPECT_EQ(capitalised("the flow"), "The flow");
    EXPECT_EQ(uncapitalised("The flow"), "the flow");
    EXPECT_EQ(capitalised("12 m3"), "12 m3");
    EXPECT_EQ(capitalised(""), "");
    EXPECT_EQ(uncapitalised(""), "");
}

}  // namespace
}  // namespace talus::run
