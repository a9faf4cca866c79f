#include "twin/trigger.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "core/hash.hpp"
#include "terrain/inflow.hpp"
#include "twin/journal.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using ::testing::HasSubstr;

/// The channel with a second scar, a gauged inflow across its upper end, a house, and triggers for each source.
scene::Scene scene_with_gauge(int threads = 2) {
    scene::Scene scene = channel_scene();
    scene.spec.solver.thread_count = threads;
    terrain::Release second = scene.releases[0];
    second.name = "second scar";
    second.patches = {{rectangle(west + 24, south + 26, west + 30, south + 34), 1}};
    second.volume = release_volume(scene.terrain, second);
    scene.releases.push_back(second);
    terrain::Inflow inflow;
    inflow.name = "stream";
    inflow.from = {west + 20, south + 27};
    inflow.to = {west + 20, south + 33};
    inflow.hydrograph = {{0, 0, 0}, {1, 10, 4}, {4, 10, 4}, {5, 0, 0}};
    inflow.spec.name = inflow.name;
    inflow.spec.line = {inflow.from, inflow.to};
    scene.inflows.push_back(inflow);
    add_building(scene, "House 38", rectangle(west + 60, south + 27, west + 66, south + 33), 6);
    params::TriggerSpec by_volume, by_gauge;
    by_volume.name = by_volume.release = "scar";
    by_volume.volume_limit = 100;
    by_volume.pore_pressure_ratio_limit = 0.5;
    by_gauge.name = "gauge";
    by_gauge.inflow = "stream";
    by_gauge.discharge_limit = 20;
    by_gauge.hold_time = 3;
    scene.spec.triggers = {by_volume, by_gauge};
    return scene;
}

json start(const char* trigger, const json& values) {
    return {{"action", "trigger"},
            {"trigger", trigger},
            {"source", "HTTP"},
            {"received_at", "2026-11-24T14:03:00Z"},
            {"values", values}};
}
json reading(double time, const json& discharge) {
    return {{"action", "gauge"}, {"trigger", "gauge"}, {"time_s", time}, {"discharge_m3ps", discharge}};
}

TEST(Trigger, starts_with_its_own_source_and_the_values_of_the_message) {
    const auto scenario = open(scene_with_gauge());
    const Done done = act(*scenario, start("scar", {{"volume_m3", 20}, {"pore_pressure_ratio", 0.3}}));
    EXPECT_THAT(done.sentence, HasSubstr("started by trigger \"scar\", volume 20 m3, pore pressure ratio 0.3"));
    const json setup = setup_json(*scenario);
    // The second scar belongs to no trigger and takes part; the stream belongs to another one.
    ASSERT_EQ(setup["releases"].size(), 2);
    EXPECT_NEAR(setup["releases"][0]["volume_m3"].get<double>(), 20, 1e-6);
    EXPECT_EQ(setup["inflows"].size(), 0);
    ASSERT_NE(started_by(*scenario), nullptr);
    EXPECT_EQ((*started_by(*scenario))["values"]["volume_m3"], 20);
    EXPECT_EQ(setup["undo"], nullptr);
    run_until(*scenario, 1);
    EXPECT_THAT(refusal(*scenario, start("scar", json::object())), HasSubstr("has begun"));
    act(*scenario, {{"action", "restart"}});
    EXPECT_EQ(started_by(*scenario), nullptr);
}

TEST(Trigger, refuses_values_outside_the_limits_of_the_scene) {
    const auto scenario = open(scene_with_gauge());
    const std::pair<json, const char*> bad[] = {
        {start("scar", {{"volume_m3", 101}}), "volume_m3 = 101"},
        {start("scar", {{"volume_m3", 0}}), "volume_m3 = 0"},
        {start("scar", {{"volume_m3", -1}}), "volume_m3 = -1"},
        {start("scar", {{"volume_m3", "20"}}), "volume_m3 = \"20\""},
        {start("scar", {{"volume_m3", nullptr}}), "volume_m3 = null"},
        {start("scar", {{"volume_m3", 0.001}}), "at least one particle"},
        {start("scar", {{"pore_pressure_ratio", 0.6}}), "pore_pressure_ratio = 0.6"},
        {start("scar", {{"discharge_m3ps", 1}}), "does not take it"},
        {start("scar", {{"friction", 1}}), "friction"},
        {start("scars", json::object()), "nearest name: scar"},
        {start("gauge", {{"discharge_m3ps", 20.5}}), "discharge_m3ps = 20.5"},
        {start("gauge", {{"discharge_m3ps", 0}}), "discharge_m3ps = 0"},
    };
    for (const auto& [action, message] : bad) EXPECT_THAT(refusal(*scenario, action), HasSubstr(message));
}

