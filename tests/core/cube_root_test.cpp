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
    EXPECT_EQ(cube_root(27), 3);
    EXPECT_EQ(cube_root(0.125F), 0.5F);
    const float least = std::numeric_limits<float>::min();
    EXPECT_FLOAT_EQ(cube_root(least), std::cbrt(least));
}

}  // namespace
}  // namespace talus
