#include "twin/scenario.hpp"

#include <gmock/gmock.h>

#include "run/run_scene.hpp"
#include "support/fixtures.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using ::testing::HasSubstr;

TEST(Scenario, without_actions_is_the_run_of_the_scene) {
    scene::Scene scene = channel_scene();
    scene.spec.solver.end_time = 3;
    const auto run = run::run_scene(scene, {});
    ASSERT_TRUE(run);
    const auto scenario = open(scene);
    run_until(*scenario, 100);
    EXPECT_EQ(scenario->phase(), run::RunPhase::ended);
    EXPECT_EQ(scenario->message(), run->stop_reason);
    EXPECT_EQ(scenario->step(), run->steps);
    EXPECT_EQ(hash(*scenario), run->hash);
    EXPECT_EQ(series_json(*scenario)["time"]["time_s"].size(), run->observation.timeseries.size());
}

TEST(Scenario, expects_its_end_from_the_motion_of_the_debris) {
    scene::Scene scene = channel_scene();
    scene.spec.material.friction_coefficient = 0.7;  // it hardly moves
    scene.spec.solver.stop_duration = 1;
    const auto scenario = open(scene);
    EXPECT_TRUE(state_json(*scenario)["expected_end_s"].is_null());
    EXPECT_TRUE(state_json(*scenario)["wall_remaining_s"].is_null());
    run_until(*scenario, 0.5);
    ASSERT_EQ(scenario->phase(), run::RunPhase::ready);
    EXPECT_GE(number(*scenario, "expected_end_s"), scenario->time());
    EXPECT_LT(number(*scenario, "expected_end_s"), scene.spec.solver.end_time / 2) << "not end_time";
    EXPECT_GT(number(*scenario, "wall_remaining_s"), 0);
    run_until(*scenario, 100);
    ASSERT_EQ(scenario->phase(), run::RunPhase::at_rest);
    EXPECT_EQ(number(*scenario, "expected_end_s"), number(*scenario, "time_s"));
    EXPECT_EQ(number(*scenario, "wall_remaining_s"), 0);
}

TEST(Scenario, comes_to_rest_as_the_run_does_and_goes_on_when_something_changes) {
    scene::Scene scene = channel_scene();
    scene.spec.material.friction_coefficient = 0.7;  // steeper than the slope: it hardly moves
    scene.spec.solver.stop_duration = 1;
    const auto run = run::run_scene(scene, {});
    const auto scenario = open(scene);
    run_until(*scenario, 100);
    ASSERT_EQ(scenario->phase(), run::RunPhase::at_rest) << scenario->message();
    EXPECT_EQ(hash(*scenario), run->hash);
    const std::uint64_t step = scenario->step();
    scenario->advance();
    EXPECT_EQ(scenario->step(), step);

    act(*scenario, {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.2}});
    EXPECT_EQ(scenario->phase(), run::RunPhase::ready);
    EXPECT_EQ(scenario->message(), "");
    EXPECT_LT(number(*scenario, "largest_speed_mps"), 0.1);
    run_until(*scenario, scenario->time() + 1);
    EXPECT_GT(number(*scenario, "largest_speed_mps"), 1) << "debris at rest was not woken";
}

TEST(Scenario, debris_that_cohesion_holds_wakes_when_it_becomes_heavier) {
    scene::Scene scene = channel_scene();
    scene.spec.material.friction_coefficient = 0.1;
    scene.spec.material.cohesion = 30000;
    scene.spec.solver.stop_duration = 1;
    const auto scenario = open(scene);
    run_until(*scenario, 100);
    ASSERT_EQ(scenario->phase(), run::RunPhase::at_rest) << scenario->message();
    act(*scenario, {{"action", "set_parameter"}, {"key", "material.rest_density_kgpm3"}, {"value", 25000}});
    run_until(*scenario, scenario->time() + 1);
    EXPECT_GT(number(*scenario, "largest_speed_mps"), 1) << "cohesion is divided by density";
}

