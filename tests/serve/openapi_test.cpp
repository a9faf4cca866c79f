#include <algorithm>
#include <map>
#include <set>
#include <thread>

#include <gmock/gmock.h>

#include "serve/protocol.hpp"
#include "serve/schema.hpp"
#include "serve/serve_fixture.hpp"
#include "support/photo.hpp"

namespace talus::test {
namespace {

using nlohmann::json;

class OpenApi : public Serve {
  protected:
    void SetUp() override {
        Serve::SetUp();
        document = HttpClient(port()).get("/api/openapi.json").json();
    }

    /// Whether the answer is as the description has it for its status.
    void expect_described(const std::string& method, const std::string& pattern, const Answer& answer) {
        SCOPED_TRACE(method + " " + pattern + " " + std::to_string(answer.status));
        std::string lower = method;
        std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
        const json& responses = document["paths"][pattern][lower]["responses"];
        const std::string status = std::to_string(answer.status);
        ASSERT_TRUE(responses.contains(status)) << answer.body.substr(0, 300);
        json response = responses[status];
        if (response.contains("$ref"))
            response = document.at(json::json_pointer(response["$ref"].get<std::string>().substr(1)));
        const json& content = response["content"];
        const std::string type = answer.headers.at("content-type");
        ASSERT_TRUE(content.contains(type) || content.contains("*/*")) << type;
        if (!content.contains(type) || !content[type].contains("schema")) return;
        for (const std::string& line : differences(answer.json(), content[type]["schema"], document))
            ADD_FAILURE() << line;
    }

