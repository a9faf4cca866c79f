// Zones, beds and inflows that people draw and change while debris moves.
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>

#include "twin/journal.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using testing::HasSubstr;

/// All of the channel's floor behind a distance from its head, m.
json floor_from(double distance) {
    return ring(west + distance, south + 20, west + 118, south + 40);
}

json rough_zone() {
    return {{"action", "put_zone"}, {"polygon", floor_from(20)}, {"friction_coefficient", 0.9}};
}

json loose_bed() {
    return {{"action", "put_bed"}, {"polygon", floor_from(20)}, {"depth_m", 0.5}, {"growth_rate_per_m", 0.03}};
}

json rows(double discharge, double velocity = 4) {
    return {{{"time_s", 0}, {"discharge_m3ps", discharge}, {"velocity_mps", velocity}},
            {{"time_s", 2}, {"discharge_m3ps", discharge}, {"velocity_mps", velocity}}};
}

json gully(double discharge) {
    return {{"action", "put_inflow"},
            {"line", {{west + 20, south + 27}, {west + 20, south + 33}}},
            {"hydrograph", rows(discharge)}};
}

double front_after(Scenario& scenario, double time) {
    run_until(scenario, time);
    EXPECT_NE(scenario.phase(), run::RunPhase::fault) << scenario.message();
    return number(scenario, "front_chainage_m");
}

void expect_same_when_replayed(const Scenario& scenario, scene::Scene scene) {
    const auto journal = read_journal(journal_json(scenario).dump());
    ASSERT_TRUE(journal) << journal.error().message;
    const auto again = replay(*journal, std::make_shared<const scene::Scene>(std::move(scene)));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->hash, journal->hash);
}

/// The channel with one of each.
scene::Scene furnished_scene() {
    scene::Scene scene = channel_scene();
    scene::Zone zone;
    zone.spec.name = "wood";
    zone.spec.stem_density = 0.1;
    zone.outline = {rectangle(west + 60, south + 20, west + 70, south + 40)};
    scene.zones.push_back(zone);
    scene::BedLayer layer;
    layer.spec.name = "fan";
    layer.spec.growth_rate = 0.02;
    layer.parts = {{rectangle(west + 30, south + 25, west + 40, south + 35), 0.4},
                   {rectangle(west + 40, south + 25, west + 50, south + 35), 0.8}};
    scene.bed_layers.push_back(layer);
    scene.inflows.push_back({"gully", {west + 20, south + 27}, {west + 20, south + 33}, {{0, 6, 4}, {2, 6, 4}}});
    return scene;
}

TEST(Zone, drawn_while_debris_moves_holds_it_back_and_undone_lets_it_go) {
    const auto plain = open(channel_scene()), rough = open(channel_scene());
    run_until(*plain, 1);
    run_until(*rough, 1);
    ASSERT_EQ(hash(*plain), hash(*rough));
    const Done done = act(*rough, rough_zone());
    EXPECT_EQ(done.created, "zone-1");
    EXPECT_EQ(done.sentence, "zone \"zone 1\" drawn: 1960 m2");
    EXPECT_LT(front_after(*rough, 6), front_after(*plain, 6) - 3);
    expect_same_when_replayed(*rough, channel_scene());

    run_until(*rough, 12);
    const double held = number(*rough, "front_chainage_m");
    act(*rough, {{"action", "undo"}});
    EXPECT_EQ(setup_json(*rough)["zones"].size(), 0U);
    EXPECT_GT(front_after(*rough, 20), held + 3) << "debris at rest on the slope wakes";
    expect_same_when_replayed(*rough, channel_scene());
}

