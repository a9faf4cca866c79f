// libtalus through its C interface.
#include "talus.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace {

namespace fs = std::filesystem;

struct Close {
    void operator()(talus_simulation* simulation) const { talus_close(simulation); }
};
using Simulation = std::unique_ptr<talus_simulation, Close>;

/// A slope of 1 : 2 that falls to the east, with a scar 1 m deep and a house below it.
struct Slope {
    static constexpr int columns = 60, rows = 30;
    std::vector<float> elevation, release;
    std::vector<double> outline{40, 12, 46, 12, 46, 18, 40, 18};
    talus_building house{"house", outline.data(), 4, 4};
    talus_arrays arrays{};

    Slope() {
        for (int row = 0; row < rows; ++row) {
            for (int column = 0; column < columns; ++column) {
                elevation.push_back(200 - 0.5F * static_cast<float>(column));
                const bool scar = column >= 5 && column < 15 && row >= 10 && row < 20;
                release.push_back(scar ? 1.0F : 0.0F);
            }
        }
        arrays.crs = "EPSG:32650";
        arrays.grid = {0, 0, 1, columns, rows};
        arrays.elevation = elevation.data();
        arrays.release = release.data();
        arrays.buildings = &house;
        arrays.building_count = 1;
    }

    [[nodiscard]] Simulation open(const char* folder = nullptr, const char* threads = "solver.thread_count=1") const {
        const char* settings[] = {"solver.target_particle_count=600", "material.friction_coefficient=0.2", threads};
        talus_simulation* simulation = nullptr;
        talus_error error;
        EXPECT_EQ(talus_open_arrays(&arrays, folder, settings, 3, &simulation, &error), TALUS_OK) << error.text;
        return Simulation(simulation);
    }
};

