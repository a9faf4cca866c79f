#include "twin/recorded_flow.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "geo/gltf_file.hpp"
#include "products/series.hpp"
#include "run/run_scene.hpp"
#include "support/fixtures.hpp"
#include "support/value_of.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using ::testing::HasSubstr;

geo::GltfFile opened(const std::filesystem::path& file) {
    return talus::test::value_of(geo::GltfFile::open(file.string()));
}

/// The meshes of the debris, in the order of time.
std::vector<json> debris_in(const geo::GltfFile& glb) {
    std::vector<json> meshes;
    for (const json& mesh : glb.root()["meshes"]) {
        if (mesh["name"].get<std::string>().starts_with("debris")) meshes.push_back(mesh);
    }
    return meshes;
}

void expect_same_positions(const geo::GltfFile& one, const json& mesh, const geo::GltfFile& other, const json& its) {
    EXPECT_EQ(mesh["name"], its["name"]);
    const auto positions = [](const geo::GltfFile& file, const json& of) {
        return *file.accessor(of["primitives"][0]["attributes"]["POSITION"]);
    };
    const geo::GltfAccessor a = positions(one, mesh), b = positions(other, its);
    ASSERT_EQ(a.count, b.count);
    ASSERT_GT(a.count, 20U);
    double farthest = 0;
    for (std::size_t k = 0; k < a.count; ++k) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            farthest = std::max(farthest, std::abs(a.at(k, axis) - b.at(k, axis)));
        }
    }
    EXPECT_LT(farthest, 1e-3) << "more than the steps of recorded depths";
}

bool never_ends(double) {
    return true;
}

TEST(RecordedFlow, has_the_debris_that_a_run_writes_of_the_same_times) {
    const talus::test::TemporaryFolder folder;
    scene::Scene scene = channel_scene();
    scene.spec.solver.end_time = 5;
    scene.spec.outputs.series = {"gltf"};
    const auto live = open(scene);
    run_until(*live, 100);

    products::Series series(scene, folder.path() / "run");
    run::RunOptions options;
    options.on_frame = [&](const run::Frame& frame) { ASSERT_TRUE(series.add(frame)); };
    const auto result = run::run_scene(scene, options);
    ASSERT_TRUE(result) << result.error().message;
    ASSERT_THAT(series.finish(*result), ::testing::IsEmpty());

    std::filesystem::create_directory(folder.path() / "live");
    const auto flow = recorded_flow_of(*live);
    const json offer = flow->describe(1);
    double told = 0;
    const Status written = flow->write({"gltf"}, 1, folder.path() / "live", [&](double share) {
        EXPECT_GE(share, told);
        told = share;
        return share <= 1;
    });
    ASSERT_TRUE(written) << written.error().message;
    EXPECT_GT(told, 0.9);

    const geo::GltfFile of_run = opened(folder.path() / "run" / "run.glb");
    const geo::GltfFile of_live = opened(folder.path() / "live" / "run.glb");
    const auto one = debris_in(of_run), other = debris_in(of_live);
    ASSERT_EQ(one.size(), other.size());
    ASSERT_GE(one.size(), 5U);
    expect_same_positions(of_run, one.front(), of_live, other.front());
    expect_same_positions(of_run, one[one.size() / 2], of_live, other[one.size() / 2]);
    expect_same_positions(of_run, one.back(), of_live, other.back());

    EXPECT_EQ(offer["frames"], one.size());
    EXPECT_EQ(offer["formats"][0]["frames"], one.size());
    EXPECT_EQ(offer["to_s"], live->time());
    const auto bytes = static_cast<double>(std::filesystem::file_size(folder.path() / "live" / "run.glb"));
    EXPECT_GT(offer["formats"][0]["bytes"].get<double>(), bytes / 3) << bytes;
    EXPECT_LT(offer["formats"][0]["bytes"].get<double>(), bytes * 3) << bytes;
}

