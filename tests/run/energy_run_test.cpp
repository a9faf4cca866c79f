#include <cmath>
#include <optional>

#include <gmock/gmock.h>

#include "run/grid_fault.hpp"
#include "run/run.hpp"
#include "run/run_scene.hpp"
#include "run/verdict.hpp"
#include "scene/scene_folder.hpp"

namespace talus::run {
namespace {

using testing::HasSubstr;

/// Runs of both models of one scene: "" of particles.
class EnergyOfARun : public scene::SceneFolder, public testing::WithParamInterface<const char*> {
  protected:
    [[nodiscard]] RunResult ran(const std::vector<std::string>& settings) const {
        std::vector<std::string> all{"solver.end_time_s=6", "solver.target_particle_count=800"};
        if (*GetParam() != '\0') all = {"solver.end_time_s=6", GetParam()};
        all.insert(all.end(), settings.begin(), settings.end());
        return test::value_of(run_scene(loaded(all), {}));
    }
    static void expect_within(const RunResult& result) {
        const observe::Energy& energy = result.observation.energy;
        ASSERT_TRUE(energy.known());
        EXPECT_LE(energy.share, observe::Energy::share_limit);
        EXPECT_LE(energy.gained, 0.005);
        EXPECT_EQ(energy.cells_above, 0);
        EXPECT_EQ(judge(result).check("energy").state, CheckState::within) << judge(result).check("energy").text;
    }
};

TEST_P(EnergyOfARun, is_that_of_free_fall_without_friction_and_less_with_it) {
    write_terrain("dem.tif", [](double x, double) { return 200 - 0.5 * (x - west); });
    write_features("release.geojson", {rectangle(20, 60, 40, 140)});
    write("scene.toml", "[terrain]\nfile = \"dem.tif\"\n[[release]]\nfile = \"release.geojson\"\nthickness_m = 2\n");
    const RunResult free = ran({"material.friction_coefficient=0"});
    expect_within(free);
    EXPECT_GT(free.observation.energy.share, 0.7);
    const RunResult rough = ran({"material.friction_coefficient=0.35"});
    expect_within(rough);
    EXPECT_LT(rough.observation.energy.share, 0.5);
}

TEST_P(EnergyOfARun, has_what_inflow_and_the_bed_bring_in) {
    write_valley("[[bed]]\ndepth_m = 1\ngrowth_rate_per_m = 0.02\n");
    const RunResult entrained = ran({"material.friction_coefficient=0.1"});
    EXPECT_GT(entrained.observation.timeseries.back().volume_entrained, 50);
    expect_within(entrained);

    // 30 m/s on level ground: all energy is that of the inflow.
    write_terrain("dem.tif", [](double, double) { return 10.0; });
    write("flow.csv", "time_s,discharge_m3ps,velocity_mps\n0,300,30\n6,300,30\n");
    write("scene.toml", fmt::format("[terrain]\nfile = \"dem.tif\"\n[[inflow]]\nline_m = [[{0}, {1}], [{0}, {2}]]\n"
                                    "hydrograph = \"flow.csv\"\n[material]\nfriction_coefficient = 0.05\n",
                                    west + 20, south + 95, south + 105));
    const RunResult inflow = ran({});
    EXPECT_GT(inflow.observation.energy.speed, 20);
    expect_within(inflow);
}

INSTANTIATE_TEST_SUITE_P(Models, EnergyOfARun, testing::Values("", "solver.model=depth_averaged"),
                         [](const auto& model) { return *model.param == '\0' ? "particles" : "depth_averaged"; });

/// A slope of 0.5 with 2 m of debris at its top, some of it much too fast.
class TooFast : public testing::Test {
  protected:
    TooFast() : bed(GridGeometry{1000, 2000, 5, 40, 20}) {
        for (int row = 0; row < 20; ++row) {
            for (int column = 0; column < 40; ++column) bed.at(column, row) = 100 - 2.5 * column;
        }
        Grid<float> depth(bed.geometry);
        for (int row = 8; row < 12; ++row) {
            for (int column = 2; column < 6; ++column) depth.at(column, row) = 2;
        }
        solver.emplace(bed, depth::Material{});
        const params::OutputSpec outputs;
        observer.emplace(*solver, terrain::FlowPath{}, outputs,
                         observe::GridStructures(*solver, terrain::Terrain(Grid<float>(bed.geometry)), {}, {}, outputs),
                         0);
        solver->add(depth);
        observer->note_release(*solver, depth, solver->volume(), 0);
    }
    void step() {
        ASSERT_TRUE(solver->advance(0.01));
        observer->after_step(*solver, 0, 0);
    }
    Grid<double> bed;
    std::optional<depth::Solver> solver;
    std::optional<observe::GridObserver> observer;
};

TEST_F(TooFast, debris_is_a_fault_that_names_speed_and_time) {
    step();
    EXPECT_TRUE(find_grid_fault(*solver, *observer));
    // From 97 m down to the lowest ground at 2.5: 43.5 m/s, with the thickness.
    EXPECT_NEAR(observer->greatest_speed(), std::sqrt(2 * 9.80665 * (97 - 2.5 + 2)), 0.1);
    solver->set_velocity(3, 10, 120, 0);
    step();
    const Status found = find_grid_fault(*solver, *observer);
    ASSERT_FALSE(found);
    EXPECT_THAT(found.error().message, HasSubstr("at t = 0.02 s debris of the depth-averaged model moves at 1"));
    EXPECT_THAT(found.error().message, HasSubstr("more than its fall can explain (66"));
    const FaultRecord record = record_grid_fault(bed, GridState(*solver), *solver, found.error().message);
    EXPECT_NEAR(record.content["cell"]["x_m"].get<double>(), 1017.5, 10);
}

TEST_F(TooFast, debris_below_that_is_told_by_the_verdict) {
    solver->set_velocity(3, 10, 40, 0);  // where it has not fallen by 10 m
    step();
    EXPECT_TRUE(find_grid_fault(*solver, *observer));
    Grid<float> heights(bed.geometry);
    for (std::size_t k = 0; k < bed.values.size(); ++k) heights.values[k] = static_cast<float>(bed.values[k]);
    const terrain::Terrain ground(heights);
    RunResult result;
    result.grid_cell = 5;
    result.observation = observer->finish(*solver, sim::Ground(ground), 0);
    const RunVerdict verdict = judge(result);
    EXPECT_EQ(verdict.check("energy").state, CheckState::beyond);
    EXPECT_THAT(verdict.check("energy").text, HasSubstr("faster than its fall explains"));
    EXPECT_GT(result.observation.energy.cells_above, 0);
}

}  // namespace
}  // namespace talus::run
