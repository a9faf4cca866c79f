#include "validate/set_up.hpp"

#include <gtest/gtest.h>

namespace talus::validate {
namespace {

TEST(Trial, shows_what_a_device_has_moved_after_every_step_and_at_the_end) {
    const Incline incline(0.5, 20, 20);
    params::MaterialSpec material;
    material.friction_coefficient = 0.1;
    sim::Model model = sim::make_model(material, {}, 0.5);
    sim::Ground ground(incline.terrain());
    const auto points = fill_lattice(incline, 0.5, -1, 4, -1, 4, [](double, double) { return 1.0; });
    Watch watch;
    watch.backend = params::BackendChoice::host;
    Trial trial({std::move(model), std::move(ground), state_at_rest(points)}, watch);
    const sim::State& state = trial.state();
    const auto fastest = [&] {
        float most = 0;
        for (std::uint32_t i = 0; i < state.count; ++i) most = std::max(most, state.velocity.x[i]);
        return most;
    };
    ASSERT_TRUE(trial.advance_to(0.2));
    const float before = fastest();
    EXPECT_GT(before, 0.1F);
    std::vector<float> speeds;
    ASSERT_TRUE(trial.advance_to(0.5, [&] { speeds.push_back(fastest()); }));
    ASSERT_GT(speeds.size(), 2U);
    EXPECT_GT(speeds[0], before);
    EXPECT_GT(speeds[1], speeds[0]);
    EXPECT_EQ(fastest(), speeds.back());
}

}  // namespace
}  // namespace talus::validate
