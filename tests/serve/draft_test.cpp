// A new scene from uploaded files: what is asked, mended and made.
#include "serve/draft.hpp"

#include <filesystem>

#include <gmock/gmock.h>

#include "serve/draft_fixture.hpp"

namespace talus::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(NewScenePage, makes_a_scene_of_a_terrain_and_a_drawn_scar_which_opens_and_is_downloaded) {
    const Answer terrain = put_file("terrain", scene_.input("terrain.tif"));
    ASSERT_EQ(terrain.status, 200) << terrain.body;
    EXPECT_TRUE(terrain.json()["terrain"]["problem"].is_null()) << terrain.body;
    EXPECT_EQ(terrain.json()["terrain"]["columns"], 60);
    EXPECT_EQ(client_->get(draft_ + "/relief").body.substr(0, 4), "TLSG");
    EXPECT_THAT(check({{"title", "My slope"}}).body, HasSubstr("a release is needed"));
    ASSERT_EQ(put_file("buildings", scene_.input("buildings.geojson")).status, 200);

    const json wanted = {{"title", "My slope"}, {"volume_m3", 200}, {"scar", scar()}};
    const Answer checked = check(wanted);
    ASSERT_EQ(checked.status, 200) << checked.body;
    EXPECT_THAT(checked.json()["summary"].get<std::string>(), HasSubstr("200 m3"));
    EXPECT_TRUE(checked.json()["created"].is_null());
    EXPECT_EQ(page()["scenes"].size(), 2U) << "checking makes nothing";

    const Answer made = client_->post(draft_ + "/scene", wanted);
    ASSERT_EQ(made.status, 200) << made.body;
    EXPECT_EQ(client_->get(draft_).status, 404);
    const std::string made_id = made.json()["created"];
    EXPECT_TRUE(fs::exists(folder() / "scenes/my-slope/scene.toml"));
    const json after = open({{"scene", made_id}});
    EXPECT_TRUE(after["error"].is_null()) << after["error"];
    EXPECT_EQ(after["open"]["title"], "My slope");
    EXPECT_EQ(client_->get("/api/scene").json()["title"], "My slope");

    // As an archive it makes the same scene again.
    const Answer bundle = client_->get("/api/scenes/" + made_id + "/bundle");
    ASSERT_EQ(bundle.status, 200) << bundle.body;
    EXPECT_EQ(bundle.headers.at("content-disposition"), "attachment; filename=\"my-slope.zip\"");
    draft_ = "/api/draft/" + begin();
    ASSERT_EQ(put("bundle", "copy.zip", bundle.body).status, 200);
    const Answer again = client_->post(draft_ + "/scene", json::object());
    ASSERT_EQ(again.status, 200) << again.body;
    EXPECT_TRUE(fs::exists(folder() / "scenes/copy/scene.toml"));
    EXPECT_EQ(client_->ask("DELETE", "/api/scenes/" + again.json()["created"].get<std::string>()).status, 200);
    EXPECT_FALSE(fs::exists(folder() / "scenes/copy"));
    EXPECT_EQ(client_->ask("DELETE", "/api/scenes/sham_tseng").status, 404);
    EXPECT_TRUE(fs::is_empty(folder() / "drafts"));
}