TEST(Zone, changes_by_the_keys_of_a_scene_and_says_what_it_holds) {
    const auto scenario = open(furnished_scene());
    json zone = setup_json(*scenario)["zones"][0];
    EXPECT_EQ(zone["name"], "wood");
    EXPECT_EQ(zone["from_scene"], true);
    EXPECT_EQ(zone["area_m2"], 200);
    EXPECT_EQ(zone["friction_coefficient"], nullptr);
    EXPECT_EQ(zone["stem_density_pm2"], 0.1);
    const std::string id = zone["id"];
    act(*scenario, {{"action", "put_zone"},
                    {"id", id},
                    {"name", "old wood"},
                    {"cohesion_Pa", 300},
                    {"stem_diameter_m", 0.6},
                    {"move_m", {5, 0}}});
    zone = setup_json(*scenario)["zones"][0];
    EXPECT_EQ(zone["name"], "old wood");
    EXPECT_EQ(zone["cohesion_Pa"], 300);
    EXPECT_EQ(zone["stem_diameter_m"], 0.6);
    EXPECT_EQ(zone["stem_density_pm2"], 0.1) << "what is left out stays";
    EXPECT_EQ(zone["polygons"][0][0][0], json({west + 65, south + 20}));
    act(*scenario, {{"action", "put_zone"}, {"id", id}, {"cohesion_Pa", nullptr}});
    EXPECT_EQ(setup_json(*scenario)["zones"][0]["cohesion_Pa"], nullptr);
    act(*scenario, {{"action", "remove_zone"}, {"id", id}});
    EXPECT_EQ(setup_json(*scenario)["zones"].size(), 0U);
}

TEST(Zone, has_no_drag_of_its_own_beside_samosat) {
    scene::Scene scene = channel_scene();
    scene.spec.material.samosat = true;
    const auto scenario = open(std::move(scene));
    json zone = rough_zone();
    zone["turbulent_friction_mps2"] = 500;
    EXPECT_THAT(refusal(*scenario, zone), HasSubstr("is given beside material.samosat = true"));
    EXPECT_THAT(
        refusal(*scenario, {{"action", "set_parameter"}, {"key", "material.turbulent_friction_mps2"}, {"value", 500}}),
        HasSubstr("is given beside material.samosat = true"));
    act(*scenario, rough_zone());
}

TEST(Zone, refusals_name_key_value_and_what_is_allowed) {
    const auto scenario = open(channel_scene());
    const auto with = [](json action, const char* key, const json& value) {
        action[key] = value;
        return action;
    };
    EXPECT_EQ(refusal(*scenario, {{"action", "put_zone"}, {"friction_coefficient", 0.4}}),
              "polygon: missing; a new zone needs it");
    EXPECT_THAT(refusal(*scenario, {{"action", "put_zone"}, {"polygon", floor_from(20)}}), HasSubstr("says nothing"));
    EXPECT_EQ(refusal(*scenario, with(rough_zone(), "friction_coefficient", -1)),
              "friction_coefficient = -1: must be a number 0 to 10");
    EXPECT_THAT(refusal(*scenario, with(rough_zone(), "stem_diameter_m", nullptr)),
                HasSubstr("stem_diameter_m = null"));
    EXPECT_THAT(refusal(*scenario, with(rough_zone(), "depth_m", 1)), HasSubstr("no such key here"));
    EXPECT_THAT(refusal(*scenario, with(rough_zone(), "polygon", ring(0, 0, 9, 9))), HasSubstr("ground is not known"));
    const double x = west + 30.1, y = south + 30.1;  // between the centres of cells
    EXPECT_THAT(refusal(*scenario, with(rough_zone(), "polygon", ring(x, y, x + 0.2, y + 0.2))),
                HasSubstr("covers the centre of no cell"));
    EXPECT_THAT(refusal(*scenario, {{"action", "remove_zone"}, {"id", "zone-9"}}), HasSubstr("no such zone"));
}

TEST(Bed, drawn_at_time_0_is_picked_up) {
    const auto scenario = open(channel_scene());
    const Done done = act(*scenario, loose_bed());
    EXPECT_EQ(done.sentence, "bed \"bed 1\" drawn: 980 m3");
    const json bed = setup_json(*scenario)["beds"][0];
    EXPECT_EQ(bed["depth_m"], 0.5);
    EXPECT_EQ(bed["volume_m3"], 980);
    EXPECT_EQ(bed["law"], "growth");
    EXPECT_EQ(bed["in_force"], true);
    EXPECT_EQ(setup_json(*scenario)["pending_restart"], false);
    run_until(*scenario, 5);
    ASSERT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
    EXPECT_GT(number(*scenario, "volume_entrained_m3"), 3);
    expect_balance(*scenario);
    expect_same_when_replayed(*scenario, channel_scene());
}

