#include "sim/sources/seed.hpp"

#include <gtest/gtest.h>

#include "sim/physics/contact.hpp"
#include "sim_fixtures.hpp"

namespace talus::sim {
namespace {

using testing::block;
using testing::inclined_plane;
using testing::rectangle;

TEST(Seeding, matches_the_requested_volume_within_one_per_cent) {
    for (const double degrees : {0.0, 20.0, 40.0}) {
        const terrain::Terrain terrain = inclined_plane(degrees, 40, 30);
        const terrain::Release release = block(terrain, rectangle(5.3, 5.1, 12.9, 11.7), 1.1);
        Model model = make_model({}, {}, 0.33);
        const Ground ground(terrain);
        const Result<State> state = seed_releases(model, ground, {release});
        ASSERT_TRUE(state.ok());
        EXPECT_NEAR(state->count * model.particle_volume() / release.volume, 1, 0.01);
    }
}

TEST(Seeding, starts_at_rest_without_jumping_apart) {
    const terrain::Terrain terrain = inclined_plane(0, 30, 30);
    params::SolverSpec solver;
    Simulation simulation =
        testing::simulate({}, solver, terrain, {block(terrain, rectangle(10, 10, 18, 18), 1.2)}, 0.4);
    EXPECT_EQ(simulation.state().max_speed, 0) << "m/s";
    const double before = potential_energy(simulation.model(), simulation.state());
    double highest = before, fastest = 0;
    for (int i = 0; i < 20; ++i) {
        ASSERT_TRUE(simulation.advance());
        highest = std::max(highest, potential_energy(simulation.model(), simulation.state()));
        fastest = std::max(fastest, simulation.state().max_speed);
    }
    EXPECT_LT(highest, before * 1.001);
    EXPECT_LT(fastest, 9.81 * simulation.state().time) << "m/s: the rim may crumble, nothing may fly";
}

TEST(Seeding, puts_no_particle_into_a_building_at_the_rim) {
    const terrain::Terrain terrain = inclined_plane(20, 30, 30);
    terrain::Building house;
    house.footprint = {rectangle(11.6, 6, 15, 12)};  // over the middles of the last column
    house.height = 8;
    Simulation simulation =
        testing::simulate({}, {}, terrain, {block(terrain, rectangle(6, 6, 12, 12), 1)}, 0.5, {house});
    for (int i = 0; i < 10; ++i) {
        for (std::uint32_t k = 0; k < simulation.state().count; ++k) {
            ASSERT_TRUE(is_free(simulation.ground(), simulation.state().position.at(k))) << "before step " << i;
        }
        ASSERT_TRUE(simulation.advance());
    }
}

TEST(Seeding, a_release_whose_room_a_building_takes_is_an_error) {
    const terrain::Terrain pit = testing::terrain_of(
        30, 30, 1, [](double x, double y) { return std::max(std::abs(x - 15), std::abs(y - 15)) < 2.5 ? 0 : 40; });
    const auto seeded = [&](double house_width) {
        std::vector<terrain::Building> houses(1);
        houses[0].footprint = {rectangle(12, 12, 12 + house_width, 18)};
        houses[0].height = 60;
        place_buildings(pit, houses);
        Model model = make_model({}, {}, 1);
        return seed_releases(model, Ground(pit, houses, model.support_radius),
                             {block(pit, rectangle(13, 13, 17, 17), 2)});
    };
    EXPECT_TRUE(seeded(1.5).ok());
    const Result<State> full = seeded(4.6);
    ASSERT_FALSE(full.ok());
    EXPECT_NE(full.error().message.find("no room"), std::string::npos) << full.error().message;
}

TEST(Seeding, too_many_particles_say_how_many_and_which_spacing_fits) {
    const terrain::Terrain terrain = inclined_plane(0, 30, 30);
    params::SolverSpec solver;
    solver.particle_limit = 1000;
    Model model = make_model({}, solver, 0.1);
    const Ground ground(terrain);
    const Result<State> state = seed_releases(model, ground, {block(terrain, rectangle(5, 5, 15, 15), 1)});
    ASSERT_FALSE(state.ok());
    EXPECT_NE(state.error().message.find("100000 particles"), std::string::npos) << state.error().message;
    EXPECT_NE(state.error().message.find("0.465"), std::string::npos) << state.error().message;
}

TEST(Seeding, a_release_smaller_than_a_particle_is_an_error) {
    const terrain::Terrain terrain = inclined_plane(0, 30, 30);
    Model model = make_model({}, {}, 5);
    const Ground ground(terrain);
    EXPECT_FALSE(seed_releases(model, ground, {block(terrain, rectangle(5, 5, 6, 6), 1)}).ok());
}

TEST(Seeding, a_release_waits_for_its_start_time) {
    const terrain::Terrain terrain = inclined_plane(35, 60, 30);
    const terrain::Release first = block(terrain, rectangle(5, 5, 9, 9), 0.8);
    const terrain::Release second = block(terrain, rectangle(5, 18, 9, 22), 0.8, 0.5);
    Simulation simulation = testing::simulate({}, {}, terrain, {first, second}, 0.4);
    const std::uint32_t first_of_second = simulation.model().releases[1].first_particle;
    const auto fastest_of_second = [&] {
        float fastest = 0;
        for (std::uint32_t i = 0; i < simulation.state().count; ++i) {
            if (simulation.state().id[i] >= first_of_second) {
                fastest = std::max(fastest, length(simulation.state().velocity.at(i)));
            }
        }
        return fastest;
    };
    while (simulation.state().time < 0.48) ASSERT_TRUE(simulation.advance());
    EXPECT_EQ(fastest_of_second(), 0);
    EXPECT_GT(simulation.state().max_speed, 0.5);
    while (simulation.state().time < 1.0) ASSERT_TRUE(simulation.advance());
    EXPECT_GT(fastest_of_second(), 0.5);
}

}  // namespace
}  // namespace talus::sim
