#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "sim/backend_choice.hpp"
#include "sim/cpu/backend.hpp"
#include "sim/device/backend.hpp"
#include "sim/reference/reference.hpp"
#include "sim/step.hpp"
#include "sim_fixtures.hpp"
#include "simd/dispatch.hpp"
#include "terrain/barrier.hpp"

namespace talus::sim {
namespace {

using reference::Vector;
using testing::random_points;
using testing::state_of;

Model free_space(params::KernelChoice kernel = params::KernelChoice::wendland_c2,
                 params::InternalFriction friction = params::InternalFriction::stress) {
    params::SolverSpec solver;
    solver.kernel = kernel;
    solver.internal_friction = friction;
    Model model = make_model({}, solver, 0.4);
    model.gravity = 0;
    return model;
}

Ground level_ground() {
    return Ground(testing::terrain_of(40, 40, 1, [](double, double) { return 0; }));
}

TEST(DensityConstraint, gradient_agrees_with_finite_differences) {
    for (const params::KernelChoice kernel :
         {params::KernelChoice::wendland_c2, params::KernelChoice::cubic_spline, params::KernelChoice::spiky}) {
        const Model model = free_space(kernel);
        const Ground ground = level_ground();
        std::vector<Vector> points;
        // Close to the ground, so that its share of the gradient is tested as well.
        for (const LocalPoint& p : random_points(40, {-0.6F, -0.6F, 0.1F}, {0.6F, 0.6F, 1.0F}, 5)) {
            points.push_back({p.x, p.y, p.z});
        }
        for (std::size_t k = 0; k < points.size(); ++k) {
            const Vector gradient = reference::constraint_gradient(model, ground, points, 3, k);
            const double components[] = {gradient.x, gradient.y, gradient.z};
            for (int axis = 0; axis < 3; ++axis) {
                constexpr double h = 1e-5;
                const auto shifted = [&](double by) {
                    auto moved = points;
                    (axis == 0 ? moved[k].x : axis == 1 ? moved[k].y : moved[k].z) += by;
                    return reference::constraint(model, ground, moved, 3);
                };
                EXPECT_NEAR(components[axis], (shifted(h) - shifted(-h)) / (2 * h), 2e-3)
                    << "particle " << k << " axis " << axis;
            }
        }
    }
}

/// Takes a step of the processor, or of the kernels of a device run by plain loops.
void take_step(params::BackendChoice choice, const Model& model, const Ground& ground, State& state) {
    StageTimes times;
    if (choice == params::BackendChoice::cpu) {
        cpu::Backend backend(model, state.count);
        step(backend, model, ground, state, times);
        return;
    }
    const auto backend = device::make_host_backend();
    backend->follow(model, ground, state);
    step(*backend, model, ground, state, times);
    backend->fetch(state);
}

/// Momentum of compressed, shearing debris in free space before and after some steps, per particle.
void expect_momentum_kept(params::InternalFriction friction, params::BackendChoice choice) {
    Model model = free_space(params::KernelChoice::wendland_c2, friction);
    const Ground ground = level_ground();
    const auto points = random_points(800, {-1.7F, -1.7F, 8}, {1.7F, 1.7F, 11.4F}, 6);
    const auto velocities = random_points(800, {-1, -1, -1}, {3, 1, 1}, 7);
    State state = state_of(points, velocities);
    state.time_step = 1.0 / 120;
    const auto momentum = [&] {
        Vec3<double> sum{};
        for (std::uint32_t i = 0; i < state.count; ++i) {
            sum += Vec3<double>{state.velocity.x[i], state.velocity.y[i], state.velocity.z[i]};
        }
        return sum;
    };
    const Vec3<double> before = momentum();
    double compression = 0;
    for (int i = 0; i < 10; ++i) {
        take_step(choice, model, ground, state);
        compression = std::max(compression, state.mean_compression);
    }
    const Vec3<double> change = momentum() - before;
    EXPECT_EQ(state.count, 800u);
    EXPECT_LT(length(change) / state.count, 1e-5) << "m/s per particle";
    EXPECT_GT(compression, 0.01) << "nothing pressed: the test would show nothing";
}

TEST(ParticleCorrections, conserve_momentum_with_stresses) {
    expect_momentum_kept(params::InternalFriction::stress, params::BackendChoice::cpu);
    expect_momentum_kept(params::InternalFriction::stress, params::BackendChoice::host);
}

TEST(ParticleCorrections, conserve_momentum_with_pair_friction) {
    expect_momentum_kept(params::InternalFriction::pair, params::BackendChoice::cpu);
    expect_momentum_kept(params::InternalFriction::pair, params::BackendChoice::host);
}

/// Forest on rough ground in the south, as elsewhere in the north.
terrain::GroundCover half_and_half(const terrain::Terrain& terrain) {
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    Grid<terrain::CoverCell> cells(terrain.elevation().geometry, {none, none, none, 0});
    for (int row = 0; row < cells.geometry.rows / 2; ++row) {
        for (int column = 0; column < cells.geometry.columns; ++column)
            cells.at(column, row) = {0.6F, 0.01F, 500, 0.05F, 0.08F};
    }
    return terrain::GroundCover(cells);
}

params::MaterialSpec everything() {
    params::MaterialSpec material;
    material.turbulent_friction = 300;
    material.turbulent_friction_thickness = 0.7;
    material.laminar_viscosity = 0.03;
    material.cohesion = 200;
    material.pore_pressure_ratio = 0.4;
    material.pore_pressure_decay_time = 0.5;
    material.inertial_friction_coefficient = 0.7;
    material.viscosity_on_ground = true;
    return material;
}

params::MaterialSpec snow() {
    params::MaterialSpec material;
    material.samosat = true;
    material.friction_coefficient = 0.155;
    material.pore_pressure_ratio = 0.2;
    return material;
}

/// Across the debris's way, just before the building.
terrain::Building net_on(const terrain::Terrain& terrain) {
    const auto net = make_barrier(terrain, "net", {{{20.4, 16}, {20.4, 24}}, 2, {}, 0.3, {}, 0.5});
    EXPECT_TRUE(net);
    return *net;
}

/// Runs a fast backend and the reference side by side over debris that falls onto a slope beside a building.
void expect_agreement(params::BackendChoice choice, params::InternalFriction friction, params::KernelChoice kernel,
                      int steps, double tolerance, const params::MaterialSpec& material = {}, bool zones = false,
                      bool net = false) {
    params::SolverSpec solver;
    solver.backend = choice;
    solver.internal_friction = friction;
    solver.kernel = kernel;
    solver.largest_time_step = 1.0 / 60;  // rounding errors grow with the step where iterations do not converge
    terrain::Building house;
    house.footprint = {testing::rectangle(20.6, 18, 24, 22)};
    house.height = 3;
    const terrain::Terrain terrain = testing::inclined_plane(25, 40, 40);
    std::vector<terrain::Building> buildings{house};
    place_buildings(terrain, buildings);
    if (net) buildings.push_back(net_on(terrain));
    Model model = make_model(material, solver, 0.4);
    Ground ground(terrain, buildings, model.support_radius);
    if (zones) model.cover = half_and_half(terrain);
    Result<State> seeded =
        seed_releases(model, ground, {testing::block(terrain, testing::rectangle(17.5, 18.5, 20.5, 21.5), 1.2)});
    ASSERT_TRUE(seeded);
    Simulation simulation(std::move(model), std::move(ground), *std::move(seeded));
    reference::State exact(simulation.state());
    reference::Backend backend;
    StageTimes times;
    for (int i = 0; i < steps; ++i) {
        EXPECT_TRUE(simulation.advance());
        exact.time_step = simulation.state().time_step;
        step(backend, simulation.model(), simulation.ground(), exact, times);
    }
    const State& state = simulation.state();
    double worst = 0;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const auto& p = exact.particles[state.id[i]].position;
        const LocalPoint q = state.position.at(i);
        worst = std::max(worst, length(Vector{q.x - p.x, q.y - p.y, q.z - p.z}));
    }
    EXPECT_EQ(simulation.backend(), choice);
    EXPECT_LT(worst, tolerance) << "m";
    EXPECT_FALSE(state.building_contacts.empty()) << "the building was never touched";
    if (!net) return;
    EXPECT_TRUE(std::any_of(state.building_contacts.begin(), state.building_contacts.end(),
                            [](const BuildingContact& contact) { return contact.building == 1; }))
        << "the net was never touched";
}

/// An instruction set of the processor; or the kernels of a device, run by plain loops ("host") or by a graphics card
/// ("cuda"), if there is one.
class InstructionSet : public ::testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        const std::string name = GetParam();
        if (name == "host") backend = params::BackendChoice::host;
        if (name == "cuda") backend = params::BackendChoice::cuda;
        if (const Status usable = check_backend(backend); !usable) GTEST_SKIP() << usable.error().message;
        if (backend != params::BackendChoice::cpu) return;
        const Status chosen = simd::choose_instruction_set(GetParam());
        if (!chosen) GTEST_SKIP() << chosen.error().message;
        const Model model = make_model({}, {}, 0.4);
        ASSERT_EQ(cpu::Backend(model, 1).instruction_set(), GetParam());
    }
    params::BackendChoice backend = params::BackendChoice::cpu;

    void TearDown() override { ASSERT_TRUE(simd::choose_instruction_set(simd::instruction_sets().front())); }
};

