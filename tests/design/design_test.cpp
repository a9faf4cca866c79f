#include "design/design.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/scene_folder.hpp"

namespace talus::design {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class DesignTest : public scene::SceneFolder {
  protected:
    void SetUp() override {
        write_valley(
            fmt::format("[solver]\nmodel = \"depth_averaged\"\nend_time_s = 12\n"
                        "[[barrier]]\nname = \"wall\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nheight_m = 4\n"
                        "thickness_m = 5\n",
                        west + 90, south + 20, south + 180));
    }
    [[nodiscard]] DesignRequest request() const {
        DesignRequest wanted;
        wanted.plan.runs = 3;
        wanted.plan.factors.clear();
        EXPECT_TRUE(add_factor(wanted.plan, "release.thickness_m=1:3"));
        EXPECT_TRUE(add_factor(wanted.plan, "material.friction_coefficient=0.1:0.2"));
        wanted.source.file = folder / "scene.toml";
        wanted.scene_name = "valley";
        wanted.folder = folder / "out";
        wanted.barrier = "wall";
        wanted.share = 0;
        wanted.low = 1;
        wanted.high = 25;
        wanted.step = 1;
        return wanted;
    }
    /// Runs whatever is missing, and counts it.
    [[nodiscard]] DesignResult searched(const Design& design) {
        made_ = 0;
        auto result = search(design, [&](const Part& part) -> Result<bool> {
            ensemble::EnsembleOptions options;
            options.on_run = [&](const ensemble::RunRecord&) { ++made_; };
            if (const Status opened = open_part(part); !opened) return opened.error();
            const auto outcome = run_part(design, part, options);
            if (!outcome) return outcome.error();
            return !outcome->interrupted;
        });
        EXPECT_TRUE(result) << (result ? "" : result.error().message);
        return **std::move(result);
    }
    [[nodiscard]] static Design planned(const DesignRequest& request) { return test::value_of(plan_design(request)); }
    [[nodiscard]] static std::string error_of(const DesignRequest& request) {
        const auto design = plan_design(request);
        return design ? "(it was planned)" : design.error().message;
    }
    std::size_t made_ = 0;
};

TEST_F(DesignTest, finds_a_height_that_holds_all_runs_and_falls_with_what_may_pass) {
    DesignRequest strict = request();
    const Design first = planned(strict);
    EXPECT_EQ(first.missing_runs(), first.most_runs());
    const DesignResult none = searched(first);
    const LineResult& line = none.lines.front();
    ASSERT_TRUE(line.found);
    EXPECT_EQ(line.shown().passing_runs, 0);
    EXPECT_GT(line.trials.front().passing_runs, 0);  // a metre does not hold it
    EXPECT_LE(made_, first.most_runs());
    for (const auto& run : line.undisturbed) {
        ASSERT_TRUE(run);
        EXPECT_GT(run->speed, 1);
        EXPECT_GT(run->depth, 0);
        EXPECT_NEAR(run->crossed, run->released, 0.35 * run->released);  // all of it comes down the valley
        EXPECT_EQ(run->force, 0);
    }
    // The same draws: more released gives more at the line.
    EXPECT_GT(line.volume.greatest, line.volume.median);

    strict.share = 0.7;  // two of three runs may pass: the heights of the search before are not made again
    const DesignResult lenient = searched(planned(strict));
    ASSERT_TRUE(lenient.lines.front().found);
    EXPECT_LE(lenient.lines.front().shown().height, line.shown().height);
    strict.of_volume = true;
    strict.share = 0.5;
    const DesignResult half = searched(planned(strict));
    ASSERT_TRUE(half.lines.front().found);
    EXPECT_LE(half.lines.front().shown().height, line.shown().height);
}

TEST_F(DesignTest, resumes_makes_damaged_runs_again_and_writes_all_of_it) {
    DesignRequest small = request();  // the address sanitizer runs this one: a hundred times slower
    small.plan.runs = 2;
    small.low = small.high = 4;
    const Design design = planned(small);
    const DesignResult first = searched(design);
    EXPECT_EQ(made_, 4U);
    const auto numbers = design_results(first)["lines"].dump();
    const DesignResult again = searched(design);
    EXPECT_EQ(made_, 0U);
    EXPECT_EQ(design_results(again)["lines"].dump(), numbers);
    std::ofstream(folder / "out/0_wall/without/barrier/000001.json") << "{}";
    const DesignResult repaired = searched(design);
    EXPECT_EQ(made_, 1U);
    EXPECT_EQ(design_results(repaired)["lines"].dump(), numbers);

    const Status written = write_design(repaired);
    ASSERT_TRUE(written) << written.error().message;
    for (const char* file : {"design.html", "runs.csv", "heights.csv", "loads.csv", "results.json"}) {
        EXPECT_TRUE(std::filesystem::is_regular_file(folder / "out" / file)) << file;
    }
    std::ifstream in(folder / "out/design.html");
    const std::string page((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    EXPECT_THAT(page, AllOf(HasSubstr("licensed engineer"), HasSubstr("not checked against its text"),
                            HasSubstr("Section across the barrier"), Not(HasSubstr("{{"))));
}

TEST_F(DesignTest, compares_two_lines_of_the_same_valley) {
    DesignRequest two = request();
    two.lines = {fmt::format("lower={0},{1} {0},{2}", west + 130, south + 20, south + 180)};
    two.low = two.high = 9;
    const Design design = planned(two);
    const DesignResult result = searched(design);
    ASSERT_EQ(result.lines.size(), 2U);
    EXPECT_EQ(result.lines[1].line.name, "lower");
    EXPECT_EQ(result.lines[0].trials.size(), 1U);
    EXPECT_GT(result.lines[1].speed.median, 0);
    // The valley is the same everywhere, so that both lines hold the same.
    EXPECT_NEAR(result.lines[1].level.volume, result.lines[0].level.volume, 0.05 * result.lines[0].level.volume);
    EXPECT_EQ(design_results(result)["lines"][1]["name"], "lower");
}

TEST_F(DesignTest, says_that_no_height_is_enough) {
    DesignRequest low = request();
    low.low = 0.5;
    low.high = 1;
    low.step = 0.5;
    const Design design = planned(low);
    const DesignResult result = searched(design);
    EXPECT_FALSE(result.lines.front().found);
    EXPECT_TRUE(design_results(result)["lines"][0]["least_height_m"].is_null());
}

TEST_F(DesignTest, stops_where_the_runner_was_interrupted) {
    const Design design = planned(request());
    const auto result = search(design, [](const Part&) -> Result<bool> { return false; });
    ASSERT_TRUE(result);
    EXPECT_FALSE(result->has_value());
}

TEST_F(DesignTest, refuses_hostile_input_in_one_sentence) {
    const auto with = [&](auto change) {
        DesignRequest wanted = request();
        change(wanted);
        return error_of(wanted);
    };
    EXPECT_THAT(with([](auto& r) { r.barrier = "dam"; }), HasSubstr("there is no barrier \"dam\"; barriers: wall"));
    EXPECT_THAT(with([](auto& r) { r.share = 1.5; }),
                HasSubstr("--share 1.5 is refused; it must be from 0 to below 1"));
    EXPECT_THAT(with([](auto& r) { r.share = std::nan(""); }), HasSubstr("--share nan is refused"));
    EXPECT_THAT(with([](auto& r) { r.low = -1; }), HasSubstr("--min-height -1 is refused"));
    EXPECT_THAT(with([](auto& r) { r.boulder_diameter = -1; }), HasSubstr("--boulder-diameter -1 is refused"));
    EXPECT_THAT(with([](auto& r) { r.deposition_slope = 80; }), HasSubstr("--deposition-slope 80 is refused"));
    EXPECT_THAT(with([](auto& r) { r.lines = {"nothing"}; }), HasSubstr("--line \"nothing\": write NAME=x,y"));
    EXPECT_THAT(with([](auto& r) { r.lines = {"a=1,2"}; }), HasSubstr("has one place"));
    EXPECT_THAT(with([](auto& r) { r.lines = {"a=no_such.geojson"}; }), HasSubstr("is neither a file nor places"));
    EXPECT_THAT(with([](auto& r) { r.lines = {"wall=1,2 3,4"}; }), HasSubstr("another line has that name"));
    EXPECT_THAT(with([](auto& r) { r.lines = {"far=1,2 3,4"}; }), HasSubstr("is not on known ground"));
    const std::string release = fmt::format(
        "on="
        "{0},{1} {0},{2}",
        west + 30, south + 80, south + 120);
    EXPECT_THAT(with([&](auto& r) { r.lines = {release}; }), HasSubstr("stands on release \"scarp\""));
    EXPECT_THAT(with([](auto& r) { r.plan.runs = 1; }), HasSubstr("--runs 1 is refused"));
    EXPECT_THAT(with([](auto& r) { (void)add_factor(r.plan, "barrier.height_m=1:2"); }),
                HasSubstr("factor barrier.height_m: is refused"));
}

}  // namespace
}  // namespace talus::design
