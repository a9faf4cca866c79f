#include <cstring>

#include <gmock/gmock.h>

#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using ::testing::HasSubstr;

json drawn(double x_min, double thickness) {
    return {{"action", "put_release"},
            {"name", "drawn"},
            {"polygon", ring(west + x_min, south + 27, west + x_min + 6, south + 33)},
            {"thickness_m", thickness}};
}

json release_of(const Scenario& scenario, const std::string& id) {
    const json setup = setup_json(scenario);
    for (const json& release : setup["releases"]) {
        if (release["id"] == id) return release;
    }
    return nullptr;
}

TEST(DrawnRelease, waits_until_it_is_triggered) {
    scene::Scene scene = channel_scene();
    scene.releases[0].spec.start_time = 20;  // nothing else moves
    const auto scenario = open(scene);
    const double held = number(*scenario, "volume_held_m3");
    run_until(*scenario, 0.3);
    const std::string id = act(*scenario, drawn(25, 1)).created;
    EXPECT_EQ(id, "release-2");
    const double volume = release_of(*scenario, id)["volume_m3"];
    EXPECT_NEAR(volume, 36 / std::cos(M_PI / 6), 0.3);
    EXPECT_EQ(release_of(*scenario, id)["status"], "held");
    EXPECT_NEAR(number(*scenario, "volume_held_m3"), held + volume, 0.2);
    expect_balance(*scenario);
    run_until(*scenario, 1);
    EXPECT_EQ(number(*scenario, "largest_speed_mps"), 0);

    act(*scenario, {{"action", "trigger_release"}, {"id", id}});
    EXPECT_EQ(release_of(*scenario, id)["status"], "released");
    run_until(*scenario, 3);
    EXPECT_GT(number(*scenario, "largest_speed_mps"), 2);
    EXPECT_NEAR(number(*scenario, "volume_held_m3"), held, 1e-6);
    EXPECT_GT(number(*scenario, "front_chainage_m"), 30);
    expect_balance(*scenario);
    EXPECT_THAT(refusal(*scenario, {{"action", "trigger_release"}, {"id", id}}), HasSubstr("already started"));
    act(*scenario, {{"action", "trigger_release"}, {"id", "release-1"}});
    run_until(*scenario, 4);
    EXPECT_EQ(number(*scenario, "volume_held_m3"), 0);
}

TEST(DrawnRelease, is_moved_as_a_whole_while_held) {
    scene::Scene scene = channel_scene();
    const auto scenario = open(scene);
    const std::string id = act(*scenario, drawn(25, 1)).created;
    const json before = release_of(*scenario, id);
    act(*scenario, {{"action", "put_release"}, {"id", id}, {"move_m", {7, 0}}});
    const json after = release_of(*scenario, id);
    EXPECT_DOUBLE_EQ(after["polygons"][0][0][0][0].get<double>(), before["polygons"][0][0][0][0].get<double>() + 7);
    EXPECT_NEAR(after["volume_m3"].get<double>(), before["volume_m3"].get<double>(), 0.1);
    expect_balance(*scenario);
    EXPECT_THAT(refusal(*scenario, {{"action", "put_release"}, {"id", id}, {"move_m", {-500, 0}}}),
                HasSubstr("move_m: reaches"));
    EXPECT_EQ(release_of(*scenario, id), after);
}

