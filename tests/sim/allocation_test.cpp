#include <gtest/gtest.h>

#include "sim/sources/inflow.hpp"
#include "sim_fixtures.hpp"
#include "support/allocations.hpp"

namespace talus::sim {
namespace {

using testing::block;
using testing::inclined_plane;
using testing::rectangle;
using testing::simulate;

/// Allocations of `steps` steps after `warm_up` of them.
long allocations_of(Simulation& simulation, int warm_up, int steps) {
    for (int i = 0; i < warm_up; ++i) EXPECT_TRUE(simulation.advance());
    const long before = test::allocation_count();
    for (int i = 0; i < steps; ++i) EXPECT_TRUE(simulation.advance());
    return test::allocation_count() - before;
}

TEST(Step, allocates_nothing_once_it_runs) {
    const terrain::Terrain terrain = inclined_plane(30, 60, 40);
    Simulation simulation = simulate({}, {}, terrain, {block(terrain, rectangle(6, 12, 16, 24), 1)}, 0.4);
    EXPECT_EQ(allocations_of(simulation, 30, 10), 0);
}

TEST(Step, allocates_nothing_while_debris_presses_on_a_wall) {
    const terrain::Terrain terrain = inclined_plane(30, 60, 40);
    terrain::Building house;
    house.footprint = {rectangle(16.5, 14, 20, 22)};
    house.height = 3;
    Simulation simulation = simulate({}, {}, terrain, {block(terrain, rectangle(6, 12, 16, 24), 1)}, 0.4, {house});
    EXPECT_EQ(allocations_of(simulation, 100, 20), 0);
    EXPECT_GT(simulation.state().building_contacts.size(), 20U) << "the wall was hardly touched";
}

TEST(Step, allocates_nothing_while_debris_flows_in) {
    const terrain::Inflow gully{"gully", {20, 17}, {20, 23}, {{0, 30, 4}, {60, 30, 4}}};
    const terrain::Inflow spring{"spring", {}, {}, {{0, 10, 1}, {60, 10, 1}}, {rectangle(30, 17, 36, 23)}};
    const Model model = make_model({}, {}, testing::fine_spacing);
    const Ground ground(inclined_plane(25));
    Simulation simulation(model, ground, State{}, InflowFeeder(model, ground.terrain.frame(), {gully, spring}));
    EXPECT_EQ(allocations_of(simulation, 100, 0), 0);
    const std::uint32_t before = simulation.state().count;
    EXPECT_EQ(allocations_of(simulation, 0, 50), 0);
    EXPECT_GT(simulation.state().count, before + 50) << "hardly anything came in";
}

TEST(Step, allocates_nothing_while_debris_picks_up_its_bed) {
    const terrain::Terrain terrain = inclined_plane(25);
    params::MaterialSpec moving;
    moving.friction_coefficient = 0.2;
    Model model = make_model(moving, {}, testing::coarse_spacing);
    Ground ground(terrain);
    Result<State> state = seed_releases(model, ground, {block(terrain, rectangle(8, 15, 14, 25), 1.5)});
    terrain::BedMaterial growing, sheared;
    growing.growth_rate = 0.02;
    sheared.law = params::EntrainmentLaw::shear;
    sheared.critical_shear_stress = 1000;
    sheared.erosion_rate = 0.1;
    sheared.depth_per_shear = 1e-5;
    const std::size_t cells = terrain.elevation().values.size();
    ground.bed = {{growing, sheared},
                  std::vector<std::uint8_t>(cells, 1),
                  std::vector<float>(cells, 1),
                  std::vector<float>(cells, 0)};
    for (std::size_t cell = 0; cell < cells; cell += 2) ground.bed.material_at[cell] = 2;
    Simulation simulation(std::move(model), std::move(ground), *std::move(state));
    EXPECT_EQ(allocations_of(simulation, 120, 0), 0);
    const std::uint32_t before = simulation.state().entrained;
    // Its lists grow when more comes loose in a step than ever before, not in every step.
    EXPECT_LT(allocations_of(simulation, 0, 40), 4);
    EXPECT_GT(simulation.state().entrained, before + 10) << "hardly anything came loose";
}

}  // namespace
}  // namespace talus::sim
