// Copies of a scenario that go on by themselves.
#include <memory>
#include <thread>
#include <vector>

#include "twin/depth_averaged.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

/// With an inflow, a bed and a wall on the way.
std::unique_ptr<Scenario> busy_channel() {
    auto scenario = open(channel_scene());
    act(*scenario, {{"action", "put_bed"},
                    {"polygon", ring(west + 20, south + 20, west + 118, south + 40)},
                    {"depth_m", 0.5},
                    {"growth_rate_per_m", 0.03}});
    const json row = {{"time_s", 0}, {"discharge_m3ps", 5}, {"velocity_mps", 4}};
    json last = row;
    last["time_s"] = 2;
    act(*scenario, {{"action", "put_inflow"},
                    {"line", {{west + 20, south + 27}, {west + 20, south + 33}}},
                    {"hydrograph", {row, last}}});
    act(*scenario,
        {{"action", "put_barrier"}, {"line", {{west + 60, south + 22}, {west + 60, south + 38}}}, {"height_m", 1}});
    return scenario;
}

TEST(Fork, goes_on_as_its_original_does) {
    auto original = busy_channel();
    run_until(*original, 2.5);
    const auto fork = original->fork();
    EXPECT_EQ(state_json(*fork), state_json(*original));
    EXPECT_EQ(journal_json(*fork), journal_json(*original));
    for (Scenario* each : {original.get(), fork.get()}) run_until(*each, 5);
    EXPECT_GT(original->run().ground().bed.eroded.size(), 0U);
    EXPECT_GT(original->run().summary().entrained, 0);
    EXPECT_EQ(hash(*fork), hash(*original));
    EXPECT_EQ(impacts_json(*fork), impacts_json(*original));
    EXPECT_EQ(fork->run().ground().bed.eroded, original->run().ground().bed.eroded);
    EXPECT_EQ(fork->run().ground().terrain.elevation().values, original->run().ground().terrain.elevation().values);
    EXPECT_EQ(fork->run().observer().maps().maps().peak_depth.geometry,
              original->run().observer().maps().maps().peak_depth.geometry);
    EXPECT_EQ(recording_json(*fork), recording_json(*original));
    // What is done to one is not done to the other; and it can be undone as before.
    act(*fork, {{"action", "undo"}});
    EXPECT_NE(setup_key(*fork), setup_key(*original));
    EXPECT_EQ(version_of(*original).revision + 1, version_of(*fork).revision);
}

TEST(Fork, needs_nothing_of_its_original_in_another_thread) {
    auto original = busy_channel();
    run_until(*original, 2);
    std::vector<std::unique_ptr<Scenario>> forks;
    for (int k = 0; k < 2; ++k) forks.push_back(original->fork());
    {
        std::vector<std::jthread> threads;
        for (auto& fork : forks) threads.emplace_back([&fork] { run_until(*fork, 3); });
        original.reset();
    }
    EXPECT_EQ(hash(*forks[0]), hash(*forks[1]));
    EXPECT_GE(forks[0]->time(), 3);
}

}  // namespace
}  // namespace talus::twin::test
