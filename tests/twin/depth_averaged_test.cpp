#include "twin/depth_averaged.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "run/run_scene.hpp"
#include "terrain/barrier.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using ::testing::HasSubstr;

DepthAveragedRun run_of(const Scenario& scenario, const DepthAveragedLimits& limits = {}) {
    const scene::Scene scene = talus::test::value_of(scene_for_depth_averaged(scenario)());
    const std::atomic<bool> stop = false;
    return talus::test::value_of(run_depth_averaged(scene, stop, {}, limits));
}

/// What `talus run --model depth_averaged` makes of it.
run::RunResult plain_run_of(scene::Scene scene) {
    scene.spec.solver.model = params::ModelChoice::depth_averaged;
    return talus::test::value_of(run::run_scene(scene, {}));
}

std::string text_of(const std::vector<std::string>& sentences) {
    std::string all;
    for (const std::string& sentence : sentences) all += sentence + "\n";
    return all;
}

TEST(DepthAveragedBeside, is_the_run_of_the_present_setup_to_the_bit) {
    const auto scenario = open(channel_scene());
    const DepthAveragedRun before = run_of(*scenario);
    EXPECT_EQ(before.result.hash, plain_run_of(channel_scene()).hash);

    act(*scenario, {{"action", "set_parameter"}, {"key", "material.friction_coefficient"}, {"value", 0.4}});
    act(*scenario, {{"action", "put_building"},
                    {"name", "hut"},
                    {"polygon", ring(west + 60, south + 26, west + 64, south + 34)},
                    {"height_m", 3}});
    scene::Scene same = channel_scene();
    same.spec.material.friction_coefficient = 0.4;
    add_building(same, "hut", rectangle(west + 60, south + 26, west + 64, south + 34), 3);
    const DepthAveragedRun after = run_of(*scenario);
    const run::RunResult plain = plain_run_of(same);
    EXPECT_EQ(after.result.hash, plain.hash);
    EXPECT_NE(after.result.hash, before.result.hash);
    EXPECT_GT(plain.observation.front.size(), 20U);
    EXPECT_EQ(after.message().front.chainage_m.size(), plain.observation.front.size());
    const Grid<float> peak = *after.layer("peak_depth");
    ASSERT_EQ(peak.geometry, plain.observation.maps.peak_depth.geometry);
    for (std::size_t k = 0; k < peak.values.size(); ++k) {
        const float other = plain.observation.maps.peak_depth.values[k];
        ASSERT_TRUE(peak.values[k] == other || (std::isnan(peak.values[k]) && std::isnan(other))) << k;
    }
}

TEST(DepthAveragedBeside, changes_nothing_of_the_run) {
    const auto with = open(channel_scene()), without = open(channel_scene());
    run_until(*with, 1);
    run_until(*without, 1);
    const auto run = std::make_shared<const DepthAveragedRun>(run_of(*with));
    (void)comparison_with(*with, run)();
    run_until(*with, 2);
    run_until(*without, 2);
    EXPECT_EQ(hash(*with), hash(*without));
    EXPECT_EQ(journal_json(*with), journal_json(*without));
}

TEST(DepthAveragedBeside, maps_are_those_of_a_time_where_that_is_known) {
    const auto scenario = open(channel_scene());
    const DepthAveragedRun run = run_of(*scenario);
    const auto wet = [](const Grid<float>& grid) {
        std::size_t count = 0;
        for (const float value : grid.values) count += value > 0 ? 1 : 0;
        return count;
    };
    const auto count = [&](const char* name, std::optional<double> time) { return wet(*run.layer(name, time)); };
    EXPECT_GT(count("depth", 0), 20U);
    EXPECT_GT(count("depth", 4), count("depth", 0));
    EXPECT_EQ(count("depth", 1e6), wet(run.moments.back().depth));
    EXPECT_LT(count("arrival_time", 2), count("arrival_time", 4));
    EXPECT_LE(count("arrival_time", 4), count("arrival_time", {}));
    EXPECT_FALSE(run.layer("erosion_depth"));
}