TEST(RecordedFlow, shows_a_change_on_the_way) {
    const talus::test::TemporaryFolder folder;
    const auto changed = open(channel_scene()), unchanged = open(channel_scene());
    run_until(*changed, 2);
    run_until(*unchanged, 6);
    act(*changed, {{"action", "put_barrier"},
                   {"line", {{west + 35, south + 15}, {west + 35, south + 45}}},
                   {"height_m", 5},
                   {"thickness_m", 1.5}});
    run_until(*changed, 6);
    const auto easternmost = [&](const Scenario& scenario, const char* name) {
        std::filesystem::create_directory(folder.path() / name);
        EXPECT_TRUE(recorded_flow_of(scenario)->write({"gltf"}, 1, folder.path() / name, never_ends));
        const geo::GltfFile glb = opened(folder.path() / name / "run.glb");
        const json last = debris_in(glb).back();
        return glb.root()["accessors"][last["primitives"][0]["attributes"]["POSITION"].get<std::size_t>()]["max"][0]
            .get<double>();
    };
    EXPECT_LT(easternmost(*changed, "changed"), easternmost(*unchanged, "unchanged") - 5);
}

TEST(RecordedFlow, writes_maps_and_a_tileset_beside_the_animation) {
    const talus::test::TemporaryFolder folder;
    const auto live = open(channel_scene());
    run_until(*live, 2);
    const Status local = recorded_flow_of(*live)->write({"3dtiles"}, 1, folder.path(), never_ends);
    ASSERT_FALSE(local);
    EXPECT_THAT(local.error().message, HasSubstr("local"));
    const Status written =
        recorded_flow_of(*live)->write({"gltf", "geotiff", "netcdf"}, 0.5, folder.path(), never_ends);
    ASSERT_TRUE(written) << written.error().message;
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
        names.push_back(entry.path().filename().string());
    }
    EXPECT_THAT(names, ::testing::UnorderedElementsAre("run.glb", "depth.tif", "speed.tif", "pressure.tif", "maps.nc"));
}

TEST(RecordedFlow, ends_when_it_is_cancelled) {
    const talus::test::TemporaryFolder folder;
    const auto live = open(channel_scene());
    run_until(*live, 3);
    for (const double limit : {0.0, 0.05, 0.5}) {
        int asked_after = 0;
        const Status ended = recorded_flow_of(*live)->write({"gltf", "netcdf"}, 0.1, folder.path(), [&](double share) {
            asked_after += share > limit;
            return share <= limit;
        });
        ASSERT_FALSE(ended) << limit;
        EXPECT_THAT(ended.error().message, HasSubstr("cancelled"));
        EXPECT_EQ(asked_after, 1) << "it went on after it was told to end";
        EXPECT_FALSE(std::filesystem::exists(folder.path() / "maps.nc"));
    }
}

TEST(RecordedFlow, is_refused_with_the_reason) {
    const auto live = open(channel_scene());
    const json before = recorded_flow_of(*live)->describe(1);
    EXPECT_THAT(before["formats"][0]["refused"], HasSubstr("nothing has moved yet"));
    EXPECT_THAT(recorded_flow_of(*live)->check({"gltf"}, 1).error().message, HasSubstr("nothing has moved yet"));
    run_until(*live, 1);
    const auto flow = recorded_flow_of(*live);
    EXPECT_FALSE(flow->describe(1).formats[0].refused);
    EXPECT_THAT(flow->describe(1).formats[1].refused.value_or(""), HasSubstr("local"));
    EXPECT_THAT(flow->check({}, 1).error().message, HasSubstr("at least one"));
    EXPECT_THAT(flow->check({"gltf", "usd"}, 1).error().message, HasSubstr("gltf, 3dtiles, geotiff, netcdf"));
    EXPECT_THAT(flow->check({"gltf", "netcdf", "gltf"}, 1).error().message, HasSubstr("\"gltf\" is there twice"));
    EXPECT_EQ(flow->check(std::vector<std::string>(5, "gltf"), 1).error().message,
              "formats has 5 names; there are 4 formats");
    EXPECT_LE(flow->describe(0.001).frames.value, 12) << "more than is recorded";
}

}  // namespace
}  // namespace talus::twin::test