    json document;
};

std::string filled(std::string pattern, const std::string& scenario, const std::string& name) {
    for (const auto& [key, value] : {std::pair<std::string, std::string>{"{s}", scenario}, {"{name}", name}}) {
        if (const auto at = pattern.find(key); at != std::string::npos) pattern.replace(at, key.size(), value);
    }
    return pattern;
}

TEST_F(OpenApi, describes_every_route_and_no_other) {
    std::set<std::string> described, served;
    for (const auto& [path, item] : document["paths"].items()) {
        for (const char* method : {"GET", "POST", "PUT", "DELETE", "PATCH"}) {
            std::string lower = method;
            std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
            if (item.contains(lower)) described.insert(method + (" " + path));
        }
    }
    for (const serve::Route& route : server_->routes()) {
        served.insert(route.method + " " + route.pattern);
        if (route.needs == serve::Role::nobody) {
            EXPECT_EQ(document["paths"][route.pattern]["get"]["security"], json::array()) << route.pattern;
        }
    }
    const std::vector<serve::Route> routes = server_->routes();
    for (const serve::RouteDescription& route : serve::protocol().routes) {
        const auto found = std::find_if(routes.begin(), routes.end(), [&](const auto& one) {
            return one.method == route.method && one.pattern == route.path;
        });
        ASSERT_NE(found, routes.end()) << route.path;
        EXPECT_EQ(found->needs, serve::role_of(route.who)) << route.path;
        std::vector<std::string> query;
        for (const serve::Field& field : route.query) query.push_back(field.key);
        EXPECT_EQ(found->query, query) << route.path;
    }
    EXPECT_EQ(described, served);
    EXPECT_GE(served.size(), 19U);
}

TEST_F(OpenApi, every_route_answers_as_described) {
    HttpClient hand = as_controller(), nobody(port());
    // Some of everything, so that no list is empty.
    const std::string actions = "/api/scenarios/A/actions";
    const json some[] = {{{"action", "put_barrier"},
                          {"name", "Dam"},
                          {"line", {{824185, 825080}, {824185, 825120}}},
                          {"height_m", 2},
                          {"thickness_m", 1},
                          {"passing_share", 0.5},
                          {"openings", {{{"position_m", 20}, {"width_m", 4}}}},
                          {"resistance_Npm", nullptr}},
                         {{"action", "put_building"},
                          {"name", "Barn"},
                          {"polygon", {{824120, 825090}, {824130, 825090}, {824130, 825100}}},
                          {"height_m", 4}},
                         {{"action", "put_release"},
                          {"name", "Second"},
                          {"polygon", {{824230, 825090}, {824240, 825090}, {824240, 825100}}},
                          {"thickness_m", 0.5}},
                         {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.2}},
                         {{"action", "set_speed"}, {"factor", nullptr}},
                         {{"action", "run"}}};
    for (const json& action : some) {
        const Answer answer = hand.post(actions, action);
        EXPECT_EQ(answer.status, 200) << answer.body;
        expect_described("POST", actions.substr(0, 15) + "{s}/actions", answer);
    }
    for (int i = 0; i < 100 && hand.get("/api/scenarios/A/state").json()["time_s"] < 4; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    expect_described("GET", "/api/scenarios/{s}/state", hand.get("/api/scenarios/A/state"));
    EXPECT_EQ(hand.post(actions, {{"action", "pause"}}).status, 200);
    for (int i = 0; i < 5; ++i) {
        expect_described("POST", "/api/scenarios", hand.post("/api/scenarios", {{"copy_of", "A"}}));
    }

    const std::map<std::string, std::string> queries = {{"/api/scenarios/{s}/probe", "?x_m=824195&y_m=825100"},
                                                        {"/api/scenarios/{s}/frame", "?time_s=0.5"},
                                                        {"/api/terrain", "?max_cells=500"}};
    const std::map<std::string, std::string> names = {{"/api/scenarios/{s}/layers/{name}", "peak_depth"},
                                                      {"/api/scenarios/{s}/exports/{name}", "front.csv"}};
    const std::map<std::string, json> bodies = {
        {"/api/scenarios/{s}/actions", {{"action", "step"}}},
        {"/api/control", {{"do", "request"}}},
        {"/api/share", {{"address", "192.0.2.1"}}},
        {"/api/tiles", {{"address", "https://tile.example.org/{z}/{x}/{y}.png"}}},
        {"/api/scenarios", {{"copy_of", "A"}}},
        {"/api/depth_averaged", {{"on", true}}},
        {"/api/scenarios/{s}/flow", {{"formats", {"gltf"}}}},
        {"/api/calibration",
         {{"parameters", {{{"key", "material.friction_coefficient"}, {"low", 0.1}, {"high", 0.6}}}}, {"runs", 9}}}};
    const std::map<std::string, int> refused = {{"/api/control", 409},
                                                {"/api/scenarios", 409},
                                                {"/api/trigger", 403},
                                                {"/api/orthophoto", 404},
                                                {"/api/ensembles/{e}/maps/{name}", 404},
                                                {"/api/open", 409},
                                                {"/api/recent/{id}", 409},
                                                {"/api/sessions", 409},
                                                {"/api/sessions/{id}", 409},
                                                {"/api/draft", 409},
                                                {"/api/draft/{id}", 409},
                                                {"/api/draft/{id}/files/{role}", 409},
                                                {"/api/draft/{id}/mend", 409},
                                                {"/api/draft/{id}/relief", 409},
                                                {"/api/draft/{id}/scene", 409},
                                                {"/api/scenes/{id}", 409},
                                                {"/api/scenes/{id}/bundle", 409},
                                                {"/api/jobs", 409},
                                                {"/api/jobs/form/{id}", 409},
                                                {"/api/jobs/estimate/{id}", 409},
                                                {"/api/jobs/cases", 409},
                                                {"/api/jobs/{id}", 409},
                                                {"/api/jobs/{id}/cancel", 409},
                                                {"/api/jobs/{id}/resume", 409},
                                                {"/api/reports/{ticket}", 404},
                                                {"/api/quit", 409},  // this server has no start page
                                                {"/api/flow/{name}", 404},
                                                {"PUT /api/overlays", 400},   // an empty file
                                                {"POST /api/overlays", 409},  // nothing to bring back
                                                {"/api/overlays/{id}", 404},
                                                {"/api/tiles/{id}", 404},
                                                {"/api/overlays/{id}/picture", 404},
                                                {"/api/scenarios/{s}/depth_averaged/layers/{name}", 404},
                                                {"/api/scenarios/{s}/depth_averaged/comparison", 404}};  // off
    for (const serve::Route& route : server_->routes()) {
        SCOPED_TRACE(route.method + " " + route.pattern);
        const std::string name = names.count(route.pattern) ? names.at(route.pattern) : "nothing";
        const std::string query = queries.count(route.pattern) ? queries.at(route.pattern) : "";
        const bool sends = route.method == "POST" && bodies.count(route.pattern) > 0;
        const std::string body = sends ? bodies.at(route.pattern).dump() : "";
        const std::string target = filled(route.pattern, route.method == "DELETE" ? "B" : "A", name) + query;
        const Answer answer = hand.ask(route.method, target, body);
        const bool no_address = route.method == "POST" && route.pattern == "/api/share";
        const std::string method_and_pattern = route.method + " " + route.pattern;
        const std::string& key = refused.count(method_and_pattern) > 0 ? method_and_pattern : route.pattern;
        EXPECT_EQ(answer.status, no_address               ? 409
                                 : refused.count(key) > 0 ? refused.at(key)
                                                          : 200)
            << answer.body.substr(0, 300);
        expect_described(route.method, route.pattern, answer);
        if (route.needs != serve::Role::nobody) {
            expect_described(route.method, route.pattern, nobody.ask(route.method, target, body));
        }
        if (route.pattern.find("{s}") != std::string::npos) {
            const Answer none = hand.ask(route.method, filled(route.pattern, "G", name) + query, body);
            EXPECT_EQ(none.status, 404);
            expect_described(route.method, route.pattern, none);
        }
    }
}

TEST_F(OpenApi, the_depth_averaged_model_answers_as_described) {
    start({"solver.end_time_s=3"});
    const std::string route = "/api/scenarios/{s}/depth_averaged", path = filled(route, "A", "");
    HttpClient hand = as_controller();
    act({{"action", "step"}});
    ASSERT_EQ(hand.post("/api/depth_averaged", {{"on", true}}).status, 200);
    for (int i = 0; i < 1000 && hand.get(path).json()["state"] != "done"; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    ASSERT_EQ(hand.get(path).json()["state"], "done");
    expect_described("GET", route, hand.get(path));
    expect_described("GET", route + "/comparison", hand.get(path + "/comparison"));
    for (const char* rest : {"/layers/depth?time_s=1", "/layers/nothing", "/layers/depth?time_s=soon"}) {
        expect_described("GET", route + "/layers/{name}", hand.get(path + rest));
    }
    expect_described("POST", "/api/depth_averaged", hand.post("/api/depth_averaged", {{"on", 2}}));
}

TEST_F(OpenApi, messages_of_the_websocket_are_as_described) {
    const json page = {{"$ref", "#/components/schemas/PageMessage"}},
               server = {{"$ref", "#/components/schemas/ServerMessage"}};
    const json action = {{"action", "put_note"}, {"name", "Here"}, {"x_m", 824195}, {"y_m", 825100}};
    EXPECT_EQ(differences(action, {{"$ref", "#/components/schemas/Action"}}, document), std::vector<std::string>());
    WebSocket who = join(controller);
    std::set<std::string> seen;
    std::string secret;
    const auto expect_until = [&](const std::string& type) {
        while (seen.count(type) == 0) {
            const auto message = who.receive();
            ASSERT_TRUE(message) << type;
            if (!message->text) continue;
            const json content = json::parse(message->data);
            seen.insert(content["type"].get<std::string>());
            if (content["type"] == "hello") secret = content["you"]["secret"];
            for (const std::string& line : differences(content, server, document)) {
                ADD_FAILURE() << content["type"] << ": " << line;
            }
        }
    };
    for (const char* type : {"hello", "setup", "state", "calibration", "alerts", "people"}) {
        expect_until(type);
    }
    for (const json& message :
         {view_message(10), json{{"type", "mark"}, {"at", {1, 2, 3}}}, json{{"type", "name"}, {"name", "Eve"}}}) {
        EXPECT_EQ(differences(message, page, document), std::vector<std::string>());
        EXPECT_TRUE(who.send(message));
    }
    EXPECT_FALSE(differences({{"type", "mark"}, {"at", {1, 2}}}, page, document).empty());
    EXPECT_FALSE(differences({{"type", "mark"}}, page, document).empty());
    HttpClient hand = as_controller();
    EXPECT_EQ(hand.post("/api/scenarios/A/actions", action, secret).status, 200);
    expect_until("done");
    EXPECT_EQ(hand.post("/api/scenarios", {{"copy_of", "A"}}, secret).status, 200);
    expect_until("scenarios");
    EXPECT_EQ(hand.post("/api/depth_averaged", {{"on", true}}, secret).status, 200);
    expect_until("depth_averaged");
}

TEST_F(OpenApi, an_obstacle_removed_during_the_run_is_reported_as_described) {
    act({{"action", "step"}});
    const json setup = as_viewer().get("/api/scenarios/A/setup").json();
    ASSERT_FALSE(setup["buildings"].empty());
    EXPECT_EQ(act({{"action", "remove_building"}, {"id", setup["buildings"][0]["id"]}}).status, 200);
    const Answer dam = act({{"action", "put_barrier"},
                            {"line", {{824185, 825080}, {824185, 825120}}},
                            {"height_m", 2},
                            {"thickness_m", 1}});
    ASSERT_EQ(dam.status, 200) << dam.body;
    act({{"action", "step"}});
    EXPECT_EQ(act({{"action", "remove_barrier"}, {"id", dam.json()["created"]}}).status, 200);
    act({{"action", "step"}});
    const Answer impacts = as_viewer().get("/api/scenarios/A/impacts");
    EXPECT_EQ(impacts.json()["removed"].size(), 2U) << impacts.body;
    expect_described("GET", "/api/scenarios/{s}/impacts", impacts);
}

TEST_F(OpenApi, wrong_values_are_refused_as_described) {
    HttpClient hand = as_controller();
    for (const char* query : {"", "?x_m=1", "?x_m=1&y_m=x", "?x_m=nan&y_m=1", "?x_m=1e99&y_m=1"}) {
        const Answer answer = hand.get(std::string("/api/scenarios/A/probe") + query);
        EXPECT_EQ(answer.status, 400) << query;
        expect_described("GET", "/api/scenarios/{s}/probe", answer);
    }
    EXPECT_EQ(hand.get("/api/scenarios/A/frame?time_s=-1").status, 400);
    EXPECT_EQ(hand.get("/api/terrain?max_cells=1").status, 400);
    EXPECT_EQ(hand.get("/api/terrain?max_cells=99999999999").status, 400);
    EXPECT_EQ(hand.get("/api/scenarios/A/layers/nothing").status, 404);
    for (const char* path : {"layers/peak_depth", "impacts", "gauges", "frame"}) {
        const Answer answer = hand.get("/api/scenarios/A/" + std::string(path) + "?time_s=soon");
        EXPECT_EQ(answer.status, 400) << path;
        EXPECT_NE(answer.body.find("time_s = soon"), std::string::npos) << answer.body;
    }
    EXPECT_EQ(hand.get("/api/scenarios/A/exports/nothing").status, 404);
}

TEST_F(OpenApi, terrain_is_thinned_to_what_was_asked) {
    const auto cells = [](const Answer& answer) {
        std::uint32_t size[2] = {};
        std::memcpy(size, answer.body.data() + 32, sizeof size);
        return size[0] * size[1];
    };
    HttpClient eye = as_viewer();
    const Answer whole = eye.get("/api/terrain"), thin = eye.get("/api/terrain?max_cells=700");
    ASSERT_EQ(whole.body.substr(0, 4), "TLSG");
    EXPECT_EQ(cells(whole), 60U * 40U);
    EXPECT_LE(cells(thin), 700U);
    EXPECT_GE(cells(thin), 500U);
    EXPECT_EQ(eye.get("/api/terrain?max_cells=700").body, thin.body);
}

TEST_F(OpenApi, maps_and_impacts_are_also_of_an_earlier_time) {
    act({{"action", "set_speed"}, {"factor", nullptr}});
    act({{"action", "run"}});
    HttpClient eye = as_viewer();
    for (int i = 0; i < 200 && eye.get("/api/scenarios/A/state").json()["time_s"] < 12; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    act({{"action", "pause"}});
    const auto cells_of = [&](const std::string& query) {
        const Answer answer = eye.get("/api/scenarios/A/layers/peak_depth" + query);
        EXPECT_EQ(answer.status, 200);
        std::uint32_t size[2] = {};
        std::memcpy(size, answer.body.data() + 32, sizeof size);
        return size[0] * size[1];
    };
    EXPECT_LT(cells_of("?time_s=0.3"), cells_of("?time_s=3"));
    EXPECT_LE(cells_of("?time_s=3"), cells_of(""));
    const Answer then = eye.get("/api/scenarios/A/impacts?time_s=0.2"), now = eye.get("/api/scenarios/A/impacts");
    expect_described("GET", "/api/scenarios/{s}/impacts", then);
    EXPECT_EQ(then.json()["buildings"][0]["hit"], false);
    EXPECT_EQ(now.json()["buildings"][0]["hit"], true);
}

TEST_F(OpenApi, the_scene_s_orthophoto_is_served_cut_to_the_terrain) {
    PhotoOptions options;
    options.x_min = 824000;
    options.y_max = 825200;
    options.pixel = 3;
    options.columns = 100;
    options.rows = 70;
    const std::string file = write_photo(scene_.input("photo.tif"), options);
    EXPECT_EQ(as_viewer().get("/api/scene").json()["orthophoto"], false);
    start({"terrain.orthophoto=" + file});
    EXPECT_EQ(as_viewer().get("/api/scene").json()["orthophoto"], true);
    const Answer photo = as_viewer().get("/api/orthophoto");
    ASSERT_EQ(photo.status, 200) << photo.body;
    expect_described("GET", "/api/orthophoto", photo);
    const auto pixel = ReadPhoto(photo.body).at(0.25, 0.25);
    EXPECT_GT(pixel[0], 200);
    EXPECT_LT(pixel[1], 50);
    EXPECT_EQ(HttpClient(port()).get("/api/orthophoto").status, 401);
}

TEST_F(OpenApi, exports_are_of_the_run_so_far) {
    HttpClient eye = as_viewer();
    const auto bytes_of = [&](const std::string& name) {
        const json listed = eye.get("/api/scenarios/A/exports").json();
        for (const json& file : listed["files"]) {
            if (file["name"] == name) return file["bytes"];
        }
        return json("not listed");
    };
    act({{"action", "step"}});
    EXPECT_TRUE(bytes_of("timeseries.csv").is_null());
    const Answer first = eye.get("/api/scenarios/A/exports/timeseries.csv");
    ASSERT_EQ(first.status, 200);
    EXPECT_EQ(first.headers.at("content-disposition"), "attachment; filename=\"timeseries.csv\"");
    EXPECT_EQ(bytes_of("timeseries.csv"), first.body.size());
    for (int i = 0; i < 30; ++i) act({{"action", "step"}});
    EXPECT_TRUE(bytes_of("timeseries.csv").is_null());
    EXPECT_EQ(eye.get("/api/scenarios/A/exports/report.html").status, 200);
    const Answer results = eye.get("/api/scenarios/A/exports/results.json");
    EXPECT_EQ(results.json()["format"], "talus results");
    EXPECT_EQ(bytes_of("results.json"), results.body.size());
    EXPECT_EQ(eye.get("/api/scenarios/A/exports/peak_depth.tif").status, 200);
    EXPECT_EQ(bytes_of("erosion_depth.tif"), "not listed");
    const Answer none = eye.get("/api/scenarios/A/exports/erosion_depth.tif");
    EXPECT_EQ(none.status, 404);
    EXPECT_NE(none.body.find("nothing was entrained"), std::string::npos);
}

TEST_F(OpenApi, exports_have_the_files_of_a_run_for_other_readers) {
    const auto get = [&](const std::string& name) { return as_viewer().get("/api/scenarios/A/exports/" + name); };
    const Answer none = get("gauges.csv");
    EXPECT_EQ(none.status, 404);
    EXPECT_NE(none.body.find("the scene has no gauges"), std::string::npos);
    scene_.replace("[[observation]]", "[[gauge]]\nname = \"Bridge\"\nchainage_m = 5\n\n[[observation]]");
    start();
    act({{"action", "step"}});
    EXPECT_NE(get("gauges.csv").body.find("Bridge"), std::string::npos);
    EXPECT_EQ(get("stac_item.json").json()["type"], "Feature");
    EXPECT_NE(get("results.kml").body.find("<kml"), std::string::npos);
    std::vector<std::string> listed;
    const json answer = as_viewer().get("/api/scenarios/A/exports").json();
    for (const json& file : answer["files"]) {
        const bool packed_when_asked_for = file["name"] == "scene.zip" || file["name"] == "twin.html";
        EXPECT_TRUE(packed_when_asked_for || file["bytes"] > 0) << file;
        listed.push_back(file["name"]);
    }
    for (const char* name : {"gauges.csv", "stac_item.json", "results.kml"})
        EXPECT_THAT(listed, ::testing::Contains(name));
}

}  // namespace
}  // namespace talus::test
