// Snapshots and forks: copies of a simulation that go on to the same bits.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "embed_fixtures.hpp"

namespace talus::embed::test {
namespace {

struct Drop {
    void operator()(talus_snapshot* snapshot) const { talus_drop_snapshot(snapshot); }
};
using Snapshot = std::unique_ptr<talus_snapshot, Drop>;

Simulation fork_of(const Simulation& simulation) {
    talus_error error = TALUS_SIZED(talus_error);
    talus_simulation* fork = nullptr;
    EXPECT_EQ(talus_fork(simulation.get(), &fork, &error), TALUS_OK) << error.text;
    return Simulation(fork);
}

Snapshot snapshot_of(const Simulation& simulation) {
    talus_error error = TALUS_SIZED(talus_error);
    talus_snapshot* snapshot = nullptr;
    EXPECT_EQ(talus_take_snapshot(simulation.get(), &snapshot, &error), TALUS_OK) << error.text;
    return Snapshot(snapshot);
}

std::string json_of(const Simulation& simulation, const char* name) {
    const char* text = nullptr;
    EXPECT_EQ(talus_get_json(simulation.get(), name, &text, nullptr), TALUS_OK);
    return text;
}

/// All that is measured: bits of peak maps, front and structures.
std::string measured(const Simulation& simulation) {
    std::string bits;
    const auto add = [&](const auto* values, std::size_t count) {
        bits.append(reinterpret_cast<const char*>(values), count * sizeof *values);
    };
    talus_error error = TALUS_SIZED(talus_error);
    for (const char* name : {"depth", "speed", "peak_depth", "peak_speed", "peak_pressure", "arrival_time",
                             "deposit_depth", "erosion_depth"}) {
        talus_map map = TALUS_SIZED(talus_map);
        EXPECT_EQ(talus_get_map(simulation.get(), name, &map, &error), TALUS_OK) << error.text;
        add(map.values, static_cast<std::size_t>(map.grid.columns) * static_cast<std::size_t>(map.grid.rows));
    }
    talus_front front = TALUS_SIZED(talus_front);
    EXPECT_EQ(talus_get_front(simulation.get(), &front, &error), TALUS_OK) << error.text;
    add(front.arrival_time, front.count);
    return bits + json_of(simulation, "impacts") + json_of(simulation, "setup");
}

std::uint32_t newest(const talus_debris& debris) {
    return *std::max_element(debris.id, debris.id + debris.count);
}

/// Everything that a state has: an inflow, a bed that is entrained, a wall that debris overtops.
/// Without a bed, a device keeps the particles from step to step.
Simulation open_with_everything(const char* backend = "solver.backend=cpu", bool bed = true) {
    const Slope slope;
    const char* settings[] = {"solver.target_particle_count=600", "material.friction_coefficient=0.2",
                              "solver.thread_count=1", backend};
    talus_simulation* opened = nullptr;
    talus_error error = TALUS_SIZED(talus_error);
    EXPECT_EQ(talus_open_arrays(&slope.arrays, nullptr, settings, 4, nullptr, &opened, &error), TALUS_OK) << error.text;
    Simulation simulation(opened);
    for (const char* action : {R"({"action": "put_inflow", "line": [[20, 12], [20, 18]],
                                   "hydrograph": [{"time_s": 0, "discharge_m3ps": 12, "velocity_mps": 3},
                                                  {"time_s": 4, "discharge_m3ps": 12, "velocity_mps": 3}]})",
                               R"({"action": "put_barrier", "line": [[37, 5], [37, 25]], "height_m": 1})",
                               R"({"action": "put_bed", "polygon": [[16, 5], [36, 5], [36, 25], [16, 25]], "depth_m": 1,
                                   "growth_rate_per_m": 0.02})"}) {
        if (!bed && std::string(action).find("put_bed") != std::string::npos) continue;
        EXPECT_EQ(talus_apply(simulation.get(), action, nullptr, &error), TALUS_OK) << error.text;
    }
    return simulation;
}

TEST(Forks, go_on_to_the_same_bits_with_all_that_was_measured) {
    const Simulation simulation = open_with_everything();
    advance_to(simulation, 2);
    const Simulation fork = fork_of(simulation);
    EXPECT_EQ(hash_of(fork), hash_of(simulation));
    EXPECT_EQ(measured(fork), measured(simulation));
    const talus_debris here = debris_of(simulation), there = debris_of(fork);
    EXPECT_NE(here.x, there.x) << "memory of its own";
    EXPECT_EQ(std::memcmp(here.x, there.x, here.count * sizeof *here.x), 0) << "in the same order";
    // Step by step, so that a difference of the first steps cannot hide behind later ones.
    talus_error error = TALUS_SIZED(talus_error);
    const std::uint32_t before = newest(here);
    while (state_of(simulation).time < 4) {
        for (const Simulation* each : {&simulation, &fork}) {
            ASSERT_EQ(talus_step(each->get(), 1, nullptr, &error), TALUS_OK) << error.text;
        }
        ASSERT_EQ(hash_of(fork), hash_of(simulation)) << "at t = " << state_of(simulation).time;
    }
    EXPECT_GT(newest(debris_of(fork)), before) << "more came in";
    EXPECT_EQ(measured(fork), measured(simulation));
}