TEST(DrawnRelease, follows_its_outline_while_held_without_using_up_ids) {
    const auto scenario = open(channel_scene());
    run_until(*scenario, 0.5);
    const std::string id = act(*scenario, drawn(30, 1)).created;
    const double volume = release_of(*scenario, id)["volume_m3"];
    const auto slots = [&] {
        std::uint32_t n = 0;
        std::memcpy(&n, encode(*scenario->run().frame(1, 0), 0).data() + 24, sizeof n);
        return n;
    };
    const std::uint32_t before = slots();
    for (const double thickness : {0.5, 0.8, 1.0}) {
        json change = {{"action", "put_release"}, {"id", id}, {"thickness_m", thickness}};
        act(*scenario, change);
        EXPECT_NEAR(number(*scenario, "volume_held_m3"), thickness * volume, 0.2);
        expect_balance(*scenario);
        scenario->advance();
    }
    EXPECT_EQ(slots(), before);
    act(*scenario, {{"action", "undo"}});
    EXPECT_NEAR(number(*scenario, "volume_held_m3"), 0.8 * volume, 0.2);
    act(*scenario, {{"action", "remove_release"}, {"id", id}});
    EXPECT_EQ(number(*scenario, "volume_held_m3"), 0);
    expect_balance(*scenario);
}

TEST(DrawnRelease, that_moves_changes_at_restart_and_is_held_again) {
    const auto scenario = open(channel_scene());
    const std::string id = act(*scenario, drawn(30, 1)).created;
    act(*scenario, {{"action", "trigger_release"}, {"id", id}});
    run_until(*scenario, 0.5);
    const double moving = number(*scenario, "volume_released_m3");
    const Done done = act(*scenario, {{"action", "put_release"}, {"id", id}, {"thickness_m", 0.5}});
    EXPECT_THAT(done.sentence, HasSubstr("from the next restart"));
    EXPECT_EQ(number(*scenario, "volume_released_m3"), moving);
    act(*scenario, {{"action", "restart"}});
    EXPECT_EQ(release_of(*scenario, id)["status"], "held");
    EXPECT_EQ(number(*scenario, "volume_held_m3"), number(*scenario, "volume_released_m3")) << "before the first step";
    EXPECT_LT(number(*scenario, "volume_released_m3"), moving - 10);
    run_until(*scenario, 0.5);
    EXPECT_GT(number(*scenario, "volume_held_m3"), 10);
}

TEST(Release, removed_while_it_moves_is_taken_away_and_the_rest_goes_on) {
    const auto scenario = open(channel_scene());
    const std::string id = act(*scenario, drawn(30, 1)).created;
    act(*scenario, {{"action", "trigger_release"}, {"id", id}});
    run_until(*scenario, 1);
    const double all = number(*scenario, "volume_released_m3");
    const std::string frame = encode(*scenario->run().frame(1, 0), 0);
    act(*scenario, {{"action", "remove_release"}, {"id", "release-1"}});
    expect_balance(*scenario);
    EXPECT_LT(number(*scenario, "volume_released_m3"), 0.5 * all);
    run_until(*scenario, 2);
    expect_balance(*scenario);
    EXPECT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
    const json series = series_json(*scenario);
    for (const json& row : series["time"]["volume_released_m3"]) EXPECT_GT(row.get<double>(), 0);
    // Undone, it is back where it was and starts again.
    act(*scenario, {{"action", "undo"}});
    EXPECT_NEAR(number(*scenario, "volume_released_m3"), all, 1e-6 * all);
    expect_balance(*scenario);
    run_until(*scenario, 3);
    EXPECT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
}

TEST(Release, its_trigger_can_be_taken_back) {
    const auto scenario = open(channel_scene());
    const std::string id = act(*scenario, drawn(30, 1)).created;
    act(*scenario, {{"action", "trigger_release"}, {"id", id}});
    run_until(*scenario, 1);
    EXPECT_EQ(number(*scenario, "volume_held_m3"), 0);
    act(*scenario, {{"action", "undo"}});
    EXPECT_NEAR(number(*scenario, "volume_held_m3"), release_of(*scenario, id)["volume_m3"].get<double>(), 0.2);
    EXPECT_EQ(release_of(*scenario, id)["status"], "held");
    expect_balance(*scenario);
}