TEST_P(InstructionSet, agrees_with_the_double_precision_reference) {
    expect_agreement(backend, params::InternalFriction::stress, params::KernelChoice::wendland_c2, 12, 2e-4);
}

TEST_P(InstructionSet, agrees_with_the_reference_where_pore_pressure_evolves) {
    params::MaterialSpec material;
    material.pore_pressure = params::PorePressure::dilatancy;
    material.permeability = 1e-9;
    material.solid_fraction = 0.58;
    material.critical_solid_fraction = 0.62;
    expect_agreement(backend, params::InternalFriction::stress, params::KernelChoice::wendland_c2, 12, 5e-4, material);
}

TEST_P(InstructionSet, agrees_with_the_reference_for_the_published_model) {
    expect_agreement(backend, params::InternalFriction::pair, params::KernelChoice::poly6_spiky, 4, 2e-4);
}

TEST_P(InstructionSet, agrees_with_the_reference_for_the_other_kernels) {
    expect_agreement(backend, params::InternalFriction::stress, params::KernelChoice::cubic_spline, 4, 2e-4);
    expect_agreement(backend, params::InternalFriction::stress, params::KernelChoice::spiky, 4, 2e-4);
}

TEST_P(InstructionSet, agrees_with_the_reference_for_every_resistance) {
    expect_agreement(backend, params::InternalFriction::stress, params::KernelChoice::wendland_c2, 12, 2e-4,
                     everything(), true);
}

