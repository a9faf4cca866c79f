#include "sim/step.hpp"

#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "sim/compression.hpp"
#include "sim_fixtures.hpp"

namespace talus::sim {
namespace {

TEST(Step, docs_tour_has_the_table_of_its_stages) {
    std::ifstream file(TALUS_SOURCE_DIR "/docs/tour.md");
    const std::string tour{std::istreambuf_iterator<char>(file), {}};
    std::string table = "| Stage | What it does |\n|---|---|\n";
    for (const StageDescription& stage : step_stages) {
        table += "| `" + std::string(stage.name) + "` | " + std::string(stage.what) + " |\n";
    }
    EXPECT_NE(tour.find("\n" + table + "\n"), std::string::npos) << "docs/tour.md needs this table:\n" << table;
}

/// Notes what a step tells it, and brings one building down.
class Notebook : public StepWatcher {
  public:
    void follow_inflow(const Model&, const Ground&, const State& state, std::uint32_t first_new_id) override {
        came_in += state.seeded - first_new_id;
        EXPECT_EQ(observed, state.step) << "inflow comes before the step is observed";
    }
    void observe(const Model&, const Ground& ground, const State& state) override {
        ++observed;
        EXPECT_EQ(observed, state.step);
        failed.clear();
        if (observed == 3) failed.push_back(0);
        solids_empty.push_back(ground.solids.empty());
    }
    [[nodiscard]] const std::vector<std::size_t>& failed_buildings() const override { return failed; }

    std::uint32_t came_in = 0;
    std::uint64_t observed = 0;
    std::vector<std::size_t> failed;
    std::vector<bool> solids_empty;
};

TEST(Step, brings_inflow_in_tells_its_watcher_and_removes_what_failed) {
    terrain::Building house;
    house.footprint = {testing::rectangle(50, 10, 54, 16)};
    house.height = 3;
    const terrain::Terrain terrain = testing::inclined_plane(25);
    std::vector<terrain::Building> buildings{house};
    place_buildings(terrain, buildings);
    const Model model = make_model({}, {}, testing::fine_spacing);
    const Ground ground(terrain, buildings, model.support_radius);
    const terrain::Inflow inflow{"gully", {20, 17}, {20, 23}, {{0, 30, 5}, {5, 30, 5}}};
    Simulation simulation(model, ground, State{}, InflowFeeder(model, ground.terrain.frame(), {inflow}));
    const std::uint32_t all = simulation.inflow().remaining();
    Notebook notebook;
    for (int k = 0; k < 40; ++k) ASSERT_TRUE(simulation.advance(&notebook));
    EXPECT_EQ(notebook.observed, 40U);
    EXPECT_GT(notebook.came_in, 0U);
    EXPECT_EQ(notebook.came_in, simulation.state().seeded);
    EXPECT_EQ(notebook.came_in + simulation.inflow().remaining(), all);
    for (std::size_t k = 0; k < 40; ++k) EXPECT_EQ(notebook.solids_empty[k], k >= 3) << k;
    for (std::size_t stage = 0; stage < stage_count; ++stage) {
        EXPECT_GT(simulation.stage_times().seconds[stage], 0) << step_stages[stage].name << " was not run";
    }
}

/// A cube of debris in the air whose upper half falls onto the lower one at `speed`, m/s; compressed where `spacing` is
/// less than the model's.
Simulation cube(float speed, int extra_iterations, double spacing = testing::fine_spacing) {
    params::SolverSpec solver;
    solver.extra_iteration_count = extra_iterations;
    Model model = make_model({}, solver, testing::fine_spacing);
    std::vector<LocalPoint> points, velocities;
    for (int k = 0; k < 1728; ++k) {
        const auto at = [&](int cell) { return static_cast<float>(spacing * cell); };
        points.push_back({at(k % 12), at(k / 12 % 12), 20 + at(k / 144)});
        velocities.push_back({0, 0, k < 864 ? 0 : -speed});
    }
    Ground ground(testing::inclined_plane(0), {}, model.support_radius);
    return {std::move(model), std::move(ground), testing::state_of(points, velocities)};
}

TEST(Step, takes_extra_iterations_where_debris_is_overcompressed_and_only_there) {
    Simulation loose = cube(0, 12);
    ASSERT_TRUE(loose.advance());
    EXPECT_EQ(loose.state().iterations, 4);

    Simulation overcompressed = cube(12, 12), without = cube(12, 0);
    ASSERT_TRUE(overcompressed.advance());
    ASSERT_TRUE(without.advance());
    EXPECT_EQ(without.state().iterations, 4);
    EXPECT_GT(overcompressed.state().iterations, 4);
    EXPECT_LE(overcompressed.state().iterations, 16);
    EXPECT_LT(overcompressed.state().mean_compression, without.state().mean_compression);
    if (overcompressed.state().iterations < 16) {
        EXPECT_FALSE(needs_iteration(overcompressed.state()));
    }
}

TEST(Step, takes_no_extra_iterations_for_the_compression_that_it_starts_with) {
    Simulation compressed = cube(0, 12, 0.97 * testing::fine_spacing);
    ASSERT_TRUE(compressed.advance());
    EXPECT_TRUE(too_compressed(compressed.state()));
    EXPECT_EQ(compressed.state().iterations, 4);
}

TEST(Step, takes_the_same_extra_iterations_on_any_number_of_threads) {
    const auto result_on = [](int threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(threads));
        tbb::task_arena arena(threads);
        return arena.execute([] {
            Simulation overcompressed = cube(12, 12);
            std::vector<int> iterations;
            for (int k = 0; k < 5; ++k) {
                EXPECT_TRUE(overcompressed.advance());
                iterations.push_back(overcompressed.state().iterations);
            }
            return std::pair(iterations, hash_state(overcompressed.state()));
        });
    };
    const auto one = result_on(1);
    EXPECT_GT(one.first.front(), 4);
    EXPECT_EQ(result_on(2), one);
    EXPECT_EQ(result_on(4), one);
}

}  // namespace
}  // namespace talus::sim