/// A new folder, removed with this.
struct Folder {
    fs::path path;
    Folder() {
        std::string name = (fs::temp_directory_path() / "talus-embed-XXXXXX").string();
        path = mkdtemp(name.data());
    }
    ~Folder() { fs::remove_all(path); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
};

void advance_to(const Simulation& simulation, double time) {
    talus_error error;
    ASSERT_EQ(talus_advance(simulation.get(), time, &error), TALUS_OK) << error.text;
}

TEST(Library, simulates_a_scene_from_arrays_and_shows_its_debris_without_a_copy) {
    const Simulation simulation = Slope().open();
    const talus_debris before = talus_get_debris(simulation.get());
    EXPECT_NEAR(static_cast<double>(before.count) * talus_particle_volume(simulation.get()), 100, 1)
        << "10 m x 10 m x 1 m";
    double origin[3];
    talus_origin(simulation.get(), origin);
    double start = 0, end = 0;
    for (std::size_t i = 0; i < before.count; ++i) start += before.x[i] + origin[0];
    EXPECT_NEAR(start / static_cast<double>(before.count), 10, 0.3) << "the middle of the scar, world";
    advance_to(simulation, 2);
    EXPECT_GE(talus_time(simulation.get()), 2);
    EXPECT_GT(talus_steps(simulation.get()), 10U);
    const talus_debris after = talus_get_debris(simulation.get());
    for (std::size_t i = 0; i < after.count; ++i) end += after.x[i] + origin[0];
    EXPECT_GT(end, start + static_cast<double>(after.count)) << "more than a metre down the slope";
}

TEST(Library, reads_maps_front_structures_and_json) {
    const Simulation simulation = Slope().open();
    advance_to(simulation, 6);
    talus_error error;
    talus_map map;
    ASSERT_EQ(talus_get_map(simulation.get(), "peak_speed", &map, &error), TALUS_OK) << error.text;
    float fastest = 0;
    for (int k = 0; k < map.grid.columns * map.grid.rows; ++k) fastest = std::fmax(fastest, map.values[k]);
    EXPECT_GT(fastest, 2);
    const talus_front front = talus_get_front(simulation.get());
    ASSERT_GT(front.count, 2U);
    EXPECT_LT(front.chainage[0], front.chainage[front.count - 1]);
    ASSERT_EQ(talus_structure_count(simulation.get()), 1U);
    talus_structure house;
    ASSERT_EQ(talus_get_structure(simulation.get(), 0, &house, &error), TALUS_OK);
    EXPECT_STREQ(house.name, "house");
    EXPECT_TRUE(house.hit);
    EXPECT_GT(house.peak_force, 1000);
    const char* text = nullptr;
    ASSERT_EQ(talus_get_json(simulation.get(), "state", &text, &error), TALUS_OK);
    EXPECT_NE(std::string(text).find("\"time_s\""), std::string::npos);
}

TEST(Library, refuses_with_a_code_and_a_sentence) {
    talus_error error;
    talus_simulation* none = nullptr;
    EXPECT_EQ(talus_open("/nowhere/scene.toml", nullptr, 0, &none, &error), TALUS_BAD_INPUT);
    EXPECT_EQ(error.code, TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("/nowhere/scene.toml"), std::string::npos) << error.text;
    EXPECT_EQ(none, nullptr);

    Slope slope;
    slope.arrays.crs = "EPSG:0";
    EXPECT_EQ(talus_open_arrays(&slope.arrays, nullptr, nullptr, 0, &none, &error), TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("EPSG:0"), std::string::npos) << error.text;
    slope = Slope();
    slope.arrays.grid.rows = 1;
    EXPECT_EQ(talus_open_arrays(&slope.arrays, nullptr, nullptr, 0, &none, nullptr), TALUS_BAD_INPUT);
    slope = Slope();
    slope.arrays.release = nullptr;
    EXPECT_EQ(talus_open_arrays(&slope.arrays, nullptr, nullptr, 0, &none, &error), TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("release"), std::string::npos) << error.text;
    slope = Slope();
    const char* wrong[] = {"material.friction_coefficient=-1"};
    EXPECT_EQ(talus_open_arrays(&slope.arrays, nullptr, wrong, 1, &none, &error), TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("friction_coefficient"), std::string::npos) << error.text;

    const Simulation simulation = Slope().open();
    const std::uint64_t hash = talus_hash(simulation.get());
    EXPECT_EQ(talus_set(simulation.get(), "material.friction_coefficient", -1, &error), TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("-1"), std::string::npos) << error.text;
    EXPECT_EQ(talus_apply(simulation.get(), "{", nullptr, &error), TALUS_BAD_INPUT);
    talus_map map;
    EXPECT_EQ(talus_get_map(simulation.get(), "depht", &map, &error), TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("peak_depth"), std::string::npos) << "names what is allowed";
    talus_structure structure;
    EXPECT_EQ(talus_get_structure(simulation.get(), 1, &structure, &error), TALUS_BAD_INPUT);
    EXPECT_EQ(talus_save(simulation.get(), "/tmp/never.json", &error), TALUS_BAD_INPUT) << "its scene is kept nowhere";
    EXPECT_EQ(talus_hash(simulation.get()), hash) << "nothing was changed";
}

TEST(Library, changes_material_and_obstacles_between_steps) {
    const Simulation slippery = Slope().open(), rough = Slope().open();
    talus_error error;
    for (const Simulation* simulation : {&slippery, &rough}) advance_to(*simulation, 1);
    EXPECT_EQ(talus_hash(slippery.get()), talus_hash(rough.get()));
    ASSERT_EQ(talus_set(rough.get(), "material.friction_coefficient", 0.6, &error), TALUS_OK) << error.text;
    const char* created = nullptr;
    ASSERT_EQ(talus_apply(slippery.get(), R"({"action": "put_barrier", "line": [[35, 5], [35, 25]], "height_m": 4})",
                          &created, &error),
              TALUS_OK)
        << error.text;
    EXPECT_STRNE(created, "");
    for (const Simulation* simulation : {&slippery, &rough}) advance_to(*simulation, 6);
    talus_structure house, wall;
    ASSERT_EQ(talus_structure_count(slippery.get()), 2U);
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
    talus_error error;
    advance_to(simulation, 1);
    ASSERT_EQ(talus_set(simulation.get(), "material.friction_coefficient", 0.3, &error), TALUS_OK) << error.text;
    advance_to(simulation, 2);
    ASSERT_EQ(talus_save(simulation.get(), file.c_str(), &error), TALUS_OK) << error.text;
    talus_simulation* opened = nullptr;
    ASSERT_EQ(talus_open_saved(file.c_str(), &opened, &error), TALUS_OK) << error.text;
    const Simulation again(opened);
    EXPECT_EQ(talus_time(again.get()), talus_time(simulation.get()));
    EXPECT_EQ(talus_hash(again.get()), talus_hash(simulation.get()));
    for (const Simulation* each : {&simulation, &again}) advance_to(*each, 3);
    EXPECT_EQ(talus_hash(again.get()), talus_hash(simulation.get())) << "and goes on in the same way";

    const fs::path results = folder.path / "results";
    ASSERT_EQ(talus_write_results(again.get(), results.c_str(), &error), TALUS_OK) << error.text;
    EXPECT_TRUE(fs::exists(results / "report.html"));
    EXPECT_EQ(talus_write_results(again.get(), results.c_str(), &error), TALUS_BAD_INPUT) << "it is not empty any more";
    // The same scene from its file.
    talus_simulation* from_file = nullptr;
    ASSERT_EQ(talus_open((scene / "scene.toml").c_str(), nullptr, 0, &from_file, &error), TALUS_OK) << error.text;
    talus_close(from_file);
    const Slope slope;
    EXPECT_EQ(talus_open_arrays(&slope.arrays, scene.c_str(), nullptr, 0, &from_file, &error), TALUS_BAD_INPUT);
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
                hash = talus_hash(simulation.get());
            });
        }
    }
    EXPECT_EQ(hashes[0], talus_hash(alone.get()));
    EXPECT_EQ(hashes[1], talus_hash(alone.get()));
}

}  // namespace
