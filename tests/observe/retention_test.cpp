#include "observe/retention.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace talus::observe {
namespace {

/// A row of cells of 1 m2 upstream of a wall, the nearest first: bottoms and depths. All of it moves.
std::vector<DebrisColumn> row_behind_a_wall(const std::vector<std::pair<double, double>>& cells) {
    std::vector<DebrisColumn> columns;
    for (std::size_t k = 0; k < cells.size(); ++k) {
        const auto [bottom, depth] = cells[k];
        columns.push_back({static_cast<std::int32_t>(k), 0, depth, bottom, bottom + depth, false, k == 0});
    }
    return columns;
}

TEST(Retention, is_what_lies_below_the_surface_at_the_face) {
    // A pond up to 2 m over ground that rises by half a metre per cell, and debris that comes down to it.
    const auto columns = row_behind_a_wall({{0, 2}, {0.5, 1.5}, {1, 1}, {1.5, 0.5}, {2, 0.4}, {2.5, 0.4}});
    EXPECT_DOUBLE_EQ(retained_volume(columns), 5);
}

TEST(Retention, goes_on_where_debris_has_come_to_rest) {
    auto columns = row_behind_a_wall({{0, 2}, {1, 1}, {2, 1}, {3, 1}, {4, 1}});
    columns[2].at_rest = columns[3].at_rest = true;
    EXPECT_DOUBLE_EQ(retained_volume(columns), 5);
}

TEST(Retention, ends_at_a_gap_and_begins_at_the_face) {
    auto columns = row_behind_a_wall({{0, 2}, {0, 1}, {0, 1}, {0, 1}});
    for (DebrisColumn& column : columns) column.at_rest = true;
    columns.erase(columns.begin() + 2);
    EXPECT_DOUBLE_EQ(retained_volume(columns), 3);
    columns.erase(columns.begin());
    EXPECT_EQ(retained_volume(columns), 0) << "nothing touches the wall";
}

}  // namespace
}  // namespace talus::observe
