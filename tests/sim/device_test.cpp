#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "sim/backend_choice.hpp"
#include "sim/compression.hpp"
#include "sim_fixtures.hpp"

/// What a run does beside the laws (constraint_test.cpp compares those with the reference), on the processor and with
/// the kernels of a device run by plain loops.
namespace talus::sim {
namespace {

using params::BackendChoice;

/// Debris that slides against a house, over a bed that it entrains, joined by an inflow, some of it out of the terrain.
Simulation busy(BackendChoice choice, double spacing = 0.5, params::MaterialSpec material = {}) {
    material.turbulent_friction = 400;
    params::SolverSpec solver;
    solver.backend = choice;
    solver.time_step = 1.0 / 60;  // the same moments, so that both take the same inflow
    terrain::Building house;
    house.footprint = {testing::rectangle(33, 14, 36, 20)};
    house.height = 3;
    const terrain::Terrain terrain = testing::inclined_plane(30, 48, 34);
    std::vector<terrain::Building> buildings{house};
    place_buildings(terrain, buildings);
    Model model = make_model(material, solver, spacing);
    terrain::Bed bed;
    bed.materials.push_back({"loam"});
    bed.materials.front().growth_rate = 0.02;
    const std::size_t cells = terrain.elevation().values.size();
    bed.material_at.assign(cells, 1);
    bed.depth.assign(cells, 0.5F);
    bed.eroded.assign(cells, 0.0F);
    Ground ground(terrain, buildings, model.support_radius, bed);
    Result<State> seeded = seed_releases(model, ground,
                                         {testing::block(terrain, testing::rectangle(26, 14, 32, 20), 1.2),
                                          testing::block(terrain, testing::rectangle(41, 22, 46.5, 26), 1, 0.5)});
    const terrain::Inflow inflow{"gully", {10, 14}, {10, 20}, {{0, 25, 5}, {5, 25, 5}}};
    InflowFeeder feeder(model, ground.terrain.frame(), {inflow});
    return {std::move(model), std::move(ground), *std::move(seeded), std::move(feeder)};
}

/// Mean position, weight 1 per particle, and how many there are.
struct Summary {
    Vec3<double> centre, momentum;
    double count = 0, contacts = 0, impulse = 0, impulse_times_speed = 0;
};

Summary summary_of(const State& state) {
    Summary s;
    s.count = state.count;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        s.centre += Vec3<double>{state.position.x[i], state.position.y[i], state.position.z[i]};
        s.momentum += Vec3<double>{state.velocity.x[i], state.velocity.y[i], state.velocity.z[i]};
    }
    s.centre = s.centre * (1 / s.count);
    s.momentum = s.momentum * (1 / s.count);
    s.contacts = static_cast<double>(state.building_contacts.size());
    for (const BuildingContact& contact : state.building_contacts) {
        s.impulse += contact.impulse;
        s.impulse_times_speed += static_cast<double>(contact.impulse) * static_cast<double>(contact.speed);
    }
    return s;
}

TEST(Device, moves_a_whole_scene_as_the_processor_does) {
    Simulation processor = busy(BackendChoice::cpu), device = busy(BackendChoice::host);
    double impulse = 0, impulse_of_device = 0, times_speed = 0, times_speed_of_device = 0;
    for (int i = 0; i < 120; ++i) {
        ASSERT_TRUE(processor.advance());
        ASSERT_TRUE(device.advance());
        impulse += summary_of(processor.state()).impulse;
        impulse_of_device += summary_of(device.state()).impulse;
        times_speed += summary_of(processor.state()).impulse_times_speed;
        times_speed_of_device += summary_of(device.state()).impulse_times_speed;
    }
    const State &a = processor.state(), &b = device.state();
    const Summary of_a = summary_of(a), of_b = summary_of(b);
    EXPECT_EQ(b.time, a.time);
    EXPECT_GT(a.entrained, 20U);
    EXPECT_GT(a.outflow, 20U);
    EXPECT_GT(impulse, 0);
    EXPECT_NEAR(b.entrained, a.entrained, 0.1 * a.entrained);
    EXPECT_NEAR(b.outflow, a.outflow, 0.1 * a.outflow);
    EXPECT_EQ(b.released(), a.released()) << "inflow";
    EXPECT_NEAR(impulse_of_device, impulse, 0.15 * impulse);
    EXPECT_NEAR(times_speed_of_device, times_speed, 0.25 * times_speed);
    EXPECT_LT(length(of_b.centre - of_a.centre), 0.05) << "m";
    EXPECT_LT(length(of_b.momentum - of_a.momentum), 0.05) << "m/s";
    EXPECT_FALSE(too_compressed(b));
    EXPECT_EQ(b.count + b.outflow, b.seeded);
}

TEST(Device, drains_what_comes_in_later_from_then_on_as_the_processor_does) {
    params::MaterialSpec material;
    material.friction_coefficient = 1;
    material.internal_friction_coefficient = 0.5;
    material.pore_pressure_ratio = 0.9;
    material.pore_pressure_decay_time = 0.5;
    Simulation processor = busy(BackendChoice::cpu, 0.8, material), device = busy(BackendChoice::host, 0.8, material);
    for (int i = 0; i < 150; ++i) {
        ASSERT_TRUE(processor.advance());
        ASSERT_TRUE(device.advance());
    }
    const Summary of_a = summary_of(processor.state()), of_b = summary_of(device.state());
    ASSERT_GT(processor.state().entry_of_id.size(), 100U);
    EXPECT_GT(of_a.momentum.x, 0.3) << "only what came in lately moves";
    EXPECT_NEAR(of_b.momentum.x, of_a.momentum.x, 0.1);
    EXPECT_LT(length(of_b.centre - of_a.centre), 0.1);
}

TEST(Device, finds_the_neighbours_that_the_processor_finds) {
    Simulation processor = busy(BackendChoice::cpu), device = busy(BackendChoice::host);
    ASSERT_TRUE(processor.advance());
    ASSERT_TRUE(device.advance());
    EXPECT_GT(device.mean_neighbours(), 20);
    EXPECT_NEAR(device.mean_neighbours(), processor.mean_neighbours(), 1e-9);
}

TEST(Device, gives_the_same_bits_on_any_number_of_threads_and_again) {
    const auto hash_on = [](int threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(threads));
        tbb::task_arena arena(threads);
        return arena.execute([] {
            Simulation simulation = busy(BackendChoice::host);
            for (int i = 0; i < 25; ++i) EXPECT_TRUE(simulation.advance());
            return hash_state(simulation.state());
        });
    };
    const std::uint64_t one = hash_on(1);
    EXPECT_EQ(hash_on(1), one);
    EXPECT_EQ(hash_on(2), one);
    EXPECT_EQ(hash_on(4), one);
}

