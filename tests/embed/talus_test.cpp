// libtalus through its C interface.
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <dlfcn.h>
#include <fstream>
#include <iterator>
#include <limits>
#include <regex>
#include <string>
#include <thread>
#include <utility>

#include "embed_fixtures.hpp"

namespace talus::embed::test {
namespace {

TEST(Library, simulates_a_scene_from_arrays_and_shows_its_debris_without_a_copy) {
    const Simulation simulation = Slope().open();
    const talus_debris before = debris_of(simulation);
    EXPECT_NEAR(static_cast<double>(before.count) * state_of(simulation).particle_volume, 100, 1)
        << "10 m x 10 m x 1 m";
    const talus_state at_start = state_of(simulation);
    EXPECT_EQ(at_start.phase, TALUS_READY);
    EXPECT_STREQ(at_start.message, "");
    const double* const origin = at_start.origin;
    double start = 0, end = 0;
    for (std::size_t i = 0; i < before.count; ++i) start += before.x[i] + origin[0];
    EXPECT_NEAR(start / static_cast<double>(before.count), 10, 0.3) << "the middle of the scar, world";
    advance_to(simulation, 2);
    EXPECT_GE(state_of(simulation).time, 2);
    EXPECT_GT(state_of(simulation).steps, 10U);
    const talus_debris after = debris_of(simulation);
    for (std::size_t i = 0; i < after.count; ++i) end += after.x[i] + origin[0];
    EXPECT_GT(end, start + static_cast<double>(after.count)) << "more than a metre down the slope";
}

TEST(Library, reads_maps_front_structures_and_json) {
    const Simulation simulation = Slope().open();
    advance_to(simulation, 6);
    talus_error error = TALUS_SIZED(talus_error);
    talus_map map = TALUS_SIZED(talus_map);
    ASSERT_EQ(talus_get_map(simulation.get(), "peak_speed", &map, &error), TALUS_OK) << error.text;
    float fastest = 0;
    for (int k = 0; k < map.grid.columns * map.grid.rows; ++k) fastest = std::fmax(fastest, map.values[k]);
    EXPECT_GT(fastest, 2);
    talus_front front = TALUS_SIZED(talus_front);
    ASSERT_EQ(talus_get_front(simulation.get(), &front, &error), TALUS_OK) << error.text;
    ASSERT_GT(front.count, 2U);
    EXPECT_LT(front.chainage[0], front.chainage[front.count - 1]);
    ASSERT_EQ(state_of(simulation).structure_count, 1U);
    talus_structure house = TALUS_SIZED(talus_structure);
    ASSERT_EQ(talus_get_structure(simulation.get(), 0, &house, &error), TALUS_OK);
    EXPECT_STREQ(house.name, "house");
    EXPECT_TRUE(house.hit);
    EXPECT_GT(house.peak_force, 1000);
    const char* text = nullptr;
    ASSERT_EQ(talus_get_json(simulation.get(), "state", &text, &error), TALUS_OK);
    EXPECT_NE(std::string(text).find("\"time_s\""), std::string::npos);
}

TEST(Library, refuses_with_a_code_and_a_sentence) {
    talus_error error = TALUS_SIZED(talus_error);
    talus_simulation* none = nullptr;
    EXPECT_EQ(talus_open("/nowhere/scene.toml", nullptr, 0, nullptr, &none, &error), TALUS_BAD_INPUT);
    EXPECT_EQ(error.code, TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("/nowhere/scene.toml"), std::string::npos) << error.text;
    EXPECT_EQ(none, nullptr);

    Slope slope;
    slope.arrays.crs = "EPSG:0";
    EXPECT_EQ(talus_open_arrays(&slope.arrays, nullptr, nullptr, 0, nullptr, &none, &error), TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("EPSG:0"), std::string::npos) << error.text;
    slope = Slope();
    slope.arrays.grid.rows = 1;
    EXPECT_EQ(talus_open_arrays(&slope.arrays, nullptr, nullptr, 0, nullptr, &none, nullptr), TALUS_BAD_INPUT);
    slope = Slope();
    slope.arrays.release = nullptr;
    EXPECT_EQ(talus_open_arrays(&slope.arrays, nullptr, nullptr, 0, nullptr, &none, &error), TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("release"), std::string::npos) << error.text;
    slope = Slope();
    const char* wrong[] = {"material.friction_coefficient=-1"};
    EXPECT_EQ(talus_open_arrays(&slope.arrays, nullptr, wrong, 1, nullptr, &none, &error), TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("friction_coefficient"), std::string::npos) << error.text;

    const Simulation simulation = Slope().open();
    const std::uint64_t hash = hash_of(simulation);
    EXPECT_EQ(talus_set(simulation.get(), "material.friction_coefficient", -1, &error), TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("-1"), std::string::npos) << error.text;
    EXPECT_EQ(talus_apply(simulation.get(), "{", nullptr, &error), TALUS_BAD_INPUT);
    talus_map map = TALUS_SIZED(talus_map);
    EXPECT_EQ(talus_get_map(simulation.get(), "depht", &map, &error), TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("peak_depth"), std::string::npos) << "names what is allowed";
    talus_structure structure = TALUS_SIZED(talus_structure);
    EXPECT_EQ(talus_get_structure(simulation.get(), 1, &structure, &error), TALUS_BAD_INPUT);
    EXPECT_EQ(talus_save(simulation.get(), "/tmp/never.json", &error), TALUS_BAD_INPUT) << "its scene is kept nowhere";
    EXPECT_EQ(hash_of(simulation), hash) << "nothing was changed";
}

TEST(Library, changes_material_and_obstacles_between_steps) {
    const Simulation slippery = Slope().open(), rough = Slope().open();
    talus_error error = TALUS_SIZED(talus_error);
    for (const Simulation* simulation : {&slippery, &rough}) advance_to(*simulation, 1);
    EXPECT_EQ(hash_of(slippery), hash_of(rough));
    ASSERT_EQ(talus_set(rough.get(), "material.friction_coefficient", 0.6, &error), TALUS_OK) << error.text;
    const char* created = nullptr;
    ASSERT_EQ(talus_apply(slippery.get(), R"({"action": "put_barrier", "line": [[35, 5], [35, 25]], "height_m": 4})",
                          &created, &error),
              TALUS_OK)
        << error.text;
    EXPECT_STRNE(created, "");
    for (const Simulation* simulation : {&slippery, &rough}) advance_to(*simulation, 6);
    talus_structure house = TALUS_SIZED(talus_structure), wall = house;
    ASSERT_EQ(state_of(slippery).structure_count, 2U);
    ASSERT_EQ(talus_get_structure(slippery.get(), 1, &wall, &error), TALUS_OK);
    EXPECT_TRUE(wall.is_barrier);
    EXPECT_TRUE(wall.hit);
    ASSERT_EQ(talus_get_structure(slippery.get(), 0, &house, &error), TALUS_OK);
    EXPECT_FALSE(house.hit) << "the wall is before it";
    ASSERT_EQ(talus_get_structure(rough.get(), 0, &house, &error), TALUS_OK);
    EXPECT_FALSE(house.hit) << "too rough to come so far";
}

TEST(Library, opens_what_was_saved_in_the_same_state) {
    const Folder folder;
    const fs::path scene = folder.path / "scene", file = folder.path / "saved.json";
    const Simulation simulation = Slope().open(scene.c_str());
    talus_error error = TALUS_SIZED(talus_error);
    advance_to(simulation, 1);
    ASSERT_EQ(talus_set(simulation.get(), "material.friction_coefficient", 0.3, &error), TALUS_OK) << error.text;
    advance_to(simulation, 2);
    ASSERT_EQ(talus_save(simulation.get(), file.c_str(), &error), TALUS_OK) << error.text;
    talus_simulation* opened = nullptr;
    ASSERT_EQ(talus_open_saved(file.c_str(), nullptr, &opened, &error), TALUS_OK) << error.text;
    const Simulation again(opened);
    EXPECT_EQ(state_of(again).time, state_of(simulation).time);
    EXPECT_EQ(hash_of(again), hash_of(simulation));
    for (const Simulation* each : {&simulation, &again}) advance_to(*each, 3);
    EXPECT_EQ(hash_of(again), hash_of(simulation)) << "and goes on in the same way";

    const fs::path results = folder.path / "results";
    ASSERT_EQ(talus_write_results(again.get(), results.c_str(), &error), TALUS_OK) << error.text;
    EXPECT_TRUE(fs::exists(results / "report.html"));
    EXPECT_EQ(talus_write_results(again.get(), results.c_str(), &error), TALUS_BAD_INPUT) << "it is not empty any more";
    // The same scene from its file.
    talus_simulation* from_file = nullptr;
    ASSERT_EQ(talus_open((scene / "scene.toml").c_str(), nullptr, 0, nullptr, &from_file, &error), TALUS_OK)
        << error.text;
    talus_close(from_file);
    const Slope slope;
    EXPECT_EQ(talus_open_arrays(&slope.arrays, scene.c_str(), nullptr, 0, nullptr, &from_file, &error),
              TALUS_BAD_INPUT);
}

TEST(Library, opens_no_saved_simulation_whose_settings_name_another_file) {
    const Folder folder;
    const fs::path scene = folder.path / "scene", file = folder.path / "saved.json";
    talus_error error = TALUS_SIZED(talus_error);
    {
        const Simulation simulation = Slope().open(scene.c_str());
        ASSERT_EQ(talus_save(simulation.get(), file.c_str(), &error), TALUS_OK) << error.text;
    }
    std::ifstream saved(file);
    const std::string text{std::istreambuf_iterator<char>(saved), {}};
    std::ofstream(file) << std::regex_replace(text, std::regex(R"("overrides"\s*:\s*\[[^\]]*\])"),
                                              R"("overrides": ["terrain.file=/etc/passwd"])");
    talus_simulation* none = nullptr;
    ASSERT_EQ(talus_open_saved(file.c_str(), nullptr, &none, &error), TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text)
                  .find("terrain.file: the session sets a file that its scene does not name, "
                        "/etc/passwd"),
              std::string::npos)
        << error.text;
}

TEST(Library, has_symbols_of_the_version_that_its_header_says) {
    const std::string version =
        "TALUS_" + std::to_string(TALUS_VERSION_MAJOR) + "." + std::to_string(TALUS_VERSION_MINOR);
    EXPECT_NE(dlvsym(RTLD_DEFAULT, "talus_step", version.c_str()), nullptr) << version;
    EXPECT_EQ(dlvsym(RTLD_DEFAULT, "talus_step", "TALUS_0.0"), nullptr);
    const std::string name = "libtalus.so." + version.substr(6);
    EXPECT_NE(dlopen(name.c_str(), RTLD_NOLOAD | RTLD_NOW), nullptr) << name << " is what programs are linked to";
}

TEST(Library, reading_leaves_what_was_read_before_valid) {
    const Simulation simulation = Slope().open();
    advance_to(simulation, 3);
    talus_error error = TALUS_SIZED(talus_error);
    talus_map first = TALUS_SIZED(talus_map), second = first, other = first;
    ASSERT_EQ(talus_get_map(simulation.get(), "depth", &first, &error), TALUS_OK);
    ASSERT_EQ(talus_get_map(simulation.get(), "peak_depth", &other, &error), TALUS_OK);
    ASSERT_EQ(talus_get_map(simulation.get(), "depth", &second, &error), TALUS_OK);
    EXPECT_EQ(first.values, second.values);
    const char *scene = nullptr, *state = nullptr, *again = nullptr;
    ASSERT_EQ(talus_get_json(simulation.get(), "scene", &scene, &error), TALUS_OK);
    const std::string before = scene;
    ASSERT_EQ(talus_get_json(simulation.get(), "state", &state, &error), TALUS_OK);
    ASSERT_EQ(talus_get_json(simulation.get(), "scene", &again, &error), TALUS_OK);
    EXPECT_EQ(scene, again);
    EXPECT_EQ(before, scene);
    // A map of another time is another answer.
    const std::vector<float> then(first.values, first.values + first.grid.columns * first.grid.rows);
    advance_to(simulation, 4);
    ASSERT_EQ(talus_get_map(simulation.get(), "depth", &second, &error), TALUS_OK);
    float change = 0;
    for (std::size_t k = 0; k < then.size(); ++k) {
        if (std::isfinite(then[k]) && std::isfinite(second.values[k])) change += std::fabs(then[k] - second.values[k]);
    }
    EXPECT_GT(change, 0);
}

/// Counts the calls, and cancels the one of a number.
struct Counter {
    int calls = 0, cancel_at = -1;
    std::vector<double> shares{};
    talus_simulation* simulation = nullptr;
    int codes[2] = {-1, -1};  // of reading and of changing the simulation in the call
    talus_progress progress{sizeof(talus_progress), &Counter::call, this};

