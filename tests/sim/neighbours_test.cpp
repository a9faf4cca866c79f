#include "sim/cpu/neighbours.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "sim/cpu/cell_sort.hpp"
#include "sim_fixtures.hpp"

namespace talus::sim {
namespace {

/// Finds the neighbours of every point and checks them against all pairs.
void expect_all_pairs_found(const std::vector<LocalPoint>& points, float radius) {
    const State state = testing::state_of(points);
    cpu::CellSort sort(points.size());
    cpu::CellGrid grid;
    const double cell = double(radius) * (1 + 1e-7);
    const auto by_cell = sort.sort(state.position, points.size(), cell, grid);
    cpu::NeighbourSearch search(points.size());
    const auto order = search.find(state.position, by_cell, state.asleep, grid, radius).order;
    ASSERT_EQ(std::set<std::uint32_t>(order.begin(), order.end()).size(), points.size()) << "not a permutation";
    cpu::NeighbourLists lists(points.size());
    search.write(lists);

    for (std::uint32_t i = 0; i < points.size(); ++i) {
        std::vector<std::uint32_t> expected, found;
        for (std::uint32_t j = 0; j < points.size(); ++j) {
            const LocalPoint d = points[order[j]] - points[order[i]];
            if (j != i && d.x * d.x + d.y * d.y + d.z * d.z < radius * radius) expected.push_back(j);
        }
        const std::uint32_t length = lists.length[i / block_size];
        ASSERT_LE(lists.count_of(i), length);
        for (std::uint32_t k = 0; k < length; ++k) {
            if (k < lists.count_of(i)) {
                found.push_back(lists.neighbour_of(i, k));
            } else {
                ASSERT_EQ(lists.neighbour_of(i, k), i) << "a list ends with the particle itself";
            }
        }
        std::sort(found.begin(), found.end());
        ASSERT_EQ(found, expected) << "particle " << i;
    }
}

TEST(NeighbourLists, agree_with_all_pairs_in_a_cloud) {
    expect_all_pairs_found(testing::random_points(1500, {-3, -2, 0}, {3, 2, 2}, 1), 0.5F);
}

TEST(NeighbourLists, agree_with_all_pairs_in_scattered_debris) {
    auto points = testing::random_points(600, {-400, -300, 0}, {400, 300, 120}, 2);
    const auto clump = testing::random_points(400, {100, 50, 60}, {102, 52, 61}, 3);
    points.insert(points.end(), clump.begin(), clump.end());
    expect_all_pairs_found(points, 0.7F);
}

TEST(NeighbourLists, agree_with_all_pairs_for_any_cell_size) {
    // Whether the outermost particle falls into the padding depends on how its coordinate rounds.
    for (unsigned seed = 20; seed < 60; ++seed) {
        const float radius = 0.3F + 0.03F * static_cast<float>(seed - 20);
        expect_all_pairs_found(testing::random_points(150, {-1.7F, -1.7F, 18}, {1.7F, 1.7F, 21.4F}, seed), radius);
    }
}

TEST(NeighbourLists, agree_with_all_pairs_on_cell_edges) {
    std::vector<LocalPoint> points;
    for (int x = 0; x < 8; ++x) {
        for (int y = 0; y < 8; ++y) {
            for (int z = 0; z < 4; ++z) points.push_back({0.5F * x, 0.5F * y, 0.5F * z});
        }
    }
    expect_all_pairs_found(points, 0.5F + 1e-4F);
}

TEST(NeighbourLists, grow_when_debris_is_denser_than_the_buffer_expects) {
    expect_all_pairs_found(testing::random_points(400, {0, 0, 0}, {0.3F, 0.3F, 0.3F}, 4), 0.5F);
}

TEST(NeighbourLists, of_a_block_are_about_equally_long) {
    // A block has as many particles on its faces, with short lists, as inside.
    std::vector<LocalPoint> points;
    for (int x = 0; x < 20; ++x) {
        for (int y = 0; y < 20; ++y) {
            for (int z = 0; z < 4; ++z) points.push_back({0.5F * x, 0.5F * y, 0.5F * z});
        }
    }
    const State state = testing::state_of(points);
    cpu::CellSort sort(points.size());
    cpu::CellGrid grid;
    const auto by_cell = sort.sort(state.position, points.size(), 1.1, grid);
    cpu::NeighbourSearch search(points.size());
    search.find(state.position, by_cell, state.asleep, grid, 1.1F);
    cpu::NeighbourLists lists(points.size());
    search.write(lists);
    double neighbours = 0, entries = 0;
    for (std::size_t i = 0; i < points.size(); ++i) neighbours += lists.count_of(i);
    for (std::size_t b = 0; b < points.size() / block_size; ++b) entries += double(block_size) * lists.length[b];
    EXPECT_LT(entries, 1.15 * neighbours);
}

TEST(NeighbourLists, of_one_particle_are_empty) {
    expect_all_pairs_found({{1, 2, 3}}, 0.5F);
}

}  // namespace
}  // namespace talus::sim
