#include <string>
#include <thread>

#include <gmock/gmock.h>

#include "geo/vector.hpp"
#include "geo/zip_archive.hpp"
#include "serve/serve_fixture.hpp"
#include "serve/start_fixture.hpp"

namespace talus::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// A line across the terrain of the small scene and one beside it, with a style of its own.
std::string roads() {
    return R"({"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "EPSG:2326"}}, "features": [
      {"type": "Feature", "properties": {"name": "<b>Route</b>", "lanes": 2, "stroke": "#ff0000", "stroke-width": 4},
       "geometry": {"type": "LineString", "coordinates": [[824100, 825100], [824200, 825100]]}},
      {"type": "Feature", "properties": {"name": "far"},
       "geometry": {"type": "LineString", "coordinates": [[1, 1], [2, 2]]}}]})";
}

Answer lay(HttpClient& client, const std::string& name, const std::string& content, const std::string& person = "") {
    return client.ask("PUT", "/api/overlays?name=" + name, content,
                      person.empty() ? Headers{} : Headers{{"Talus-Person", person}});
}

class OverlaysTest : public Serve {};

TEST_F(OverlaysTest, a_layer_is_seen_by_everybody_changed_removed_and_brought_back) {
    WebSocket watcher = join(viewer, "Bo");
    watcher.hello = watcher.wait_for("hello");
    EXPECT_EQ(watcher.wait_for("overlays")["overlays"], json::array());
    HttpClient client = as_controller();
    const Answer added = lay(client, "roads.geojson", roads());
    ASSERT_EQ(added.status, 200) << added.body;
    const json told = watcher.wait_for("overlays");
    ASSERT_EQ(told["overlays"].size(), 1U) << told;
    const json one = told["overlays"][0];
    EXPECT_EQ(one["name"], "roads");
    EXPECT_EQ(one["features"], 1);
    EXPECT_EQ(one["outside"], 1);
    EXPECT_EQ(one["styled"], true);
    const std::string path = "/api/overlays/" + one["id"].get<std::string>();
    HttpClient reader = as_viewer();
    const json data = reader.get(path).json();
    EXPECT_EQ(data["features"][0]["name"], "<b>Route</b>");
    EXPECT_EQ(data["styles"][0]["stroke"], "#ff0000");
    EXPECT_EQ(reader.get(path + "/picture").status, 404);

    EXPECT_EQ(client.post(path, {{"visible", false}, {"opacity", 0.5}, {"colour", "#0f0"}, {"name", "Lane"}}).status,
              200);
    const json changed = watcher.wait_for("overlays")["overlays"][0];
    EXPECT_EQ(changed["visible"], false);
    EXPECT_EQ(changed["colour"], "#00ff00");
    EXPECT_EQ(changed["name"], "Lane");
    EXPECT_THAT(client.post(path, {{"opacity", 2}}).body, HasSubstr("opacity = 2"));
    EXPECT_THAT(client.post(path, {{"colour", "url(x)"}}).body, HasSubstr("colour"));
    EXPECT_THAT(client.post(path, {{"visible", "no"}}).body, HasSubstr("visible"));
    EXPECT_THAT(client.post(path, {{"name", " "}}).body, HasSubstr("must have characters that can be seen"))
        << "a saved session must name its layers";

    EXPECT_EQ(client.ask("DELETE", path).status, 200);
    EXPECT_EQ(watcher.wait_for("overlays")["removed"], "Lane");
    EXPECT_EQ(client.ask("DELETE", path).status, 404);
    EXPECT_EQ(client.ask("POST", "/api/overlays", "{}").status, 200);
    EXPECT_EQ(watcher.wait_for("overlays")["overlays"][0]["name"], "Lane");
    EXPECT_EQ(client.ask("POST", "/api/overlays", "{}").status, 409);
}

