#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "observe/observer.hpp"
#include "sim/sim_fixtures.hpp"

/// Everything that runs in parallel, small and on more threads than cores: what the thread sanitizer looks at.
namespace talus {
namespace {

TEST(ParallelStages, step_and_observe_on_four_threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
    tbb::task_arena arena(4);
    arena.execute([] {
        const Terrain terrain = testing::inclined_plane(30, 60, 40);
        Building house;
        house.footprint = {testing::rectangle(17, 12, 22, 20)};
        house.height = 3;
        Simulation simulation = testing::simulate(
            {}, {}, terrain, {testing::block(terrain, testing::rectangle(6, 10, 16, 22), 1)}, 0.5, {house});
        const FlowPath path({{8, 16}, {55, 16}}, 30);
        Observer observer(simulation.model(), simulation.state(), path, {}, 1);
        for (int i = 0; i < 20; ++i) {
            ASSERT_FALSE(simulation.advance(&observer));
        }
        EXPECT_FALSE(observer.finish(simulation.model(), simulation.state()).maps.peak_depth.values.empty());
    });
}

}  // namespace
}  // namespace talus