TEST(Scenario, a_parameter_holds_from_the_next_step_on) {
    const auto changed = open(channel_scene()), unchanged = open(channel_scene());
    run_until(*changed, 1);
    run_until(*unchanged, 1);
    EXPECT_EQ(hash(*changed), hash(*unchanged));
    const Done done =
        act(*changed, {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.6}});
    EXPECT_EQ(done.sentence, "friction coefficient 0.25 -> 0.6");
    EXPECT_EQ(hash(*changed), hash(*unchanged));
    changed->advance();
    unchanged->advance();
    EXPECT_NE(hash(*changed), hash(*unchanged));
    const json parameters = setup_json(*changed)["parameters"];
    EXPECT_EQ(parameters["material.friction_coefficient"], 0.6);
    // Both follow the first as long as they are not set apart.
    EXPECT_EQ(parameters["material.internal_friction_coefficient"], 0.6);
    act(*changed, {{"action", "set_parameter"}, {"key", "material.internal_friction_coefficient"}, {"value", 0.3}});
    EXPECT_EQ(setup_json(*changed)["parameters"]["material.internal_friction_coefficient"], 0.3);
    EXPECT_EQ(setup_json(*changed)["parameters"]["material.building_friction_coefficient"], 0.6);
    act(*changed, {{"action", "set_parameter"}, {"key", "material.internal_friction_coefficient"}, {"value", nullptr}});
    EXPECT_EQ(setup_json(*changed)["parameters"]["material.internal_friction_coefficient"], 0.6);
    run_until(*changed, 4);
    run_until(*unchanged, 4);
    EXPECT_LT(number(*changed, "front_chainage_m"), number(*unchanged, "front_chainage_m") - 3);
}

TEST(Scenario, several_parameters_at_once_are_one_change) {
    const auto scenario = open(channel_scene());
    const json before = setup_json(*scenario)["parameters"];
    const json action = {{"action", "set_parameters"},
                         {"values", {{"material.friction_coefficient", 0.2}, {"material.viscosity", 0.05}}}};
    EXPECT_THAT(act(*scenario, action).sentence, testing::HasSubstr("-> 0.2, viscosity "));
    EXPECT_EQ(setup_json(*scenario)["parameters"]["material.friction_coefficient"], 0.2);
    EXPECT_EQ(setup_json(*scenario)["parameters"]["material.viscosity"], 0.05);
    act(*scenario, {{"action", "undo"}});
    EXPECT_EQ(setup_json(*scenario)["parameters"], before);
    // Where one is wrong, none is changed.
    const json wrong = {{"material.friction_coefficient", 0.3}, {"material.viscosity", -1}};
    EXPECT_FALSE(scenario->apply({{"action", "set_parameters"}, {"values", wrong}}, "Ada"));
    EXPECT_FALSE(scenario->apply({{"action", "set_parameters"}, {"values", json::object()}}, "Ada"));
    EXPECT_EQ(setup_json(*scenario)["parameters"], before);
}

TEST(Scenario, density_changes_pressures_from_then_on_and_not_those_before) {
    scene::Scene scene = channel_scene();
    const auto light = open(scene), heavy = open(scene), late = open(scene);
    const json denser = {{"action", "set_parameter"}, {"key", "material.rest_density_kgpm3"}, {"value", 4000}};
    EXPECT_EQ(act(*heavy, denser).sentence, "rest density 2000 -> 4000 kg/m3");
    for (const auto* s : {&light, &heavy, &late}) run_until(**s, 2);
    EXPECT_EQ(hash(*light), hash(*heavy)) << "density has no part in how debris moves";
    act(*late, denser);
    late->advance();
    const Grid<float> thin = layer(*light, "peak_pressure"), thick = layer(*heavy, "peak_pressure"),
                      then = layer(*late, "peak_pressure");
    int as_before = 0, twice = 0;
    for (std::size_t k = 0; k < thin.values.size(); ++k) {
        if (std::isnan(thin.values[k])) continue;
        EXPECT_FLOAT_EQ(thick.values[k], 2 * thin.values[k]);
        ASSERT_GE(then.values[k], thin.values[k] * 0.999F);
        as_before += then.values[k] < 1.2F * thin.values[k];
        twice += then.values[k] > 1.8F * thin.values[k];
    }
    EXPECT_GT(as_before, 0) << "where debris was faster before";
    EXPECT_GT(twice, 0) << "where it is at its fastest";
}