    static int call(void* user, double share) {
        Counter& self = *static_cast<Counter*>(user);
        self.shares.push_back(share);
        if (self.simulation != nullptr) {
            talus_state state = TALUS_SIZED(talus_state);
            self.codes[0] = talus_get_state(self.simulation, &state, nullptr);
            self.codes[1] = talus_step(self.simulation, 1, nullptr, nullptr);
        }
        return self.calls++ == self.cancel_at ? 1 : 0;
    }
};

TEST(Library, says_what_a_run_has_measured_without_writing_files) {
    const Simulation simulation = Slope().open();
    advance_to(simulation, 3);
    const auto read = [&](const char* name) {
        const char* text = nullptr;
        talus_error error = TALUS_SIZED(talus_error);
        EXPECT_EQ(talus_get_json(simulation.get(), name, &text, &error), TALUS_OK) << error.text;
        return std::string(text == nullptr ? "" : text);
    };
    const std::string measures = read("measures"), results = read("results");
    const auto number = [&](const std::string& key) {
        const std::size_t at = measures.find("\"" + key + "\":");
        return at == std::string::npos ? std::nan("") : std::atof(measures.c_str() + at + key.size() + 3);
    };
    EXPECT_GT(number("run_out_along_flow_m"), 1);
    EXPECT_GT(number("run_out_along_flow_m"), 0.9 * number("run_out_straight_m"));
    EXPECT_GT(number("drop_m"), 1);
    EXPECT_NE(measures.find("PROJCRS"), std::string::npos);
    EXPECT_NE(measures.find("\"gauges\":[]"), std::string::npos);
    EXPECT_NE(results.find("\"format\":\"talus results\""), std::string::npos);
}

TEST(Library, tells_how_far_a_call_is_and_ends_it_when_it_is_told_to) {
    const Simulation whole = Slope().open(), parted = Slope().open();
    talus_error error = TALUS_SIZED(talus_error);
    advance_to(whole, 5);
    Counter counter;
    counter.cancel_at = 1;
    counter.simulation = parted.get();
    EXPECT_EQ(talus_advance(parted.get(), 5, &counter.progress, &error), TALUS_CANCELLED) << error.text;
    EXPECT_EQ(counter.calls, 2);
    EXPECT_EQ(counter.codes[0], TALUS_OK) << "it can be read in the call";
    EXPECT_EQ(counter.codes[1], TALUS_BAD_INPUT) << "and not changed";
    EXPECT_LT(state_of(parted).time, 5);
    EXPECT_EQ(state_of(parted).phase, TALUS_READY);
    counter.cancel_at = -1;
    counter.shares.clear();
    ASSERT_EQ(talus_advance(parted.get(), 5, &counter.progress, &error), TALUS_OK) << error.text;
    EXPECT_EQ(hash_of(whole), hash_of(parted)) << "it went on as if nothing had been";
    for (std::size_t k = 0; k < counter.shares.size(); ++k) {
        EXPECT_GE(counter.shares[k], k == 0 ? 0 : counter.shares[k - 1]);
        EXPECT_LE(counter.shares[k], 1);
    }
    Counter at_once;
    at_once.cancel_at = 0;
    EXPECT_EQ(talus_step(parted.get(), std::numeric_limits<std::uint64_t>::max(), &at_once.progress, &error),
              TALUS_CANCELLED);
    const Folder folder;
    const Slope slope;
    talus_simulation* none = nullptr;
    for (int call = 0; call < 3; ++call) {
        Counter opening;
        opening.cancel_at = call;
        const int code = talus_open_arrays(&slope.arrays, (folder.path / "scene").c_str(), nullptr, 0,
                                           &opening.progress, &none, &error);
        if (code == TALUS_OK) break;  // it was quick
        EXPECT_EQ(code, TALUS_CANCELLED) << error.text;
        EXPECT_EQ(none, nullptr);
        EXPECT_FALSE(fs::exists(folder.path / "scene"));
    }
    talus_close(std::exchange(none, nullptr));
    Counter never;
    never.cancel_at = 0;
    EXPECT_EQ(talus_open(nullptr, nullptr, 0, &never.progress, &none, &error), TALUS_CANCELLED);
    EXPECT_EQ(none, nullptr);
}

TEST(Library, steps_two_simulations_in_two_threads) {
    const Simulation alone = Slope().open();
    advance_to(alone, 3);
    std::vector<std::uint64_t> hashes(2);
    {
        std::vector<std::jthread> threads;
        for (std::uint64_t& hash : hashes) {
            threads.emplace_back([&hash] {
                const Simulation simulation = Slope().open(nullptr, "solver.thread_count=2");
                advance_to(simulation, 3);
                hash = hash_of(simulation);
            });
        }
    }
    EXPECT_EQ(hashes[0], hash_of(alone));
    EXPECT_EQ(hashes[1], hash_of(alone));
}

}  // namespace
}  // namespace talus::embed::test
