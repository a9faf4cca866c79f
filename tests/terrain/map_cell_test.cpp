#include "terrain/map_cell.hpp"

#include <gtest/gtest.h>

namespace talus::terrain {
namespace {

TEST(DefaultMapCell, fits_the_terrains_cells_and_the_particles) {
    EXPECT_DOUBLE_EQ(default_map_cell(5, 0.4), 1);
    EXPECT_DOUBLE_EQ(default_map_cell(1, 0.4), 1);
    EXPECT_DOUBLE_EQ(default_map_cell(0.5, 0.4), 1);
    EXPECT_DOUBLE_EQ(default_map_cell(5, 1.5), 5);
    EXPECT_DOUBLE_EQ(default_map_cell(2, 0.1), 0.25);
    EXPECT_DOUBLE_EQ(default_map_cell(1, 2), 5);
}

}  // namespace
}  // namespace talus::terrain