TEST(Scenario, names_key_value_and_range_of_what_it_refuses) {
    const auto scenario = open(channel_scene());
    scenario->advance();
    EXPECT_THAT(
        refusal(*scenario, {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 11}}),
        HasSubstr("material.friction_coefficient: value = 11: must be a number 0 to 10"));
    EXPECT_THAT(refusal(*scenario, {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}}),
                HasSubstr("value: missing"));
    EXPECT_THAT(refusal(*scenario, {{"action", "set_parameter"}, {"key", "solver.end_time_s"}, {"value", 1}}),
                HasSubstr("key = \"solver.end_time_s\": must be one of material.friction_coefficient"));
    EXPECT_THAT(
        refusal(*scenario, {{"action", "set_parameter"}, {"key", "material.viscosity"}, {"value", 0.1}, {"x", 1}}),
        HasSubstr("\"x\" = 1: no such key"));
    EXPECT_THAT(refusal(*scenario, {{"action", "dance"}}), HasSubstr("action = \"dance\": must be one of"));
    EXPECT_THAT(refusal(*scenario, json::array()), HasSubstr("must be a JSON object"));
    EXPECT_THAT(refusal(*scenario, {{"action", "undo"}}), HasSubstr("nothing to undo"));
    EXPECT_THAT(refusal(*scenario, {{"action", "remove_barrier"}, {"id", "barrier-9"}}),
                HasSubstr("id = \"barrier-9\": there is no such barrier"));
}

TEST(Scenario, undo_and_redo_go_through_the_setups) {
    const auto scenario = open(channel_scene());
    const json first = setup_json(*scenario);
    act(*scenario, {{"action", "set_parameter"}, {"key", "material.viscosity"}, {"value", 0.3}});
    act(*scenario, {{"action", "put_barrier"},
                    {"line", {{west + 60, south + 20}, {west + 60, south + 40}}},
                    {"height_m", 2},
                    {"thickness_m", 1}});
    const json last = setup_json(*scenario);
    EXPECT_THAT(last["undo"].get<std::string>(), HasSubstr("barrier \"barrier 1\" placed: 20.0 m long, 2 m high"));
    EXPECT_EQ(last["redo"], nullptr);
    act(*scenario, {{"action", "undo"}});
    EXPECT_EQ(setup_json(*scenario)["barriers"].size(), 0U);
    EXPECT_EQ(act(*scenario, {{"action", "undo"}}).sentence, "undo: viscosity 0.1 -> 0.3");
    EXPECT_EQ(setup_json(*scenario)["parameters"], first["parameters"]);
    act(*scenario, {{"action", "redo"}});
    act(*scenario, {{"action", "redo"}});
    EXPECT_EQ(setup_json(*scenario)["barriers"], last["barriers"]);
    EXPECT_EQ(setup_json(*scenario)["parameters"], last["parameters"]);
    act(*scenario, {{"action", "undo"}});
    act(*scenario, {{"action", "set_parameter"}, {"key", "material.viscosity"}, {"value", 0.2}});
    EXPECT_THAT(refusal(*scenario, {{"action", "redo"}}), HasSubstr("nothing to redo"));
}

TEST(Scenario, restart_and_copy_begin_with_the_setup_as_it_is_now) {
    const auto scenario = open(channel_scene());
    run_until(*scenario, 1);
    act(*scenario, {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.1}});
    const auto copy = scenario->copying()({});
    ASSERT_TRUE(copy);
    act(*scenario, {{"action", "restart"}});
    for (const Scenario* s : {scenario.get(), copy->get()}) {
        EXPECT_EQ(s->time(), 0);
        EXPECT_EQ(s->step(), 0U);
        EXPECT_EQ(journal_json(*s)["actions"].size(), 0U);
        EXPECT_EQ(setup_json(*s)["parameters"]["material.friction_coefficient"], 0.1);
    }
    scene::Scene direct = channel_scene();
    direct.spec.material.friction_coefficient = 0.1;
    const auto wanted = open(direct);
    run_until(*scenario, 1);
    run_until(**copy, 1);
    run_until(*wanted, 1);
    EXPECT_EQ(hash(*scenario), hash(*wanted));
    EXPECT_EQ(hash(**copy), hash(*wanted));
}

