#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "observe/debris.hpp"
#include "observe/device/particles.hpp"
#include "observe/map_accumulator.hpp"
#include "observe/particles.hpp"
#include "sim/backend_choice.hpp"

/// What a device is asked for beside the steps, against the same from the arrays of a state.
namespace talus::observe::device {
namespace {

using sim::device::Backend;

/// A house at the local origin.
terrain::Building house() {
    terrain::Building building;
    building.footprint = {{{{1000, 2000}, {1004, 2000}, {1004, 2003}, {1000, 2003}}, {}}};
    building.roof_elevation = 53;
    return building;
}

/// Debris on both sides of a house, some of it held, some fast, some of it off the path; more than a task takes.
class DeviceParticles : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        const bool card = std::string(GetParam()) == "cuda";
        const Status usable = sim::check_backend(card ? params::BackendChoice::cuda : params::BackendChoice::host);
        if (!usable) GTEST_SKIP() << usable.error().message;
        backend = card ? sim::device::make_cuda_backend() : sim::device::make_host_backend();
        state = test::block(0.4, -14.03, -6, 70, 30, 3);
        for (std::uint32_t i = 0; i < state.count; ++i) {
            state.held[i] = i % 7 == 0 ? 1 : 0;
            const float x = state.position.x[i], y = state.position.y[i];
            state.velocity.set(i, {0.2F * x, i % 3 == 0 ? 0.0F : y, i % 5 == 0 ? 0.5F : 0.0F});
            if (i % 11 == 0) state.velocity.set(i, {});
        }
        test::add_particle(state, {0, 90, 1}, {3, 0, 0});          // far from the path
        test::add_particle(state, {-99.9F, 99.9F, 1}, {0, 1, 0});  // in a corner of the terrain
        follow();
    }
    void follow() {
        state.resize(state.count);  // a device takes all arrays over
        backend->follow(model, ground, state);
        particles = make_particles(*backend);
        ASSERT_NE(particles, nullptr);
    }
    [[nodiscard]] Debris on_device() const { return {*particles, state}; }
    [[nodiscard]] Debris in_arrays() const { return state; }

    sim::Model model = test::make_model();
    sim::Ground ground = test::make_ground();
    sim::State state;
    std::unique_ptr<Backend> backend;
    std::unique_ptr<Particles> particles;
};

TEST_P(DeviceParticles, are_counted_and_summed_as_those_of_a_state) {
    for (const double deposited_speed : {0.0, 0.5, 2.0, 100.0}) {
        const ParticleSums sums = on_device().sums(model, deposited_speed);
        const ParticleSums expected = in_arrays().sums(model, deposited_speed);
        EXPECT_EQ(sums.held, expected.held);
        EXPECT_EQ(sums.moving, expected.moving);
        EXPECT_EQ(sums.deposited, expected.deposited);
        EXPECT_EQ(sums.held + sums.moving + sums.deposited, state.count);
        // Added in another order.
        EXPECT_NEAR(sums.speed, expected.speed, 1e-12 * expected.speed);
        EXPECT_NEAR(sums.speed_squared, expected.speed_squared, 1e-12 * expected.speed_squared);
        EXPECT_NEAR(sums.height, expected.height, 1e-12 * expected.height);
    }
}

TEST_P(DeviceParticles, weigh_in_sums_by_densities_of_their_own) {
    const ParticleSums before = on_device().sums(model, 1);
    state.density_of_id.resize(state.count);
    for (std::uint32_t i = 0; i < state.count; ++i) state.density_of_id[i] = i % 2 == 0 ? 1800 : 2300;
    follow();
    const ParticleSums sums = on_device().sums(model, 1), expected = in_arrays().sums(model, 1);
    EXPECT_NEAR(sums.height, expected.height, 1e-12 * expected.height);
    EXPECT_NEAR(sums.speed_squared, expected.speed_squared, 1e-12 * expected.speed_squared);
    EXPECT_GT(std::abs(sums.height - before.height), 0.01 * before.height);
}

TEST_P(DeviceParticles, on_a_path_are_those_at_a_chainage_or_beyond_it) {
    const terrain::FlowPath path = test::straight_path();
    const PlanPoint origin{1000, 2000};
    const auto by_particle = [](Debris::OnPath& found) {
        found.found.resize(found.count);
        std::sort(found.found.begin(), found.found.end(),
                  [](const PathParticle& a, const PathParticle& b) { return a.particle < b.particle; });
    };
    std::uint32_t before = state.count;
    for (const double from : {0.0, 80.0, 95.3, 102.0, 170.0}) {
        Debris::OnPath made, expected;
        on_device().find_on_path(path, origin, from, made);
        in_arrays().find_on_path(path, origin, from, expected);
        by_particle(made);
        by_particle(expected);
        EXPECT_EQ(made.held, expected.held);
        ASSERT_EQ(made.count, expected.count) << from;
        for (std::uint32_t k = 0; k < made.count; ++k) {
            EXPECT_EQ(made.found[k].particle, expected.found[k].particle);
            EXPECT_EQ(made.found[k].chainage, expected.found[k].chainage);
            EXPECT_EQ(made.found[k].speed, expected.found[k].speed);
            EXPECT_GE(static_cast<double>(made.found[k].chainage), from);
        }
        EXPECT_LE(made.count, before);
        before = made.count;
    }
    EXPECT_EQ(before, 0U) << "none is so far";
}

