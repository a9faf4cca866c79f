#include "session/page_api.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "session/page_fixture.hpp"

namespace talus::session {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using ::testing::HasSubstr;

/// The requests of a page to a session in its own worker.
class PageApiTest : public PageOfASession {
  protected:
    json content(const std::string& method, const std::string& target, const std::string& body = "", int status = 200) {
        const PageAnswer answer = ask(method, target, body);
        EXPECT_EQ(answer.status, status) << method << " " << target << ": " << *answer.body;
        EXPECT_EQ(answer.type, "application/json");
        return json::parse(*answer.body);
    }
    std::string refusal(const std::string& method, const std::string& target, const std::string& body, int status) {
        return content(method, target, body, status).at("error");
    }
};

TEST_F(PageApiTest, answers_what_a_page_asks_when_it_opens) {
    EXPECT_EQ(content("GET", "/api/scene").at("title"), "Channel");
    EXPECT_EQ(content("GET", "/api/session").at("title"), "Channel");
    const PageAnswer coarse = ask("GET", "/api/terrain?max_cells=2000");
    EXPECT_EQ(coarse.type, "application/octet-stream");
    EXPECT_EQ(coarse.body, ask("GET", "/api/terrain?max_cells=2000").body) << "encoded once";
    EXPECT_THAT(refusal("GET", "/api/terrain?max_cells=7", "", 400), HasSubstr("max_cells = 7"));
    EXPECT_THAT(refusal("GET", "/api/orthophoto", "", 404), HasSubstr("terrain.orthophoto"));
}

TEST_F(PageApiTest, has_the_orthophoto_that_it_was_given) {
    PageApi with_picture(*session_, *scene_,
                         PageApi::Picture{"image/webp", std::make_shared<const std::string>("bytes")});
    const PageAnswer answer = with_picture.answer("GET", "/api/orthophoto", "", ann_, now_);
    EXPECT_EQ(answer.type, "image/webp");
    EXPECT_EQ(*answer.body, "bytes");
}

TEST_F(PageApiTest, answers_every_question_about_a_scenario) {
    for (const Question& question : questions()) {
        std::string name = question.name;
        if (name == "layers/{name}") name = "layers/depth";
        if (name == "probe") name += "?x_m=20&y_m=30";
        EXPECT_EQ(ask("GET", "/api/scenarios/A/" + name).status, 200) << name;
    }
    EXPECT_TRUE(content("GET", "/api/scenarios/A/observed").at("rows").empty()) << "the scene has no observations";
    EXPECT_THAT(refusal("GET", "/api/scenarios/Z/state", "", 404), HasSubstr("no scenario Z"));
    EXPECT_THAT(refusal("GET", "/api/scenarios/A/state?when=now", "", 400), HasSubstr("the query has no when"));
    EXPECT_EQ(ask("GET", "/api/scenarios/A/layers/colour").status, 404);
}

TEST_F(PageApiTest, a_run_has_its_tables_and_maps_once_it_has_begun) {
    const std::string exports = "/api/scenarios/A/exports";
    EXPECT_TRUE(content("GET", exports).at("files").empty());
    EXPECT_THAT(refusal("GET", "/api/scenarios/Z/exports", "", 404), HasSubstr("no scenario Z"));
    EXPECT_TRUE(content("GET", "/api/scenarios/A/journal").contains("last"));

    EXPECT_THAT(refusal("GET", exports + "/front.csv", "", 404), HasSubstr("no results yet"));
    content("POST", "/api/scenarios/A/actions", R"({"action": "run"})");
    while (content("GET", "/api/scenarios/A/state").at("step") < 20) session_->advance(now_, milliseconds(20));
    std::vector<std::string> names;
    const json list = content("GET", exports);
    for (const json& file : list.at("files")) {
        names.push_back(file.at("name"));
        const PageAnswer answer = ask("GET", exports + "/" + names.back());
        EXPECT_EQ(answer.status, 200) << names.back();
        EXPECT_GT(answer.body->size(), 20U) << names.back();
        EXPECT_NE(file.at("what"), "") << names.back();
    }
    EXPECT_THAT(names, testing::IsSupersetOf({"front.csv", "timeseries.csv", "peak_depth.tif", "intensity.tif"}));
    EXPECT_EQ(ask("GET", exports + "/front.csv").type, "text/csv");
    const Bytes listed = ask("GET", exports + "/timeseries.csv").body;
    const int step = content("GET", "/api/scenarios/A/state").at("step");
    for (int k = 0; k < 2000 && content("GET", "/api/scenarios/A/state").at("step") < step + 200; ++k) {
        session_->advance(now_, milliseconds(20));
    }
    EXPECT_EQ(*ask("GET", exports + "/timeseries.csv").body, *listed) << "all files of a list are of one moment";
    content("GET", exports);
    EXPECT_NE(*ask("GET", exports + "/timeseries.csv").body, *listed);
    EXPECT_THAT(refusal("GET", exports + "/report.html", "", 404), HasSubstr("needs the program"));
}

TEST_F(PageApiTest, what_needs_a_machine_is_refused_in_a_sentence) {
    for (const char* target : {"/api/ensembles", "/api/share", "/", "/api/scenarios//"}) {
        EXPECT_THAT(refusal("GET", target, "", 404), HasSubstr("needs the program on a machine")) << target;
    }
    EXPECT_THAT(refusal("PUT", "/api/scenarios", "", 404), HasSubstr("PUT /api/scenarios"));
}

TEST_F(PageApiTest, a_change_is_made_before_it_is_answered) {
    const std::string target = "/api/scenarios/A/actions";
    const json set = {{"action", "set_parameters"}, {"values", {{"material.friction_coefficient", 0.3}}}};
    content("POST", target, set.dump());
    EXPECT_EQ(content("GET", "/api/scenarios/A/journal").at("actions").size(), 1U);
    const json wrong = {{"action", "set_parameters"}, {"values", {{"material.friction_coefficient", -3}}}};
    EXPECT_THAT(refusal("POST", target, wrong.dump(), 400), HasSubstr("friction_coefficient"));
    EXPECT_EQ(ask("POST", target, "{\"action\":").status, 400) << "no JSON";
    EXPECT_EQ(content("GET", "/api/scenarios/A/journal").at("actions").size(), 1U) << "nothing was changed";
}

TEST_F(PageApiTest, scenarios_are_copied_and_ended) {
    EXPECT_EQ(content("POST", "/api/scenarios", R"({"copy_of": "A"})").at("created"), "B");
    EXPECT_EQ(content("GET", "/api/scenarios/B/state").at("time_s"), 0);
    content("DELETE", "/api/scenarios/B");
    EXPECT_EQ(ask("GET", "/api/scenarios/B/state").status, 404);
}

TEST_F(PageApiTest, only_who_has_control_changes_anything) {
    const std::string bo = session_->join(Role::controller, "Bo", time_);
    const std::string run = R"({"action": "run"})";
    const PageAnswer refused = api_.answer("POST", "/api/scenarios/A/actions", run, bo, now_);
    EXPECT_EQ(refused.status, 409);
    EXPECT_THAT(*refused.body, HasSubstr("Ann has control"));
    content("POST", "/api/control", R"({"do": "release"})");
    EXPECT_EQ(api_.answer("POST", "/api/control", R"({"do": "request"})", bo, now_).status, 200);
    EXPECT_EQ(api_.answer("POST", "/api/scenarios/A/actions", run, bo, now_).status, 200);
    EXPECT_THAT(refusal("POST", "/api/control", R"({"do": "take"})", 400), HasSubstr("do = \"take\""));
}

}  // namespace
}  // namespace talus::session
