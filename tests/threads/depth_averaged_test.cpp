#include <cmath>
#include <cstdint>
#include <utility>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "depth/solver.hpp"

namespace talus::test {
namespace {

/// Debris on two slopes of a valley that spreads over many segments; the hash of the end, and the updated cells.
std::pair<std::uint64_t, std::uint64_t> spread_on(int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    return arena.execute([] {
        Grid<double> bed({0, 0, 1, 150, 90});
        Grid<float> debris(bed.geometry);
        for (int row = 0; row < bed.geometry.rows; ++row) {
            for (int column = 0; column < bed.geometry.columns; ++column) {
                const PlanPoint p = bed.geometry.centre(column, row);
                bed.at(column, row) =
                    0.3 * std::abs(p.y - 45) - 0.1 * p.x + 0.4 * std::sin(p.x / 5) * std::cos(p.y / 4);
                debris.at(column, row) =
                    std::hypot(p.x - 40, p.y - 20) < 8 || std::hypot(p.x - 60, p.y - 70) < 5 ? 2 : 0;
            }
        }
        depth::Material material;
        material.friction_coefficient = 0.15;
        depth::Solver solver(bed, material);
        solver.add(debris);
        for (int step = 0; step < 60; ++step) EXPECT_TRUE(solver.advance(0.2).ok());
        return std::pair(solver.hash(), solver.cell_updates());
    });
}

TEST(DepthAveraged, steps_alike_on_one_thread_and_on_four) {
    const auto one = spread_on(1);
    EXPECT_GT(one.second, 0U);
    EXPECT_EQ(spread_on(4), one);
}

}  // namespace
}  // namespace talus::test
