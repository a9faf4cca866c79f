#include "run/grid_fault.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "depth/solver.hpp"
#include "run/run_scene.hpp"
#include "scene/scene_folder.hpp"

namespace talus::run {
namespace {

using testing::HasSubstr;

/// Level ground of 40 x 30 cells of 2 m with 1 m of debris on a square of it.
class GridFault : public testing::Test {
  protected:
    GridFault() {
        Grid<float> depth(bed.geometry);
        for (int row = 10; row < 20; ++row) {
            for (int column = 10; column < 20; ++column) depth.at(column, row) = 1;
        }
        solver.add(depth);
        solver.set_velocity(15, 12, 3, 4);
    }
    Grid<double> bed{GridGeometry{1000, 2000, 2, 40, 30}, 50.0};
    depth::Solver solver{bed, {}};
};

TEST_F(GridFault, names_the_first_bad_cell_and_its_neighbours) {
    const GridState good(solver);
    EXPECT_EQ(good.cells.size(), 100U);
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    solver.set_velocity(15, 12, nan, 0);
    const Status stepped = solver.advance(0.01);
    ASSERT_FALSE(stepped);
    solver.set_velocity(16, 13, 0, nan);
    solver.set_velocity(17, 18, nan, nan);
    const FaultRecord record = record_grid_fault(bed, good, solver, stepped.error().message);
    EXPECT_EQ(record.content["fault"], stepped.error().message);
    EXPECT_EQ(record.content["step"], 1);
    EXPECT_GE(record.content["cells_not_finite"], 3);
    const auto& cell = record.content["cell"];
    // A step reaches two cells to every side: Heun's method has two stages.
    EXPECT_NEAR(cell["row"].get<int>(), 12, 2);
    EXPECT_NEAR(cell["column"].get<int>(), 15, 2);
    EXPECT_EQ(cell["x_m"], 1000 + 2 * (cell["column"].get<int>() + 0.5));
    EXPECT_EQ(cell["ground_m"], 50);
    EXPECT_EQ(cell["depth_m"], 1);
    EXPECT_EQ(cell["neighbours"].size(), 4U);
    EXPECT_EQ(cell["neighbours"][1]["column"], cell["column"].get<int>() + 1);
    EXPECT_THAT(record.sentence, HasSubstr(fmt::format("the cell in column {} and row {} of the grid",
                                                       cell["column"].get<int>(), cell["row"].get<int>())));
    EXPECT_THAT(record.sentence, HasSubstr("1 m west, 1 m east"));
}

TEST_F(GridFault, keeps_the_debris_of_the_good_state_with_all_digits) {
    const FaultRecord record = record_grid_fault(bed, GridState(solver), solver, "too fast");
    EXPECT_EQ(std::count(record.state_table.begin(), record.state_table.end(), '\n'), 101);
    EXPECT_THAT(record.state_table, HasSubstr("column,row,x_m,y_m,depth_m,u_mps,v_mps\n10,10,1021,2021,1,0,0\n"));
    EXPECT_THAT(record.state_table, HasSubstr("\n15,12,1031,2025,1,3,4\n"));
    EXPECT_EQ(record.content["cells_not_finite"], 0);
    EXPECT_EQ(record.content["cell"]["column"], 15) << "where all are finite, the fastest";
    EXPECT_THAT(record.sentence, HasSubstr("had 1 m of debris at 5 m/s at t = 0 s"));
}

class FaultOfAGridRun : public scene::SceneFolder {};

TEST_F(FaultOfAGridRun, ends_it_with_what_is_known) {
    write_valley();
    scene::Scene scene = loaded({"solver.model=depth_averaged", "solver.end_time_s=12"});
    scene.releases[0].volume = 1e38;  // so deep that single precision cannot hold its momentum
    const auto result = run_scene(scene, {});
    ASSERT_TRUE(result) << result.error().message;
    ASSERT_EQ(result->status, RunStatus::fault);
    ASSERT_TRUE(result->fault);
    const auto& content = result->fault->content;
    EXPECT_GT(content["cells_not_finite"], 0);
    EXPECT_NEAR(content["cell"]["x_m"].get<double>(), west + 30, 20);
    EXPECT_NEAR(content["cell"]["y_m"].get<double>(), south + 100, 20);
    EXPECT_GT(content["last_good"]["cells"], 10);
    EXPECT_LE(content["step"].get<int>() - content["last_good"]["step"].get<int>(), 64);
    EXPECT_THAT(result->stop_reason, HasSubstr("is not a number at t = "));
    EXPECT_THAT(result->stop_reason, HasSubstr(result->fault->sentence));
}

}  // namespace
}  // namespace talus::run
