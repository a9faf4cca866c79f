#include "observe/overtopping.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "observe/particles.hpp"
#include "sim/physics/net.hpp"

namespace talus::observe {
namespace {

using test::add_particle;
using test::advance;

/// From south to north through the middle of the test ground: what runs east crosses it from left to right.
params::BarrierSpec dam(std::vector<params::BarrierOpeningSpec> openings = {}) {
    return {{{1000, 1990}, {1000, 2010}}, 2, {}, 1, std::move(openings)};
}

/// A particle of 0.4 m runs east at `y` and `z`.
sim::State runner(float y, float z, float speed = 5) {
    sim::State state;
    add_particle(state, {-3, y, z}, {speed, 0, 0});
    return state;
}

void run(Overtopping& watch, sim::State& state, int steps) {
    for (int k = 0; k < steps; ++k) {
        advance(state, 0.05);
        watch.after_step(state);
    }
}

TEST(Overtopping, tells_what_goes_over_the_crest_from_what_goes_through_a_slot) {
    const sim::Model model = test::make_model(0.4);
    const double volume = model.particle_volume();
    struct Case {
        float y, z;
        double over, through;
    };
    // The slot is 2 m wide around the middle of the line, y = 0; the crest is 2 m above the ground.
    for (const Case& c : {Case{5, 3, 1, 0}, Case{0, 0.2F, 0, 1}, Case{0, 2.5F, 1, 0}, Case{0.9F, 1, 0, 1}}) {
        Overtopping watch(model, test::make_ground().terrain, dam({{10, 2, 0}}), 0.1);
        sim::State state = runner(c.y, c.z);
        run(watch, state, 30);
        EXPECT_NEAR(watch.volume(), c.over * volume, 1e-12) << c.y << " " << c.z;
        EXPECT_NEAR(watch.passed_volume(), c.through * volume, 1e-12) << c.y << " " << c.z;
        EXPECT_EQ(std::isnan(watch.first_time()), c.over == 0);
    }
}

TEST(Overtopping, what_a_net_lets_through_below_its_crest_has_passed) {
    const sim::Model model = test::make_model(0.4);
    params::BarrierSpec net = dam();
    net.passing_share = 0.5;
    for (std::uint32_t id = 0; id < 20; ++id) {
        for (const float z : {0.2F, 1.9F, 2.1F}) {
            Overtopping watch(model, test::make_ground().terrain, net, 0.1);
            sim::State state = runner(5, z);
            state.id[0] = id;
            state.seeded = 20;
            run(watch, state, 30);
            // What is too coarse for the meshes can only have gone over it, where the ground is not level.
            const bool through = z < 2 && sim::grain_rank(id) < 0.5F;
            EXPECT_EQ(watch.passed_volume() > 0, through) << id << " " << z;
            EXPECT_EQ(watch.volume() > 0, !through) << id << " " << z;
        }
    }
}

TEST(Overtopping, what_comes_back_does_not_count) {
    const sim::Model model = test::make_model(0.4);
    Overtopping watch(model, test::make_ground().terrain, dam({{10, 2, 0}}), 0.1);
    sim::State state = runner(0, 0.2F);
    run(watch, state, 30);
    EXPECT_GT(watch.passed_volume(), 0);
    state.velocity.x[0] = -5;
    run(watch, state, 30);
    EXPECT_EQ(watch.passed_volume(), 0);
    EXPECT_EQ(watch.volume(), 0);
}

TEST(Overtopping, filling_is_the_depth_at_the_upstream_face) {
    const sim::Model model = test::make_model(0.4);
    Overtopping watch(model, test::make_ground().terrain, dam(), 0.1);
    // 4 m long, 8 m wide and 1.2 m deep behind the face, which is half a metre west of the line.
    sim::State state = test::block(0.4, -4.5, -4, 10, 20, 3);
    watch.follow(state);
    watch.after_step(state);
    const Overtopping::Filling filling = watch.filling(state);
    EXPECT_NEAR(filling.volume, 4 * 8 * 1.2, 1e-3);
    EXPECT_NEAR(filling.height, 1.2, 0.15);
}

TEST(Overtopping, the_height_of_a_dam_has_no_part_in_what_it_retains) {
    const sim::Model model = test::make_model(0.4);
    // 20 m long, twenty times as long as deep, and 12 m beyond a gap a heap that touches nothing.
    sim::State state = test::block(0.4, -20.5, -4, 50, 20, 2);
    const sim::State away = test::block(0.4, -40, -4, 10, 20, 2);
    for (std::uint32_t i = 0; i < away.count; ++i) test::add_particle(state, away.position.at(i));
    for (const double height : {3.0, 6.0, 20.0}) {
        params::BarrierSpec shape = dam();
        shape.height = height;
        Overtopping watch(model, test::make_ground().terrain, shape, 0.1);
        watch.follow(state);
        watch.after_step(state);
        EXPECT_NEAR(watch.filling(state).volume, 20 * 8 * 0.8, 1e-3) << height;
    }
}

TEST(Overtopping, retains_nothing_that_has_not_come_to_it) {
    const sim::Model model = test::make_model(0.4);
    Overtopping watch(model, test::make_ground().terrain, dam(), 0.1);
    sim::State state = test::block(0.4, -20, -4, 10, 20, 3);
    watch.follow(state);
    watch.after_step(state);
    EXPECT_EQ(watch.filling(state).volume, 0);
}

}  // namespace
}  // namespace talus::observe