TEST(Bed, changed_later_waits_for_the_restart) {
    const auto scenario = open(channel_scene());
    run_until(*scenario, 1);
    const std::string id = act(*scenario, loose_bed()).created;
    EXPECT_EQ(setup_json(*scenario)["beds"][0]["in_force"], false);
    EXPECT_EQ(setup_json(*scenario)["pending_restart"], true);
    run_until(*scenario, 4);
    EXPECT_EQ(number(*scenario, "volume_entrained_m3"), 0);
    act(*scenario, {{"action", "restart"}});
    EXPECT_EQ(setup_json(*scenario)["beds"][0]["in_force"], true);
    EXPECT_EQ(setup_json(*scenario)["pending_restart"], false);
    run_until(*scenario, 4);
    EXPECT_GT(number(*scenario, "volume_entrained_m3"), 1);
    act(*scenario, {{"action", "remove_bed"}, {"id", id}});
    EXPECT_EQ(setup_json(*scenario)["pending_restart"], true);
    act(*scenario, {{"action", "undo"}});
    EXPECT_EQ(setup_json(*scenario)["pending_restart"], false) << "as it began, however it came about";
    expect_same_when_replayed(*scenario, channel_scene());
}

TEST(Bed, of_the_scene_is_shown_and_gets_one_depth) {
    const auto scenario = open(furnished_scene());
    json bed = setup_json(*scenario)["beds"][0];
    EXPECT_EQ(bed["name"], "fan");
    EXPECT_EQ(bed["depth_m"], nullptr) << "0.4 and 0.8 m";
    EXPECT_NEAR(bed["volume_m3"].get<double>(), 120, 1e-9);
    EXPECT_EQ(bed["polygons"].size(), 2U);
    const std::string id = bed["id"];
    act(*scenario, {{"action", "put_bed"}, {"id", id}, {"law", "shear"}, {"depth_m", 1}});
    bed = setup_json(*scenario)["beds"][0];
    EXPECT_EQ(bed["law"], "shear");
    EXPECT_NEAR(bed["volume_m3"].get<double>(), 200, 1e-9);
    EXPECT_EQ(bed["growth_rate_per_m"], 0.02);
}

TEST(Bed, refusals_name_key_value_and_what_is_allowed) {
    const auto scenario = open(channel_scene());
    EXPECT_EQ(refusal(*scenario, {{"action", "put_bed"}, {"polygon", floor_from(20)}}),
              "depth_m: missing; a new bed needs it");
    EXPECT_THAT(refusal(*scenario, {{"action", "put_bed"}, {"polygon", floor_from(20)}, {"depth_m", 1}}),
                HasSubstr("growth_rate_per_m: missing; law = \"growth\" needs it"));
    json bed = loose_bed();
    bed["law"] = "magic";
    EXPECT_EQ(refusal(*scenario, bed), "law = \"magic\": must be one of \"growth\", \"shear\"");
}

TEST(Inflow, drawn_brings_debris_across_its_line) {
    const auto scenario = open(channel_scene());
    const double released = number(*scenario, "volume_released_m3");
    const Done done = act(*scenario, gully(10));
    EXPECT_EQ(done.created, "inflow-1");
    EXPECT_EQ(done.sentence, "inflow \"inflow 1\" drawn: 20 m3");
    EXPECT_EQ(setup_json(*scenario)["inflows"][0]["in_force"], true);
    run_until(*scenario, 4);
    ASSERT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
    EXPECT_NEAR(number(*scenario, "volume_released_m3"), released + 20, 0.3);
    act(*scenario, {{"action", "put_inflow"}, {"id", done.created}, {"hydrograph", rows(5)}});
    const json inflow = setup_json(*scenario)["inflows"][0];
    EXPECT_EQ(inflow["volume_m3"], 10);
    EXPECT_EQ(inflow["in_force"], false);
    expect_same_when_replayed(*scenario, channel_scene());
    act(*scenario, {{"action", "restart"}});
    run_until(*scenario, 4);
    EXPECT_NEAR(number(*scenario, "volume_released_m3"), released + 10, 0.3);
    expect_balance(*scenario);
}

