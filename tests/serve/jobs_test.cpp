#include "serve/jobs.hpp"

#include <filesystem>
#include <fstream>
#include <sys/stat.h>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "ensemble/finished_ensemble.hpp"
#include "serve/start_fixture.hpp"

namespace talus::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

/// A start page whose jobs are computed by the program of the release build.
class JobsTest : public StartPage {
  protected:
    void SetUp() override {
        program_ = TALUS_PROGRAM;
        StartPage::SetUp();
    }
    [[nodiscard]] json factor(double low = 0.3, double high = 0.5) const {
        return {{"key", "material.friction_coefficient"}, {"low", low}, {"high", high}};
    }
    [[nodiscard]] json ensemble(int runs) const {
        return {{"kind", "ensemble"}, {"scene", id()}, {"factors", {factor()}}, {"runs", runs}};
    }
    std::string begin(const json& wanted) {
        const Answer answer = hand().post("/api/jobs", wanted);
        EXPECT_EQ(answer.status, 202) << answer.body;
        return answer.status == 202 ? answer.json()["created"].get<std::string>() : "";
    }
    [[nodiscard]] json job(const std::string& name) const {
        const json now = page();
        for (const json& one : now["jobs"]) {
            if (one["id"] == name) return one;
        }
        return nullptr;
    }
    /// The job once `good` says so; a test that fails waits until its own time is over.
    json wait(const std::string& name, const std::function<bool(const json&)>& good) {
        json now = job(name);
        // What has ended changes no more.
        while (!good(now) && now["ended_at"].is_null()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
            now = job(name);
        }
        EXPECT_TRUE(good(now)) << now.dump();
        return now;
    }
    json ended(const std::string& name) {
        return wait(name, [](const json& now) { return !now["ended_at"].is_null(); });
    }
    [[nodiscard]] fs::path results(const std::string& name) const { return folder() / "jobs" / name; }
};

TEST_F(JobsTest, an_ensemble_is_computed_by_the_command_reported_and_opened_on_its_scene) {
    const std::string name = begin(ensemble(4));
    const json done = ended(name);
    EXPECT_EQ(done["state"], "done") << done["message"];
    EXPECT_EQ(done["done"], 4);
    EXPECT_THAT(done["command"].get<std::string>(), HasSubstr("--vary material.friction_coefficient=0.3:0.5 --runs 4"));
    // The folder is that of the command.
    const auto finished = ensemble::read_finished_ensemble(results(name));
    ASSERT_TRUE(finished) << finished.error().message;
    EXPECT_EQ(finished->complete, 4U);

    // The report is a page of its own, which a link without a token reaches.
    const std::string link = "/" + done["report"].get<std::string>();
    const Answer report = HttpClient(server_->port()).get(link);
    EXPECT_EQ(report.status, 200);
    EXPECT_THAT(report.body, HasSubstr("<html"));
    EXPECT_THAT(report.headers.at("content-security-policy"), HasSubstr("sandbox"));
    EXPECT_EQ(HttpClient(server_->port()).get("/api/reports/" + name).status, 404);

    const json after = open({{"ensemble", name}});
    EXPECT_TRUE(after["error"].is_null()) << after["error"];
    const json shown = hand().get("/api/ensembles").json()["ensembles"];
    ASSERT_EQ(shown.size(), 1U);
    EXPECT_EQ(shown[0]["runs"], 4);
    EXPECT_EQ(hand().post("/api/open", {{"ensemble", "ensemble-9"}, {"replace", true}}).status, 404);
}

