#include "observe/observer.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/hash.hpp"
#include "observe/particles.hpp"
#include "support/allocations.hpp"

namespace talus::observe {
namespace {

using test::advance;
using test::block;

/// A cloud that disperses eastward, some of it against a house.
struct Cloud {
    sim::Model model = test::make_model(0.4);
    sim::Ground ground = test::make_ground();
    sim::State state;
    std::mt19937 random{11};

    Cloud() {
        ground.buildings.resize(1);
        state = block(0.4, -80, -10, 40, 50, 5);
        std::normal_distribution<float> spread(0, 2);
        for (std::uint32_t i = 0; i < state.count; ++i) state.velocity.set(i, {10 + spread(random), spread(random), 0});
    }
    void step() {
        advance(state, 0.01);
        state.building_contacts.clear();
        for (std::uint32_t i = 0; i < 300; ++i) {
            const auto particle = static_cast<std::uint32_t>(random() % state.count);
            state.building_contacts.push_back({particle, 0, static_cast<float>(random() % 1000)});
        }
    }
};

void add(StateHash& hash, const Grid<float>& map) {
    hash.add(std::span<const float>(map.values));
}

std::uint64_t hash_of_run(int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    Cloud cloud;
    Observer observer(cloud.model, cloud.ground, cloud.state, test::straight_path(), params::OutputSpec{}, 1);
    for (int step = 0; step < 60; ++step) {
        cloud.step();
        observer.after_step(cloud.model, cloud.ground, cloud.state, 0);
    }
    const Observation o = observer.finish(cloud.model, cloud.ground, cloud.state);
    StateHash hash;
    for (const auto* map :
         {&o.maps.peak_depth, &o.maps.peak_speed, &o.maps.peak_pressure, &o.maps.arrival_time, &o.maps.deposit_depth}) {
        add(hash, *map);
    }
    hash.add(std::span<const FrontSample>(o.front));
    hash.add(std::span<const TimeSample>(o.timeseries));
    const RunOut& r = o.run_out;  // member by member: it has padding
    for (const double number : {r.front_chainage, r.along_flow, r.straight, r.at_least ? 1.0 : 0.0, r.crown.x,
                                r.crown.y, r.toe.x, r.toe.y, r.drop, r.runout_angle, r.travel_angle}) {
        hash.add(&number, sizeof(number));
    }
    hash.add(&o.buildings[0].peak_force, sizeof(double));
    hash.add(&o.buildings[0].peak_dynamic_pressure, sizeof(double));
    EXPECT_GT(o.front.size(), 3U);
    EXPECT_GT(o.timeseries.size(), 5U);
    return hash.value();
}

TEST(Observer, same_result_on_1_2_and_4_threads) {
    const std::uint64_t one = hash_of_run(1);
    EXPECT_EQ(hash_of_run(2), one);
    EXPECT_EQ(hash_of_run(4), one);
}

TEST(Observer, watching_a_step_allocates_nothing_once_debris_moves_where_it_was) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 2);
    Cloud cloud;
    params::OutputSpec outputs;
    outputs.sample_interval = 1000;
    Observer observer(cloud.model, cloud.ground, cloud.state, test::straight_path(), outputs, 1);
    for (int step = 0; step < 40; ++step) {
        cloud.step();
        observer.after_step(cloud.model, cloud.ground, cloud.state, 0);
    }
    for (std::uint32_t i = 0; i < cloud.state.count; ++i) cloud.state.velocity.set(i, {});
    for (int step = 0; step < 30; ++step) {
        advance(cloud.state, 0.01);
        observer.after_step(cloud.model, cloud.ground, cloud.state, 0);
    }
    const long before = test::allocation_count();
    for (int step = 0; step < 100; ++step) {
        advance(cloud.state, 0.01);
        observer.after_step(cloud.model, cloud.ground, cloud.state, 0);
    }
    EXPECT_EQ(test::allocation_count() - before, 0);
}

TEST(Observer, rows_come_at_the_interval_with_the_first_and_the_last) {
    Cloud cloud;
    params::OutputSpec outputs;
    outputs.sample_interval = 0.1;
    Observer observer(cloud.model, cloud.ground, cloud.state, test::straight_path(), outputs, 1);
    EXPECT_EQ(observer.latest().time, 0);
    for (int step = 0; step < 55; ++step) {
        cloud.step();
        observer.after_step(cloud.model, cloud.ground, cloud.state, 120);
    }
    EXPECT_NEAR(observer.latest().time, 0.5, 1e-9);
    EXPECT_EQ(observer.latest().steps_per_second, 120);
    const Observation o = observer.finish(cloud.model, cloud.ground, cloud.state);
    ASSERT_EQ(o.timeseries.size(), 7U);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(o.timeseries[i].time, 0.1 * static_cast<double>(i), 1e-9);
    EXPECT_NEAR(o.timeseries.back().time, 0.55, 1e-9);
    EXPECT_EQ(observer.finish(cloud.model, cloud.ground, cloud.state).timeseries.size(), 7U)
        << "asking twice adds no row";
}

