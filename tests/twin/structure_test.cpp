#include <gmock/gmock.h>

#include "terrain/barrier.hpp"
#include "twin/journal.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

/// The channel with a house and a dam across it; both from the scene.
scene::Scene dammed_scene(std::optional<double> resistance = {}) {
    scene::Scene scene = channel_scene();
    add_building(scene, "hut", rectangle(west + 100, south + 26, west + 104, south + 30), 3);
    params::BarrierSpec shape{{{west + 52, south + 8}, {west + 52, south + 52}}, 5, {}, 1.2, {{22, 2, 0}}};
    shape.resistance_force = resistance;
    const auto dam = make_barrier(scene.terrain, "dam", shape);
    EXPECT_TRUE(dam);
    scene.buildings.push_back(*dam);
    return scene;
}

TEST(SceneBarrier, is_shown_edited_and_removed_like_a_drawn_one) {
    const auto scenario = open(dammed_scene());
    json setup = setup_json(*scenario);
    ASSERT_EQ(setup["buildings"].size(), 1U);
    ASSERT_EQ(setup["barriers"].size(), 1U);
    const json& dam = setup["barriers"][0];
    EXPECT_EQ(dam["name"], "dam");
    EXPECT_EQ(dam["from_scene"], true);
    EXPECT_EQ(dam["openings"][0]["width_m"], 2);
    EXPECT_EQ(dam["resistance_Npm"], nullptr);
    const std::string id = dam["id"];
    act(*scenario, {{"action", "put_barrier"}, {"id", id}, {"height_m", 3}, {"resistance_Npm", 5000}});
    setup = setup_json(*scenario);
    EXPECT_EQ(setup["barriers"][0]["height_m"], 3);
    EXPECT_EQ(setup["barriers"][0]["resistance_Npm"], 5000);
    EXPECT_EQ(setup["barriers"][0]["openings"].size(), 1U) << "the slot stays";
    act(*scenario, {{"action", "remove_barrier"}, {"id", id}});
    EXPECT_EQ(setup_json(*scenario)["barriers"].size(), 0U);
    act(*scenario, {{"action", "undo"}});
    EXPECT_EQ(setup_json(*scenario)["barriers"].size(), 1U);
}

TEST(SceneBarrier, lets_through_its_slot_what_is_counted_as_passed) {
    const auto scenario = open(dammed_scene());
    run_until(*scenario, 10);
    ASSERT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
    const json dam = impacts_json(*scenario)["barriers"][0];
    EXPECT_EQ(dam["hit"], true);
    EXPECT_GT(dam["impulse_kNs"], 0);
    EXPECT_GT(dam["passed_m3"], 1);
    EXPECT_GT(dam["peak_filling_height_m"], 0.3);
    EXPECT_EQ(dam["failed_s"], nullptr);
}

TEST(Resistance, exceeded_takes_the_dam_away_once_and_replays_to_the_same_hash) {
    const double weak = 500;  // N/m
    const auto scenario = open(dammed_scene(weak));
    run_until(*scenario, 6);
    ASSERT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
    const json dam = impacts_json(*scenario)["barriers"][0];
    ASSERT_NE(dam["failed_s"], nullptr);
    EXPECT_GE(dam["failed_s"], dam["first_hit_s"]);
    // Another edit does not put it up again.
    act(*scenario, {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.2}});
    run_until(*scenario, 9);
    EXPECT_EQ(impacts_json(*scenario)["barriers"][0]["failed_s"], dam["failed_s"]);
    EXPECT_GT(number(*scenario, "front_chainage_m"), 60);

    const auto journal = read_journal(journal_json(*scenario).dump());
    ASSERT_TRUE(journal) << journal.error().message;
    const auto again = replay(*journal, std::make_shared<const scene::Scene>(dammed_scene(weak)));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->hash, journal->hash);

    act(*scenario, {{"action", "restart"}});
    EXPECT_EQ(impacts_json(*scenario)["barriers"][0]["failed_s"], nullptr) << "it stands again";
}

