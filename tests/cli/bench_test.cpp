// `talus bench` as its users run it.
#include <csignal>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "support/fixtures.hpp"

namespace talus::test {
namespace {

using testing::HasSubstr;

class Bench : public testing::Test {
  protected:
    [[nodiscard]] ProgramOutcome run(std::vector<std::string> arguments, ProgramOptions options = {}) const {
        arguments.insert(arguments.begin(), "bench");
        options.folder = folder_.path();
        return run_program(arguments, options);
    }
    [[nodiscard]] nlohmann::json rows(const std::string& file) const {
        return nlohmann::json::parse(read_text(folder_.path() / file));
    }

    const std::vector<std::string> short_ = {"--particles", "600", "--repeats", "2", "--steps", "2", "--warm-up", "1"};
    TemporaryFolder folder_;
};

TEST_F(Bench, measures_every_scene_method_size_and_number_of_threads) {
    std::vector<std::string> arguments = short_;
    arguments[1] = "600,900";
    for (const char* more : {"--threads", "1,2", "--json-file", "b.json"}) arguments.emplace_back(more);
    const ProgramOutcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_THAT(outcome.out, HasSubstr("share of each stage"));
    EXPECT_THAT(outcome.error, HasSubstr("row 24 of 24"));
    const auto list = rows("b.json");
    ASSERT_EQ(list.size(), 3U * 2 * 2 * 2);
    for (std::size_t i = 0; i < list.size(); i += 2) {
        EXPECT_EQ(list[i]["threads"], 1);
        EXPECT_EQ(list[i + 1]["threads"], 2);
        EXPECT_EQ(list[i]["hash"], list[i + 1]["hash"]) << "the same on any number of threads";
        EXPECT_THAT(outcome.out, HasSubstr(list[i]["hash"].get<std::string>()));
        EXPECT_NE(list[i]["hash"], list[(i + 2) % list.size()]["hash"]);
        EXPECT_GT(list[i]["steps_per_second"], 0);
    }
    EXPECT_EQ(list.back()["scene"], "sham_tseng");
}

TEST_F(Bench, prints_its_rows_as_json_lines) {
    std::vector<std::string> arguments = short_;
    for (const char* more :
         {"--scene", "slab", "--method", "stress", "--threads", "1,2", "--json", "--json-file", "b.json"}) {
        arguments.emplace_back(more);
    }
    const ProgramOutcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto lines = lines_of(outcome.out);
    const auto list = rows("b.json");
    ASSERT_EQ(lines.size(), 2U) << outcome.out;
    for (std::size_t i = 0; i < 2; ++i) {
        auto line = nlohmann::json::parse(lines[i]);
        EXPECT_EQ(line["event"], "row");
        line.erase("event");
        EXPECT_EQ(line, list[i]);
    }
}

TEST_F(Bench, chooses_and_repeats_itself) {
    std::vector<std::string> arguments = short_;
    for (const char* more : {"--scene", "column", "--method", "pair", "--iterations", "3", "--backend", "cpu"}) {
        arguments.emplace_back(more);
    }
    std::vector<std::string> hashes;
    for (const char* file : {"first.json", "second.json"}) {
        std::vector<std::string> now = arguments;
        now.insert(now.end(), {"--json-file", file});
        EXPECT_EQ(run(now).exit_code, 0);
        const auto list = rows(file);
        ASSERT_EQ(list.size(), 1U);
        EXPECT_EQ(list[0]["scene"], "column");
        EXPECT_EQ(list[0]["method"], "pair");
        EXPECT_EQ(list[0]["iterations"], 3);
        EXPECT_EQ(list[0]["steps"], 2);
        EXPECT_EQ(list[0]["repeats"], 2);
        EXPECT_EQ(list[0]["warm_up_steps"], 1);
        hashes.push_back(list[0]["hash"]);
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

TEST_F(Bench, measures_the_code_of_a_card_on_the_processor) {
    std::vector<std::string> arguments = short_;
    for (const char* more :
         {"--scene", "slab", "--method", "stress", "--backend", "host", "--json-file", "host.json"}) {
        arguments.emplace_back(more);
    }
    ASSERT_EQ(run(arguments).exit_code, 0);
    const auto list = rows("host.json");
    ASSERT_EQ(list.size(), 1U);
    EXPECT_EQ(list[0]["backend"], "host");
    EXPECT_EQ(list[0]["instruction_set"], "host");
    EXPECT_GT(list[0]["neighbours_per_particle"], 10);
    EXPECT_GT(list[0]["bytes_per_particle"], 100);
}

TEST_F(Bench, bad_input_is_refused_in_one_line_before_anything_runs) {
    const std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> refused = {
        {{"--backend", "abacus"}, {"--backend", "abacus", "cpu, cuda, auto, host"}},
        {{"--scene", "slab,wedge"}, {"--scene", "wedge", "slab", "column", "sham_tseng"}},
        {{"--method", "magic"}, {"--method", "magic", "pair", "stress"}},
        {{"--particles", "20000,5"}, {"--particles", "5", "500", "4000000"}},
        {{"--particles", "many"}, {"--particles", "many"}},
        {{"--threads", "0"}, {"--threads", "0", "1", "512"}},
        {{"--iterations", "0"}, {"--iterations", "0", "1000"}},
        {{"--repeats", "-1"}, {"--repeats", "-1", "1000"}},
        {{"--steps", "0"}, {"--steps", "0"}},
        {{"--full", "--particles", "5000"}, {"--full", "--particles"}},
        {{"--json-file", "no/such/folder/b.json"}, {"no/such/folder"}},
        {{"--json-file", "."}, {"is a folder"}},
        {{"stray"}, {"stray", "talus bench --help"}},
        {{"--json", "b.json"}, {"b.json", "--json-file FILE"}},
    };
    for (const auto& [arguments, said] : refused) {
        const ProgramOutcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 2) << arguments[0];
        EXPECT_EQ(outcome.out, "");
        EXPECT_EQ(lines_of(outcome.error).size(), 1U) << outcome.error;
        for (const std::string& part : said) EXPECT_THAT(outcome.error, HasSubstr(part));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(Bench, a_full_disk_leaves_no_piece_of_a_file) {
    std::vector<std::string> arguments = short_;
    for (const char* more : {"--scene", "slab", "--json-file", "b.json"}) arguments.emplace_back(more);
    const ProgramOutcome outcome = run(arguments, {.largest_file = 100});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.error, HasSubstr("b.json"));
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "b.json"));
}

TEST_F(Bench, an_interrupt_shows_what_was_complete_and_writes_nothing) {
    ProgramOptions options;
    options.wait_for = "row 2 of";
    options.while_running = [](int process) { kill(process, SIGINT); };
    const ProgramOutcome outcome = run({"--scene", "slab", "--particles", "600,20000", "--method", "stress", "--steps",
                                        "10", "--repeats", "50", "--json-file", "b.json"},
                                       options);
    EXPECT_EQ(outcome.exit_code, 130);
    EXPECT_THAT(outcome.out, HasSubstr("slab"));
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "b.json"));
}

TEST_F(Bench, help_teaches) {
    const ProgramOutcome outcome = run({"--help"});
    EXPECT_EQ(outcome.exit_code, 0);
    for (const char* part :
         {"slab", "column", "sham_tseng", "--threads", "relative", "hash", "130", "talus bench --"}) {
        EXPECT_THAT(outcome.out, HasSubstr(part));
    }
}

}  // namespace
}  // namespace talus::test
