#include "observe/wall_patches.hpp"

#include <gtest/gtest.h>

#include "observe/particles.hpp"
#include "terrain/barrier.hpp"

namespace talus::observe {
namespace {

/// Around the local origin, on level ground at local z = 0.
terrain::Building house(double width, double depth, double height) {
    terrain::Building building;
    building.footprint = {
        {{{1000, 2000}, {1000 + width, 2000}, {1000 + width, 2000 + depth}, {1000, 2000 + depth}}, {}}};
    building.roof_elevation = 50 + height;
    return building;
}

double sum_of_shares(const WallPatches& patches, const LocalPoint& at, double size) {
    double sum = 0;
    patches.spread(0, at, size, [&](std::uint32_t patch, double share) {
        EXPECT_LT(patch, patches.patches_of(0));
        for (const WallPatches::Column& c : patches.columns()) {
            const auto rows = static_cast<std::uint32_t>(c.rows);
            if (patch >= c.first_patch && patch < c.first_patch + rows) sum += share * c.area;
        }
    });
    return sum;
}

TEST(WallPatches, walls_and_roof_are_cut_into_equal_patches_no_smaller_than_the_area) {
    const WallPatches patches(test::make_ground().terrain, {house(10.5, 4, 3.2)}, 1, 2);
    EXPECT_EQ(patches.patches_of(0), 2 * 10 * 3 + 2 * 4 * 3 + 10 * 4);
    for (const WallPatches::Column& c : patches.columns()) {
        EXPECT_GE(c.area, 1);
        EXPECT_LE(c.area, 1.05 * 3.2 / 3 + 1e-9);
    }
}

TEST(WallPatches, what_is_narrower_than_the_area_counts_with_the_area) {
    const WallPatches patches(test::make_ground().terrain, {house(0.3, 6, 0.5)}, 1, 2);
    for (const WallPatches::Column& c : patches.columns()) EXPECT_EQ(c.area, 1);
}

TEST(WallPatches, shares_add_up_to_one_wherever_it_is_touched) {
    const WallPatches patches(test::make_ground().terrain, {house(10.5, 4, 3.2)}, 1, 4);
    for (const double size : {0.1, 1.0, 2.7, 6.0}) {
        for (const LocalPoint& at : {LocalPoint{5, 0, 1}, LocalPoint{0, 0, 1}, LocalPoint{0, 2, 3.2F},
                                     LocalPoint{10.5F, 4, 0}, LocalPoint{5, 4, 0.01F}, LocalPoint{4, 2, 3.2F}}) {
            EXPECT_NEAR(sum_of_shares(patches, at, size), 1, 1e-9) << at.x << ' ' << at.y << ' ' << at.z;
        }
    }
}

TEST(WallPatches, shares_add_up_to_one_above_the_roof_and_below_the_foot) {
    const WallPatches patches(test::make_ground().terrain, {house(10.5, 4, 7.4)}, 0.5, 4);
    for (const double size : {0.5, 1.0, 2.7, 6.0}) {
        for (const float z : {-0.2F, 0.1F, 2.9F, 5.0F, 7.3F, 7.6F}) {
            EXPECT_NEAR(sum_of_shares(patches, {5, -0.1F, z}, size), 1, 1e-9) << size << ' ' << z;
        }
    }
}

TEST(WallPatches, a_touch_belongs_to_the_wall_it_is_on) {
    const WallPatches patches(test::make_ground().terrain, {house(10, 4, 3)}, 1, 4);
    patches.spread(0, {9.8F, 0, 1.5F}, 1, [&](std::uint32_t patch, double) {
        for (const WallPatches::Column& c : patches.columns()) {
            const bool its = patch >= c.first_patch && patch < c.first_patch + static_cast<std::uint32_t>(c.rows);
            if (its) {
                EXPECT_TRUE(!c.roof && c.along_x == 1) << "the southern wall runs east";
            }
        }
    });
    EXPECT_EQ(sum_of_shares(patches, {50, 50, 1}, 1), 0) << "out of reach";
}

TEST(WallPatches, every_column_starts_at_the_ground) {
    const terrain::Terrain slope = test::make_ground(0.5).terrain;
    terrain::Building building = house(10, 4, 0);
    building.roof_elevation = 110;
    const WallPatches patches(slope, {building}, 1, 2);
    for (const WallPatches::Column& c : patches.columns()) {
        if (c.roof) continue;
        const double x = c.x + c.width / 2 * c.along_x, y = c.y + c.width / 2 * c.along_y;
        EXPECT_NEAR(c.z, slope.sample(x, y).height, 1e-6);
    }
}

TEST(WallPatches, there_is_no_wall_where_parts_of_a_structure_meet) {
    const terrain::Terrain ground = test::make_ground().terrain;
    const auto dam = terrain::make_barrier(ground, "dam", {{{990, 2000}, {1010, 2000}}, 2, {}, 1, {}});
    ASSERT_TRUE(dam);
    ASSERT_GT(dam->footprint.size(), 5U);
    const WallPatches patches(ground, {*dam}, 1, 2);
    double around = 0;
    for (const WallPatches::Column& c : patches.columns()) around += c.roof ? 0 : c.width;
    EXPECT_NEAR(around, 2 * (20 + 1), 1e-9);
    // A touch beside such a place is one on the face.
    double face = 0;
    patches.spread(0, {0.01F, 0.5F, 1}, 1, [&](std::uint32_t patch, double share) {
        for (const WallPatches::Column& c : patches.columns()) {
            const bool of_face = !c.roof && c.along_y == 0;
            if (of_face && patch >= c.first_patch && patch < c.first_patch + static_cast<std::uint32_t>(c.rows)) {
                face += share * c.area;
            }
        }
    });
    EXPECT_NEAR(face, 1, 1e-6);
}

}  // namespace
}  // namespace talus::observe
