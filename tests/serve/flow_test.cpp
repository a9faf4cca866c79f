#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "geo/gltf_file.hpp"
#include "serve/serve_fixture.hpp"

namespace talus::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// Files of the moving flow, asked for as a page does.
class FlowTest : public Serve {
  protected:
    void SetUp() override {
        start({"solver.end_time_s=6"});
        act({{"action", "set_speed"}, {"factor", nullptr}});
        act({{"action", "run"}});
        HttpClient eye = as_viewer();
        until([&] { return eye.get("/api/scenarios/A/state").json()["time_s"] >= 3; });
        act({{"action", "pause"}});
    }
    template <class Condition>
    static void until(const Condition& holds) {
        for (int i = 0; i < 3000 && !holds(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
        ASSERT_TRUE(holds());
    }
    static json ended(HttpClient& client) {
        json job;
        until([&] {
            job = client.get("/api/flow").json();
            return job["state"] != "running" && job["state"] != "cancelling";
        });
        return job;
    }
    /// Folders of flows that are there.
    [[nodiscard]] int folders() const {
        int count = 0;
        for (const auto& entry : std::filesystem::directory_iterator(scene_.folder())) {
            count += entry.path().filename().string().starts_with("flow-") ? 1 : 0;
        }
        return count;
    }
};

TEST_F(FlowTest, is_offered_written_and_read_back) {
    HttpClient hand = as_controller(), eye = as_viewer();
    EXPECT_EQ(eye.get("/api/flow").json()["state"], "idle");
    const json offer = eye.get("/api/scenarios/A/flow?interval_s=0.5").json();
    EXPECT_EQ(offer["scenario"], "A");
    EXPECT_EQ(offer["interval_s"], 0.5);
    EXPECT_GE(offer["frames"], 7);
    EXPECT_GT(offer["formats"][0]["bytes"], 1000) << offer;
    const Answer begun =
        hand.post("/api/scenarios/A/flow", {{"formats", {"gltf", "3dtiles", "netcdf"}}, {"interval_s", 0.5}});
    ASSERT_EQ(begun.status, 200) << begun.body;
    EXPECT_EQ(begun.json()["scenario"], "A");
    const json job = ended(eye);
    ASSERT_EQ(job["state"], "done") << job;
    std::vector<std::string> names;
    for (const json& file : job["files"]) {
        const Answer answer = eye.get("/api/flow/" + file["name"].get<std::string>());
        EXPECT_EQ(answer.status, 200) << file;
        EXPECT_EQ(answer.body.size(), file["bytes"]);
        names.push_back(file["name"]);
        std::ofstream(scene_.folder() / names.back(), std::ios::binary) << answer.body;
    }
    EXPECT_THAT(names, ::testing::ElementsAre("run.glb", "tileset.json", "maps.nc"));
    const auto glb = geo::GltfFile::open(scene_.input("run.glb"));
    ASSERT_TRUE(glb) << glb.error().message;
    std::size_t moments = 0;
    for (const json& mesh : glb->root()["meshes"]) {
        moments += mesh["name"].get<std::string>().starts_with("debris") ? 1U : 0U;
    }
    EXPECT_EQ(moments, offer["frames"]);

    EXPECT_EQ(hand.ask("DELETE", "/api/flow").json()["state"], "idle");
    EXPECT_EQ(eye.get("/api/flow/run.glb").status, 404);
    EXPECT_EQ(folders(), 0);
}

TEST_F(FlowTest, is_cancelled_and_leaves_nothing) {
    HttpClient hand = as_controller();
    const json all = {{"formats", {"gltf", "geotiff", "netcdf"}}, {"interval_s", 0.1}};
    ASSERT_EQ(hand.post("/api/scenarios/A/flow", all).status, 200);
    const json told = hand.ask("DELETE", "/api/flow").json();
    EXPECT_THAT(told["state"], ::testing::AnyOf("cancelling", "idle")) << "idle: it was done before";
    const json job = ended(hand);
    EXPECT_THAT(job["state"], ::testing::AnyOf("cancelled", "idle"));
    EXPECT_TRUE(job["files"].empty());
    EXPECT_EQ(folders(), 0);
    ASSERT_EQ(hand.post("/api/scenarios/A/flow", {{"formats", {"gltf"}}}).status, 200) << "another one after it";
    EXPECT_EQ(ended(hand)["state"], "done");
    server_.reset();
    EXPECT_EQ(folders(), 0) << "the session's end deletes the files";
}

TEST_F(FlowTest, is_refused_in_one_sentence) {
    HttpClient hand = as_controller();
    EXPECT_EQ(as_viewer().post("/api/scenarios/A/flow", {{"formats", {"gltf"}}}).status, 403);
    EXPECT_EQ(as_viewer().ask("DELETE", "/api/flow").status, 403);
    const std::pair<json, const char*> wrong[] = {
        {{{"formats", json::array()}}, "name at least one"},
        {{{"formats", {"usd"}}}, "each is one of gltf, 3dtiles, geotiff, netcdf"},
        {{{"formats", {3}}}, "formats = 3; each is a name"},
        {{{"interval_s", 1}}, "formats: is a list of names"},
        {{{"formats", {"gltf"}}, {"interval_s", 0}}, "interval_s = 0"},
        {{{"formats", {"gltf"}}, {"colour", "red"}}, "colour"},
    };
    for (const auto& [body, sentence] : wrong) {
        const Answer answer = hand.post("/api/scenarios/A/flow", body);
        EXPECT_EQ(answer.status, 400) << body;
        EXPECT_THAT(answer.json()["error"], HasSubstr(sentence));
    }
    EXPECT_EQ(hand.get("/api/scenarios/A/flow?interval_s=soon").status, 400);
    EXPECT_EQ(hand.get("/api/flow/..%2Fslope.toml").status, 404);
    EXPECT_EQ(hand.get("/api/flow").json()["state"], "idle");
}

}  // namespace
}  // namespace talus::test
