#include "bench/grid.hpp"

#include <gtest/gtest.h>

namespace talus::bench {
namespace {

TEST(MeasuredGrid, has_a_rate_and_the_same_bits_on_any_number_of_threads) {
    Calibration calibration;
    const auto one = measure_grid(1, 1, calibration), two = measure_grid(2, 1, calibration);
    ASSERT_TRUE(one && two);
    EXPECT_EQ(one->hash, two->hash);
    EXPECT_EQ(one->cells, 512U * 512U);
    EXPECT_GT(one->cells_per_step, 1000);
    EXPECT_NEAR(one->relative_rate, one->updates_per_second / one->calibration_rate, 1e-9 * one->relative_rate);
    EXPECT_EQ(one->instruction_set, calibration.instruction_set());
}

}  // namespace
}  // namespace talus::bench
