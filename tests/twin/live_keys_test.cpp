#include <tuple>

#include <gtest/gtest.h>

#include "run/run.hpp"
#include "sim/simulation.hpp"
#include "twin/action.hpp"
#include "twin/setup_file.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

/// An allowed value that no new shape begins with.
json value_of(const params::Parameter& parameter) {
    if (parameter.kind == params::ParameterKind::choice) return parameter.choices.back();
    if (parameter.live == "crest_elevation_m") return 20;
    for (const double value : {0.75, 0.01}) {
        if (parameter.range.contains(value)) return value;
    }
    return 20;
}

json row(double time) {
    return {{"time_s", time}, {"discharge_m3ps", 5}, {"velocity_mps", 2}};
}

struct Shape {
    const char *section, *list;
    json put;
};

/// Whatever key the field table declares to change live can be set by an action and is in setups and journals.
TEST(LiveKeys, are_set_shown_written_and_read_back) {
    const scene::Scene scene = channel_scene();
    const json floor = ring(west + 60, south + 20, west + 70, south + 40);
    const Shape shapes[] = {
        {"barrier",
         "barriers",
         {{"action", "put_barrier"}, {"line", {{west + 52, south + 8}, {west + 52, south + 52}}}, {"height_m", 5}}},
        {"release", "releases", {{"action", "put_release"}, {"polygon", floor}, {"thickness_m", 0.5}}},
        {"buildings", "buildings", {{"action", "put_building"}, {"polygon", floor}, {"height_m", 5}}},
        {"inflow", "inflows", {{"action", "put_inflow"}, {"polygon", floor}, {"hydrograph", {row(0), row(2)}}}},
        {"zone", "zones", {{"action", "put_zone"}, {"polygon", floor}, {"friction_coefficient", 0.3}}},
        {"bed", "beds", {{"action", "put_bed"}, {"polygon", floor}, {"depth_m", 0.5}, {"growth_rate_per_m", 0.02}}}};
    const ActionContext context{scene, 0.6, 0.1, [](const std::string&) { return false; }};
    for (const Shape& shape : shapes) {
        for (const params::Parameter& parameter : params::find_section(shape.section)->parameters) {
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
            EXPECT_EQ(written[shape.list].back()[parameter.live], value);
            const auto again = read_setup(written, scene);
            ASSERT_TRUE(again) << again.error().message;
            EXPECT_EQ(json::parse(write_setup(*again).dump()), written);
            const auto scenario = open(scene);
            act(*scenario, action);
            EXPECT_EQ(setup_json(*scenario)[shape.list].back()[parameter.live], value);

            action[parameter.live] = "much";
            EXPECT_FALSE(read_action(action, setup_of(scene, next), next, context));
        }
    }
}

/// The same for the rows of a hydrograph, which have a table of their own.
TEST(LiveKeys, of_hydrographs_are_set_shown_written_and_read_back) {
    const scene::Scene scene = channel_scene();
    for (const params::Parameter& parameter : params::live_section("hydrograph").parameters) {
        SCOPED_TRACE(parameter.key);
        json rows = {row(0), row(2), row(4)};
        for (json& each : rows) {
            if (parameter.key != "time_s") each[parameter.key] = 7;
        }
        rows[1][parameter.key] = 3;
        const json action = {{"action", "put_inflow"},
                             {"polygon", ring(west + 60, south + 20, west + 70, south + 40)},
                             {"hydrograph", rows}};
        const auto scenario = open(scene);
        act(*scenario, action);
        EXPECT_EQ(setup_json(*scenario)["inflows"][0]["hydrograph"][1][parameter.key], 3);
        const json written = journal_json(*scenario)["actions"][0]["action"];
        EXPECT_EQ(written["hydrograph"], rows);
        json bad = action;
        bad["hydrograph"][1][parameter.key] = -1;
        EXPECT_NE(refusal(*scenario, bad).find("hydrograph[1]: " + parameter.key + " = -1: must be a number"),
                  std::string::npos);
        if (!parameter.required) continue;
        bad["hydrograph"][1].erase(parameter.key);
        EXPECT_NE(refusal(*scenario, bad).find("hydrograph[1]: " + parameter.key + ": missing"), std::string::npos);
    }
}

