#include "serve/ensembles.hpp"

#include <cstring>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/program.hpp"
#include "serve/serve_fixture.hpp"

namespace talus::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using serve::Ensembles;
using ::testing::HasSubstr;

/// A small scene with an ensemble of it in the folder "ens".
class EnsemblesTest : public Serve {
  protected:
    void SetUp() override {
        const auto outcome =
            run_program({"ensemble", "slope.toml", "--vary", "material.friction_coefficient=0.1:0.4", "--runs", "4",
                         "--depth-m", "0.05,0.2", "--return-period", "100", "-o", "ens", "--quiet"},
                        {.folder = scene_.folder()});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    }
    [[nodiscard]] fs::path ensemble() const { return scene_.folder() / "ens"; }
    [[nodiscard]] std::string refusal(const fs::path& folder) const {
        const auto scene = scene::load_scene(scene_.scene_file(), {});
        EXPECT_TRUE(scene);
        const auto read = Ensembles::read({folder}, *scene);
        return read ? "" : read.error().message;
    }
};

TEST_F(EnsemblesTest, are_listed_with_their_maps) {
    ensembles_ = {ensemble()};
    start();
    HttpClient eye = as_viewer();
    const json list = eye.get("/api/ensembles").json()["ensembles"];
    ASSERT_EQ(list.size(), 1U);
    EXPECT_EQ(list[0]["name"], "ens");
    EXPECT_EQ(list[0]["runs"], 4);
    EXPECT_EQ(list[0]["same_terrain"], true);
    EXPECT_EQ(list[0]["factors"][0]["key"], "material.friction_coefficient");
    const json& first = list[0]["maps"][0];
    EXPECT_EQ(first["name"], "probability_depth_0.05m");
    EXPECT_EQ(first["kind"], "probability");
    EXPECT_EQ(first["of"], "peak_depth");
    EXPECT_EQ(first["threshold"], 0.05);
    EXPECT_EQ(first["threshold_unit"], "m");
    EXPECT_EQ(first["unit"], "%");
    EXPECT_EQ(first["greatest"], 100);
    const auto named = [&](const char* name) -> json {
        for (const json& map : list[0]["maps"]) {
            if (map["name"] == name) return map;
        }
        return {};
    };
    const json odds = named("probability_intensity_medium"), zones = named("hazard_zones");
    EXPECT_EQ(odds["kind"], "probability");
    EXPECT_EQ(odds["of"], "intensity");
    EXPECT_EQ(odds["threshold"], nullptr);
    EXPECT_EQ(zones["kind"], "zones");
    EXPECT_THAT(zones["description"].get<std::string>(), HasSubstr("Swiss hazard matrix"));
    ASSERT_EQ(zones["categories"].size(), 4U);
    EXPECT_EQ(zones["categories"][3]["name"], "high (red)");
    EXPECT_EQ(zones["categories"][3]["colour"], "#c81e28");
    for (const json& map : list[0]["maps"]) {
        const Answer grid = eye.get("/api/ensembles/1/maps/" + map["name"].get<std::string>());
        ASSERT_EQ(grid.status, 200) << map.dump();
        EXPECT_EQ(grid.body.substr(0, 4), "TLSG");
    }
    EXPECT_EQ(HttpClient(port()).get("/api/ensembles/1/maps/probability_depth_0.05m").status, 401);
}

TEST_F(EnsemblesTest, nothing_else_can_be_read) {
    ensembles_ = {ensemble()};
    start();
    HttpClient eye = as_viewer();
    for (const char* path : {"2/maps/probability_depth_0.05m", "0/maps/probability_depth_0.05m", "1/maps/runs",
                             "1/maps/..%2Fens%2Fprobability_depth_0.05m", "1/maps/probability_depth_0.05m.tif",
                             "ens/maps/probability_depth_0.05m"}) {
        EXPECT_EQ(eye.get(std::string("/api/ensembles/") + path).status, 404) << path;
    }
}

TEST_F(EnsemblesTest, what_is_wrong_with_a_folder_is_said_once) {
    EXPECT_EQ(refusal(ensemble()), "");
    EXPECT_THAT(refusal(scene_.folder() / "nothing"), HasSubstr("is no folder"));
    EXPECT_THAT(refusal(scene_.folder()), HasSubstr("is no ensemble"));

    const fs::path statistics = ensemble() / "statistics.json";
    const std::string text = read_text(statistics.string());
    json missing = json::parse(text);
    missing["missing"] = {2, 3};
    write_text(statistics.string(), missing.dump());
    EXPECT_THAT(refusal(ensemble()), HasSubstr("2 of its 4 runs are missing"));
    fs::remove(statistics);
    EXPECT_THAT(refusal(ensemble()), HasSubstr("is not finished"));
    write_text(statistics.string(), text);

    const auto rewrite = [&](double x_min, int epsg) {
        RasterOptions options;
        options.x_min = x_min;
        options.epsg = epsg;
        write_raster((ensemble() / "probability_depth_0.05m.tif").string(), options, [](int, int) { return 50.0; });
        return refusal(ensemble());
    };
    EXPECT_THAT(rewrite(834000, 2326), HasSubstr("beyond the terrain of this scene"));
    EXPECT_THAT(rewrite(824000, 32650), HasSubstr("is in EPSG:32650"));
    EXPECT_EQ(rewrite(824000, 2326), "");

    const auto outcome =
        run_program({"serve", "slope.toml", "--port", "0", "--ensemble", "."}, {.folder = scene_.folder()});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.error, HasSubstr("is no ensemble"));
}

TEST_F(EnsemblesTest, one_of_another_terrain_file_says_so) {
    write_plane(scene_.input("terrain.tif"), [] {
        RasterOptions options = SmallScene::terrain();
        options.cell_height = 0;
        options.unit = "m";
        return options;
    }());
    ensembles_ = {ensemble()};
    start();
    EXPECT_EQ(as_viewer().get("/api/ensembles").json()["ensembles"][0]["same_terrain"], false);
}

}  // namespace
}  // namespace talus::test