TEST(Trigger, a_reading_changes_the_hydrograph_from_its_time_on_and_holds) {
    const std::vector<params::InflowSample> rated = {{0, 0, 0, 0}, {1, 32, 4, 0}, {2, 0, 0, 0}};
    const std::vector<params::InflowSample> before = {{0, 1, 1, 0}, {60, 1, 1, 0}, {61, 0, 0, 0}};
    terrain::Inflow old, now;
    old.hydrograph = before;
    now.hydrograph = with_reading(before, rated, 10, 1, 30);
    for (const double time : {0.0, 3.3, 10.0}) EXPECT_NEAR(now.volume_until(time), old.volume_until(time), 1e-12);
    // 4 m/s at 32 m3/s; a 32nd of the discharge has a quarter of the velocity: 32^0.4 = 4.
    EXPECT_NEAR(now.velocity_at(20), 1, 1e-12);
    EXPECT_NEAR(now.volume(), 10 + 1 + 30 + 0.5, 1e-9);
    EXPECT_EQ(now.hydrograph.back().discharge, 0);
    EXPECT_EQ(now.hydrograph.back().time, 42);
    // After the end of the one before it begins at 0.
    now.hydrograph = with_reading(before, rated, 100, 2, 30);
    EXPECT_NEAR(now.volume(), old.volume() + 1 + 60 + 1, 1e-9);
}

/// A run with a gauge: more, late, an undone change between, then silence.
void play_triggers(Scenario& scenario) {
    act(scenario, start("gauge", {{"discharge_m3ps", 6}}));
    run_until(scenario, 1);
    act(scenario, reading(1.5, 12));
    act(scenario, {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.3}});
    run_until(scenario, 2.2);
    EXPECT_THAT(act(scenario, reading(1.9, 9)).sentence, HasSubstr("late"));
    act(scenario, {{"action", "undo"}});
    EXPECT_THAT(refusal(scenario, reading(1.9, 9)), HasSubstr("not later"));
    EXPECT_THAT(refusal(scenario, reading(1.0, 9)), HasSubstr("not later"));
    EXPECT_THAT(refusal(scenario, reading(3, -1)), HasSubstr("discharge_m3ps = -1"));
    EXPECT_THAT(refusal(scenario, reading(3, "much")), HasSubstr("much"));
    EXPECT_THAT(refusal(scenario, reading(3, nullptr)), HasSubstr("discharge_m3ps"));
    run_until(scenario, 4);
}

TEST(Trigger, a_gauge_feeds_the_inflow_of_the_run_and_its_silence_ends_it) {
    const auto scenario = open(scene_with_gauge());
    play_triggers(*scenario);
    const json setup = setup_json(*scenario);
    EXPECT_EQ(setup["pending_restart"], false);
    EXPECT_EQ(setup["inflows"][0]["in_force"], true);
    ASSERT_EQ(setup["inflows"].size(), 1);
    // Over the whole hydrograph: 6 m3/s until 1.5 s, a rise to 12 that is cut short at about 2.2 s, then 9 held for 3
    // s.
    const double expected = setup["inflows"][0]["volume_m3"];
    EXPECT_NEAR(expected, 9 + (6 + 10.2) / 2 * 0.7 + 9.6 + 27 + 4.5, 1.0);
    EXPECT_LT(number(*scenario, "volume_released_m3"), expected + 60);
    // The run lasts at least as long as the gauge's last value does, and then brings no more.
    run_until(*scenario, 8);
    const double in = number(*scenario, "volume_released_m3");
    run_until(*scenario, 9);
    EXPECT_EQ(number(*scenario, "volume_released_m3"), in);
    double scars = 0;
    for (const json& release : setup["releases"]) scars += release["volume_m3"].get<double>();
    EXPECT_NEAR(in - scars, expected, 1);
    expect_balance(*scenario);
    if (scenario->phase() == run::RunPhase::ready) {
        act(*scenario, reading(20, 5));  // it may speak again
        run_until(*scenario, 26);
        EXPECT_GT(number(*scenario, "volume_released_m3"), in + 10);
    }
}

TEST(Trigger, replays_to_the_same_hash_with_every_value_of_the_gauge) {
    const auto scenario = open(scene_with_gauge());
    play_triggers(*scenario);
    const auto journal = read_journal(journal_json(*scenario).dump());
    ASSERT_TRUE(journal) << journal.error().message;
    for (const int threads : {1, 2}) {
        const auto again = replay(*journal, std::make_shared<const scene::Scene>(scene_with_gauge(threads)));
        ASSERT_TRUE(again) << again.error().message;
        EXPECT_EQ(again->hash, to_hex(hash(*scenario)));
        EXPECT_EQ(setup_json(*again->scenario)["inflows"], setup_json(*scenario)["inflows"]);
    }
    Journal other = *journal;
    ASSERT_EQ(other.entries[1].action["action"], "gauge");
    other.entries[1].action["discharge_m3ps"] = 12.5;
    EXPECT_NE(replay(other, std::make_shared<const scene::Scene>(scene_with_gauge()))->hash, journal->hash);
}

TEST(Trigger, a_gauge_that_would_bring_too_many_particles_is_refused) {
    scene::Scene scene = scene_with_gauge();
    scene.spec.solver.particle_limit = 900;
    scene.spec.triggers[1].hold_time = 10;
    const auto scenario = open(std::move(scene));
    act(*scenario, start("gauge", {{"discharge_m3ps", 1}}));
    run_until(*scenario, 0.5);
    EXPECT_THAT(refusal(*scenario, reading(1, 20)), HasSubstr("particles in all"));
    EXPECT_THAT(refusal(*scenario, reading(1, 21)), HasSubstr("discharge_m3ps = 21"));
}

}  // namespace
}  // namespace talus::twin::test