TEST(Inflow, moves_between_a_line_and_an_area) {
    const auto scenario = open(furnished_scene());
    const std::string id = setup_json(*scenario)["inflows"][0]["id"];
    act(*scenario, {{"action", "put_inflow"},
                    {"id", id},
                    {"polygon", ring(west + 20, south + 26, west + 30, south + 34)},
                    {"direction_deg", 90}});
    json inflow = setup_json(*scenario)["inflows"][0];
    EXPECT_EQ(inflow["line"], nullptr);
    EXPECT_EQ(inflow["polygons"].size(), 1U);
    EXPECT_NEAR(inflow["direction_deg"].get<double>(), 90, 1e-9);
    act(*scenario, {{"action", "put_inflow"}, {"id", id}, {"move_m", {2, 1}}});
    EXPECT_EQ(setup_json(*scenario)["inflows"][0]["polygons"][0][0][0], json({west + 22, south + 27}));
    run_until(*scenario, 3);
    EXPECT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
    expect_same_when_replayed(*scenario, furnished_scene());
    act(*scenario,
        {{"action", "put_inflow"}, {"id", id}, {"line", {{west + 30, south + 27}, {west + 30, south + 33}}}});
    inflow = setup_json(*scenario)["inflows"][0];
    EXPECT_EQ(inflow["polygons"].size(), 0U);
    EXPECT_EQ(inflow["direction_deg"], nullptr);
}

TEST(Inflow, refusals_name_key_value_and_what_is_allowed) {
    const auto scenario = open(channel_scene());
    const auto with = [](const json& hydrograph) {
        json action = gully(1);
        action["hydrograph"] = hydrograph;
        return action;
    };
    EXPECT_THAT(refusal(*scenario, {{"action", "put_inflow"}, {"hydrograph", rows(1)}}), HasSubstr("line or polygon"));
    EXPECT_THAT(refusal(*scenario, with(nullptr)), HasSubstr("hydrograph = null: must be a list"));
    EXPECT_THAT(refusal(*scenario, with({rows(1)[1], rows(1)[0]})), HasSubstr("hydrograph[1]: time_s = 0 is refused"));
    EXPECT_THAT(refusal(*scenario, with(rows(1, 0))), HasSubstr("hydrograph[0]: velocity_mps = 0 is refused"));
    EXPECT_THAT(refusal(*scenario, with(rows(0))), HasSubstr("no debris at all"));
    EXPECT_THAT(refusal(*scenario, with(rows(1e6, 300))), HasSubstr("solver.particle_limit"));
    EXPECT_THAT(refusal(*scenario, with(rows(1e7))), HasSubstr("m thick; it must be at most 1000 m"));
    json mixed = rows(1);
    mixed[0]["density_kgpm3"] = 2000;
    EXPECT_THAT(refusal(*scenario, with(mixed)), HasSubstr("in every row or in none"));
    json late = rows(1);
    late[0]["time_s"] = 40;
    late[1]["time_s"] = 50;
    EXPECT_THAT(refusal(*scenario, with(late)), HasSubstr("solver.end_time_s = 30"));
    json turned = gully(1);
    turned["direction_deg"] = 10;
    EXPECT_THAT(refusal(*scenario, turned), HasSubstr("direction_deg"));
}

TEST(Ground, as_it_was_in_the_run_is_in_the_products) {
    const auto scenario = open(furnished_scene());
    act(*scenario, rough_zone());
    run_until(*scenario, 1);
    act(*scenario, loose_bed());
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "ground products";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    const Status written = products_of(*scenario)(folder);
    ASSERT_TRUE(written) << written.error().message;
    std::ifstream in(folder / "report.html");
    const std::string report((std::istreambuf_iterator<char>(in)), {});
    const auto tells_of = [&](const char* name) { return report.find(name) != std::string::npos; };
    EXPECT_TRUE(tells_of(">wood<"));
    EXPECT_TRUE(tells_of(">zone 2<"));
    EXPECT_TRUE(tells_of(">fan<"));
    EXPECT_FALSE(tells_of(">bed 2<")) << "it was drawn too late";
}

}  // namespace
}  // namespace talus::twin::test