TEST(Scenario, writes_the_products_of_the_run_so_far) {
    scene::Scene scene = channel_scene();
    scene.crs.epsg = 2326;
    add_building(scene, "shed", rectangle(west + 40, south + 28, west + 44, south + 32), 4);
    const auto scenario = open(scene);
    act(*scenario, {{"action", "put_barrier"},
                    {"name", "dam"},
                    {"line", {{west + 70, south + 20}, {west + 70, south + 40}}},
                    {"height_m", 2},
                    {"thickness_m", 1}});
    run_until(*scenario, 5);
    talus::test::TemporaryFolder folder;
    const auto products = products_of(*scenario);
    const json manifest = state_json(*scenario);
    run_until(*scenario, 6);
    EXPECT_NE(state_json(*scenario), manifest);
    const Status written = products(folder.path());
    ASSERT_TRUE(written) << written.error().message;
    EXPECT_THAT(talus::test::read_text(folder.file("manifest.json")), HasSubstr(manifest["hash"].get<std::string>()))
        << "files are of the run as it was when they were asked for";
    const std::string buildings = talus::test::read_text(folder.file("buildings.csv"));
    EXPECT_THAT(buildings, HasSubstr("\nshed,yes,"));
    EXPECT_THAT(buildings, HasSubstr("\ndam,no,"));
    EXPECT_THAT(talus::test::read_text(folder.file("PARTIAL.txt")), HasSubstr("written while running"));
    EXPECT_THAT(talus::test::read_text(folder.file("manifest.json")), HasSubstr("before step 0, by Ann"));
}

TEST(Scenario, classifies_buildings_by_depth_and_speed_at_their_walls) {
    scene::Scene scene = channel_scene();
    add_building(scene, "in the way", rectangle(west + 30, south + 27, west + 34, south + 33), 6);
    add_building(scene, "beside", rectangle(west + 30, south + 50, west + 34, south + 54), 6);
    const auto scenario = open(scene);
    run_until(*scenario, 5);
    const json buildings = impacts_json(*scenario)["buildings"];
    ASSERT_EQ(buildings.size(), 2U);
    EXPECT_EQ(buildings[0]["hit"], true);
    EXPECT_GT(buildings[0]["peak_force_kN"], 1);
    const bool high = buildings[0]["peak_depth_m"] > 1 && buildings[0]["peak_speed_mps"] > 1;
    EXPECT_EQ(buildings[0]["intensity"], high ? "high" : "medium");
    EXPECT_EQ(buildings[1]["intensity"], nullptr);
    EXPECT_THAT(scene_json(*scenario)["intensity"]["source"].get<std::string>(), HasSubstr("1997"));
}

TEST(Scenario, classifies_buildings_by_the_guideline_of_the_scene) {
    scene::Scene scene = channel_scene();
    scene.spec.outputs.intensity_guideline = params::GuidelineChoice::garcia_2003;
    add_building(scene, "in the way", rectangle(west + 30, south + 27, west + 34, south + 33), 6);
    const auto scenario = open(scene);
    run_until(*scenario, 5);
    const json told = scene_json(*scenario)["intensity"];
    ASSERT_EQ(told["classes"].size(), 3U);
    EXPECT_EQ(told["guideline"], "Venezuelan debris-flow classes");
    const json house = impacts_json(*scenario)["buildings"][0];
    const double depth = house["peak_depth_m"], speed = house["peak_speed_mps"];
    ASSERT_GT(depth, 0.2);
    EXPECT_EQ(house["intensity"], depth > 1 || depth * speed > 1 ? "high" : depth * speed > 0.2 ? "medium" : "low");
}

TEST(Answers, have_numbers_as_short_as_they_are_read_back) {
    scene::Scene scene = channel_scene();
    Grid<float> raised = scene.terrain.elevation();
    for (float& z : raised.values) z += 4.77F;
    scene.terrain = terrain::Terrain(std::move(raised));
    const auto scenario = open(std::move(scene));
    act(*scenario, {{"action", "trigger_release"}, {"id", "release-1"}});
    run_until(*scenario, 1);
    EXPECT_EQ(scene_json(*scenario)["elevation_m"][0].dump(), "4.77");
    const json state = state_json(*scenario);
    EXPECT_GT(state["largest_speed_mps"], 0);
    EXPECT_LE(state["largest_speed_mps"].dump().size(), 11U) << state["largest_speed_mps"];
}

}  // namespace
}  // namespace talus::twin::test
