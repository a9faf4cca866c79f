#include <filesystem>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/small_scene.hpp"

namespace talus::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(Compare, runs_both_models_of_the_built_in_scene_and_says_where_they_part) {
    const TemporaryFolder folder;
    const auto outcome = run_program({"compare", "-o", "both", "--set", "solver.target_particle_count=500", "--set",
                                      "solver.end_time_s=30", "--set", "solver.grid_cell_m=2.5"},
                                     {.folder = folder.path()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_THAT(outcome.out, HasSubstr("% of what either covers"));
    EXPECT_THAT(outcome.out, HasSubstr("both/report.html"));
    for (const char* file : {"report.html", "results.json", "particles/manifest.json", "particles/report.html",
                             "depth_averaged/manifest.json", "depth_averaged/peak_depth.tif"}) {
        EXPECT_TRUE(fs::exists(folder.path() / "both" / file)) << file;
    }
    const auto results = nlohmann::json::parse(read_text(folder.path() / "both/results.json"));
    EXPECT_EQ(results.at("format"), "talus comparison");
    const auto& agreement = results.at("agreement");
    const double both = agreement.at("both_m2"), particles = agreement.at("particles_only_m2"),
                 grid = agreement.at("depth_averaged_only_m2");
    EXPECT_GT(both, 1000);
    EXPECT_NEAR(agreement.at("intersection_over_union").get<double>(), both / (both + particles + grid), 1e-9);
    EXPECT_GT(agreement.at("intersection_over_union"), 0.3);
    for (const auto& row : results.at("quantities").at("rows")) {
        if (row.at("quantity") != "Front velocity at 121 m") continue;
        EXPECT_EQ(row.at("observed").at("value"), 11);
        EXPECT_GT(row.at("particles").at("value"), 3);
        EXPECT_GT(row.at("depth_averaged").at("value"), 3);
    }
    EXPECT_GE(results.at("differences").size(), 4U);
    const std::string page = read_text(folder.path() / "both/report.html");
    EXPECT_THAT(outcome.out, HasSubstr("Peak speed: "));
    for (const char* part : {"data-layer=\"peak_speed_difference\"", "data-layer=\"affected_area\"",
                             "Where the models differ", "What each model leaves out", "intersection over union"}) {
        EXPECT_TRUE(page.find(part) != std::string::npos) << part;
    }
    EXPECT_EQ(page.find("{{"), std::string::npos);
}

TEST(Compare, refuses_a_scene_that_the_depth_averaged_model_cannot_have) {
    const SmallScene scene;
    scene.write(read_text(scene.scene_file()) +
                "[[barrier]]\nname = \"net\"\nline_m = [[824100, 825080], [824100, 825120]]\nheight_m = "
                "1\npassing_share = 0.5\n");
    const auto outcome = run_program({"compare", "slope.toml"}, {.folder = scene.folder()});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.error, HasSubstr("passing_share"));
    EXPECT_FALSE(fs::exists(scene.folder() / "talus_out"));
}

TEST(Compare, puts_the_gauges_of_both_models_side_by_side_and_leaves_out_a_zoom) {
    const SmallScene scene;
    scene.replace("end_time_s = 1\n", "end_time_s = 8\n");
    scene.write(read_text(scene.scene_file()) +
                "[[gauge]]\nname = \"below the scar\"\nx_m = 824190\ny_m = 825100\n"
                "[zoom]\npolygon_m = [[824120, 825060], [824180, 825060], [824180, 825140], [824120, 825140]]\n");
    const auto outcome = run_program({"compare", "slope.toml", "-o", "both"}, {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto results = nlohmann::json::parse(read_text(scene.folder() / "both/results.json"));
    const auto& rows = results.at("gauges").at("table").at("rows");
    ASSERT_EQ(rows.size(), 2U);
    for (const auto& row : rows) {
        EXPECT_EQ(row.at("gauge"), "below the scar");
        EXPECT_GT(row.at("peak_depth_m"), 0.05) << row;
        EXPECT_GT(row.at("peak_speed_mps"), 0.5) << row;
    }
    const auto& curves = results.at("gauges").at("chart").at("plots").at(0).at("curves");
    ASSERT_EQ(curves.size(), 2U);
    EXPECT_NE(curves.at(0).at("y"), curves.at(1).at("y"));
    for (const char* model : {"particles", "depth_averaged"}) {
        EXPECT_THAT(read_text(scene.folder() / "both" / model / "gauges.csv"),
                    testing::StartsWith("name,time_s,depth_m,speed_mps\nbelow the scar,0,0,0\n"));
    }
    EXPECT_THAT(read_text(scene.folder() / "both/particles/report.html"),
                HasSubstr("[zoom] is left out: talus compare runs the whole event"));
    EXPECT_NE(read_text(scene.folder() / "both/report.html").find("<h2>Gauges</h2>"), std::string::npos);
}

TEST(Compare, ignores_the_model_of_the_scene) {
    const SmallScene scene;
    scene.replace("[solver]\n", "[solver]\nmodel = \"depth_averaged\"\n");
    const auto outcome = run_program({"compare", "slope.toml", "--json", "-o", "both"}, {.folder = scene.folder()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto event = nlohmann::json::parse(lines_of(outcome.out).back());
    EXPECT_EQ(event.at("event"), "result");
    EXPECT_NE(event.at("particles").at("hash"), event.at("depth_averaged").at("hash"));
    EXPECT_GT(event.at("agreement").at("both_m2"), 300);
    std::set<int> runs;
    for (const std::string& line : lines_of(outcome.out)) {
        if (const auto now = nlohmann::json::parse(line); now.at("event") == "progress")
            runs.insert(now.at("run").get<int>());
    }
    EXPECT_TRUE(runs.contains(1)) << "progress of both runs together";

    const ProgramOptions here{.folder = scene.folder()};
    EXPECT_EQ(run_program({"compare", "slope.toml", "-o", "both"}, here).exit_code, 2) << "it is there";
    EXPECT_EQ(run_program({"compare", "slope.toml", "-o", "both", "--force"}, here).exit_code, 0);
}

}  // namespace
}  // namespace talus::test