TEST_P(InstructionSet, agrees_with_the_reference_for_samosat) {
    expect_agreement(backend, params::InternalFriction::stress, params::KernelChoice::wendland_c2, 12, 2e-4, snow());
}

TEST_P(InstructionSet, agrees_with_the_reference_for_a_net) {
    expect_agreement(backend, params::InternalFriction::stress, params::KernelChoice::wendland_c2, 12, 2e-4, {}, false,
                     true);
    expect_agreement(backend, params::InternalFriction::pair, params::KernelChoice::poly6_spiky, 4, 2e-4, {}, false,
                     true);
}

/// Beyond that which every build has and every processor can.
using FasterInstructionSet = InstructionSet;

TEST_P(FasterInstructionSet, gives_the_same_bits_as_the_baseline) {
    const std::string baseline = simd::instruction_sets().back();
    const auto hash_after = [](const std::string& set, params::InternalFriction friction,
                               const params::MaterialSpec& material = {}, bool net = false) {
        EXPECT_TRUE(simd::choose_instruction_set(set));
        params::SolverSpec solver;
        solver.internal_friction = friction;
        const terrain::Terrain terrain = testing::terrain_of(
            40, 40, 1, [](double x, double y) { return 20 - 0.5 * x + 0.3 * std::sin(x) * std::cos(0.7 * y); });
        terrain::Building house;
        house.footprint = {testing::rectangle(20.6, 18, 24, 22)};
        house.height = 3;
        std::vector<terrain::Building> buildings{house};
        place_buildings(terrain, buildings);
        if (net) buildings.push_back(net_on(terrain));
        Model model = make_model(material, solver, 0.3);
        Ground ground(terrain, buildings, model.support_radius);
        Result<State> seeded =
            seed_releases(model, ground, {testing::block(terrain, testing::rectangle(17.5, 18.5, 20.5, 21.5), 1.2)});
        Simulation simulation(std::move(model), std::move(ground), *std::move(seeded));
        EXPECT_EQ(simulation.instruction_set(), set);
        for (int i = 0; i < 30; ++i) EXPECT_TRUE(simulation.advance());
        return hash_state(simulation.state());
    };
    for (const params::InternalFriction friction : {params::InternalFriction::stress, params::InternalFriction::pair}) {
        EXPECT_EQ(hash_after(GetParam(), friction), hash_after(baseline, friction));
        EXPECT_EQ(hash_after(GetParam(), friction, {}, true), hash_after(baseline, friction, {}, true));
    }
    EXPECT_EQ(hash_after(GetParam(), params::InternalFriction::stress, everything()),
              hash_after(baseline, params::InternalFriction::stress, everything()));
    EXPECT_EQ(hash_after(GetParam(), params::InternalFriction::stress, snow()),
              hash_after(baseline, params::InternalFriction::stress, snow()));
    EXPECT_NE(hash_after(GetParam(), params::InternalFriction::stress, everything()),
              hash_after(GetParam(), params::InternalFriction::stress));
}