TEST(Forks, go_on_by_themselves) {
    const Simulation simulation = open_with_everything(), untouched = open_with_everything();
    advance_to(simulation, 2);
    Simulation fork = fork_of(simulation);
    talus_error error = TALUS_SIZED(talus_error);
    ASSERT_EQ(talus_set(fork.get(), "material.friction_coefficient", 0.7, &error), TALUS_OK) << error.text;
    ASSERT_EQ(talus_apply(fork.get(), R"({"action": "put_barrier", "line": [[55, 5], [55, 25]], "height_m": 4})",
                          nullptr, &error),
              TALUS_OK)
        << error.text;
    advance_to(fork, 4);
    advance_to(simulation, 4);
    EXPECT_NE(hash_of(fork), hash_of(simulation));
    fork.reset();
    advance_to(untouched, 4);
    EXPECT_EQ(hash_of(simulation), hash_of(untouched)) << "as if there had been no fork";
    EXPECT_EQ(measured(simulation), measured(untouched));
}

TEST(Forks, outlast_what_they_were_made_from_and_run_in_other_threads) {
    Simulation simulation = open_with_everything();
    advance_to(simulation, 2);
    const std::vector<Simulation> forks = [&] {
        std::vector<Simulation> made;
        for (int k = 0; k < 2; ++k) made.push_back(fork_of(simulation));
        made.push_back(fork_of(made.front()));
        return made;
    }();
    advance_to(simulation, 3);
    const std::uint64_t hash = hash_of(simulation);
    simulation.reset();
    {
        std::vector<std::jthread> threads;
        for (const Simulation& fork : forks) threads.emplace_back([&fork] { advance_to(fork, 3); });
    }
    for (const Simulation& fork : forks) EXPECT_EQ(hash_of(fork), hash);
}

TEST(Forks, are_saved_as_their_originals_are) {
    const Folder folder;
    const Simulation simulation = Slope().open((folder.path / "scene").c_str());
    advance_to(simulation, 1);
    const Simulation fork = fork_of(simulation);
    talus_error error = TALUS_SIZED(talus_error);
    ASSERT_EQ(talus_set(fork.get(), "material.friction_coefficient", 0.3, &error), TALUS_OK) << error.text;
    advance_to(fork, 2);
    const fs::path file = folder.path / "saved.json";
    ASSERT_EQ(talus_save(fork.get(), file.c_str(), &error), TALUS_OK) << error.text;
    talus_simulation* opened = nullptr;
    ASSERT_EQ(talus_open_saved(file.c_str(), nullptr, &opened, &error), TALUS_OK) << error.text;
    EXPECT_EQ(hash_of(Simulation(opened)), hash_of(fork)) << "by computing it again from the start";
    EXPECT_EQ(talus_save(fork_of(Slope().open()).get(), file.c_str(), &error), TALUS_BAD_INPUT)
        << "arrays without a folder";
}

TEST(Forks, of_a_device_go_on_to_the_same_bits) {
    const Simulation simulation = open_with_everything("solver.backend=host", false);
    advance_to(simulation, 1);
    const Simulation fork = fork_of(simulation);
    EXPECT_EQ(measured(fork), measured(simulation));
    for (const Simulation* each : {&simulation, &fork}) advance_to(*each, 1.5);
    EXPECT_EQ(hash_of(fork), hash_of(simulation));
    EXPECT_EQ(measured(fork), measured(simulation));
}

TEST(Snapshots, bring_a_simulation_back_as_often_as_wanted) {
    Simulation simulation = open_with_everything();
    advance_to(simulation, 1);
    const Snapshot early = snapshot_of(simulation);
    const std::uint64_t at_early = hash_of(simulation);
    const std::string measured_early = measured(simulation);
    advance_to(simulation, 2);
    const Snapshot late = snapshot_of(simulation);
    const std::uint64_t at_late = hash_of(simulation);
    talus_error error = TALUS_SIZED(talus_error);
    for (int k = 0; k < 2; ++k) {
        ASSERT_EQ(talus_restore(simulation.get(), early.get(), &error), TALUS_OK) << error.text;
        EXPECT_EQ(hash_of(simulation), at_early);
        EXPECT_EQ(measured(simulation), measured_early) << "peaks of later are forgotten";
        advance_to(simulation, 2);
        EXPECT_EQ(hash_of(simulation), at_late);
    }
    ASSERT_EQ(talus_restore(simulation.get(), early.get(), &error), TALUS_OK) << error.text;
    ASSERT_EQ(talus_restore(simulation.get(), late.get(), &error), TALUS_OK) << error.text;
    EXPECT_EQ(hash_of(simulation), at_late) << "forwards too";
    // What a fork may use, and after the simulation was closed.
    const Simulation fork = fork_of(simulation);
    simulation.reset();
    ASSERT_EQ(talus_restore(fork.get(), early.get(), &error), TALUS_OK) << error.text;
    advance_to(fork, 2);
    EXPECT_EQ(hash_of(fork), at_late);
}

TEST(Snapshots, of_another_scene_are_refused) {
    const Simulation simulation = Slope().open(), other = Slope().open();
    advance_to(other, 0.5);
    const Snapshot snapshot = snapshot_of(other);
    const std::uint64_t hash = hash_of(simulation);
    talus_error error = TALUS_SIZED(talus_error);
    EXPECT_EQ(talus_restore(simulation.get(), snapshot.get(), &error), TALUS_BAD_INPUT);
    EXPECT_STREQ(error.text, "snapshot: must be of this simulation, or of one that it was forked from or into");
    EXPECT_EQ(hash_of(simulation), hash) << "nothing was changed";
}

}  // namespace
}  // namespace talus::embed::test
