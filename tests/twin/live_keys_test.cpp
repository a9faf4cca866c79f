#include <gtest/gtest.h>

#include "twin/action.hpp"
#include "twin/setup_file.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

/// An allowed value that no new shape begins with.
json value_of(const Parameter& parameter) {
    if (parameter.kind == ParameterKind::choice) return parameter.choices.back();
    if (parameter.range.text().empty()) return 20;  // an elevation
    return parameter.range.contains(0.75) ? 0.75 : 0.01;
}

struct Shape {
    const char *section, *list;
    json put;
};

/// Whatever key the field table declares to change live can be set by an action and is in setups and journals.
TEST(LiveKeys, are_set_shown_written_and_read_back) {
    const Scene scene = channel_scene();
    const json floor = ring(west + 60, south + 20, west + 70, south + 40);
    const Shape shapes[] = {
        {"barrier",
         "barriers",
         {{"action", "put_barrier"}, {"line", {{west + 52, south + 8}, {west + 52, south + 52}}}, {"height_m", 5}}},
        {"zone", "zones", {{"action", "put_zone"}, {"polygon", floor}, {"friction_coefficient", 0.3}}},
        {"bed", "beds", {{"action", "put_bed"}, {"polygon", floor}, {"depth_m", 0.5}, {"growth_rate_per_m", 0.02}}}};
    const ActionContext context{scene, 0.6, 0.1, [](const std::string&) { return false; }};
    for (const Shape& shape : shapes) {
        for (const Parameter& parameter : find_section(shape.section)->parameters) {
            if (parameter.live.empty()) continue;
            SCOPED_TRACE(parameter.key);
            NextNumbers next;
            json action = shape.put;
            const json value = value_of(parameter);
            if (parameter.live == "crest_elevation_m") action.erase("height_m");
            action[parameter.live] = value;
            const auto edit = read_action(action, setup_of(scene, next), next, context);
            ASSERT_TRUE(edit) << edit.error().message;
            const json written = json::parse(write_setup(edit->setup).dump());
            EXPECT_EQ(written[shape.list][0][parameter.live], value);
            const auto again = read_setup(written, scene);
            ASSERT_TRUE(again) << again.error().message;
            EXPECT_EQ(json::parse(write_setup(*again).dump()), written);
            const auto scenario = open(scene);
            act(*scenario, action);
            EXPECT_TRUE(scenario->setup_json()[shape.list][0].contains(parameter.live));

            action[parameter.live] = "much";
            EXPECT_FALSE(read_action(action, setup_of(scene, next), next, context));
        }
    }
}

TEST(LiveKeys, take_the_place_of_their_alternatives) {
    const Scene scene = channel_scene();
    const auto scenario = open(scene);
    act(*scenario,
        {{"action", "put_barrier"}, {"line", {{west + 52, south + 8}, {west + 52, south + 52}}}, {"height_m", 5}});
    const auto barrier = [&] { return scenario->setup_json()["barriers"][0]; };
    act(*scenario, {{"action", "put_barrier"}, {"id", "barrier-1"}, {"crest_elevation_m", 15}});
    EXPECT_EQ(barrier()["crest_elevation_m"], 15);
    EXPECT_NE(barrier()["height_m"], 5) << "the mean above the ground";
    act(*scenario, {{"action", "put_barrier"}, {"id", "barrier-1"}, {"height_m", 4}});
    EXPECT_EQ(barrier()["crest_elevation_m"], nullptr);
    EXPECT_EQ(barrier()["height_m"], 4);
    EXPECT_NE(refusal(*scenario, {{"action", "put_barrier"}, {"id", "barrier-1"}, {"height_m", nullptr}})
                  .find("exactly one of height_m, crest_elevation_m must be given"),
              std::string::npos);
    EXPECT_NE(
        refusal(*scenario, {{"action", "put_barrier"}, {"id", "barrier-1"}, {"height_m", 3}, {"crest_elevation_m", 15}})
            .find("only one of height_m, crest_elevation_m"),
        std::string::npos);
    EXPECT_NE(refusal(*scenario, {{"action", "put_barrier"}, {"id", "barrier-1"}, {"thickness_m", 0.1}})
                  .find("thickness_m = 0.1 is refused; with particles of 0.6 m it must be at least 0.3 m"),
              std::string::npos);
}

}  // namespace
}  // namespace talus::twin::test
