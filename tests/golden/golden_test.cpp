#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/hash.hpp"
#include "golden/hash_of.hpp"
#include "run/run_scene.hpp"
#include "scene/scene.hpp"
#include "simd/dispatch.hpp"
#include "support/value_of.hpp"

/// Small runs whose results are known to the bit. golden_hashes.json is the table: what is run, and the hashes.
namespace talus::run {
namespace {

using Json = nlohmann::ordered_json;

std::string in_source(const std::string& path) {
    return std::string(TALUS_SOURCE_DIR) + "/" + path;
}
const char* const table = "tests/golden/golden_hashes.json";

Json read_table() {
    std::ifstream file(in_source(table));
    return Json::parse(file);
}

/// How the table comes to be, for whoever finds that it does not hold.
const char* const what_to_do =
    "Results must not change without a reason. If this change is meant, GOLDEN_REMAKE=1 build/release/bin/test_golden "
    "writes the table again; say in the commit which results changed and why. If nothing was changed, run the test on "
    "the commit before: another compiler or C library may round otherwise (docs/testing.md)";

struct Hashes {
    std::string motion, measurements;
};

/// With GOLDEN_REMAKE the first result of a run becomes the table's.
void expect_in_table(const std::string& name, const Hashes& hashes, const std::string& with) {
    static std::vector<std::string> remade;
    if (std::getenv("GOLDEN_REMAKE") != nullptr && std::find(remade.begin(), remade.end(), name) == remade.end()) {
        Json all = read_table();
        all[name]["motion"] = hashes.motion;
        all[name]["measurements"] = hashes.measurements;
        std::ofstream(in_source(table)) << all.dump(2) << "\n";
        remade.push_back(name);
    }
    const Json row = read_table().at(name);
    EXPECT_EQ(hashes.motion, row.at("motion"))
        << table << ": " << name << ": positions and velocities at the end are not those of the table, with " << with
        << ". " << what_to_do;
    EXPECT_EQ(hashes.measurements, row.at("measurements"))
        << table << ": " << name << ": maps, structures or volumes are not those of the table, with " << with << ". "
        << what_to_do;
}

std::vector<std::string> names() {
    std::vector<std::string> all;
    const Json rows = read_table();
    for (const auto& row : rows.items()) all.push_back(row.key());
    return all;
}

/// A run of the table on an instruction set.
class Golden : public testing::TestWithParam<std::tuple<std::string, const char*>> {
  protected:
    void TearDown() override { ASSERT_TRUE(simd::choose_instruction_set(simd::instruction_sets().front())); }

    static RunResult result_on(const Json& row, int threads) {
        auto set = row.at("set").get<std::vector<std::string>>();
        set.push_back(fmt::format("solver.thread_count={}", threads));
        const std::string file = in_source(row.at("scene").get<std::string>());
        return test::value_of(run_scene(test::value_of(scene::load_scene(file, set)), {}));
    }
};

TEST_P(Golden, has_the_known_result_on_any_number_of_threads) {
    const auto& [name, instruction_set] = GetParam();
    const Json row = read_table().at(name);
    const bool on_host = row.at("set").dump().find("backend=host") != std::string::npos;
    if (const Status chosen = simd::choose_instruction_set(instruction_set); !chosen) {
        GTEST_SKIP() << chosen.error().message;
    }
    if (on_host && simd::instruction_sets().front() != instruction_set) {
        GTEST_SKIP() << "the kernels of a card, as plain loops, have no instruction set";
    }
    for (const int threads : {1, 2, 3}) {
        const RunResult result = result_on(row, threads);
        ASSERT_EQ(result.thread_count, threads);
        if (!on_host) {
            ASSERT_EQ(result.instruction_set, instruction_set);
        }
        expect_in_table(name, {to_hex(result.hash), test::hash_of(result.observation)},
                        fmt::format("{} on {} threads", instruction_set, threads));
    }
}

INSTANTIATE_TEST_SUITE_P(Table, Golden,
                         ::testing::Combine(::testing::ValuesIn(names()),
                                            ::testing::Values("AVX3", "AVX2", "SSE4", "SCALAR")),
                         [](const auto& run) { return std::get<0>(run.param) + "_" + std::get<1>(run.param); });

/// A table of runs in which nothing happens would hold whatever is broken.
TEST(GoldenScenes, contain_what_they_are_named_after) {
    const auto observed = [](const char* name) {
        const std::string file = in_source(std::string("tests/golden/scenes/") + name + ".toml");
        return test::value_of(run_scene(test::value_of(scene::load_scene(file)), {})).observation;
    };
    const observe::Observation hit = observed("barrier_and_houses");
    EXPECT_EQ(observe::hits_among(hit.buildings, true).hit, 1U);
    EXPECT_GE(observe::hits_among(hit.buildings, false).hit, 1U);
    EXPECT_GT(hit.buildings.back().overtopped_volume, 1) << hit.buildings.back().name;

    const observe::Observation grown = observed("entrainment_and_inflow");
    EXPECT_GT(grown.timeseries.back().volume_entrained, 10);
    EXPECT_GT(grown.timeseries.back().volume_released, 250) << "150 m3 and the inflow";

    const observe::BuildingImpact net = observed("net").buildings.at(0);
    EXPECT_GT(net.passed_volume, 1) << "through its meshes";
    EXPECT_GT(net.failure_time, 0) << "it breaks";

    const observe::Observation grid = observed("depth_averaged");
    EXPECT_GT(grid.timeseries.back().volume_entrained, 10);
    EXPECT_GE(observe::hits_among(grid.buildings, false).hit, 1U);
}

}  // namespace
}  // namespace talus::run
