#include "sim/step.hpp"

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sim_fixtures.hpp"

namespace talus {
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
    void follow_inflow(const State& state, std::uint32_t first_new_id) override {
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
    Building house;
    house.footprint = {testing::rectangle(50, 10, 54, 16)};
    house.height = 3;
    const Terrain terrain = testing::inclined_plane(25);
    std::vector<Building> buildings{house};
    place_buildings(terrain, buildings);
    const Model model = make_model({}, {}, testing::fine_spacing);
    const Ground ground(terrain, buildings, model.support_radius);
    const Inflow inflow{"gully", {20, 17}, {20, 23}, {{0, 30, 5}, {5, 30, 5}}};
    Simulation simulation(model, ground, State{}, InflowFeeder(model, ground.terrain.frame(), {inflow}));
    const std::uint32_t all = simulation.inflow().to_come();
    Notebook notebook;
    for (int k = 0; k < 40; ++k) ASSERT_TRUE(simulation.advance(&notebook));
    EXPECT_EQ(notebook.observed, 40U);
    EXPECT_GT(notebook.came_in, 0U);
    EXPECT_EQ(notebook.came_in, simulation.state().seeded);
    EXPECT_EQ(notebook.came_in + simulation.inflow().to_come(), all);
    for (std::size_t k = 0; k < 40; ++k) EXPECT_EQ(notebook.solids_empty[k], k >= 3) << k;
    for (std::size_t stage = 0; stage < stage_count; ++stage) {
        EXPECT_GT(simulation.stage_times().seconds[stage], 0) << step_stages[stage].name << " was not run";
    }
}

}  // namespace
}  // namespace talus