TEST(Net, is_drawn_opened_closed_and_made_a_wall) {
    const auto scenario = open(dammed_scene());
    const std::string id = setup_json(*scenario)["barriers"][0]["id"];
    const auto net = [&] { return setup_json(*scenario)["barriers"][0]; };
    EXPECT_EQ(net()["passing_share"], nullptr);
    act(*scenario, {{"action", "put_barrier"}, {"id", id}, {"passing_share", 0.4}, {"openings", json::array()}});
    EXPECT_EQ(net()["passing_share"], 0.4);
    EXPECT_EQ(net()["openings"].size(), 0U);
    act(*scenario, {{"action", "put_barrier"},
                    {"id", id},
                    {"openings", {{{"position_m", 10}, {"width_m", 3}, {"sill_height_m", 1}}}},
                    {"resistance_Pa", 3e4}});
    EXPECT_EQ(net()["passing_share"], 0.4) << "left out: as it was";
    EXPECT_EQ(net()["openings"][0]["sill_height_m"], 1);
    act(*scenario, {{"action", "put_barrier"}, {"id", id}, {"passing_share", nullptr}, {"resistance_Pa", nullptr}});
    EXPECT_EQ(net()["passing_share"], nullptr);
    EXPECT_EQ(net()["resistance_Pa"], nullptr);
    EXPECT_EQ(net()["openings"].size(), 1U);
    for (const json& bad : {json{{"passing_share", 1}}, json{{"passing_share", -0.1}}, json{{"passing_share", "half"}},
                            json{{"openings", 3}}, json{{"openings", {3}}}, json{{"openings", {{{"width_m", 3}}}}},
                            json{{"openings", {{{"position_m", 10}, {"width_m", 0.01}}}}},
                            json{{"openings", {{{"position_m", 1e9}, {"width_m", 3}}}}}}) {
        json action = {{"action", "put_barrier"}, {"id", id}};
        action.update(bad);
        const auto done = scenario->apply(action, "test");
        ASSERT_FALSE(done) << bad;
        EXPECT_THAT(done.error().message, testing::HasSubstr(bad.begin().key().substr(0, 7)));
    }
}

TEST(Net, lets_through_and_holds_in_the_live_twin_and_replays_to_the_same_hash) {
    const auto scenario = open(dammed_scene());
    const std::string id = setup_json(*scenario)["barriers"][0]["id"];
    act(*scenario, {{"action", "put_barrier"}, {"id", id}, {"passing_share", 0.6}, {"openings", json::array()}});
    run_until(*scenario, 5);
    // Another one behind it, as debris comes down.
    act(*scenario, {{"action", "put_barrier"},
                    {"line", {{west + 60, south + 12}, {west + 60, south + 48}}},
                    {"height_m", 3},
                    {"thickness_m", 1},
                    {"passing_share", 0.2}});
    run_until(*scenario, 10);
    ASSERT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
    expect_balance(*scenario);
    const json net = impacts_json(*scenario)["barriers"][0];
    EXPECT_EQ(net["hit"], true);
    EXPECT_GT(net["passed_m3"], 0.5);
    EXPECT_GT(net["retained_m3"], 1);
    EXPECT_GT(net["peak_force_kN"], 0);
    const auto journal = read_journal(journal_json(*scenario).dump());
    ASSERT_TRUE(journal) << journal.error().message;
    const auto again = replay(*journal, std::make_shared<const scene::Scene>(dammed_scene()));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->hash, journal->hash);
}

/// The channel with a net across it, which reaches 4 m above the ground and none of whose debris passes the meshes.
scene::Scene netted_scene(std::optional<double> clearance) {
    scene::Scene scene = channel_scene();
    params::BarrierSpec net{{{west + 62, south + 8}, {west + 62, south + 52}}, 4, {}, 1.2, {}, 0.0};
    net.clearance = clearance;
    scene.buildings.push_back(*make_barrier(scene.terrain, "net", net));
    return scene;
}

TEST(Clearance, is_a_gap_with_an_edge_above_it) {
    const scene::Scene scene = netted_scene(1);
    const terrain::BuildingSolids solids(scene.terrain, scene.buildings, 2);
    const WorldPoint origin = scene.terrain.frame().origin;
    const auto at = [&](double east, double height) {  // on the flat floor of the channel, at an elevation of 0
        return Vec3<double>{west + 62 + east - origin.x, south + 30 - origin.y, height - origin.z};
    };
    for (const double height : {0.1, 0.9, 4.1}) EXPECT_FALSE(solids.inside(at(0, height))) << height;
    for (const double height : {1.1, 2.5, 3.9}) EXPECT_TRUE(solids.inside(at(0, height))) << height;
    for (const double height : {0.4, 0.9}) {
        const auto below = solids.nearest(at(0, height));
        EXPECT_NEAR(below.distance, 1 - height, 1e-6);
        EXPECT_EQ(below.normal.z, -1);
    }
    const auto in = solids.nearest(at(0, 1.2));
    EXPECT_NEAR(in.distance, -0.2, 1e-6);
    EXPECT_EQ(in.normal.z, -1) << "the nearest way out is down";
    const auto beside = solids.nearest(at(-1, 0.6));
    EXPECT_NEAR(beside.distance, std::hypot(0.4, 0.4), 1e-6) << "to the lower edge of the wall";
    EXPECT_NEAR(solids.nearest(at(-1, 2)).distance, 0.4, 1e-6);
    EXPECT_EQ(solids.second_nearest(at(-1, 0.6), beside).building, -1);
}

