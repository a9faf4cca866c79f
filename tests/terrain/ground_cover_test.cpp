#include "terrain/ground_cover.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace talus::terrain {
namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

TEST(GroundCover, gives_every_place_the_cell_that_it_lies_in) {
    // Six cells of 2 m around the local origin; each says its own number.
    Grid<CoverCell> cells(GridGeometry{100, 200, 2, 3, 2}, {none, none, none, 0});
    for (std::size_t i = 0; i < cells.values.size(); ++i) cells.values[i].friction_coefficient = static_cast<float>(i);
    const GroundCover cover(cells);
    EXPECT_FALSE(cover.empty());
    for (int row = 0; row < 2; ++row) {
        for (int column = 0; column < 3; ++column) {
            for (const double inside : {0.01, 1.0, 1.99}) {
                const double x = -3 + 2 * column + inside, y = -2 + 2 * row + inside;
                EXPECT_EQ(cover.at(x, y).x, 3 * row + column) << x << ", " << y;
                EXPECT_EQ(cover.at(static_cast<float>(x), static_cast<float>(y)).x, 3 * row + column);
            }
        }
    }
    EXPECT_EQ(cover.at(-50.0, -50.0).x, 0) << "outside: the nearest cell";
    EXPECT_EQ(cover.at(50.0, 50.0).x, 5);
    EXPECT_TRUE(std::isnan(cover.at(0.0, 0.0).y)) << "as elsewhere";
}

TEST(GroundCover, drags_where_a_cell_has_stems_or_turbulent_friction) {
    Grid<CoverCell> cells(GridGeometry{0, 0, 1, 2, 2}, {0.5F, none, 100, 0});
    EXPECT_FALSE(GroundCover(cells).drags());
    cells.at(1, 1).stem_drag = 0.01F;
    EXPECT_TRUE(GroundCover(cells).drags());
    cells.at(1, 1) = {none, 1.0F / 500, none, 0};
    EXPECT_TRUE(GroundCover(cells).drags());
    EXPECT_TRUE(GroundCover().empty());
}

}  // namespace
}  // namespace talus::terrain
