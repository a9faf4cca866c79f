#include "core/byte_planes.hpp"

#include <bit>
#include <limits>

#include <gtest/gtest.h>

namespace talus::test {
namespace {

Grid<float> grid_of(int columns, int rows, const std::vector<float>& values) {
    Grid<float> grid(GridGeometry{0, 0, 1, columns, rows});
    grid.values = values;
    return grid;
}

std::vector<std::uint32_t> bits_of(const std::vector<float>& values) {
    std::vector<std::uint32_t> bits(values.size());
    for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = std::bit_cast<std::uint32_t>(values[i]);
    return bits;
}

TEST(BytePlanes, lie_the_lowest_bytes_first) {
    const std::vector<std::uint32_t> numbers = {0x04030201, 0x14131211};
    EXPECT_EQ(to_byte_planes(numbers), std::string("\x01\x11\x02\x12\x03\x13\x04\x14"));
}

TEST(BytePlanes, differences_are_from_the_plane_through_three_neighbours) {
    // The bits of these are 1 to 6: each row grows by 1, and the second lies 3 above the first.
    std::vector<float> values;
    for (std::uint32_t bits = 1; bits <= 6; ++bits) values.push_back(std::bit_cast<float>(bits));
    const std::string bytes = to_difference_planes(grid_of(3, 2, values));
    ASSERT_EQ(bytes.size(), 24U);
    EXPECT_EQ(bytes.substr(0, 6), std::string("\x02\x02\x02\x06\0\0", 6));  // 1, 1, 1, 3, 0, 0, folded
}

TEST(BytePlanes, give_every_value_back_to_the_bit) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    const float quiet = std::numeric_limits<float>::quiet_NaN();
    const std::vector<float> ugly = {0.0F,  -0.0F, 1e-45F,    -1e-45F, 3.4e38F, -3.4e38F,
                                     quiet, quiet, -infinity, 102.5F,  102.25F, infinity};
    for (const int columns : {1, 3, 4, 12}) {
        const Grid<float> grid = grid_of(columns, 12 / columns, ugly);
        EXPECT_EQ(bits_of(from_difference_planes(to_difference_planes(grid), columns)), bits_of(ugly)) << columns;
    }
    EXPECT_TRUE(from_difference_planes("", 7).empty());
}

}  // namespace
}  // namespace talus::test