/// `restart` and `talus run` begin alike by themselves; a copy to which the action is applied must, too.
void expect_one_beginning(const Scenario& origin, const json& action) {
    const scene::Scene& scene = origin.scene();
    const auto copy = origin.copying()({});
    ASSERT_TRUE(copy) << copy.error().message;
    Scenario& fresh = **copy;
    const auto setup = read_setup(json::parse(journal_json(fresh)["first_setup"].dump()), scene);
    ASSERT_TRUE(setup) << setup.error().message;
    NextNumbers next{9, 9, 9, 9, 9, 9};
    const ActionContext context{scene, *scene.spec.solver.particle_spacing, fresh.run().model().viscosity,
                                [](const std::string&) { return false; }};
    const auto edit = read_action(action, *setup, next, context);
    ASSERT_TRUE(edit) << edit.error().message;
    const auto run = run::Run::start(scene_of(scene, edit->setup));
    ASSERT_TRUE(run) << run.error().message;

    constexpr int steps = 10;
    act(fresh, action);
    const std::uint64_t begun = hash(fresh);
    for (int step = 0; step < steps; ++step) fresh.advance();
    const std::uint64_t later = hash(fresh);
    act(fresh, {{"action", "restart"}});
    EXPECT_EQ(begun, hash(fresh)) << "after the restart: " << action;
    EXPECT_EQ(begun, hash_state((*run)->state())) << "talus run: " << action;
    for (int step = 0; step < steps; ++step) fresh.advance();
    for (int step = 0; step < steps; ++step) (*run)->advance();
    EXPECT_EQ(later, hash(fresh)) << "after the restart: " << action;
    EXPECT_EQ(later, hash_state((*run)->state())) << "talus run: " << action;
}

/// A release is seeded with the material and beside the structures of its run, so any of these keys may matter.
TEST(LiveKeys, begin_a_new_scenario_as_a_restart_and_a_run_of_its_values) {
    scene::Scene scene = channel_scene();
    const json beside = ring(west + 17, south + 27, west + 19, south + 33);
    const json under = ring(west + 4, south + 24, west + 40, south + 36);
    const Shape shapes[] = {
        {"barrier",
         "barriers",
         {{"action", "put_barrier"}, {"line", {{west + 17, south + 22}, {west + 17, south + 38}}}, {"height_m", 5}}},
        {"release", "releases", {{"action", "put_release"}, {"polygon", beside}, {"thickness_m", 1.5}}},
        {"buildings", "buildings", {{"action", "put_building"}, {"polygon", beside}, {"height_m", 5}}},
        {"inflow",
         "inflows",
         {{"action", "put_inflow"},
          {"polygon", ring(west + 20, south + 24, west + 40, south + 36)},
          {"hydrograph", {row(0), row(2)}}}},
        {"zone", "zones", {{"action", "put_zone"}, {"polygon", under}, {"friction_coefficient", 0.5}}},
        {"bed", "beds", {{"action", "put_bed"}, {"polygon", under}, {"depth_m", 0.5}, {"growth_rate_per_m", 0.02}}}};
    const auto plain = open(scene);
    run_until(*plain, 0.3);
    for (const params::Parameter* parameter : live_parameters()) {
        expect_one_beginning(
            *plain,
            {{"action", "set_parameter"}, {"key", "material." + parameter->key}, {"value", value_of(*parameter)}});
    }
    for (const Shape& shape : shapes) {
        expect_one_beginning(*plain, shape.put);
        const auto with_shape = open(scene);
        json change = {{"action", shape.put["action"]}, {"id", act(*with_shape, shape.put).created}};
        run_until(*with_shape, 0.3);
        for (const params::Parameter& parameter : params::find_section(shape.section)->parameters) {
            if (parameter.live.empty()) continue;
            json action = change;
            action[parameter.live] = parameter.live == "crest_elevation_m" ? json(25) : value_of(parameter);
            expect_one_beginning(*with_shape, action);
        }
        if (shape.section != std::string("inflow")) continue;
        for (const params::Parameter& parameter : params::live_section("hydrograph").parameters) {
            json rows = {row(0), row(2), row(4)};
            for (json& each : rows) {
                if (parameter.key != "time_s") each[parameter.key] = 7;
            }
            rows[1][parameter.key] = 3;
            json action = change;
            action["hydrograph"] = rows;
            expect_one_beginning(*with_shape, action);
        }
    }
}

/// Far from the debris they are changed in place: nobody waits for debris to be seeded again.
TEST(LiveKeys, of_structures_far_from_the_release_change_the_run_in_place) {
    scene::Scene scene = channel_scene();
    scene.spec.solver.particle_spacing = 0.8;
    add_building(scene, "house", rectangle(west + 38, south + 27, west + 42, south + 33), 6);
    const auto edited = open(scene);
    const observe::Observer* begun = &edited->run().observer();
    act(*edited,
        {{"action", "put_barrier"}, {"line", {{west + 37, south + 22}, {west + 37, south + 38}}}, {"height_m", 2}});
    act(*edited,
        {{"action", "put_building"}, {"polygon", ring(west + 44, south + 27, west + 48, south + 33)}, {"height_m", 5}});
    act(*edited, {{"action", "put_barrier"}, {"id", "barrier-1"}, {"height_m", 1}});
    act(*edited, {{"action", "remove_building"}, {"id", "building-1"}});
    EXPECT_EQ(begun, &edited->run().observer()) << "the run was started anew";
    const auto again = edited->copying()({});
    ASSERT_TRUE(again) << again.error().message;
    run_until(*edited, 6);
    run_until(**again, 6);
    EXPECT_EQ(impacts_json(*edited)["barriers"][0]["hit"], true);
    EXPECT_EQ(hash(*edited), hash(**again));
}