TEST_F(JobsTest, one_runs_at_a_time_and_one_that_waits_is_cancelled) {
    const std::string first = begin(ensemble(2000)), second = begin(ensemble(2));
    wait(first, [](const json& now) { return now["state"] == "running" && now["done"] > 0; });
    EXPECT_EQ(job(second)["state"], "waiting");
    EXPECT_EQ(hand().ask("DELETE", "/api/jobs/" + first).status, 409);
    EXPECT_EQ(hand().ask("POST", "/api/jobs/" + second + "/cancel").status, 200);
    EXPECT_EQ(job(second)["state"], "cancelled");
    const std::string third = begin(ensemble(2));
    EXPECT_EQ(hand().ask("POST", "/api/jobs/" + first + "/cancel").status, 200);
    EXPECT_EQ(ended(first)["state"], "cancelled");
    EXPECT_EQ(ended(third)["state"], "done");
    EXPECT_EQ(hand().ask("POST", "/api/jobs/" + first + "/cancel").status, 409);
    EXPECT_EQ(hand().ask("DELETE", "/api/jobs/" + first).status, 200);
    EXPECT_FALSE(fs::exists(results(first)));
    EXPECT_TRUE(job(first).is_null());
}

TEST_F(JobsTest, one_that_was_interrupted_is_listed_after_a_restart_and_goes_on_where_it_was) {
    // So many that no machine has finished them when the program ends; only a few are computed.
    const std::string name = begin(ensemble(1000));
    wait(name, [](const json& now) { return now["done"] > 2; });
    start();  // ends the program of before and begins another on the same folder
    EXPECT_EQ(job(name)["state"], "interrupted");
    const auto runs = std::distance(fs::directory_iterator(results(name) / "runs"), fs::directory_iterator());
    EXPECT_GT(runs, 2);
    const auto first_written = fs::last_write_time(results(name) / "runs/000000.run");
    EXPECT_EQ(hand().ask("POST", "/api/jobs/" + name + "/resume").status, 200);
    wait(name, [&](const json& now) { return now["state"] == "running" && now["done"] > runs + 2; });
    EXPECT_EQ(fs::last_write_time(results(name) / "runs/000000.run"), first_written);
    start();
    EXPECT_EQ(job(name)["state"], "interrupted");
}

TEST_F(JobsTest, one_that_is_done_is_done_after_a_restart_and_cannot_go_on) {
    const std::string name = begin(ensemble(4));
    EXPECT_EQ(ended(name)["state"], "done");
    start();
    EXPECT_EQ(job(name)["state"], "done");
    EXPECT_EQ(job(name)["done"], 4);
    EXPECT_EQ(hand().ask("POST", "/api/jobs/" + name + "/resume").status, 409);
}

TEST_F(JobsTest, a_validation_computes_the_cases_that_are_named) {
    const json cases = hand().get("/api/jobs/cases").json()["cases"];
    EXPECT_GT(cases.size(), 20U);
    const std::string name = begin({{"kind", "validation"}, {"cases", {"free_fall"}}});
    const json done = ended(name);
    EXPECT_EQ(done["state"], "done") << done["message"];
    EXPECT_THAT(done["message"].get<std::string>(), HasSubstr("values pass, 0 fail"));
    EXPECT_EQ(done["done"], 1);
    EXPECT_THAT(HttpClient(server_->port()).get("/" + done["report"].get<std::string>()).body, HasSubstr("free_fall"));
    EXPECT_EQ(hand().post("/api/jobs", {{"kind", "validation"}, {"cases", {"../free_fall"}}}).status, 400);
}

TEST_F(JobsTest, the_form_has_the_values_of_the_scene_and_an_estimate) {
    const json form = hand().get("/api/jobs/form/" + id()).json();
    std::map<std::string, json> parameters;
    for (const json& one : form["parameters"]) parameters[one["key"]] = one;
    EXPECT_EQ(parameters.at("release.thickness_m")["value"], 0.3);
    EXPECT_EQ(parameters.at("release.thickness_m")["unit"], "m");
    EXPECT_EQ(parameters.at("material.friction_coefficient")["range"]["low"], 0);
    EXPECT_EQ(form["observations"].size(), 1U);
    const json estimate = hand().get("/api/jobs/estimate/" + id()).json();
    EXPECT_GT(estimate["run_s"], 0);
    EXPECT_GT(estimate["particles"], 50);
    EXPECT_EQ(hand().get("/api/jobs/form/nothing").status, 404);
}