TEST_P(DeviceParticles, in_a_rectangle_are_found_with_held_ones_or_without) {
    for (const Extent& extent : {Extent{-3, -2, 5, 4}, Extent{-200, -200, 200, 200}, Extent{50, 50, 60, 60}}) {
        for (const bool released : {false, true}) {
            std::vector<PlacedParticle> made, expected;
            on_device().find_inside(extent, released, made);
            in_arrays().find_inside(extent, released, expected);
            ASSERT_EQ(made.size(), expected.size()) << extent.x_min << (released ? " released" : " all");
            for (std::size_t k = 0; k < made.size(); ++k) {
                EXPECT_EQ(made[k].id, expected[k].id) << "in the order of the particles";
                EXPECT_EQ(made[k].position.x, expected[k].position.x);
                EXPECT_EQ(made[k].position.y, expected[k].position.y);
                EXPECT_EQ(made[k].position.z, expected[k].position.z);
                EXPECT_EQ(made[k].speed, expected[k].speed);
            }
        }
    }
}

TEST_P(DeviceParticles, beside_walls_follow_the_walls) {
    const auto expect_same = [&](const WallPatches& patches) {
        Debris::BesideWalls made, expected;
        on_device().find_beside_walls(model, patches, made);
        in_arrays().find_beside_walls(model, patches, expected);
        EXPECT_EQ(made.found.size(), expected.found.size());
        for (std::size_t k = 0; k < std::min(made.found.size(), expected.found.size()); ++k) {
            EXPECT_EQ(made.found[k].position.x, expected.found[k].position.x);
            EXPECT_EQ(made.found[k].velocity.y, expected.found[k].velocity.y);
            EXPECT_EQ(made.found[k].density, expected.found[k].density);
        }
        return made.found.size();
    };
    const std::size_t beside_one = expect_same(WallPatches(ground.terrain, {house()}, 1, 2));
    EXPECT_GT(beside_one, 100U);
    EXPECT_LT(beside_one, state.count / 2);
    // Without the call the device keeps to the walls that it was given.
    particles->forget_walls();
    EXPECT_EQ(expect_same(WallPatches(ground.terrain, {}, 1, 2)), 0U);
}

TEST_P(DeviceParticles, make_the_maps_of_a_state_bit_for_bit) {
    for (const bool own_densities : {false, true}) {
        if (own_densities) {
            state.density_of_id.resize(state.count);
            for (std::uint32_t i = 0; i < state.count; ++i) state.density_of_id[i] = i % 2 == 0 ? 1800 : 2300;
            follow();
        }
        MapAccumulator made(model, ground, state, 1, 0.1), expected(model, ground, state, 1, 0.1);
        for (int step = 0; step < 4; ++step) {
            on_device().add_to(made);
            in_arrays().add_to(expected);
            // Onto new tiles, and off old ones.
            test::advance(state, 2.5);
            backend->follow(model, ground, state);
        }
        EXPECT_EQ(made.volume(), expected.volume());
        const HazardMaps a = made.maps(), b = expected.maps();
        const auto expect_same = [](const Grid<float>& x, const Grid<float>& y, const char* name) {
            EXPECT_EQ(x.geometry, y.geometry) << name;
            const auto same = [](float p, float q) { return p == q || (std::isnan(p) && std::isnan(q)); };
            EXPECT_TRUE(std::equal(x.values.begin(), x.values.end(), y.values.begin(), y.values.end(), same)) << name;
        };
        expect_same(a.peak_depth, b.peak_depth, "depth");
        expect_same(a.peak_speed, b.peak_speed, "speed");
        expect_same(a.peak_pressure, b.peak_pressure, "pressure");
        expect_same(a.arrival_time, b.arrival_time, "arrival time");
        expect_same(a.arrival_speed, b.arrival_speed, "arrival speed");
        expect_same(a.deposit_depth, b.deposit_depth, "deposit");
        expect_same(made.present().density, expected.present().density, "density");
        EXPECT_EQ(made.present().density.values.empty(), !own_densities);
    }
}

TEST_P(DeviceParticles, without_any_are_nothing) {
    state = sim::State();
    follow();
    EXPECT_EQ(on_device().sums(model, 1).moving, 0U);
    std::vector<PlacedParticle> found(3);
    on_device().find_inside({-1, -1, 1, 1}, false, found);
    EXPECT_TRUE(found.empty());
    Debris::OnPath on_path;
    on_device().find_on_path(test::straight_path(), {1000, 2000}, 0, on_path);
    EXPECT_EQ(on_path.count, 0U);
}

INSTANTIATE_TEST_SUITE_P(OnEach, DeviceParticles, ::testing::Values("host", "cuda"),
                         [](const auto& device) { return std::string(device.param); });

TEST(CudaParticles, are_not_made_for_loops_on_the_processor) {
    const std::unique_ptr<Backend> host = sim::device::make_host_backend();
    EXPECT_EQ(make_cuda_particles(*host), nullptr);
}

}  // namespace
}  // namespace talus::observe::device
