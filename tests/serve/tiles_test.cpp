// Addresses of map tiles: what is one, who adds and removes them, what a page may load, what a saved session keeps.
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "serve/serve_fixture.hpp"
#include "serve/start_fixture.hpp"
#include "serve/tile_addresses.hpp"

namespace talus::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* xyz = "https://tile.example.org/{z}/{x}/{y}.png";
constexpr const char* wmts =
    "https://maps.example.net:8443/wmts?TILEMATRIX={TileMatrix}&TILEROW={TileRow}&TILECOL={TileCol}&key=7";

class TilesTest : public Serve {
  protected:
    static std::string policy(HttpClient client) { return client.get("/").headers.at("content-security-policy"); }
};

TEST_F(TilesTest, only_addresses_that_the_user_gave_are_open_to_the_page) {
    EXPECT_THAT(policy(as_viewer()), HasSubstr("img-src 'self' blob: data:;"));
    HttpClient client = as_viewer();
    EXPECT_EQ(client.get("/api/tiles").json()["addresses"], json::array());
    EXPECT_EQ(client.get("/api/overlays").json()["tiles"], json::array());
    tiles_ = {xyz};
    start();
    EXPECT_THAT(policy(as_viewer()), HasSubstr("img-src 'self' blob: data: https://tile.example.org;"));
    HttpClient other = as_viewer();
    const json tiles = other.get("/api/tiles").json();
    EXPECT_EQ(tiles["degrees"].size(), 2 * 33 * 33);
    EXPECT_NEAR(tiles["degrees"][0].get<double>(), 114.05, 0.1);
    EXPECT_NEAR(tiles["degrees"][1].get<double>(), 22.37, 0.1);
    const json given = other.get("/api/overlays").json()["tiles"];
    ASSERT_EQ(given.size(), 1U);
    EXPECT_EQ(given[0]["by"], "");
    HttpClient hand = as_controller();
    EXPECT_EQ(hand.ask("DELETE", "/api/tiles/" + given[0]["id"].get<std::string>()).status, 409)
        << "only the command line removes what it gave";
}

TEST_F(TilesTest, an_address_is_told_to_everybody_allowed_to_pages_loaded_later_removed_and_brought_back) {
    WebSocket watcher = join(viewer, "Bo");
    watcher.hello = watcher.wait_for("hello");
    EXPECT_EQ(watcher.wait_for("overlays")["tiles"], json::array());
    HttpClient client = as_controller();
    const Answer added = client.post("/api/tiles", {{"address", wmts}});
    ASSERT_EQ(added.status, 200) << added.body;
    const json told = watcher.wait_for("overlays")["tiles"];
    ASSERT_EQ(told.size(), 1U) << told;
    EXPECT_EQ(told[0]["id"], added.json()["created"]);
    EXPECT_EQ(told[0]["address"], wmts);
    EXPECT_EQ(told[0]["by"], "a program");
    HttpClient reader = as_viewer();
    EXPECT_EQ(reader.get("/api/tiles").json()["addresses"], json::array({wmts}));
    EXPECT_EQ(reader.get("/api/tiles").json()["degrees"].size(), 2 * 33 * 33);
    EXPECT_THAT(policy(as_viewer()), HasSubstr("img-src 'self' blob: data: https://maps.example.net:8443;"));
    EXPECT_THAT(policy(as_viewer()), Not(HasSubstr("key")));

    const std::string path = "/api/tiles/" + told[0]["id"].get<std::string>();
    EXPECT_EQ(client.ask("DELETE", path).status, 200);
    const json without = watcher.wait_for("overlays");
    EXPECT_EQ(without["tiles"], json::array());
    EXPECT_EQ(without["removed"], "maps.example.net:8443");
    EXPECT_EQ(client.ask("DELETE", path).status, 404);
    EXPECT_THAT(policy(as_viewer()), HasSubstr("img-src 'self' blob: data:;"));
    EXPECT_EQ(client.ask("POST", "/api/overlays", "{}").status, 200);
    const json back = watcher.wait_for("overlays");
    EXPECT_EQ(back["tiles"][0]["address"], wmts);
    EXPECT_TRUE(back["removed"].is_null());
    EXPECT_EQ(client.ask("POST", "/api/overlays", "{}").status, 409);
}

TEST_F(TilesTest, one_that_is_no_address_there_already_or_one_too_many_is_refused_in_one_sentence) {
    HttpClient client = as_controller();
    const auto refused = [&](const json& body, int status) {
        const Answer answer = client.post("/api/tiles", body);
        EXPECT_EQ(answer.status, status) << answer.body;
        return answer.json()["error"].get<std::string>();
    };
    EXPECT_THAT(refused({{"address", "https://a.example.org/{z}/{x}"}}, 400), HasSubstr("has no {z}, {x} and {y}"));
    EXPECT_THAT(refused({{"address", 3}}, 400), HasSubstr("address"));
    EXPECT_THAT(refused({{"adress", xyz}}, 400), HasSubstr("adress"));
    EXPECT_EQ(client.get("/api/tiles").json()["addresses"], json::array());
    ASSERT_EQ(client.post("/api/tiles", {{"address", xyz}}).status, 200);
    EXPECT_THAT(refused({{"address", xyz}}, 409), HasSubstr("is there already"));
    for (std::size_t k = 1; k < serve::most_tile_addresses; ++k) {
        ASSERT_EQ(client.post("/api/tiles", {{"address", fmt::format("{}?{}", xyz, k)}}).status, 200);
    }
    EXPECT_THAT(refused({{"address", fmt::format("{}?more", xyz)}}, 409), HasSubstr("the most there can be"));
}