TEST_F(OverlaysTest, only_who_may_change_the_session_may_add_one) {
    HttpClient reader = as_viewer();
    EXPECT_EQ(lay(reader, "roads.geojson", roads()).status, 403);
    WebSocket ada = join(controller, "Ada"), cy = join(controller, "Cy");
    const std::string holder = ada.wait_for("hello")["you"]["secret"], other = cy.wait_for("hello")["you"]["secret"];
    HttpClient client = as_controller();
    ASSERT_EQ(client.post("/api/control", {{"do", "request"}, {"secret", holder}}).status, 200);
    EXPECT_EQ(lay(client, "roads.geojson", roads(), other).status, 409);
    HttpClient again = as_controller();
    EXPECT_EQ(lay(again, "roads.geojson", roads(), holder).status, 200);
    EXPECT_EQ(again.get("/api/overlays").json()["overlays"][0]["by"], "Ada");
}

TEST_F(OverlaysTest, says_in_one_sentence_what_cannot_be_laid) {
    const auto refused = [&](const std::string& name, const std::string& content) {
        HttpClient client = as_controller();
        const Answer answer = lay(client, name, content);
        EXPECT_EQ(answer.status, 400) << answer.body;
        EXPECT_THAT(answer.body, Not(HasSubstr(scene_.folder().string())));
        return answer.json()["error"].get<std::string>();
    };
    EXPECT_THAT(refused("notes.txt", "hello"), HasSubstr("notes.txt: is no layer"));
    EXPECT_THAT(refused("roads.shp", "x"), HasSubstr("belong together"));
    EXPECT_THAT(refused("bad.geojson", R"({"type": "FeatureCollection", "features": [)"), HasSubstr("bad.geojson: "));
    EXPECT_THAT(
        refused("far.geojson",
                R"({"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [1, 2]}})"),
        HasSubstr("far.geojson: lies outside the terrain"));
    EXPECT_THAT(refused("trap.vrt",
                        "<OGRVRTDataSource><OGRVRTLayer name='a'><SrcDataSource>/etc/passwd</SrcDataSource>"
                        "</OGRVRTLayer></OGRVRTDataSource>"),
                HasSubstr("trap.vrt: "));
    EXPECT_EQ(as_viewer().get("/api/overlays").json()["overlays"], json::array());
    EXPECT_FALSE(std::filesystem::exists(scene_.folder() / "overlays/1"));
}

