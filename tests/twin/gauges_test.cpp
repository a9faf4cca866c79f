#include "twin/gauges_json.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

/// One on the flow path, one on a bank that debris does not reach.
scene::Scene gauged_scene() {
    scene::Scene scene = channel_scene();
    scene.gauges = {{"in the channel", {west + 45, south + 30}, 40}, {"on the bank", {west + 60, south + 55}}};
    return scene;
}

TEST(Gauges, are_told_with_the_scene) {
    const json gauges = scene_json(*open(gauged_scene()))["gauges"];
    ASSERT_EQ(gauges.size(), 2U);
    EXPECT_EQ(gauges[0],
              (json{{"name", "in the channel"}, {"x_m", west + 45}, {"y_m", south + 30}, {"chainage_m", 40.0}}));
    EXPECT_EQ(gauges[1]["chainage_m"], nullptr) << "given as a place";
    EXPECT_EQ(gauges_json(*open(channel_scene()))["gauges"], json::array());
}

TEST(Gauges, read_what_passes_as_the_record_of_the_run_has_it) {
    const auto scenario = open(gauged_scene());
    double arrival = NAN, deepest = 0, fastest = 0;
    while (scenario->time() < 8 && scenario->phase() == run::RunPhase::ready) {
        scenario->advance();
        const json now = gauges_json(*scenario)["gauges"][0];
        deepest = std::max(deepest, now["depth_m"].get<double>());
        fastest = std::max(fastest, now["speed_mps"].get<double>());
        if (std::isnan(arrival) && !now["arrival_s"].is_null()) arrival = scenario->time();
    }
    const json gauges = gauges_json(*scenario)["gauges"];
    EXPECT_GT(deepest, 0.2);
    EXPECT_GT(fastest, 2);
    EXPECT_EQ(gauges[0]["peak_depth_m"], deepest);
    EXPECT_EQ(gauges[0]["peak_speed_mps"], fastest);
    EXPECT_EQ(gauges[0]["arrival_s"], arrival);
    EXPECT_EQ(gauges[1], (json{{"name", "on the bank"},
                               {"arrival_s", nullptr},
                               {"depth_m", 0.0},
                               {"speed_mps", 0.0},
                               {"peak_depth_m", 0.0},
                               {"peak_speed_mps", 0.0}}));
    const json curves = series_json(*scenario)["gauges"];
    ASSERT_EQ(curves["depth_m"].size(), 2U);
    EXPECT_EQ(curves["time_s"], series_json(*scenario)["time"]["time_s"]);
    EXPECT_EQ(curves["depth_m"][0].size(), curves["time_s"].size());
}

TEST(Gauges, of_an_earlier_time_know_nothing_of_what_came_later) {
    const auto scenario = open(gauged_scene());
    run_until(*scenario, 8);
    const json now = gauges_json(*scenario)["gauges"][0];
    const double arrival = now["arrival_s"];
    const json before = gauges_json(*scenario, arrival - 0.2)["gauges"][0];
    EXPECT_EQ(before["arrival_s"], nullptr);
    EXPECT_LT(before["peak_depth_m"], 0.05);
    const json soon = gauges_json(*scenario, arrival + 0.2)["gauges"][0];
    EXPECT_EQ(soon["arrival_s"], arrival);
    EXPECT_GT(soon["depth_m"], 0);
    EXPECT_LE(soon["peak_depth_m"], now["peak_depth_m"]);
    const json end = gauges_json(*scenario, scenario->time())["gauges"][0];
    EXPECT_EQ(end["peak_depth_m"], now["peak_depth_m"]) << "also of a step between two rows";
}

TEST(Gauges, curves_of_a_long_run_stay_short) {
    std::vector<observe::GaugeRecord> records(2);
    for (int row = 0; row < 2500; ++row) {
        for (observe::GaugeRecord& record : records) record.rows.push_back({0.1 * row, 0.001 * row, 0});
    }
    const json curves = gauge_curves(records);
    EXPECT_EQ(curves["time_s"].size(), 500U);
    EXPECT_EQ(curves["depth_m"][1].size(), 500U);
    EXPECT_EQ(curves["time_s"][1], 0.5);
    EXPECT_EQ(curves["depth_m"][1][1], 0.005);
}

TEST(Gauges, are_empty_again_after_a_restart_and_in_a_new_scenario) {
    const auto scenario = open(gauged_scene());
    const json first = gauges_json(*scenario);
    run_until(*scenario, 6);
    ASSERT_NE(gauges_json(*scenario), first);
    EXPECT_EQ(gauges_json(**scenario->copying()({})), first);
    act(*scenario, {{"action", "restart"}});
    EXPECT_EQ(gauges_json(*scenario), first);
    EXPECT_EQ(series_json(*scenario)["gauges"]["time_s"], json::array({0.0}));
}

TEST(CrossSections, say_what_passes_now_and_as_of_a_time) {
    scene::Scene scene = channel_scene();
    scene.cross_sections = {{"across the channel", {{west + 45, south + 60}, {west + 45, south}}},
                            {"on the bank", {{west + 60, south + 50}, {west + 60, south + 58}}}};
    const auto scenario = open(std::move(scene));
    EXPECT_EQ(scene_json(*scenario)["cross_sections"][0],
              (json{{"name", "across the channel"}, {"line", {{west + 45, south + 60}, {west + 45, south}}}}));
    const json before = gauges_json(*scenario)["cross_sections"];
    ASSERT_EQ(before.size(), 2U);
    EXPECT_EQ(before[0]["passed_m3"], 0);
    run_until(*scenario, 6);
    const json now = gauges_json(*scenario)["cross_sections"];
    EXPECT_NE(now[0]["passed_m3"].get<double>(), 0);
    EXPECT_NE(now[0]["peak_discharge_m3ps"].get<double>(), 0);
    EXPECT_EQ(
        now[1],
        (json{{"name", "on the bank"}, {"discharge_m3ps", 0.0}, {"peak_discharge_m3ps", 0.0}, {"passed_m3", 0.0}}));
    EXPECT_EQ(gauges_json(*scenario, 0)["cross_sections"], before) << "as of the beginning";
    const json soon = gauges_json(*scenario, 3)["cross_sections"][0];
    EXPECT_LE(std::abs(soon["peak_discharge_m3ps"].get<double>()),
              std::abs(now[0]["peak_discharge_m3ps"].get<double>()));
}

TEST(Gauges, change_nothing_of_the_run) {
    const auto with = open(gauged_scene()), without = open(channel_scene());
    run_until(*with, 3);
    run_until(*without, 3);
    EXPECT_EQ(hash(*with), hash(*without));
}

}  // namespace
}  // namespace talus::twin::test
