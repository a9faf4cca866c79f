#include "core/cube_root.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace talus {
namespace {

TEST(CubeRoot, is_the_nearest_number_to_the_exact_one) {
    for (float x = 1e-30F; x < 1e30F; x *= 1.0173F) {
        const auto exact = static_cast<float>(std::cbrt(static_cast<long double>(x)));
        ASSERT_EQ(cube_root(x), exact) << x;
    }
    EXPECT_EQ(cube_root(0.125F), 0.5F);
    const float least = std::numeric_limits<float>::min();
    EXPECT_FLOAT_EQ(cube_root(least), std::cbrt(least));
}

TEST(CubeRoot, of_a_double_is_within_a_last_bit) {
    for (double x = 1e-30; x < 1e30; x *= 1.0173) {
        const double root = cube_root(x), next = std::nextafter(root, 1e300);
        const long double off = root - std::cbrt(static_cast<long double>(x));
        ASSERT_LE(std::abs(off), next - root) << x;
    }
    EXPECT_EQ(cube_root(27.0), 3);
}

}  // namespace
}  // namespace talus