TEST(Device, needs_less_than_700_bytes_per_particle) {
    params::SolverSpec solver;
    solver.backend = BackendChoice::host;
    // A wide, thin sheet, as in practice, and a house: walls need memory too.
    terrain::Building house;
    house.footprint = {testing::rectangle(60, 20, 64, 26)};
    house.height = 3;
    const terrain::Terrain terrain = testing::inclined_plane(20);
    Simulation sheet = testing::simulate(
        {}, solver, terrain, {testing::block(terrain, testing::rectangle(5, 5, 35, 35), 0.8)}, 0.3, {house});
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(sheet.advance());
    const std::uint32_t particles = sheet.state().count;
    ASSERT_GT(particles, 20000U);
    const double terrain_bytes = static_cast<double>(terrain.elevation().values.size() * sizeof(Quad));
    const double each = (static_cast<double>(sheet.device_bytes()) - terrain_bytes) / particles;
    RecordProperty("bytes_per_particle", std::to_string(each));
    EXPECT_LT(each, 700);
    EXPECT_GT(each, 300) << "not all of it was counted";
}

TEST(Device, lets_debris_sleep_and_wakes_it) {
    params::SolverSpec solver;
    solver.backend = BackendChoice::host;
    solver.rest_duration = 0.2;
    const terrain::Terrain terrain = testing::inclined_plane(0, 40, 40);
    const std::vector<terrain::Release> releases = {
        testing::block(terrain, testing::rectangle(16, 16, 24, 24), 1),
        testing::block(terrain, testing::rectangle(13, 18, 14.5, 22), 1.2, 3)};
    Simulation heap = testing::simulate({}, solver, terrain, releases, 0.5);
    const auto asleep = [&] { return heap.state().count - heap.state().awake; };
    while (heap.state().time < 2.9) ASSERT_TRUE(heap.advance());
    const std::uint32_t before = asleep();
    EXPECT_GT(before, heap.state().count / 3);
    // What starts beside it now slides against it.
    heap.change([](Model&, Ground&, State& state) {
        for (std::uint32_t i = 0; i < state.count; ++i) {
            if (state.held[i] != 0) state.velocity.x[i] = 6;
        }
    });
    std::uint32_t fewest = before;
    while (heap.state().time < 4) {
        ASSERT_TRUE(heap.advance());
        fewest = std::min(fewest, asleep());
    }
    EXPECT_LT(fewest, before - before / 10) << "nothing was woken";
}