TEST(DepthAveragedBeside, compares_both_by_the_same_time_and_as_a_whole) {
    const auto scenario = open([] {
        scene::Scene scene = channel_scene();
        params::ObservationSpec observed;
        observed.chainage = 30;
        observed.front_velocity = 8;
        scene.spec.observations.push_back(observed);
        return scene;
    }());
    run_until(*scenario, 2);
    const auto run = std::make_shared<const DepthAveragedRun>(run_of(*scenario));
    const json half = comparison_with(*scenario, run)();
    EXPECT_EQ(half["over"], false);
    const auto row = [](const json& compared, const std::string& key) {
        for (const json& r : compared["rows"]) {
            if (r["key"] == key) return r;
        }
        return json();
    };
    EXPECT_LT(row(half, "front_chainage_m")["depth_averaged_by_then"], row(half, "front_chainage_m")["depth_averaged"]);
    EXPECT_LT(row(half, "affected_area")["depth_averaged_by_then"], row(half, "affected_area")["depth_averaged"]);
    EXPECT_EQ(row(half, "front_velocity")["observed"], 8);
    const double by_then = half["area"]["intersection_over_union"];
    EXPECT_GT(by_then, 0.3);
    EXPECT_LE(by_then, 1);

    for (const char* peak : {"peak_depth", "peak_speed", "peak_pressure"}) {
        EXPECT_TRUE(row(half, peak)["depth_averaged_by_then"].is_null()) << peak << " is known of the whole run only";
        EXPECT_GT(row(half, peak)["depth_averaged"], 0) << peak;
    }

    run_until(*scenario, 1000);
    const json whole = comparison_with(*scenario, run)();
    const double speed = row(whole, "peak_speed")["particles"];
    EXPECT_GT(speed, 1);
    EXPECT_GE(speed, row(half, "peak_speed")["particles"]);
    EXPECT_NEAR(row(whole, "peak_pressure")["particles"], 2 * speed * speed, 1e-3 * speed * speed) << "2000 kg/m3";
    EXPECT_EQ(row(whole, "peak_depth")["depth_averaged_by_then"], row(whole, "peak_depth")["depth_averaged"]);
    EXPECT_EQ(whole["over"], true);
    EXPECT_EQ(row(whole, "affected_area")["depth_averaged_by_then"], row(whole, "affected_area")["depth_averaged"]);
    EXPECT_EQ(row(whole, "affected_area")["depth_averaged"], row(half, "affected_area")["depth_averaged"]);
    const json& area = whole["area"];
    EXPECT_DOUBLE_EQ(area["both_m2"].get<double>() + area["particles_only_m2"].get<double>(),
                     row(whole, "affected_area")["particles"].get<double>());
    EXPECT_EQ(whole["differs"].size(), 0U);
}

TEST(DepthAveragedBeside, a_net_is_refused_in_a_sentence_and_unused_values_are_named) {
    const auto scenario = open(channel_scene());
    const std::string key = setup_key(*scenario);
    act(*scenario, {{"action", "put_barrier"},
                    {"name", "mesh"},
                    {"line", {{west + 52, south + 8}, {west + 52, south + 52}}},
                    {"height_m", 4},
                    {"thickness_m", 1},
                    {"passing_share", 0.5}});
    EXPECT_NE(setup_key(*scenario), key);
    const auto refused = scene_for_depth_averaged(*scenario)();
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message, "The depth-averaged model has no nets, and \"mesh\" is one.");
    act(*scenario, {{"action", "undo"}});
    EXPECT_EQ(setup_key(*scenario), key);
    act(*scenario, {{"action", "set_parameter"}, {"key", "material.viscosity"}, {"value", 0.13}});
    act(*scenario, {{"action", "put_release"},
                    {"name", "second"},
                    {"polygon", ring(west + 20, south + 28, west + 24, south + 32)},
                    {"thickness_m", 1}});
    EXPECT_THAT(text_of(run_of(*scenario).notes),
                testing::AllOf(HasSubstr("not use material.viscosity."), HasSubstr("one velocity over the depth"),
                               HasSubstr("Release \"second\" waits to be started")));
}

TEST(DepthAveragedBeside, cost_is_bounded_and_said) {
    const auto scenario = open(channel_scene());
    const auto coarse = for_depth_averaged(channel_scene(), {.most_cells = 2000});
    ASSERT_TRUE(coarse);
    EXPECT_EQ(coarse->spec.solver.grid_cell, 2.0);
    EXPECT_THAT(text_of(coarse->notes), HasSubstr("cells of 2 m in place of 1 m"));
    const DepthAveragedRun brief = run_of(*scenario, {.longest = 0});
    EXPECT_FALSE(brief.message().complete);
    EXPECT_THAT(brief.result.stop_reason, HasSubstr("the most that it may take"));
    const DepthAveragedRun small = run_of(*scenario, {.depth_bytes = 20'000}), whole = run_of(*scenario);
    EXPECT_EQ(small.result.hash, whole.result.hash);
    EXPECT_LT(2 * small.moments.size(), whole.moments.size());
    std::size_t bytes = 0;
    for (const auto& moment : small.moments) bytes += moment.depth.values.size() * sizeof(float);
    EXPECT_LE(bytes, 20'000U);
    EXPECT_EQ(small.moments.front().time, 0);
}

}  // namespace
}  // namespace talus::twin::test