TEST(Observer, steps_longer_than_the_interval_make_a_row_each) {
    Cloud cloud;
    params::OutputSpec outputs;
    outputs.sample_interval = 0.004;
    Observer observer(cloud.model, cloud.ground, cloud.state, {}, outputs, 1);
    for (int step = 0; step < 10; ++step) {
        cloud.step();
        observer.after_step(cloud.model, cloud.ground, cloud.state, 0);
    }
    EXPECT_EQ(observer.finish(cloud.model, cloud.ground, cloud.state).timeseries.size(), 11U);
}

TEST(Observer, volumes_and_energies_are_those_of_the_particles) {
    const sim::Model model = test::make_model(0.5);
    const sim::Ground ground = test::make_ground();
    sim::State state;
    const double volume = 0.125, mass = 250;
    test::add_particle(state, {0, 0, 3}, {3, 4, 0});
    test::add_particle(state, {1, 0, 2}, {0, 0.05F, 0});
    test::add_particle(state, {2, 0, 1}, {0, 0, 0});
    test::add_particle(state, {3, 0, 0}, {0, 0, 0}, true);
    state.seeded = 9;
    state.outflow = 5;
    state.mean_compression = 0.01;
    const TimeSample before = Observer(model, ground, state, {}, params::OutputSpec{}, 1).latest();
    EXPECT_EQ(before.volume_held, 4 * volume) << "nothing is let go before the first step";
    EXPECT_EQ(before.volume_moving + before.volume_deposited, 0);
    state.step = 1;
    Observer observer(model, ground, state, {}, params::OutputSpec{}, 1);
    const TimeSample& row = observer.latest();
    EXPECT_EQ(row.volume_moving, 1 * volume);
    EXPECT_EQ(row.volume_deposited, 2 * volume);
    EXPECT_EQ(row.volume_held, 1 * volume);
    EXPECT_EQ(row.volume_left, 5 * volume);
    EXPECT_NEAR(row.kinetic_energy, 0.5 * mass * (25 + 0.0025), 1e-3);
    EXPECT_NEAR(row.potential_energy, mass * 9.80665 * 6, 1e-6);
    EXPECT_TRUE(std::isnan(row.front_chainage));
    EXPECT_EQ(observer.finish(model, ground, state).volume_released, 9 * volume);
}

TEST(Observer, says_how_far_debris_was_compressed_and_when) {
    const sim::Model model = test::make_model(0.5);
    const sim::Ground ground = test::make_ground();
    sim::State state;
    test::add_particle(state, {0, 0, 3}, {3, 4, 0});
    state.seeded = 1;
    Observer observer(model, ground, state, {}, params::OutputSpec{}, 1);
    const auto step = [&](double time_step, double mean, double overcompressed, double max, int iterations) {
        state.time += time_step;
        state.time_step = time_step;
        state.mean_compression = mean;
        state.overcompressed_share = overcompressed;
        state.max_compression = max;
        state.iterations = iterations;
        observer.after_step(model, ground, state, 0);
    };
    step(0.25, 0.002, 0.01, 0.3, 4);
    EXPECT_TRUE(observer.finish(model, ground, state).compression.within_limits()) << "a single particle is no verdict";
    step(0.5, 0.02, 0, 0.025, 16);
    step(0.25, 0.005, 0.4, 0.1, 8);
    step(1, 0, 0, 0, 4);
    const Compression c = observer.finish(model, ground, state).compression;
    EXPECT_EQ(c.worst_mean, 0.02);
    EXPECT_EQ(c.worst_mean_time, 0.75);
    EXPECT_EQ(c.worst_max, 0.3);
    EXPECT_EQ(c.worst_max_time, 0.25);
    EXPECT_EQ(c.worst_overcompressed_share, 0.4);
    EXPECT_EQ(c.worst_overcompressed_time, 1);
    EXPECT_DOUBLE_EQ(c.time_share_above, 0.75 / 2);
    EXPECT_DOUBLE_EQ(c.time_share_iterated, 0.75 / 2);
    EXPECT_DOUBLE_EQ(c.mean_iterations, 8);
    EXPECT_FALSE(c.within_limits());
}

TEST(Observer, reports_the_front_as_it_goes) {
    Cloud cloud;
    Observer observer(cloud.model, cloud.ground, cloud.state, test::straight_path(), params::OutputSpec{}, 1);
    const double start = observer.front_chainage();
    EXPECT_NEAR(start, 26, 0.5);
    for (int step = 0; step < 100; ++step) {
        cloud.step();
        observer.after_step(cloud.model, cloud.ground, cloud.state, 0);
    }
    EXPECT_GT(observer.front_chainage(), start + 10);
    EXPECT_EQ(observer.latest().front_chainage, observer.front_chainage());
    EXPECT_EQ(observer.finish(cloud.model, cloud.ground, cloud.state).run_out.front_chainage,
              observer.front_chainage());
}

}  // namespace
}  // namespace talus::observe
