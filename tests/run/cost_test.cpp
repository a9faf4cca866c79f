#include "run/cost.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "run/run.hpp"
#include "scene/particle_spacing.hpp"
#include "scene/scene_folder.hpp"

namespace talus::run {
namespace {

class CostOfRun : public scene::SceneFolder {
  protected:
    void SetUp() override {
        write_valley(
            "[solver]\ntarget_particle_count = 400\nend_time_s = 3\nlargest_time_step_s = 0.016666666666666666\n");
    }
    /// Debris of 1 m particles so slow that every step is the longest, on a machine that takes `step` s for one.
    static Rehearsal slow_debris(double step) {
        Rehearsal rehearsal;
        rehearsal.particle_spacing = 1;
        rehearsal.steps.assign(180, {0.01, step});
        rehearsal.simulated_time = 3;
        rehearsal.complete = true;
        return rehearsal;
    }
    const std::atomic<bool> go_on{false};
};

TEST_F(CostOfRun, grows_with_particles_and_with_the_steps_that_fast_debris_needs) {
    const scene::Scene scene = loaded();
    Rehearsal rehearsal = slow_debris(1e-3);
    rehearsal.seeding_time = 1e-4;
    EXPECT_NEAR(cost_of(scene, rehearsal, 1).wall_time, 0.18, 1e-12);
    const Cost half = cost_of(scene, rehearsal, 0.5);
    EXPECT_NEAR(half.wall_time, 8 * 0.18, 1e-12);
    EXPECT_NEAR(half.particles, total_volume(scene) * 8, 1e-9);
    EXPECT_NEAR(half.seeding_time, half.particles * 1e-4, 1e-12);
    EXPECT_NEAR(half.real_time_factor(), 3 / (8 * 0.18), 1e-9);
    EXPECT_GT(half.memory, cost_of(scene, rehearsal, 1).memory);

    rehearsal.many = 8;
    rehearsal.more_per_step = 1.5;
    EXPECT_NEAR(cost_of(scene, rehearsal, 0.5).wall_time, 1.5 * 8 * 0.18, 1e-12);
    EXPECT_NEAR(cost_of(scene, rehearsal, 0.25).wall_time, 1.5 * 64 * 0.18, 1e-12);
    EXPECT_NEAR(cost_of(scene, rehearsal, std::sqrt(0.5)).wall_time, std::sqrt(1.5 * 8) * 0.18, 1e-12);
    EXPECT_NEAR(cost_of(scene, rehearsal, 1).wall_time, 0.18, 1e-12);
    for (Rehearsal::Step& step : rehearsal.steps) step.max_speed = 100;
    EXPECT_NEAR(cost_of(scene, rehearsal, 0.5).wall_time, 2 * 1.5 * 8 * 0.18, 0.2) << "half the step, too";
}

TEST_F(CostOfRun, goes_to_the_end_time_where_the_rehearsal_did_not) {
    Rehearsal rehearsal = slow_debris(1e-3);
    rehearsal.simulated_time = 1.5;
    rehearsal.complete = false;
    const Cost cost = cost_of(loaded(), rehearsal, 1);
    EXPECT_EQ(cost.simulated_time, 3);
    EXPECT_NEAR(cost.wall_time, 2 * 0.18, 1e-12);
}

TEST_F(CostOfRun, of_the_layers_in_real_time_leaves_the_margin) {
    const scene::Scene scene = loaded();
    for (const double step : {1e-4, 1e-3, 5e-3}) {
        const Rehearsal rehearsal = slow_debris(step);
        const double layers = real_time_layers(scene, rehearsal, 2);
        // A third of the spacing takes 27 times as long.
        EXPECT_NEAR(layers, 2 * std::cbrt(1 / (60 * step * real_time_margin)), 0.11) << step;
        EXPECT_GE(cost_of(scene, rehearsal, 2 / layers).real_time_factor(), real_time_margin);
        EXPECT_LT(cost_of(scene, rehearsal, 2 / (layers + 0.11)).real_time_factor(), real_time_margin);
    }
    EXPECT_LT(real_time_layers(scene, slow_debris(1), 2), 1) << "a machine that is too slow for one";
}

TEST_F(CostOfRun, of_the_layers_in_real_time_stays_within_the_particle_limit) {
    const scene::Scene scene = loaded({"solver.particle_limit=7000"});
    const double layers = real_time_layers(scene, slow_debris(1e-9), 2);
    EXPECT_LE(total_volume(scene) / std::pow(2 / layers, 3), 7000);
    EXPECT_GT(total_volume(scene) / std::pow(2 / (layers + 0.11), 3), 7000);
}

TEST_F(CostOfRun, is_rehearsed_with_the_scene_itself) {
    const scene::Scene scene = loaded();
    const auto rehearsal = rehearse(scene, particle_spacing(scene), go_on);
    ASSERT_TRUE(rehearsal) << rehearsal.error().message;
    EXPECT_EQ(rehearsal->particle_spacing, particle_spacing(scene)) << "fewer particles than a rehearsal has";
    auto run = std::move(*Run::start(scene));
    while (run->advance()) {
    }
    const Cost cost = cost_of(scene, *rehearsal, particle_spacing(scene));
    EXPECT_NEAR(cost.particles, run->state().released(), 1);
    if (rehearsal->complete) {  // within its time, even on a machine that is busy otherwise
        EXPECT_EQ(rehearsal->steps.size(), run->state().step);
        EXPECT_EQ(cost.simulated_time, run->state().time);
    }
    EXPECT_GT(cost.wall_time, 0);
    EXPECT_GT(cost.seeding_time, 0);
}

TEST_F(CostOfRun, is_rehearsed_within_the_particle_limit) {
    const scene::Scene scene = loaded({"solver.particle_limit=1000"});
    const auto rehearsal = rehearse(scene, 0, go_on);
    ASSERT_TRUE(rehearsal) << rehearsal.error().message;
    EXPECT_NEAR(total_volume(scene) / std::pow(rehearsal->particle_spacing, 3), 900, 1e-6);
}

}  // namespace
}  // namespace talus::run