TEST(Clearance, lets_debris_pass_below_the_net_as_if_it_were_not_there) {
    const auto held = open(netted_scene({})), open_below = open(netted_scene(1.5));
    for (Scenario* scenario : {held.get(), open_below.get()}) {
        run_until(*scenario, 10);
        ASSERT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
        expect_balance(*scenario);
    }
    const json closed = impacts_json(*held)["barriers"][0], gap = impacts_json(*open_below)["barriers"][0];
    EXPECT_EQ(closed["passed_m3"], 0);
    EXPECT_GT(closed["retained_m3"], 5);
    EXPECT_GT(gap["passed_m3"].get<double>() + gap["retained_m3"].get<double>(), 5);
    EXPECT_GT(gap["passed_m3"], 5);
    EXPECT_EQ(gap["overtopped_m3"], 0);
    EXPECT_GT(number(*open_below, "front_chainage_m"), number(*held, "front_chainage_m") + 3);
    // Hung lower while debris is below it: what is in its way is moved out of it.
    act(*open_below, {{"action", "put_barrier"}, {"id", "barrier-1"}, {"clearance_m", 0.8}});
    run_until(*open_below, 12);
    ASSERT_NE(open_below->phase(), run::RunPhase::fault) << open_below->message();
    expect_balance(*open_below);
    const json low = {{"action", "put_barrier"}, {"id", "barrier-1"}, {"clearance_m", 0.4}},
               high = {{"action", "put_barrier"}, {"id", "barrier-1"}, {"clearance_m", 4}};
    EXPECT_THAT(refusal(*open_below, low), testing::HasSubstr("clearance_m = 0.4 is refused; with particles of 0.6 m"));
    EXPECT_THAT(refusal(*open_below, high), testing::HasSubstr("it must be below height_m = 4"));
}

TEST(Inflow, over_an_area_with_a_density_runs_live_and_again_after_a_restart) {
    scene::Scene scene = channel_scene();
    scene.releases.clear();
    terrain::Inflow rain{"slope", {}, {}, {{0, 12, 1, 1200}, {5, 12, 1, 1200}}};
    rain.area.push_back({{{west + 20, south + 27}, {west + 30, south + 27}, {west + 30, south + 33}}, {}});
    scene.inflows.push_back(rain);
    const auto scenario = open(std::move(scene));
    run_until(*scenario, 3);
    ASSERT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
    EXPECT_NEAR(number(*scenario, "volume_released_m3"), 36, 3);
    expect_balance(*scenario);
    bool any = false;
    const json series = probe_at(*scenario, {west + 27, south + 29})();
    for (std::size_t k = 0; k < series["speed_mps"].size(); ++k) {
        const double speed = series["speed_mps"][k];
        any = any || speed > 0.1;
        EXPECT_NEAR(series["pressure_kPa"][k], 1200 * speed * speed / 1e3, 1e-4 * (1 + speed * speed));
    }
    EXPECT_TRUE(any);
    const std::uint64_t before = hash(*scenario);
    const std::uint64_t step = scenario->step();
    act(*scenario, {{"action", "restart"}});
    while (scenario->step() < step) scenario->advance();
    EXPECT_EQ(hash(*scenario), before);
}

TEST(Inflow, runs_live_and_again_after_a_restart) {
    scene::Scene scene = channel_scene();
    scene.releases.clear();
    scene.inflows.push_back({"gully", {west + 20, south + 27}, {west + 20, south + 33}, {{0, 12, 4}, {5, 12, 4}}});
    const auto scenario = open(std::move(scene));
    run_until(*scenario, 3);
    ASSERT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
    const double volume = number(*scenario, "volume_released_m3");
    EXPECT_NEAR(volume, 36, 3);
    expect_balance(*scenario);
    const std::uint64_t before = hash(*scenario);
    const std::uint64_t step = scenario->step();
    act(*scenario, {{"action", "restart"}});
    while (scenario->step() < step) scenario->advance();
    EXPECT_EQ(hash(*scenario), before);
}

}  // namespace
}  // namespace talus::twin::test