TEST(Device, takes_up_what_a_user_changes_between_two_steps) {
    Simulation simulation = busy(BackendChoice::host);
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulation.advance());
    const Summary before = summary_of(simulation.state());
    simulation.change([](Model&, Ground&, State& state) {
        for (std::uint32_t i = 0; i < state.count; ++i) state.position.y[i] += 1;
    });
    ASSERT_TRUE(simulation.advance());
    EXPECT_NEAR(summary_of(simulation.state()).centre.y, before.centre.y + 1, 0.1);
}

/// Without a bed, which needs the particles on the processor in every step.
Simulation sliding_slab() {
    params::SolverSpec solver;
    solver.backend = BackendChoice::host;
    const terrain::Terrain terrain = testing::inclined_plane(30);
    return testing::simulate({}, solver, terrain, {testing::block(terrain, testing::rectangle(10, 10, 30, 30), 1)},
                             0.5);
}

TEST(Device, keeps_a_copy_of_the_particles_for_a_later_fault) {
    Simulation simulation = sliding_slab();
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(simulation.advance());
    simulation.keep();
    const State then = simulation.state();
    const std::uint64_t copied = simulation.device_traffic().to_host;
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(simulation.advance());
    const State& kept = simulation.kept();
    EXPECT_GT(simulation.device_traffic().to_host, copied);
    EXPECT_EQ(kept.step, then.step);
    EXPECT_EQ(hash_state(kept), hash_state(then));
    EXPECT_NE(hash_state(kept), hash_state(simulation.state()));
}

TEST(Device, counts_what_moves_without_copying_it) {
    Simulation slab = sliding_slab();
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(slab.advance());
    const std::uint64_t before = slab.device_traffic().to_host;
    const double speed = slab.summary().max_speed / 2;
    const Motion motion = slab.motion(speed), fast = slab.motion(speed / 20);
    EXPECT_LT(slab.device_traffic().to_host - before, slab.summary().count);
    EXPECT_EQ(motion.moving, motion_of(slab.state(), speed).moving);
    EXPECT_EQ(fast.fast, motion_of(slab.state(), speed / 20).fast);
    EXPECT_GT(fast.fast, 0U);
    EXPECT_GT(motion.moving, 0U);
    EXPECT_LT(motion.moving, slab.summary().count);
}

TEST(Backends, are_chosen_by_name_number_of_particles_and_what_the_machine_has) {
    EXPECT_EQ(settled_backend(BackendChoice::cpu, 1000000), BackendChoice::cpu);
    EXPECT_EQ(settled_backend(BackendChoice::host, 10), BackendChoice::host);
    EXPECT_EQ(settled_backend(BackendChoice::automatic, 10), BackendChoice::cpu) << "too few to be worth a card";
    const bool has_card = check_backend(BackendChoice::cuda).ok();
    EXPECT_EQ(settled_backend(BackendChoice::automatic, 1000000), has_card ? BackendChoice::cuda : BackendChoice::cpu);
    for (const BackendChoice choice : {BackendChoice::cpu, BackendChoice::host, BackendChoice::automatic}) {
        EXPECT_TRUE(check_backend(choice)) << backend_name(choice);
    }
    EXPECT_NE(describe_backends().find(has_card ? "cuda (" : "no cuda: "), std::string::npos) << describe_backends();
}

}  // namespace
}  // namespace talus::sim
