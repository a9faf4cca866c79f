#include "sim/cpu/columns.hpp"

#include <gtest/gtest.h>

#include "sim_fixtures.hpp"

namespace talus::sim::cpu {
namespace {

VectorArray array_of(const std::vector<LocalPoint>& points) {
    VectorArray array;
    array.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) array.set(i, points[i]);
    return array;
}

std::vector<std::uint8_t> all_awake(std::size_t count) {
    return std::vector<std::uint8_t>(count, 0);
}

TEST(Columns, hold_what_is_above_their_area_wherever_a_lattice_lies) {
    constexpr float spacing = 0.5F;
    for (const float shift : {0.0F, 0.1F, 0.25F, 0.4F}) {
        std::vector<LocalPoint> points;
        for (int i = 0; i < 20; ++i) {
            for (int j = 0; j < 20; ++j) {
                for (int k = 0; k < 3; ++k) {
                    points.push_back({shift - 5 + i * spacing, 2 * shift - 5 + j * spacing, 7 + k * spacing});
                }
            }
        }
        Columns columns(points.size());
        columns.count(array_of(points), all_awake(points.size()), 2 * spacing);
        // Two spacings wide: four particles in each of the three layers.
        EXPECT_NEAR(columns.particles_at(0, 0), 12, 0.01);
        EXPECT_NEAR(columns.particles_at(-0.37F, 0.81F), 12, 0.01);
        EXPECT_EQ(columns.particles_at(40, 0), 0) << "nothing there";
        columns.count(array_of({{3, 3, 0}}), all_awake(1), 2 * spacing);
        EXPECT_EQ(columns.particles_at(0, 0), 0) << "each count begins anew";
    }
}

TEST(Columns, are_the_same_whether_one_far_away_makes_them_hashed_or_not) {
    auto points = testing::random_points(3000, {-20, -20, 0}, {20, 20, 1}, 3);
    const std::size_t near = points.size();
    points.push_back({5e4F, -3e4F, 0});
    const VectorArray array = array_of(points);
    Columns together(points.size()), hashed(points.size());
    together.count(array, all_awake(near), 0.8);
    hashed.count(array, all_awake(points.size()), 0.8);
    for (std::size_t i = 0; i < near; ++i) {
        EXPECT_EQ(together.particles_at(points[i].x, points[i].y), hashed.particles_at(points[i].x, points[i].y));
    }
}

TEST(Columns, count_debris_at_rest_where_debris_moves) {
    const auto points = testing::random_points(6000, {-20, -20, 0}, {20, 20, 1}, 5);
    const VectorArray array = array_of(points);
    std::vector<std::uint8_t> asleep(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) asleep[i] = points[i].x > -10 || points[i].y > 4 || i % 3 == 0;
    Columns all(points.size()), some(points.size()), hashed(points.size());
    all.count(array, all_awake(points.size()), 0.8);
    some.count(array, asleep, 0.8);
    auto with_far = points;
    with_far.push_back({5e4F, -3e4F, 0});
    asleep.push_back(0);
    hashed.count(array_of(with_far), asleep, 0.8);
    std::size_t moving = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (asleep[i]) continue;
        ++moving;
        EXPECT_EQ(some.particles_at(points[i].x, points[i].y), all.particles_at(points[i].x, points[i].y));
        EXPECT_EQ(hashed.particles_at(points[i].x, points[i].y), all.particles_at(points[i].x, points[i].y));
    }
    EXPECT_GT(moving, 500U);
    some.count(array, std::vector<std::uint8_t>(points.size(), 1), 0.8);
    EXPECT_EQ(some.particles_at(0, 0), 0) << "nothing moves";
}

TEST(Columns, have_room_for_particles_that_are_all_alone) {
    const auto points = testing::random_points(5000, {-4e4F, -4e4F, 0}, {4e4F, 4e4F, 1}, 7);
    Columns columns(points.size());
    columns.count(array_of(points), all_awake(points.size()), 0.1);
    for (const LocalPoint& p : points) EXPECT_GE(columns.particles_at(p.x, p.y), 0.25F - 1e-3F);
}

}  // namespace
}  // namespace talus::sim::cpu
