// What libtalus refuses: NULL, wrong sizes and numbers, files that are none.
#include <cmath>
#include <fstream>
#include <limits>
#include <sys/stat.h>
#include <utility>

#include "embed_fixtures.hpp"

namespace talus::embed::test {
namespace {

TEST(Library, refuses_NULL_everywhere_with_one_code) {
    const Simulation open = Slope().open();
    const Slope slope;
    talus_simulation *simulation = open.get(), *made = nullptr;
    talus_state state = TALUS_SIZED(talus_state);
    talus_debris debris = TALUS_SIZED(talus_debris);
    talus_map map = TALUS_SIZED(talus_map);
    talus_front front = TALUS_SIZED(talus_front);
    talus_structure structure = TALUS_SIZED(talus_structure);
    const talus_progress no_call = TALUS_SIZED(talus_progress);
    talus_surface surface = TALUS_SIZED(talus_surface);
    const talus_grid grid{0, 0, 1, 10, 10};
    const double place[] = {10, 10};
    double height = 0;
    talus_snapshot* snapshot = nullptr;
    const char* text = nullptr;
    std::uint64_t hash = 0;
    talus_error e = TALUS_SIZED(talus_error);
    const auto refused = [&](int code, const char* argument) {
        EXPECT_EQ(code, TALUS_BAD_INPUT) << argument;
        EXPECT_EQ(e.code, TALUS_BAD_INPUT) << argument;
        EXPECT_EQ(std::string(e.text), argument + std::string(" is NULL"));
    };
    refused(talus_open(nullptr, nullptr, 0, nullptr, nullptr, &e), "simulation");
    refused(talus_open(nullptr, nullptr, 2, nullptr, &made, &e), "settings");
    refused(talus_open(nullptr, nullptr, 0, &no_call, &made, &e), "progress.call");
    refused(talus_open_arrays(nullptr, nullptr, nullptr, 0, nullptr, &made, &e), "arrays");
    refused(talus_open_arrays(&slope.arrays, nullptr, nullptr, 0, nullptr, nullptr, &e), "simulation");
    refused(talus_open_saved(nullptr, nullptr, &made, &e), "file");
    refused(talus_open_saved("/tmp/saved.json", nullptr, nullptr, &e), "simulation");
    refused(talus_step(nullptr, 1, nullptr, &e), "simulation");
    refused(talus_advance(nullptr, 1, nullptr, &e), "simulation");
    refused(talus_get_state(nullptr, &state, &e), "simulation");
    refused(talus_get_state(simulation, nullptr, &e), "state");
    refused(talus_get_hash(nullptr, &hash, &e), "simulation");
    refused(talus_get_hash(simulation, nullptr, &e), "hash");
    refused(talus_get_debris(nullptr, &debris, &e), "simulation");
    refused(talus_get_debris(simulation, nullptr, &e), "debris");
    refused(talus_get_map(nullptr, "depth", &map, &e), "simulation");
    refused(talus_get_map(simulation, nullptr, &map, &e), "name");
    refused(talus_get_map(simulation, "depth", nullptr, &e), "map");
    refused(talus_get_map_on(nullptr, "depth", &grid, &map, &e), "simulation");
    refused(talus_get_map_on(simulation, nullptr, &grid, &map, &e), "name");
    refused(talus_get_map_on(simulation, "depth", nullptr, &map, &e), "grid");
    refused(talus_get_map_on(simulation, "depth", &grid, nullptr, &e), "map");
    refused(talus_get_debris_at(nullptr, 0, &debris, &e), "simulation");
    refused(talus_get_debris_at(simulation, 0, nullptr, &e), "debris");
    refused(talus_get_elevation(nullptr, 1, 1, &height, &e), "simulation");
    refused(talus_get_elevation(simulation, 1, 1, nullptr, &e), "elevation");
    refused(talus_get_elevations(nullptr, place, 1, &height, &e), "simulation");
    refused(talus_get_elevations(simulation, nullptr, 1, &height, &e), "x_y");
    refused(talus_get_elevations(simulation, place, 1, nullptr, &e), "elevations");
    refused(talus_get_surface(nullptr, &surface, &e), "simulation");
    refused(talus_get_surface(simulation, nullptr, &e), "surface");
    refused(talus_fork(nullptr, &made, &e), "simulation");
    refused(talus_fork(simulation, nullptr, &e), "fork");
    refused(talus_take_snapshot(nullptr, &snapshot, &e), "simulation");
    refused(talus_take_snapshot(simulation, nullptr, &e), "snapshot");
    refused(talus_restore(nullptr, snapshot, &e), "simulation");
    refused(talus_restore(simulation, nullptr, &e), "snapshot");
    refused(talus_get_front(nullptr, &front, &e), "simulation");
    refused(talus_get_front(simulation, nullptr, &e), "front");
    refused(talus_get_structure(nullptr, 0, &structure, &e), "simulation");
    refused(talus_get_structure(simulation, 0, nullptr, &e), "structure");
    refused(talus_set(nullptr, "material.friction_coefficient", 0.3, &e), "simulation");
    refused(talus_set(simulation, nullptr, 0.3, &e), "key");
    refused(talus_apply(nullptr, "{}", nullptr, &e), "simulation");
    refused(talus_apply(simulation, nullptr, nullptr, &e), "action");
    refused(talus_get_json(nullptr, "state", &text, &e), "simulation");
    refused(talus_get_json(simulation, nullptr, &text, &e), "name");
    refused(talus_get_json(simulation, "state", nullptr, &e), "json");
    refused(talus_write_results(nullptr, "/tmp/results", &e), "simulation");
    refused(talus_write_results(simulation, nullptr, &e), "folder");
    refused(talus_save(nullptr, "/tmp/saved.json", &e), "simulation");
    refused(talus_save(simulation, nullptr, &e), "file");
    EXPECT_EQ(made, nullptr);
    EXPECT_EQ(snapshot, nullptr);
    talus_close(nullptr);
    talus_drop_snapshot(nullptr);
}

TEST(Library, refuses_a_struct_that_does_not_say_its_size) {
    const Simulation simulation = Slope().open();
    talus_error error = TALUS_SIZED(talus_error);
    for (const std::size_t size : {std::size_t{0}, sizeof(talus_state) - 8, std::size_t{1} << 40U}) {
        talus_state state{};
        state.size = size;
        EXPECT_EQ(talus_get_state(simulation.get(), &state, &error), TALUS_BAD_INPUT);
        EXPECT_NE(std::string(error.text).find("state.size = " + std::to_string(size)), std::string::npos)
            << error.text;
        EXPECT_EQ(state.time, 0) << "nothing is written";
        talus_error wrong{};
        wrong.size = size;
        EXPECT_EQ(talus_step(simulation.get(), 1, nullptr, &wrong), TALUS_BAD_INPUT);
    }
    EXPECT_EQ(state_of(simulation).steps, 0U);
    // A struct of a later version, with members that this one does not have.
    struct Later {
        talus_state known;
        int more;
    } later{};
    later.known.size = sizeof later;
    later.more = 7;
    ASSERT_EQ(talus_get_state(simulation.get(), &later.known, &error), TALUS_OK) << error.text;
    EXPECT_EQ(later.known.size, sizeof later);
    EXPECT_EQ(later.known.structure_count, 1U);
    EXPECT_EQ(later.more, 7);
    // Buildings lie as far apart as their size says.
    struct LaterBuilding {
        talus_building known;
        double more;
    };
    Slope slope;
    LaterBuilding houses[2] = {{slope.house, 0}, {slope.house, 0}};
    const double north[] = {40, 22, 46, 22, 46, 26, 40, 26};
    houses[1].known.x_y = north;
    houses[1].known.name = "barn";
    for (LaterBuilding& each : houses) each.known.size = sizeof(LaterBuilding);
    slope.arrays.buildings = &houses[0].known;
    slope.arrays.building_count = 2;
    const Simulation two = slope.open();
    talus_structure barn = TALUS_SIZED(talus_structure);
    ASSERT_EQ(talus_get_structure(two.get(), 1, &barn, &error), TALUS_OK) << error.text;
    EXPECT_STREQ(barn.name, "barn");
}

TEST(Library, names_the_argument_that_is_wrong_and_no_file) {
    const float nan = std::nanf(""), infinite = std::numeric_limits<float>::infinity();
    const auto refused = [](Slope& slope, const std::string& sentence) {
        talus_error error = TALUS_SIZED(talus_error);
        talus_simulation* none = nullptr;
        EXPECT_EQ(talus_open_arrays(&slope.arrays, nullptr, nullptr, 0, nullptr, &none, &error), TALUS_BAD_INPUT);
        EXPECT_EQ(std::string(error.text).substr(0, sentence.size()), sentence) << error.text;
        EXPECT_EQ(std::string(error.text).find("/tmp"), std::string::npos) << error.text;
        EXPECT_EQ(std::string(error.text).find("scene.toml"), std::string::npos) << error.text;
        EXPECT_EQ(none, nullptr);
    };
    for (const auto& [height, shown] : {std::pair{0.0, "0"}, {-3.0, "-3"}, {double{nan}, "nan"}, {1001.0, "1001"}}) {
        Slope slope;
        slope.house.height = height;
        refused(slope, "buildings[0].height = " + std::string(shown) + ": must be greater than 0");
    }
    Slope slope;
    slope.outline[3] = nan;
    refused(slope, "buildings[0].x_y[3] = nan");
    slope = Slope();
    slope.house.point_count = 2;
    slope.arrays.buildings = &slope.house;
    refused(slope, "buildings[0].point_count = 2");
    const auto with = [&](const auto& change, const std::string& sentence) {
        Slope changed;
        change(changed);
        refused(changed, sentence);
    };
    with([&](Slope& s) { s.elevation[61] = infinite; }, "elevation[1, 1] = inf: must be -12000 to 9000 (m), or NaN");
    with([&](Slope& s) { s.elevation[61] = 30'000; }, "elevation[1, 1] = 30000: must be");
    with([&](Slope& s) { s.elevation.assign(s.elevation.size(), nan); }, "elevation: is NaN everywhere");
    with([&](Slope& s) { s.release[62] = -1; }, "release[1, 2] = -1: must be a thickness in m, 0 or more");
    with([&](Slope& s) { s.release[0] = nan; }, "release[0, 0] = nan");
    with([&](Slope& s) { s.release.assign(s.release.size(), 0); }, "release: is 0 everywhere");
    with([&](Slope& s) { s.arrays.grid.cell = nan; }, "grid.cell = nan");
    with([&](Slope& s) { s.arrays.grid.x_min = nan; }, "grid.x_min = nan");
    with([&](Slope& s) { s.arrays.grid.columns = s.arrays.grid.rows = 1 << 20; }, "grid: has 1048576 x 1048576 cells");
    with([&](Slope& s) { s.arrays.building_count = std::size_t{1} << 40U; }, "building_count = 1099511627776");
    with(
        [&](Slope& s) {
            for (double& c : s.outline) c += 1e6;
        },
        "buildings: none of 1 has a corner on the grid, x 0 to 60, y 0 to 30");

    const Simulation simulation = Slope().open();
    talus_error error = TALUS_SIZED(talus_error);
    EXPECT_EQ(talus_advance(simulation.get(), nan, nullptr, &error), TALUS_BAD_INPUT);
    EXPECT_STREQ(error.text, "time = nan: must be 0 or more");
    EXPECT_EQ(talus_advance(simulation.get(), -1, nullptr, &error), TALUS_BAD_INPUT);
    EXPECT_EQ(talus_set(simulation.get(), "material.friction_coefficient", nan, &error), TALUS_BAD_INPUT);
    EXPECT_STREQ(error.text, "material.friction_coefficient = nan: must be a finite number");
    EXPECT_EQ(state_of(simulation).steps, 0U);
    for (const char* action : {R"({"action": "put_barrier", "line": [[1e300, 5], [35, 25]], "height_m": 4})",
                               R"({"action": "put_inflow", "line": [[1e300, 5], [1e300, 25]],
                                   "hydrograph": [[0, 1, 1], [1, 2, 1]]})"}) {
        EXPECT_EQ(talus_apply(simulation.get(), action, nullptr, &error), TALUS_BAD_INPUT);
        EXPECT_NE(std::string(error.text).find("(1e+300, 5.0)"), std::string::npos) << error.text;
    }
    const Folder folder;
    EXPECT_EQ(talus_write_results(simulation.get(), "/dev/null", &error), TALUS_BAD_INPUT);
    EXPECT_STREQ(error.text, "/dev/null: is not a folder");
    // What is refused while it is loaded leaves its folder as it was.
    const char* wrong[] = {"material.friction_coefficient=-1"};
    talus_simulation* none = nullptr;
    const Slope good;
    EXPECT_EQ(talus_open_arrays(&good.arrays, folder.path.c_str(), wrong, 1, nullptr, &none, &error), TALUS_BAD_INPUT);
    EXPECT_TRUE(fs::is_empty(folder.path));
}

TEST(Library, opens_no_saved_simulation_from_a_device_a_folder_or_a_file_without_end) {
    const Folder folder;
    talus_simulation* none = nullptr;
    talus_error error = TALUS_SIZED(talus_error);
    const fs::path pipe = folder.path / "pipe", large = folder.path / "large.json";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    std::ofstream(large) << "{";
    fs::resize_file(large, std::uintmax_t{1} << 40U);
    for (const auto& [file, why] : {std::pair<fs::path, const char*>{"/dev/zero", "is a pipe, a socket or a device"},
                                    {pipe, "is a pipe, a socket or a device"},
                                    {folder.path, "is a folder"},
                                    {large, "has 1099511627776 bytes; a saved simulation has at most"},
                                    {folder.path / "none.json", "cannot be opened"}}) {
        EXPECT_EQ(talus_open_saved(file.c_str(), nullptr, &none, &error), TALUS_BAD_INPUT);
        EXPECT_NE(std::string(error.text).find(file.string() + ": " + why), std::string::npos) << error.text;
    }
    EXPECT_EQ(none, nullptr);
}

}  // namespace
}  // namespace talus::embed::test