TEST_F(JobsTest, what_the_command_would_refuse_is_refused_at_once_in_a_sentence) {
    const auto error = [&](json change) {
        json wanted = ensemble(8);
        wanted.update(change);
        const Answer answer = hand().post("/api/jobs", wanted);
        EXPECT_GE(answer.status, 400) << answer.body;
        return answer.json()["error"].get<std::string>();
    };
    EXPECT_THAT(error({{"kind", "run"}}),
                HasSubstr("must be one of ensemble, calibration, validation, risk, options, design"));
    EXPECT_THAT(error({{"scene", scene_.scene_file()}}), HasSubstr("nothing of this id"));
    EXPECT_THAT(error({{"runs", 2001}}), HasSubstr("from 1 to 2000"));
    EXPECT_THAT(error({{"factors", json::array()}}), HasSubstr("1 to 8"));
    EXPECT_THAT(error({{"factors", {factor(0.5, 0.3)}}}), HasSubstr("low below high"));
    EXPECT_THAT(error({{"factors", {factor(), factor()}}}), HasSubstr("twice"));
    EXPECT_THAT(error({{"factors", {factor(-3, 1)}}}), HasSubstr("material.friction_coefficient"));
    EXPECT_THAT(error({{"factors", {{{"key", "--output=/etc"}, {"low", 1}, {"high", 2}}}}}), HasSubstr("no key"));
    EXPECT_THAT(error({{"factors", {{{"key", "material.no_such"}, {"low", 1}, {"high", 2}}}}}), HasSubstr("no_such"));
    EXPECT_THAT(error({{"design", "grid"}}), HasSubstr("latin_hypercube"));
    EXPECT_EQ(error({{"design", "grid"}}).find("grid", sizeof "design = \"grid\""), std::string::npos);
    EXPECT_THAT(error({{"design", "saltelli"}, {"runs", 3}}), HasSubstr("at least"));
    EXPECT_THAT(error({{"kind", "design"}}), HasSubstr("barrier: is needed"));
    EXPECT_THAT(error({{"kind", "design"}, {"barrier", "dam"}}), HasSubstr("there is no barrier \"dam\""));
    EXPECT_THAT(error({{"kind", "design"}, {"barrier", "dam"}, {"share", 2}}), HasSubstr("share 2 is refused"));
    EXPECT_THAT(error({{"kind", "design"}, {"barrier", "dam"}, {"share", "all"}}), HasSubstr("must be a number"));
    EXPECT_THAT(error({{"kind", "design"}, {"barrier", "dam"}, {"of", "houses"}}), HasSubstr("must be runs or volume"));
    EXPECT_THAT(error({{"kind", "design"}, {"barrier", "dam"}, {"confirm", 1}}), HasSubstr("none or particles"));
    EXPECT_THAT(error({{"kind", "design"}, {"barrier", "dam"}, {"design", "morris"}}), HasSubstr("sample"));
    EXPECT_THAT(error({{"barrier", "dam"}}), HasSubstr("barrier"));
    EXPECT_THAT(error({{"more", 1}}), HasSubstr("more"));
    EXPECT_EQ(page()["jobs"], json::array());
    EXPECT_FALSE(fs::exists(folder() / "jobs")) << "nothing is left behind";
}

