#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/hash.hpp"
#include "golden/hash_of.hpp"
#include "pack/pack.hpp"
#include "run/run_scene.hpp"
#include "scene/scene.hpp"
#include "support/value_of.hpp"

namespace talus::pack {
namespace {

using nlohmann::json;

json table() {
    std::ifstream file(TALUS_SOURCE_DIR "/tests/golden/golden_hashes.json");
    return json::parse(file);
}

std::string packed_scene(const json& row) {
    const auto set = row.at("set").get<std::vector<std::string>>();
    const scene::Scene scene =
        test::value_of(scene::load_scene(TALUS_SOURCE_DIR "/" + row.at("scene").get<std::string>(), set));
    return write({.scene = scene, .overrides = set});
}

class GoldenScene : public testing::TestWithParam<std::string> {};

TEST_P(GoldenScene, has_the_known_result_after_packing) {
    const json row = table().at(GetParam());
    const std::string bytes = packed_scene(row);
    // For the page's engine, which runs them again: scripts/test.sh publish.
    if (const char* folder = std::getenv("TALUS_PACKS_TO")) {
        std::ofstream(std::filesystem::path(folder) / (GetParam() + ".talus"), std::ios::binary) << bytes;
        return;
    }
    const auto packed = read(std::as_bytes(std::span(bytes)), "scene.talus");
    ASSERT_TRUE(packed) << packed.error().message;
    const auto result = run::run_scene(packed->scene, {});
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(to_hex(result->hash), row.at("motion"));
    EXPECT_EQ(test::hash_of(result->observation), row.at("measurements"));
}

std::vector<std::string> names() {
    std::vector<std::string> all;
    const json rows = table();
    for (const auto& [name, row] : rows.items()) {
        if (row.at("set").dump().find("backend=host") == std::string::npos) all.push_back(name);
    }
    return all;
}

INSTANTIATE_TEST_SUITE_P(Table, GoldenScene, testing::ValuesIn(names()), [](const auto& run) { return run.param; });

}  // namespace
}  // namespace talus::pack
