#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/program.hpp"
#include "cli/small_scene.hpp"
#include "params/scene_text.hpp"

namespace talus::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(SceneNew, writes_a_scene_that_checks_and_runs) {
    const SmallScene inputs;
    const auto created = run_program({"scene", "new", "--dem", "terrain.tif", "--release", "release.geojson",
                                      "--buildings", "buildings.geojson", "--volume-m3", "120", "-o", "mine"},
                                     {.folder = inputs.folder()});
    ASSERT_EQ(created.exit_code, 0) << created.error;
    EXPECT_EQ(created.error, "");
    const auto checked = run_program({"scene", "check", "mine/scene.toml"}, {.folder = inputs.folder()});
    EXPECT_EQ(checked.exit_code, 0) << checked.error;
    EXPECT_THAT(checked.out, HasSubstr("120"));
    const auto run = run_program({"run", "mine/scene.toml", "--quiet", "--set", "solver.end_time_s=0.2", "--set",
                                  "solver.target_particle_count=300"},
                                 {.folder = inputs.folder()});
    EXPECT_EQ(run.exit_code, 0) << run.error;
    EXPECT_TRUE(fs::exists(inputs.folder() / "talus_out/mine/report.html")) << "named after the scene's folder";
}

TEST(SceneNew, takes_layers_a_part_and_larger_cells) {
    const SmallScene inputs;
    const auto created = run_program({"scene",
                                      "new",
                                      "--dem",
                                      "terrain.tif",
                                      "--dem-layer",
                                      "terrain",
                                      "--release",
                                      "release.geojson|layername=layer",
                                      "--release-feature",
                                      "0",
                                      "--thickness-m",
                                      "1",
                                      "--extent",
                                      "824100",
                                      "825000",
                                      "824300",
                                      "825200",
                                      "--cell",
                                      "10",
                                      "-o",
                                      "mine"},
                                     {.folder = inputs.folder()});
    ASSERT_EQ(created.exit_code, 0) << created.error;
    EXPECT_THAT(created.out, HasSubstr("note: terrain: terrain.tif holds means of 2 x 2 cells"));
    const auto checked = run_program({"scene", "check", "mine/scene.toml"}, {.folder = inputs.folder()});
    EXPECT_THAT(checked.out, HasSubstr("20 x 20 cells of 10 m")) << checked.error;
    const auto refused =
        run_program({"scene", "new", "--dem", "terrain.tif", "--release", "release.geojson", "-o", "b"},
                    {.folder = inputs.folder()});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.error, HasSubstr("--thickness-m"));
    EXPECT_FALSE(fs::exists(inputs.folder() / "b"));
}

TEST(SceneNew, warns_of_a_building_on_the_release) {
    const SmallScene inputs;
    write_vector(
        inputs.input("hut.geojson"), {},
        {{rectangle_wkt(824205, 825095, 824215, 825105), {}}, {rectangle_wkt(824150, 825090, 824160, 825110), {}}});
    const auto created = run_program({"scene", "new", "--dem", "terrain.tif", "--release", "release.geojson",
                                      "--thickness-m", "1", "--buildings", "hut.geojson", "-o", "mine"},
                                     {.folder = inputs.folder()});
    ASSERT_EQ(created.exit_code, 0) << created.error;
    EXPECT_THAT(created.out, HasSubstr("\nWARNING: building \"building 1\" stands on release \"release\" with 100 m2"));
    const auto run = run_program({"run", "mine/scene.toml", "--set", "solver.end_time_s=0.2", "--set",
                                  "solver.target_particle_count=300", "-o", "result"},
                                 {.folder = inputs.folder()});
    EXPECT_EQ(run.exit_code, 0) << run.error;
    EXPECT_THAT(run.out, HasSubstr("  WARNING          building \"building 1\" stands on"));
    EXPECT_THAT(read_text(inputs.input("result/report.html")), HasSubstr("<b>Warning.</b> building"));
}

TEST(SceneNew, refuses_a_folder_that_is_there) {
    const SmallScene inputs;
    fs::create_directory(inputs.folder() / "mine");
    write_text(inputs.input("mine/scene.toml"), "precious");
    const auto outcome = run_program(
        {"scene", "new", "--dem", "terrain.tif", "--release", "release.geojson", "--thickness-m", "1", "-o", "mine"},
        {.folder = inputs.folder()});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(lines_of(outcome.error).size(), 1u) << outcome.error;
    EXPECT_EQ(read_text(inputs.input("mine/scene.toml")), "precious");
}

TEST(SceneCheck, says_what_a_scene_means) {
    const SmallScene scene;
    const auto outcome = run_program({"scene", "check", "slope.toml"}, {.folder = scene.folder()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_EQ(outcome.error, "");
    for (const char* part : {"EPSG:2326", "scar", "particles", "buildings"}) EXPECT_THAT(outcome.out, HasSubstr(part));
}

TEST(SceneCheck, refuses_what_a_run_would_refuse) {
    const SmallScene scene;
    fs::remove(scene.input("terrain.tif"));
    const auto outcome = run_program({"scene", "check", "slope.toml"}, {.folder = scene.folder()});
    EXPECT_EQ(outcome.exit_code, 2);
    ASSERT_EQ(lines_of(outcome.error).size(), 1u) << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr("terrain.tif"));
}

TEST(SceneExportBuiltin, writes_a_scene_that_checks) {
    const TemporaryFolder folder;
    const auto exported = run_program({"scene", "export-builtin", "-o", "copy"}, {.folder = folder.path()});
    ASSERT_EQ(exported.exit_code, 0) << exported.error;
    const auto checked = run_program({"scene", "check", "copy/scene.toml"}, {.folder = folder.path()});
    EXPECT_EQ(checked.exit_code, 0) << checked.error;
    const auto again = run_program({"scene", "export-builtin", "-o", "copy"}, {.folder = folder.path()});
    EXPECT_EQ(again.exit_code, 2);
    EXPECT_THAT(again.error, HasSubstr("--force"));
    EXPECT_EQ(run_program({"scene", "export-builtin", "-o", "copy", "--force"}, {.folder = folder.path()}).exit_code,
              0);
}

TEST(SceneReference, is_the_field_table) {
    EXPECT_EQ(run_program({"scene", "reference", "--markdown"}).out, params::scene_reference_markdown());
    EXPECT_EQ(run_program({"scene", "reference"}).out, params::scene_reference_text());
}

}  // namespace
}  // namespace talus::test