TEST_F(NewScenePage, says_what_is_wrong_with_a_terrain_and_mends_it) {
    RasterOptions options = SmallScene::terrain();
    options.epsg = 0;
    const Answer none = put_file("terrain", write_plane(scene_.input("none.tif"), options));
    ASSERT_EQ(none.status, 200) << none.body;
    const std::string problem = none.json()["terrain"]["problem"];
    EXPECT_THAT(problem, HasSubstr("none.tif: states no coordinate reference system"));
    EXPECT_THAT(problem, Not(HasSubstr("gdal")));
    EXPECT_THAT(problem, Not(HasSubstr(folder().string())));
    EXPECT_EQ(client_->get(draft_ + "/relief").status, 409);
    EXPECT_THAT(check({{"scar", scar()}}).body, HasSubstr("states no coordinate reference system"));
    EXPECT_EQ(client_->post(draft_ + "/mend", {{"epsg", 999998}}).status, 400);
    EXPECT_EQ(client_->post(draft_ + "/mend", {{"epsg", "EPSG:2326"}}).status, 400);
    const Answer mended = client_->post(draft_ + "/mend", {{"epsg", 2326}});
    EXPECT_TRUE(mended.json()["terrain"]["problem"].is_null()) << mended.body;
    EXPECT_EQ(check({{"scar", scar()}, {"thickness_m", 2}}).status, 200);

    const Answer asked = check({{"scar", scar()}});
    EXPECT_EQ(asked.status, 400);
    EXPECT_THAT(asked.body, HasSubstr("give its thickness, normal to the slope, or its volume"));

    // Degrees are brought to metres.
    options.epsg = 4326;
    options.x_min = 114;
    options.y_min = 22.3;
    options.cell = 0.00005;
    const Answer degrees = put_file("terrain", write_plane(scene_.input("degrees.tif"), options, 0.5 / 0.00005));
    EXPECT_THAT(degrees.json()["terrain"]["problem"].dump(), HasSubstr("degrees"));
    EXPECT_EQ(degrees.json()["terrain"]["metric_crs"], "EPSG:32650");
    const json metric = client_->post(draft_ + "/mend", {{"metric", true}}).json()["terrain"];
    EXPECT_TRUE(metric["problem"].is_null()) << metric;
    EXPECT_THAT(metric["crs"].dump(), HasSubstr("EPSG:32650"));
    EXPECT_NEAR(metric["cell_m"], 5.3, 0.2);

    // Feet become metres, and a number that means no data is taken as such.
    options = SmallScene::terrain();
    options.unit = "ft";
    const std::string feet = write_raster(scene_.input("feet.tif"), options, [](int column, int row) {
        return column == 0 && row == 0 ? -99999 : 1000 + 8.0 * column;
    });
    EXPECT_THAT(put_file("terrain", feet).json()["terrain"]["problem"].dump(), HasSubstr("values are in ft"));
    const Answer still = client_->post(draft_ + "/mend", {{"metres_per_unit", 0.3048}});
    EXPECT_THAT(still.json()["terrain"]["problem"].dump(), HasSubstr("no elevation"));
    const Answer good = client_->post(draft_ + "/mend", {{"metres_per_unit", 0.3048}, {"nodata", -99999}});
    EXPECT_TRUE(good.json()["terrain"]["problem"].is_null()) << good.body;
    const Answer checked = check({{"scar", scar()}, {"thickness_m", 2}});
    EXPECT_THAT(checked.json()["summary"].dump(), HasSubstr("vertical unit: m")) << checked.body;
    const json made =
        client_->post(draft_ + "/scene", {{"title", "Feet"}, {"thickness_m", 2}, {"scar", scar()}}).json();
    open({{"scene", made["created"]}});
    const json elevation = client_->get("/api/scene").json()["elevation_m"];
    EXPECT_NEAR(elevation[1], (1000 + 8 * 53) * 0.3048, 0.1) << "of column 53: the extent ends there";
    EXPECT_THAT(kept(), Not(testing::Contains("feet.tif"))) << "the mended terrain takes its place";
}

TEST_F(NewScenePage, proposes_the_unit_of_heights_that_the_reference_system_has_and_shows_their_range) {
    // New York Long Island, US survey feet; heights of 300 to 400 in the same.
    RasterOptions options = SmallScene::terrain();
    options.epsg = 2263;
    options.x_min = 1000000;
    options.y_min = 200000;
    options.cell = 15;
    const std::string feet =
        write_raster(scene_.input("plane.tif"), options, [](int column, int) { return 300 + 100.0 * column / 59; });
    const json before = put_file("terrain", feet).json()["terrain"];
    EXPECT_THAT(before["problem"].dump(), HasSubstr("a CRS in metres is needed"));
    EXPECT_NEAR(before["height_unit_m"], 1200.0 / 3937, 1e-9);
    const json after = client_->post(draft_ + "/mend", {{"metric", true}, {"metres_per_unit", before["height_unit_m"]}})
                           .json()["terrain"];
    EXPECT_TRUE(after["problem"].is_null()) << after;
    EXPECT_NEAR(after["elevation_m"][0], 300 * 0.3048, 0.5);
    EXPECT_LT(after["elevation_m"][1], 401 * 0.3048);
    // In metres nothing is proposed.
    EXPECT_EQ(put_file("terrain", scene_.input("terrain.tif")).json()["terrain"]["height_unit_m"], 1);
}

TEST_F(NewScenePage, squares_oblong_cells_in_the_system_of_the_terrain) {
    RasterOptions options = SmallScene::terrain();
    options.cell_height = 1.25 * options.cell;
    const json before = put_file("terrain", write_plane(scene_.input("oblong.tif"), options)).json()["terrain"];
    EXPECT_THAT(before["problem"].dump(), HasSubstr("square ones are needed"));
    EXPECT_EQ(before["metric_crs"], "EPSG:2326");
    const json after = client_->post(draft_ + "/mend", {{"metric", true}}).json()["terrain"];
    EXPECT_TRUE(after["problem"].is_null()) << after;
    EXPECT_THAT(after["crs"].dump(), HasSubstr("EPSG:2326"));
    EXPECT_NEAR(after["cell_m"], options.cell, 1e-6);
    EXPECT_NEAR(after["rows"], 1.25 * before["rows"].get<double>(), 1.01);
}