TEST(LiveKeys, of_older_journals_are_read_to_the_same_setup) {
    const scene::Scene scene = channel_scene();
    const auto scenario = open(scene);
    act(*scenario, {{"action", "put_barrier"},
                    {"line", {{west + 52, south + 8}, {west + 52, south + 52}}},
                    {"crest_elevation_m", 15}});
    act(*scenario, {{"action", "put_inflow"},
                    {"polygon", ring(west + 60, south + 20, west + 70, south + 40)},
                    {"direction_deg", 200.3},
                    {"hydrograph", {row(0), row(2)}}});
    const json far = ring(west + 80, south + 20, west + 86, south + 40);
    act(*scenario, {{"action", "put_release"}, {"polygon", far}, {"thickness_m", 0.5}});
    act(*scenario, {{"action", "put_bed"}, {"polygon", far}, {"depth_m", 0.5}, {"growth_rate_per_m", 0.02}});
    act(*scenario, {{"action", "put_building"},  // as older actions name its outline
                    {"footprint", ring(west + 44, south + 27, west + 48, south + 33)},
                    {"height_m", 5}});
    act(*scenario, {{"action", "restart"}});
    const json now = json::parse(journal_json(*scenario)["first_setup"].dump());
    json old = now;
    old["barriers"][0]["height_m"] = 0;  // once beside the elevation of a level crest
    old["barriers"][0].erase("openings");
    for (const auto& [list, parts, number, numbers] :
         {std::tuple("releases", "patches", "thickness_m", "thicknesses_m"),
          std::tuple("beds", "parts", "depth_m", "depths_m")}) {  // once outlines with their numbers
        json& entry = old[list].back();
        ASSERT_EQ(entry["polygons"].size(), 1U);
        entry[parts] = {{{"rings", entry["polygons"][0]}, {number, entry[numbers][0]}}};
        entry.erase("polygons");
        entry.erase(numbers);
    }
    old["buildings"].back()["footprint"] = old["buildings"].back()["polygons"];
    old["buildings"].back().erase("polygons");
    old["inflows"][0].erase("direction_deg");
    old["inflows"][0]["direction"] = 200.3 * M_PI / 180;
    const auto read = read_setup(old, scene);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(json::parse(write_setup(*read).dump()), now);
    const params::BarrierSpec& barrier = read->barriers[0].shape();
    EXPECT_FALSE(barrier.height.has_value());
    EXPECT_EQ(barrier.crest_elevation, 15);
    for (double degrees = 0.05; degrees < 360; degrees += 7.3) {  // to the last bit, or a replay would be another run
        const double radians = degrees * M_PI / 180;
        old["inflows"][0]["direction"] = radians;
        EXPECT_EQ(*read_setup(old, scene)->inflows[0].body->spec.direction * M_PI / 180, radians) << degrees;
    }
}

TEST(LiveKeys, keep_the_rules_of_the_scene_file) {
    scene::Scene scene = channel_scene();
    scene.spec.solver.time_step = 0.02;
    scene.spec.solver.internal_friction = params::InternalFriction::pair;
    const auto scenario = open(scene);
    const auto set = [](const char* key, double value) {
        return json{{"action", "set_parameter"}, {"key", key}, {"value", value}};
    };
    EXPECT_NE(
        refusal(*scenario, set("material.viscosity", 0.9)).find("material.viscosity = 0.9 is refused; with particles"),
        std::string::npos);
    EXPECT_NE(refusal(*scenario, set("material.cohesion_Pa", 10))
                  .find("material.cohesion_Pa: needs solver.internal_friction = \"stress\""),
              std::string::npos);
    const json about = scene_json(*scenario);
    EXPECT_EQ(about["settings"]["solver.internal_friction"], "pair");
    for (const json& parameter : about["parameters"]) {
        if (parameter["key"] != "material.viscosity") continue;
        EXPECT_EQ(parameter["range"]["high"], 0.8333);
    }
    act(*scenario, set("material.viscosity", 0.8));
}

TEST(LiveKeys, take_the_place_of_their_alternatives) {
    const scene::Scene scene = channel_scene();
    const auto scenario = open(scene);
    act(*scenario,
        {{"action", "put_barrier"}, {"line", {{west + 52, south + 8}, {west + 52, south + 52}}}, {"height_m", 5}});
    const auto barrier = [&] { return setup_json(*scenario)["barriers"][0]; };
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
