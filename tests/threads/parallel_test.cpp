#include <array>
#include <barrier>
#include <cmath>
#include <cstdint>
#include <functional>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "observe/observer.hpp"
#include "sim/sim_fixtures.hpp"
#include "sim/sources/inflow.hpp"

/// Everything that runs in parallel, small and on more threads than cores: what the thread sanitizer looks at.
namespace talus::test {
namespace {

struct Setting {
    const char* name;
    std::function<void(params::MaterialSpec&, params::SolverSpec&)> spec = [](params::MaterialSpec&,
                                                                              params::SolverSpec&) {};
    bool bed = false, inflow = false;
};

void PrintTo(const Setting& setting, std::ostream* stream) {
    *stream << setting.name;
}

/// Runs down a slope onto a house, observed; the hash of the end and of the observed peak depths.
std::pair<std::uint64_t, std::vector<float>> run_on(int threads, const Setting& setting) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    return arena.execute([&] {
        const terrain::Terrain terrain = testing::inclined_plane(30, 60, 40);
        std::vector<terrain::Building> houses(1);
        houses[0].footprint = {testing::rectangle(17, 12, 22, 20)};
        houses[0].height = 3;
        place_buildings(terrain, houses);
        params::MaterialSpec material;
        params::SolverSpec solver;
        setting.spec(material, solver);
        sim::Model model = sim::make_model(material, solver, 0.5);
        sim::Ground ground(terrain, houses, model.support_radius);
        if (setting.bed) {
            terrain::BedMaterial gravel;
            gravel.growth_rate = 0.1;
            const std::size_t cells = terrain.elevation().values.size();
            ground.bed = {{gravel},
                          std::vector<std::uint8_t>(cells, 1),
                          std::vector<float>(cells, 1),
                          std::vector<float>(cells, 0)};
        }
        std::vector<terrain::Inflow> inflows;
        if (setting.inflow) inflows = {{"gully", {5, 8}, {5, 12}, {{0, 20, 4}, {9, 20, 4}}}};
        Result<sim::State> state =
            seed_releases(model, ground, {testing::block(terrain, testing::rectangle(6, 10, 16, 22), 1)});
        sim::InflowFeeder feeder(model, terrain.frame(), inflows);
        sim::Simulation simulation(std::move(model), std::move(ground), *std::move(state), std::move(feeder));
        const terrain::FlowPath path({{8, 16}, {55, 16}}, 30);
        observe::Observer observer(simulation.model(), simulation.ground(), simulation.state(), path, {}, 1);
        for (int i = 0; i < 20; ++i) EXPECT_TRUE(simulation.advance(&observer));
        EXPECT_EQ(simulation.state().entrained > 0, setting.bed);
        return std::pair(
            hash_state(simulation.state()),
            observer.finish(simulation.model(), simulation.ground(), simulation.state()).maps.peak_depth.values);
    });
}

class ParallelStages : public ::testing::TestWithParam<Setting> {};

TEST_P(ParallelStages, step_and_observe_alike_on_one_thread_and_on_four) {
    const auto [one, depths_of_one] = run_on(1, GetParam());
    const auto [four, depths_of_four] = run_on(4, GetParam());
    EXPECT_EQ(one, four);
    ASSERT_FALSE(depths_of_one.empty());
    ASSERT_EQ(depths_of_one.size(), depths_of_four.size());
    for (std::size_t i = 0; i < depths_of_one.size(); ++i) {
        ASSERT_TRUE(depths_of_one[i] == depths_of_four[i] ||
                    (std::isnan(depths_of_one[i]) && std::isnan(depths_of_four[i])))
            << i;
    }
}

const std::vector<Setting> settings = {
    {"stress"},
    {"pair", [](params::MaterialSpec&,
                params::SolverSpec& solver) { solver.internal_friction = params::InternalFriction::pair; }},
    {"drag_and_rest",
     [](params::MaterialSpec& material, params::SolverSpec& solver) {
         material.turbulent_friction = 300;
         material.viscosity = 0.2;
         material.cohesion = 200;
         solver.rest_duration = 0.05;
     }},
    {"bed", [](params::MaterialSpec&, params::SolverSpec&) {}, true},
    {"inflow", [](params::MaterialSpec&, params::SolverSpec&) {}, false, true},
};
INSTANTIATE_TEST_SUITE_P(Solver, ParallelStages, ::testing::ValuesIn(settings),
                         [](const auto& setting) { return std::string(setting.param.name); });

/// What one of several threads reads of a run on the host's device between two of its steps.
void read_between_steps(const sim::Simulation& simulation) {
    const sim::Motion moving = simulation.motion(0.1);
    const std::uint64_t hash = hash_state(simulation.state());
    EXPECT_GT(simulation.device_traffic().to_device, 0U);
    EXPECT_EQ(hash_state(simulation.state()), hash);
    EXPECT_EQ(sim::motion_of(simulation.state(), 0.1).moving, moving.moving);
    EXPECT_EQ(simulation.motion(0.1).moving, moving.moving);
}

TEST(Device, several_threads_read_each_of_two_runs_between_their_steps) {
    const auto run = [](std::uint64_t& hash) {
        const terrain::Terrain terrain = testing::inclined_plane(30, 60, 40);
        params::SolverSpec solver;
        solver.backend = params::BackendChoice::host;
        sim::Model model = sim::make_model({}, solver, 0.5);
        sim::Ground ground(terrain, {}, model.support_radius);
        Result<sim::State> state =
            seed_releases(model, ground, {testing::block(terrain, testing::rectangle(6, 10, 16, 22), 1)});
        sim::Simulation simulation(std::move(model), std::move(ground), *std::move(state));
        // The readers live as long as the run: TBB keeps memory for each thread and gives it to the next when one ends,
        // and the sanitizer, which does not see TBB's own code, takes that for a race.
        constexpr int steps = 10, count = 3;
        std::barrier<> stepped(count + 1), read(count + 1);
        std::vector<std::jthread> readers;
        for (int k = 0; k < count; ++k) {
            readers.emplace_back([&] {
                for (int step = 0; step < steps; ++step) {
                    stepped.arrive_and_wait();
                    read_between_steps(simulation);
                    read.arrive_and_wait();
                }
            });
        }
        for (int step = 0; step < steps; ++step) {
            EXPECT_TRUE(simulation.advance());
            stepped.arrive_and_wait();
            read.arrive_and_wait();
        }
        readers.clear();
        hash = hash_state(simulation.state());
    };
    std::array<std::uint64_t, 2> hashes{};
    {
        std::vector<std::jthread> runs;
        for (std::uint64_t& hash : hashes) runs.emplace_back([&] { run(hash); });
    }
    EXPECT_EQ(hashes[0], hashes[1]);
    EXPECT_NE(hashes[0], 0U);
}

}  // namespace
}  // namespace talus::test