TEST_F(OverlaysTest, layers_of_a_geopackage_in_a_zip_come_with_their_styles) {
    const std::string file = scene_.input("plan.gpkg");
    const auto crs = geo::crs_from_text("EPSG:2326");
    ASSERT_TRUE(crs);
    const geo::OutputFeature line{{}, {{824100, 825050}, {824250, 825050}}, {}};
    const geo::OutputFeature point{{}, {{824150, 825060}}, {}};
    ASSERT_TRUE(geo::write_geopackage_layer(file, "routes", {}, {line}, *crs));
    ASSERT_TRUE(geo::write_geopackage_layer(file, "shelters", {}, {point}, *crs));
    ASSERT_TRUE(geo::write_geopackage_styles(
        file, {{"routes", R"(<qgis><renderer-v2 type="singleSymbol"><symbols><symbol name="0" type="line">
          <layer class="SimpleLine"><prop k="line_color" v="0,128,0,255"/><prop k="line_width" v="1"/></layer>
          </symbol></symbols></renderer-v2></qgis>)"}}));
    const std::string archive = scene_.input("plan.zip");
    ASSERT_TRUE(geo::write_zip(archive, {{"plan.gpkg", file}}));
    HttpClient client = as_controller();
    const Answer added = lay(client, "plan.zip", read_text(archive));
    ASSERT_EQ(added.status, 200) << added.body;
    const json list = client.get("/api/overlays").json()["overlays"];
    ASSERT_EQ(list.size(), 2U) << list;
    EXPECT_EQ(list[0]["name"], "routes");
    EXPECT_EQ(list[0]["styled"], true);
    EXPECT_EQ(list[1]["name"], "shelters");
    EXPECT_EQ(list[1]["styled"], false);
    EXPECT_NE(list[0]["colour"], list[1]["colour"]);
    const json routes = client.get("/api/overlays/" + list[0]["id"].get<std::string>()).json();
    EXPECT_EQ(routes["styles"][0]["stroke"], "#008000");
}

TEST_F(OverlaysTest, a_raster_of_values_becomes_a_picture_below_the_others) {
    HttpClient client = as_controller();
    ASSERT_EQ(lay(client, "roads.geojson", roads()).status, 200);
    const Answer added = lay(client, "terrain.tif", read_text(scene_.input("terrain.tif")));
    ASSERT_EQ(added.status, 200) << added.body;
    const json list = client.get("/api/overlays").json()["overlays"];
    EXPECT_EQ(list[0]["kind"], "picture");
    EXPECT_LT(list[0]["low"].get<double>(), list[0]["high"].get<double>());
    EXPECT_EQ(list[1]["name"], "roads");
    const Answer picture = client.get("/api/overlays/" + list[0]["id"].get<std::string>() + "/picture");
    EXPECT_EQ(picture.headers.at("content-type"), "image/png");
    EXPECT_EQ(picture.body.substr(1, 3), "PNG");
}

TEST_F(StartPage, a_saved_session_keeps_its_overlays_and_refuses_spoilt_ones) {
    ASSERT_TRUE(open({{"scene", id()}})["error"].is_null());
    HttpClient client = hand();
    ASSERT_EQ(lay(client, "roads.geojson", roads()).status, 200);
    ASSERT_EQ(lay(client, "terrain.tif", read_text(scene_.input("terrain.tif"))).status, 200);
    const json before = client.get("/api/overlays").json()["overlays"];
    const std::string data = client.get("/api/overlays/" + before[1]["id"].get<std::string>()).body;
    const std::string picture = client.get("/api/overlays/" + before[0]["id"].get<std::string>() + "/picture").body;
    const Answer saved = client.post("/api/sessions", {{"name", "Meeting"}});
    ASSERT_EQ(saved.status, 200) << saved.body;
    json file = client.get("/api/session/file").json();
    EXPECT_EQ(file["overlays"].size(), 2U);

    const json now = open({{"session", saved.json()["created"]}, {"replace", true}});
    ASSERT_TRUE(now["error"].is_null()) << now["error"];
    const json after = client.get("/api/overlays").json()["overlays"];
    ASSERT_EQ(after.size(), 2U);
    EXPECT_EQ(after[1]["name"], "roads");
    EXPECT_EQ(after[1]["colour"], before[1]["colour"]);
    EXPECT_EQ(client.get("/api/overlays/" + after[1]["id"].get<std::string>()).body, data);
    EXPECT_EQ(client.get("/api/overlays/" + after[0]["id"].get<std::string>() + "/picture").body, picture);

    const auto spoilt = [&](const char* key, const json& value, std::size_t k) {
        json other = file;
        other["overlays"][k][key] = value;
        const Answer answer = client.post("/api/sessions", {{"name", "Spoilt"}, {"file", other}});
        EXPECT_EQ(answer.status, 400);
        return answer.body;
    };
    EXPECT_THAT(spoilt("data", "{}", 1), HasSubstr("overlays[1]: data: is no list of features"));
    EXPECT_THAT(spoilt("data", "PHN2Zz4=", 0), HasSubstr("overlays[0]: data: is no picture"));
    EXPECT_THAT(spoilt("type", "image/svg+xml", 0), HasSubstr("overlays[0]"));
    EXPECT_THAT(spoilt("colour", "red", 0), HasSubstr("colour"));
    file["overlays"] = json::array();
    EXPECT_EQ(client.post("/api/sessions", {{"name", "Plain"}, {"file", file}}).status, 200);
}

}  // namespace
}  // namespace talus::test