const auto name_of_set = [](const auto& set) { return std::string(set.param); };
INSTANTIATE_TEST_SUITE_P(CpuBackend, InstructionSet, ::testing::Values("SCALAR", "SSE4", "AVX2", "AVX3"), name_of_set);
INSTANTIATE_TEST_SUITE_P(DeviceBackend, InstructionSet, ::testing::Values("host", "cuda"), name_of_set);
INSTANTIATE_TEST_SUITE_P(CpuBackend, FasterInstructionSet, ::testing::Values("SSE4", "AVX2", "AVX3"), name_of_set);

TEST(InstructionSets, that_are_not_there_are_refused_by_name) {
    const Model model = make_model({}, {}, 0.4);
    const std::string baseline = simd::instruction_sets().back();
    ASSERT_TRUE(simd::choose_instruction_set(baseline));
    for (const char* name : {"", "avx2", "AVX4"}) {
        const Status chosen = simd::choose_instruction_set(name);
        ASSERT_FALSE(chosen);
        EXPECT_EQ(chosen.error().message.find(fmt::format("the instruction set \"{}\" is refused", name)), 0U);
        EXPECT_NE(chosen.error().message.find(baseline), std::string::npos) << "what there is";
        EXPECT_EQ(cpu::Backend(model, 1).instruction_set(), baseline) << "as before";
    }
    for (const std::string& name : simd::instruction_sets()) {
        ASSERT_TRUE(simd::choose_instruction_set(name));
        EXPECT_EQ(cpu::Backend(model, 1).instruction_set(), name);
    }
    ASSERT_TRUE(simd::choose_instruction_set(simd::instruction_sets().front()));
}

}  // namespace
}  // namespace talus::sim
