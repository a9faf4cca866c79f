#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/small_scene.hpp"

namespace talus::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

/// The small scene with a polygon 20 m below its release.
class Zoom : public testing::Test {
  protected:
    Zoom() {
        scene_.replace("end_time_s = 1\n", "end_time_s = 8\n");
        write_vector(scene_.input("area.geojson"), {}, {{rectangle_wkt(824120, 825060, 824180, 825140), {}}});
    }
    [[nodiscard]] ProgramOutcome run(const std::vector<std::string>& arguments) const {
        return run_program(arguments, {.folder = scene_.folder()});
    }
    SmallScene scene_;
};

TEST_F(Zoom, of_a_command_line_and_of_a_scene_are_the_same) {
    const auto given = run(
        {"run", "slope.toml", "--zoom-polygon", "area.geojson", "--set", "zoom.particle_spacing_m=0.4", "-o", "given"});
    ASSERT_EQ(given.exit_code, 0) << given.error;
    EXPECT_THAT(given.out,
                ContainsRegex("zoom +60 x 80 m, the event on cells of 2.5 m: [0-9.]+ m3 of [0-9.]+ m3 come in "
                              "from [0-9.]+ s on"));
    const auto manifest = nlohmann::json::parse(read_text(scene_.folder() / "given/manifest.json"));
    const auto& zoom = manifest.at("results").at("zoom");
    EXPECT_GT(zoom.at("volume_in_m3"), 10);
    EXPECT_EQ(manifest.at("resolved").at("particle_spacing_m"), 0.4);
    EXPECT_NEAR(zoom.at("particle_volume_in_m3").get<double>(), zoom.at("volume_in_m3").get<double>(), 0.04);
    EXPECT_NEAR(zoom.at("particle_momentum_in_Ns").at(0).get<double>(), zoom.at("momentum_in_Ns").at(0).get<double>(),
                0.03 * std::abs(zoom.at("momentum_in_Ns").at(0).get<double>()));
    EXPECT_NE(read_text(scene_.folder() / "given/report.html").find("<h2>Zoom</h2>"), std::string::npos);

    scene_.write(read_text(scene_.scene_file()) +
                 "[zoom]\npolygon_file = \"area.geojson\"\nparticle_spacing_m = 0.4\n");
    const auto written = run({"run", "slope.toml", "-o", "written", "--quiet"});
    ASSERT_EQ(written.exit_code, 0) << written.error;
    EXPECT_EQ(nlohmann::json::parse(read_text(scene_.folder() / "written/manifest.json")).at("result_hash"),
              manifest.at("result_hash"));
}

TEST_F(Zoom, is_checked_with_its_cost) {
    const auto checked = run({"scene", "check", "slope.toml", "--set", "zoom.polygon_file=area.geojson"});
    ASSERT_EQ(checked.exit_code, 0) << checked.error;
    EXPECT_THAT(checked.out, ContainsRegex("zoom +60 x 80 m, the event on cells of 2.5 m"));
    EXPECT_THAT(checked.out,
                ContainsRegex("depth-averaged, then [0-9]+ particles, about [0-9:]+; the whole event would "
                              "have [0-9]+ and take"));
    write_vector(scene_.input("above.geojson"), {}, {{rectangle_wkt(824250, 825060, 824280, 825140), {}}});
    const auto dry = run({"scene", "check", "slope.toml", "--set", "zoom.polygon_file=above.geojson"});
    EXPECT_EQ(dry.exit_code, 2);
    EXPECT_THAT(dry.error, HasSubstr("no debris of the depth-averaged model crosses its boundary"));
}

TEST_F(Zoom, refuses_options_that_it_cannot_be_together_with) {
    for (const auto& [option, message] : {std::pair{"--layers=2", "--layers is refused beside a zoom"},
                                          std::pair{"--convergence", "--convergence is refused beside a zoom"},
                                          std::pair{"--model=depth_averaged", "is refused beside a zoom"}}) {
        const auto outcome = run({"run", "slope.toml", "--zoom-polygon", "area.geojson", option});
        EXPECT_EQ(outcome.exit_code, 2) << option;
        EXPECT_THAT(outcome.error, HasSubstr(message));
    }
    const auto unknown = run({"run", "slope.toml", "--zoom", "mill"});
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_THAT(unknown.error, HasSubstr("zoom.structure = \"mill\" is no building"));
}

}  // namespace
}  // namespace talus::test