TEST(Release, of_the_scene_can_be_thicker_before_it_starts) {
    const auto scenario = open(channel_scene());
    const double volume = number(*scenario, "volume_released_m3");
    act(*scenario, {{"action", "put_release"}, {"id", "release-1"}, {"thickness_m", 2.4}});
    EXPECT_NEAR(number(*scenario, "volume_released_m3"), 2 * volume, 0.5);
    expect_balance(*scenario);
    run_until(*scenario, 1);
    EXPECT_GT(number(*scenario, "largest_speed_mps"), 1);
}

TEST(DrawnRelease, can_lie_on_debris_that_came_before) {
    const auto scenario = open(channel_scene());
    run_until(*scenario, 9);
    const double x = number(*scenario, "front_chainage_m") - 8;
    const std::string id = act(*scenario, drawn(x, 1)).created;
    run_until(*scenario, scenario->time() + 1);
    EXPECT_LT(number(*scenario, "largest_speed_mps"), 8) << "it must not be thrown apart";
    act(*scenario, {{"action", "trigger_release"}, {"id", id}});
    run_until(*scenario, scenario->time() + 2);
    EXPECT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
    EXPECT_LT(number(*scenario, "largest_speed_mps"), 8);
    expect_balance(*scenario);
}

TEST(DrawnRelease, makes_room_for_an_obstacle_while_it_is_held) {
    const auto scenario = open(channel_scene());
    const std::string id = act(*scenario, drawn(30, 1)).created;
    const double held = number(*scenario, "volume_held_m3");
    act(*scenario,
        {{"action", "put_building"}, {"polygon", ring(west + 32, south + 29, west + 34, south + 31)}, {"height_m", 5}});
    EXPECT_EQ(number(*scenario, "volume_held_m3"), held);
    run_until(*scenario, 0.3);
    EXPECT_LT(number(*scenario, "max_compression"), 0.05);
    act(*scenario, {{"action", "trigger_release"}, {"id", id}});
    run_until(*scenario, 0.5);
    EXPECT_NE(scenario->phase(), run::RunPhase::fault) << scenario->message();
    EXPECT_LT(number(*scenario, "largest_speed_mps"), 5);
}

TEST(Release, refuses_what_cannot_fail) {
    scene::Scene scene = channel_scene();
    scene.spec.solver.particle_limit = 600;
    const auto scenario = open(scene);
    run_until(*scenario, 0.2);
    json action = drawn(30, 1);
    action["polygon"] = ring(west + 10, south + 28, west + 20, south + 40);
    EXPECT_THAT(refusal(*scenario, action), HasSubstr("overlaps release \"scar\""));
    action["polygon"] = ring(west - 10, south + 28, west + 3, south + 40);
    EXPECT_THAT(refusal(*scenario, action), HasSubstr("the ground is not known; the terrain covers x 824000.5"));
    action["polygon"] = {
        {west + 30, south + 20}, {west + 36, south + 26}, {west + 36, south + 20}, {west + 30, south + 26}};
    EXPECT_THAT(refusal(*scenario, action), HasSubstr("polygon: touches or crosses itself"));
    action["polygon"] = {{west + 30, south + 20}, {west + 36, south + 26}};
    EXPECT_THAT(refusal(*scenario, action), HasSubstr("must be 3 to 500 points"));
    EXPECT_THAT(refusal(*scenario, drawn(30, 0)), HasSubstr("thickness_m = 0.0: must be a number 0.001 to 1000 (m)"));
    EXPECT_THAT(refusal(*scenario, drawn(30, 50)), HasSubstr("solver.particle_limit"));
    EXPECT_THAT(refusal(*scenario, drawn(30, 1e-3)), HasSubstr("at least one particle"));
    action = drawn(30, 1);
    action["id"] = "release-7";
    EXPECT_THAT(refusal(*scenario, action), HasSubstr("id = \"release-7\": there is no such release"));
    action.erase("id");
    action.erase("thickness_m");
    EXPECT_THAT(refusal(*scenario, action), HasSubstr("thickness_m: missing"));
}

}  // namespace
}  // namespace talus::twin::test
