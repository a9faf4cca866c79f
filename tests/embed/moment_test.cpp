// The debris at exact times, between two steps.
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "embed_fixtures.hpp"

namespace talus::embed::test {
namespace {

struct Point {
    double x, y, z, speed_x;
};

std::map<std::uint32_t, Point> by_id(const talus_debris& debris) {
    std::map<std::uint32_t, Point> points;
    for (std::size_t i = 0; i < debris.count; ++i) {
        points[debris.id[i]] = {debris.x[i], debris.y[i], debris.z[i], debris.velocity_x[i]};
    }
    return points;
}

std::map<std::uint32_t, Point> at(const Simulation& simulation, double time) {
    talus_error error = TALUS_SIZED(talus_error);
    talus_debris debris = TALUS_SIZED(talus_debris);
    EXPECT_EQ(talus_get_debris_at(simulation.get(), time, &debris, &error), TALUS_OK) << error.text;
    return by_id(debris);
}

std::string refusal(const Simulation& simulation, double time) {
    talus_error error = TALUS_SIZED(talus_error);
    talus_debris debris = TALUS_SIZED(talus_debris);
    EXPECT_EQ(talus_get_debris_at(simulation.get(), time, &debris, &error), TALUS_BAD_INPUT);
    EXPECT_EQ(debris.count, 0U) << "nothing is written";
    return error.text;
}

/// Steps of 1/32 s, whose times are exact.
Simulation open_with_long_steps() {
    const Slope slope;
    const char* settings[] = {"solver.target_particle_count=600", "material.friction_coefficient=0.2",
                              "solver.thread_count=1", "solver.time_step_s=0.03125"};
    talus_simulation* opened = nullptr;
    talus_error error = TALUS_SIZED(talus_error);
    EXPECT_EQ(talus_open_arrays(&slope.arrays, nullptr, settings, 4, nullptr, &opened, &error), TALUS_OK) << error.text;
    return Simulation(opened);
}

TEST(Moments, lie_on_a_straight_line_between_two_steps) {
    const Simulation simulation = open_with_long_steps();
    advance_to(simulation, 1);
    const auto first = by_id(debris_of(simulation));
    EXPECT_EQ(state_of(simulation).time, 1);
    advance_to(simulation, 1.01);
    EXPECT_EQ(state_of(simulation).time, 1.03125) << "the step is not cut short";
    const auto last = by_id(debris_of(simulation));
    for (const auto& [time, share] : {std::pair{1.0, 0.0}, {1.0078125, 0.25}, {1.015625, 0.5}, {1.03125, 1.0}}) {
        const auto between = at(simulation, time);
        ASSERT_EQ(between.size(), last.size());
        double moved = 0;
        for (const auto& [id, point] : between) {
            const Point &a = first.at(id), &b = last.at(id);
            ASSERT_NEAR(point.x, a.x + share * (b.x - a.x), 1e-4);
            ASSERT_NEAR(point.y, a.y + share * (b.y - a.y), 1e-4);
            ASSERT_NEAR(point.z, a.z + share * (b.z - a.z), 1e-4);
            ASSERT_NEAR(point.speed_x, a.speed_x + share * (b.speed_x - a.speed_x), 1e-4);
            moved = std::fmax(moved, b.x - a.x);
        }
        EXPECT_GT(moved, 0.02) << "there was something to interpolate";
    }
}

TEST(Moments, change_no_bit_of_the_result) {
    const Simulation watched = Slope().open(), alone = Slope().open();
    double last = -1;
    for (int frame = 1; frame <= 120; ++frame) {
        const double time = frame / 60.0;
        advance_to(watched, time);
        const auto points = at(watched, time);
        double mean = 0;
        for (const auto& [id, point] : points) mean += point.x / static_cast<double>(points.size());
        if (frame > 2) EXPECT_GT(mean, last) << "every frame is another, also those within one step";
        last = mean;
    }
    advance_to(alone, 2);
    EXPECT_EQ(hash_of(watched), hash_of(alone));
}

TEST(Moments, of_debris_that_comes_in_with_the_step_are_those_of_its_velocity) {
    const Simulation simulation = open_with_long_steps();
    talus_error error = TALUS_SIZED(talus_error);
    ASSERT_EQ(talus_apply(simulation.get(), R"({"action": "put_inflow", "line": [[30, 12], [30, 18]],
                                               "hydrograph": [{"time_s": 0, "discharge_m3ps": 16, "velocity_mps": 4},
                                                              {"time_s": 4, "discharge_m3ps": 16, "velocity_mps": 4}]})",
                          nullptr, &error),
              TALUS_OK)
        << error.text;
    bool came = false;
    for (int step = 1; step < 64 && !came; ++step) {
        const auto before = by_id(debris_of(simulation));
        advance_to(simulation, 0.03125 * step);
        const auto now = by_id(debris_of(simulation)), back = at(simulation, 0.03125 * step - 0.015625);
        ASSERT_EQ(back.size(), now.size());
        for (const auto& [id, point] : now) {
            if (before.contains(id)) continue;
            came = true;
            EXPECT_NEAR(back.at(id).x, point.x - 0.015625 * point.speed_x, 1e-4);
        }
    }
    EXPECT_TRUE(came);
}