TEST(JobTest, a_design_is_the_command_with_its_barrier) {
    const auto wanted = serve::read_wanted_job({{"kind", "design"},
                                                {"scene", "valley"},
                                                {"factors", {{{"key", "release.volume_m3"}, {"low", 1}, {"high", 2}}}},
                                                {"barrier", "-gully"},
                                                {"share", 0.1},
                                                {"of", "volume"},
                                                {"max_height_m", 6},
                                                {"confirm", "particles"}});
    ASSERT_TRUE(wanted) << wanted.error().message;
    EXPECT_THAT(arguments_of(*wanted, "scene.toml", "out"),
                ::testing::ElementsAre("design", "scene.toml", "--vary", "release.volume_m3=1:2", "--runs", "32",
                                       "--design", "latin_hypercube", "--barrier=-gully", "--share=0.1", "--of=volume",
                                       "--min-height=1", "--max-height=6", "--confirm=particles", "--output", "out"));
    EXPECT_STREQ(serve::report_of(wanted->kind), "design.html");
}

TEST_F(JobsTest, a_command_that_fails_or_dies_says_why) {
    const std::string script = scene_.input("program");
    const auto outcome_of = [&](const std::string& text) {
        std::ofstream(script) << "#!/bin/sh\n" << text << "\n";
        chmod(script.c_str(), 0700);
        program_ = script;
        start();
        const json now = ended(begin({{"kind", "validation"}, {"quick", true}}));
        EXPECT_EQ(now["state"], "failed");
        EXPECT_TRUE(now["report"].is_null());
        return now["message"].get<std::string>();
    };
    EXPECT_EQ(outcome_of("echo 'talus: error: the disk is full' >&2; exit 1"), "the disk is full");
    EXPECT_THAT(outcome_of("kill -9 $$"), HasSubstr("signal 9 (Killed); is the memory full?"));
    EXPECT_THAT(outcome_of("kill -TERM $$"), HasSubstr("signal 15 (Terminated): somebody or the system ended it"));
    EXPECT_EQ(outcome_of("kill -SEGV $$").find("memory"), std::string::npos);
    EXPECT_THAT(outcome_of("echo '{\"event\": 7}'; echo '['; exit 2"), HasSubstr("exit code 2"));
}

TEST_F(JobsTest, viewers_see_none_and_start_none) {
    const std::string name = begin({{"kind", "validation"}, {"cases", {"free_fall"}}});
    HttpClient eye(server_->port(), viewer);
    EXPECT_FALSE(eye.get("/api/start").json().contains("jobs"));
    EXPECT_EQ(eye.post("/api/jobs", {{"kind", "validation"}}).status, 403);
    EXPECT_EQ(eye.ask("POST", "/api/jobs/" + name + "/cancel").status, 403);
    EXPECT_EQ(eye.ask("DELETE", "/api/jobs/" + name).status, 403);
    EXPECT_EQ(eye.get("/api/jobs/form/" + id()).status, 403);
    EXPECT_EQ(ended(name)["state"], "done");
}

TEST_F(JobsTest, no_more_wait_than_is_said) {
    begin(ensemble(2000));
    int refused = 0;
    for (int i = 0; i < 12; ++i) {
        const Answer answer = hand().post("/api/jobs", {{"kind", "validation"}});
        if (answer.status != 409) continue;
        ++refused;
        EXPECT_THAT(answer.body, HasSubstr("8 jobs wait already"));
    }
    EXPECT_GE(refused, 3);
    EXPECT_LE(refused, 4);
}

TEST(JobText, a_record_that_is_damaged_or_foreign_is_left_out) {
    serve::Job job;
    job.id = "ensemble-1";
    job.arguments = {"ensemble", "--vary", "a=1:2"};
    const auto again = serve::read_job(serve::job_text(job));
    ASSERT_TRUE(again);
    EXPECT_EQ(again->arguments, job.arguments);
    for (const char* text : {"", "{", "{}", "[]", R"({"talus_job": 1})", R"({"talus_job": 1, "kind": "other"})"}) {
        EXPECT_FALSE(serve::read_job(text)) << text;
    }
    EXPECT_EQ(serve::command_text({"validate", "it's", "a b"}), "talus validate 'it'\\''s' 'a b'");
}

}  // namespace
}  // namespace talus::test
