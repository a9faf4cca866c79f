#include "sim/time_step.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "sim/model.hpp"
#include "sim/step_constants.hpp"

namespace talus::sim {
namespace {

constexpr double spacing = 0.4;

TEST(TimeStep, is_the_scene_s_where_it_gives_one) {
    params::SolverSpec solver;
    solver.time_step = 0.004;
    StateSummary fast;
    fast.max_speed = 1000;
    EXPECT_EQ(choose_time_step(make_model({}, solver, spacing), fast), 0.004);
}

TEST(TimeStep, is_the_largest_in_eighths_of_an_octave_in_which_nothing_moves_too_far) {
    const Model model = make_model({}, {}, spacing);
    const double largest = model.largest_time_step(), reach = model.solver.displacement_limit * spacing;
    EXPECT_EQ(choose_time_step(model, {}), largest);
    for (const double speed : {10.0, 25.0, 60.0}) {
        StateSummary state;
        state.max_speed = speed;
        const double dt = choose_time_step(model, state), longer = dt * std::exp2(0.125);
        EXPECT_LE(dt * (speed + model.gravity * dt), reach) << speed;
        EXPECT_TRUE(dt == largest || longer * (speed + model.gravity * longer) > reach) << speed;
        const double eighths = 8 * std::log2(largest / dt);
        EXPECT_NEAR(eighths, std::round(eighths), 1e-9) << speed;
    }
}

TEST(TimeStep, never_falls_below_the_smallest) {
    const Model model = make_model({}, {}, spacing);
    StateSummary state;
    state.max_speed = 1e6;
    EXPECT_EQ(choose_time_step(model, state), model.solver.smallest_time_step);
}

TEST(TimeStep, halves_while_debris_is_compressed_down_to_an_eighth) {
    const Model model = make_model({}, {}, spacing);
    const double largest = model.largest_time_step();
    StateSummary state;
    state.time_step = largest;
    state.mean_compression = 0.02;
    EXPECT_EQ(choose_time_step(model, state), largest / 2);
    for (int step = 0; step < 10; ++step) state.time_step = choose_time_step(model, state);
    EXPECT_EQ(state.time_step, largest / 8);
    // Slightly compressed debris keeps the step that it has; recovered debris gets the longest at once.
    state.mean_compression = 0.007;
    EXPECT_EQ(choose_time_step(model, state), largest / 8);
    state.mean_compression = 0.001;
    EXPECT_EQ(choose_time_step(model, state), largest);
}

TEST(StepConstants, scale_last_step_s_pressures_with_the_square_of_the_step) {
    const Model model = make_model({}, {}, spacing);
    StateSummary state;
    state.time_step = 0.02;
    state.previous_time_step = 0.01;
    EXPECT_FLOAT_EQ(StepConstants(model, state).warm_start_scale, 4);
    // A multiplier is -p dt^2.
    EXPECT_FLOAT_EQ(StepConstants(model, state).pressure_scale, -1e4F);
    state.previous_time_step = 0;  // the first step starts from nothing
    EXPECT_EQ(StepConstants(model, state).warm_start_scale, 0);
    EXPECT_EQ(StepConstants(model, state).pressure_scale, 0);
}

TEST(StepConstants, wake_debris_at_twice_the_speed_at_which_it_falls_asleep) {
    const Model model = make_model({}, {}, spacing);
    StateSummary state;
    state.time_step = 0.02;
    const StepConstants constants(model, state);
    EXPECT_FLOAT_EQ(constants.sleep_square, static_cast<float>(1e-4 * model.gravity * spacing));
    EXPECT_FLOAT_EQ(constants.wake_square, 4 * constants.sleep_square);
}

}  // namespace
}  // namespace talus::sim