TEST_F(TilesTest, only_who_may_change_the_session_may_add_or_remove_one) {
    HttpClient reader = as_viewer();
    EXPECT_EQ(reader.post("/api/tiles", {{"address", xyz}}).status, 403);
    WebSocket ada = join(controller, "Ada"), cy = join(controller, "Cy");
    const std::string holder = ada.wait_for("hello")["you"]["secret"], other = cy.wait_for("hello")["you"]["secret"];
    HttpClient client = as_controller();
    ASSERT_EQ(client.post("/api/control", {{"do", "request"}, {"secret", holder}}).status, 200);
    EXPECT_EQ(client.post("/api/tiles", {{"address", xyz}}, other).status, 409);
    ASSERT_EQ(client.post("/api/tiles", {{"address", xyz}}, holder).status, 200);
    const json added = client.get("/api/overlays").json()["tiles"];
    EXPECT_EQ(added[0]["by"], "Ada");
    const std::string path = "/api/tiles/" + added[0]["id"].get<std::string>();
    EXPECT_EQ(reader.ask("DELETE", path).status, 403);
    EXPECT_EQ(client.ask("DELETE", path, "", {{"Talus-Person", other}}).status, 409);
    EXPECT_EQ(client.get("/api/tiles").json()["addresses"], json::array({xyz}));
}

TEST(TileAddress, is_checked_before_it_gets_into_a_header) {
    EXPECT_TRUE(serve::check_tile_address(wmts));
    EXPECT_TRUE(serve::check_tile_address("http://127.0.0.1:8080/layer/{TileMatrix}/{TileRow}/{TileCol}.jpg"));
    for (const char* bad :
         {"ftp://a/{z}/{x}/{y}", "https://a b/{z}/{x}/{y}", "https://a;script-src *//{z}/{x}/{y}",
          "https:///{z}/{x}/{y}", "https://a/{z}/{x}", "https://{z}.a/{x}/{y}", "https://a'/{z}/{x}/{y}",
          "https://a:b/{z}/{x}/{y}", "https://a:1:2/{z}/{x}/{y}", "https://*.a/{z}/{x}/{y}", "https:/{z}/{x}/{y}",
          "https://me@a/{z}/{x}/{y}", "javascript:alert({z}{x}{y})", "https://a/{z}/{x}/{y}\r\nSet-Cookie: a"}) {
        EXPECT_FALSE(serve::check_tile_address(bad)) << bad;
    }
    const std::string longer = "https://a/{z}/{x}/{y}?" + std::string(500, 'k');
    EXPECT_THAT(serve::check_tile_address(longer).error().message, HasSubstr("is longer than 500 bytes"));
    EXPECT_EQ(serve::origin_of("https://a.example.org:8443/x/{z}"), "https://a.example.org:8443");
    EXPECT_EQ(serve::origins_of({"https://a/{z}", "http://a/{z}", "https://a/other"}), " https://a http://a");
}

TEST(TileAddress, names_a_key_that_no_page_replaces) {
    EXPECT_THAT(serve::check_tile_address("https://{s}.tile.example.org/{z}/{x}/{y}.png").error().message,
                HasSubstr("has {s} in the name of its host"));
    EXPECT_THAT(serve::check_tile_address("https://a/{Style}/{TileMatrix}/{TileRow}/{TileCol}").error().message,
                HasSubstr("has {Style}; only {z}, {x} and {y}, or {TileMatrix}"));
}

TEST_F(StartPage, a_saved_session_keeps_addresses_of_map_tiles_and_refuses_spoilt_ones) {
    ASSERT_TRUE(open({{"scene", id()}})["error"].is_null());
    HttpClient client = hand();
    EXPECT_FALSE(client.get("/api/session/file").json().contains("tiles")) << "older programs read it";
    ASSERT_EQ(client.post("/api/tiles", {{"address", xyz}}).status, 200);
    const Answer saved = client.post("/api/sessions", {{"name", "Meeting"}});
    ASSERT_EQ(saved.status, 200) << saved.body;
    json file = client.get("/api/session/file").json();
    const json kept = {{"address", xyz}, {"by", "a program"}};
    EXPECT_EQ(file["tiles"], json::array({kept}));
    const json now = open({{"session", saved.json()["created"]}, {"replace", true}});
    ASSERT_TRUE(now["error"].is_null()) << now["error"];
    EXPECT_EQ(client.get("/api/tiles").json()["addresses"], json::array({xyz}));
    EXPECT_EQ(client.get("/api/overlays").json()["tiles"][0]["by"], "a program");
    EXPECT_THAT(client.get("/").headers.at("content-security-policy"), HasSubstr(" https://tile.example.org;"));

    const auto spoilt = [&](const json& tiles) {
        file["tiles"] = tiles;
        const Answer answer = client.post("/api/sessions", {{"name", "Spoilt"}, {"file", file}});
        EXPECT_EQ(answer.status, 400);
        return answer.body;
    };
    const json bad_host = {{"address", "https://a;script-src */{z}/{x}/{y}"}, {"by", ""}};
    const json more_keys = {{"address", xyz}, {"script", "x"}}, no_address = {{"by", "Ada"}, {"address", ""}};
    EXPECT_THAT(spoilt("all"), HasSubstr("tiles: must be a list of up to 8"));
    EXPECT_THAT(spoilt(json(9, kept)), HasSubstr("tiles: must be a list of up to 8"));
    EXPECT_THAT(spoilt(json::array({kept, bad_host})), HasSubstr("tiles[1]: address: "));
    EXPECT_THAT(spoilt(json::array({more_keys})), HasSubstr("tiles[0]: "));
    EXPECT_THAT(spoilt(json::array({no_address})), HasSubstr("tiles[0]: address: missing"));
}

}  // namespace
}  // namespace talus::test