TEST_F(NewScenePage, says_that_a_release_lies_outside_and_takes_a_raster_of_thickness) {
    put_file("terrain", scene_.input("terrain.tif"));
    const std::string far =
        write_vector(scene_.input("far.geojson"), {}, {{rectangle_wkt(834200, 825090, 834220, 825110), {}}});
    ASSERT_EQ(put_file("release", far).status, 200);
    const Answer outside = check(json::object());
    EXPECT_EQ(outside.status, 400);
    EXPECT_THAT(outside.body, HasSubstr("lies outside the terrain"));
    RasterOptions options = SmallScene::terrain();
    const std::string raster = write_raster(scene_.input("thick.tif"), options, [](int column, int row) {
        return column > 30 && column < 36 && row > 15 && row < 20 ? 2 : 0;
    });
    const Answer thick = put_file("release", raster);
    EXPECT_EQ(thick.json()["files"]["release"]["kind"], "raster") << thick.body;
    EXPECT_THAT(check({{"volume_m3", 5}}).body, HasSubstr("holds its own thickness"));
    const Answer good = check(json::object());
    EXPECT_EQ(good.status, 200) << good.body;
}

TEST_F(NewScenePage, takes_a_terrain_of_a_laboratory_in_local_coordinates) {
    RasterOptions options = SmallScene::terrain();
    options.epsg = 0;
    const json none = put_file("terrain", write_plane(scene_.input("flume.tif"), options)).json()["terrain"];
    EXPECT_THAT(none["problem"].dump(), HasSubstr("states no coordinate reference system"));
    EXPECT_EQ(none["crs"], "");
    EXPECT_EQ(none["mending"]["local"], false);
    EXPECT_THAT(client_->post(draft_ + "/mend", {{"local", true}, {"epsg", 2326}}).body,
                HasSubstr("epsg and local are given"));
    EXPECT_EQ(client_->post(draft_ + "/mend", {{"epsg", 2326}}).status, 200);
    const Answer local = client_->post(draft_ + "/mend", {{"local", true}});
    ASSERT_EQ(local.status, 200) << "in place of the code: " << local.body;
    EXPECT_TRUE(local.json()["terrain"]["problem"].is_null()) << local.body;
    EXPECT_EQ(local.json()["terrain"]["crs"], "local coordinates");
    EXPECT_EQ(local.json()["terrain"]["mending"]["local"], true);
    // Drawn, and as GeoJSON, which reads as WGS 84 where it states nothing.
    const Answer drawn = check({{"scar", scar()}, {"thickness_m", 2}});
    EXPECT_EQ(drawn.status, 200) << drawn.body;
    ASSERT_EQ(put("release", "scar.geojson",
                  R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry":
                      {"type": "Polygon", "coordinates": [[[824200, 825090], [824220, 825090], [824220, 825110],
                       [824200, 825110], [824200, 825090]]]}}]})")
                  .status,
              200);
    const json wanted = {{"title", "Flume"}, {"thickness_m", 2}};
    const Answer checked = check(wanted);
    ASSERT_EQ(checked.status, 200) << checked.body;
    const Answer made = client_->post(draft_ + "/scene", wanted);
    ASSERT_EQ(made.status, 200) << made.body;
    EXPECT_THAT(read_text(folder() / "scenes/flume/scene.toml"), HasSubstr("crs = \"local\""));
    EXPECT_TRUE(open({{"scene", made.json()["created"]}})["error"].is_null());
    // As an archive it is the same again.
    const Answer bundle = client_->get("/api/scenes/" + made.json()["created"].get<std::string>() + "/bundle");
    draft_ = "/api/draft/" + begin();
    ASSERT_EQ(put("bundle", "copy.zip", bundle.body).status, 200);
    EXPECT_EQ(check(json::object()).status, 200);
    // Not where the terrain has a place on the globe.
    draft_ = "/api/draft/" + begin();
    put_file("terrain", scene_.input("terrain.tif"));
    EXPECT_THAT(client_->post(draft_ + "/mend", {{"local", true}}).body,
                HasSubstr("local = true; the terrain states a reference system, EPSG:2326"));
}

TEST_F(NewScenePage, takes_files_that_gzip_packed) {
    const Answer terrain = put("terrain", "dem.tif.gz", gzip(read_text(scene_.input("terrain.tif"))));
    ASSERT_EQ(terrain.status, 200) << terrain.body;
    EXPECT_TRUE(terrain.json()["terrain"]["problem"].is_null()) << terrain.body;
    EXPECT_EQ(terrain.json()["files"]["terrain"]["name"], "dem.tif.gz");
    ASSERT_EQ(put("release", "scar.geojson.gz", gzip(read_text(scene_.input("release.geojson")))).status, 200);
    EXPECT_EQ(check({{"thickness_m", 2}}).status, 200);
    EXPECT_EQ(kept(), (std::vector<std::string>{"dem.tif", "scar.gpkg"}));
}

}  // namespace
}  // namespace talus::test