TEST(Moments, outside_of_the_last_step_are_refused) {
    const Simulation simulation = open_with_long_steps();
    const double nan = std::nan("");
    EXPECT_EQ(at(simulation, 0).size(), debris_of(simulation).count) << "before any step";
    EXPECT_EQ(refusal(simulation, 0.01), "time = 0.01: must be 0 (s); talus_advance() to it first");
    advance_to(simulation, 0.03);
    EXPECT_EQ(refusal(simulation, nan), "time = nan: must be a finite number");
    EXPECT_EQ(refusal(simulation, std::numeric_limits<double>::infinity()), "time = inf: must be a finite number");
    EXPECT_EQ(refusal(simulation, 0.04), "time = 0.04: must be 0 to 0.03125 (s); talus_advance() to it first");
    EXPECT_EQ(refusal(simulation, -1), "time = -1: must be 0 to 0.03125 (s); talus_advance() to it first");
    talus_error error = TALUS_SIZED(talus_error);
    ASSERT_EQ(talus_step(simulation.get(), 1, nullptr, &error), TALUS_OK);
    EXPECT_EQ(refusal(simulation, 0.05), "time = 0.05: must be 0.0625 (s); talus_advance() to it first");
    advance_to(simulation, 0.07);
    EXPECT_FALSE(at(simulation, 0.07).empty());
    ASSERT_EQ(talus_set(simulation.get(), "material.friction_coefficient", 0.3, &error), TALUS_OK);
    EXPECT_EQ(refusal(simulation, 0.07), "time = 0.07: must be 0.09375 (s); talus_advance() to it first")
        << "a change is made to the state after the step";
    // Once it is over, debris lies as it lies.
    ASSERT_EQ(talus_set(simulation.get(), "material.friction_coefficient", 2, &error), TALUS_OK) << error.text;
    advance_to(simulation, std::numeric_limits<double>::infinity());
    ASSERT_NE(state_of(simulation).phase, TALUS_READY);
    EXPECT_EQ(at(simulation, 1e6).size(), debris_of(simulation).count);
}

TEST(Moments, are_kept_by_forks_and_snapshots) {
    const Simulation simulation = open_with_long_steps();
    advance_to(simulation, 0.5078125);
    const auto there = at(simulation, 0.5078125);
    talus_simulation* made = nullptr;
    talus_snapshot* snapshot = nullptr;
    talus_error error = TALUS_SIZED(talus_error);
    ASSERT_EQ(talus_fork(simulation.get(), &made, &error), TALUS_OK) << error.text;
    ASSERT_EQ(talus_take_snapshot(simulation.get(), &snapshot, &error), TALUS_OK) << error.text;
    const Simulation fork(made);
    advance_to(simulation, 1);
    ASSERT_EQ(talus_restore(simulation.get(), snapshot, &error), TALUS_OK) << error.text;
    talus_drop_snapshot(snapshot);
    for (const Simulation* each : {&simulation, &fork}) {
        const auto again = at(*each, 0.5078125);
        ASSERT_EQ(again.size(), there.size());
        for (const auto& [id, point] : again) ASSERT_EQ(point.x, there.at(id).x);
    }
}

}  // namespace
}  // namespace talus::embed::test
