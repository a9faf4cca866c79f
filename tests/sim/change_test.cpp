#include "sim/change.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include "sim/sim_fixtures.hpp"

namespace talus::testing {
namespace {

/// A block on a plane steeper than its friction angle.
struct Slide {
    Slide() {
        params::MaterialSpec material;
        material.friction_coefficient = 0.2;
        sim::Model model = sim::make_model(material, {}, coarse_spacing);
        sim::Ground ground(terrain);
        Result<sim::State> state = seed_releases(model, ground, {block(terrain, rectangle(8, 15, 14, 25), 1.5)});
        simulation.emplace(std::move(model), std::move(ground), *std::move(state));
    }
    void run(int steps) {
        for (int k = 0; k < steps; ++k) {
            const Status stepped = simulation->advance();
            ASSERT_TRUE(stepped) << stepped.error().message;
        }
    }
    [[nodiscard]] sim::State more(double x_min) const {
        sim::Model model = simulation->model();
        return *seed_releases(model, simulation->ground(), {block(terrain, rectangle(x_min, 15, x_min + 3, 25), 1)});
    }

    terrain::Terrain terrain = inclined_plane(25);
    std::optional<sim::Simulation> simulation;
};

std::uint32_t with_ids_from(const sim::State& state, std::uint32_t first) {
    return static_cast<std::uint32_t>(
        std::count_if(state.id.begin(), state.id.begin() + state.count, [&](std::uint32_t id) { return id >= first; }));
}

TEST(Change, adds_more_particles_than_there_was_room_for) {
    Slide slide;
    slide.run(20);
    const std::uint32_t before = slide.simulation->state().count;
    const sim::State more = slide.more(40);
    slide.simulation->change([&](sim::Model&, sim::Ground&, sim::State& state) {
        append_particles(state, more, before);
        std::fill(state.held.begin() + before, state.held.begin() + state.count, 1);
    });
    EXPECT_EQ(slide.simulation->state().seeded, before + more.count);
    std::vector<LocalPoint> start(more.count);
    for (std::uint32_t k = 0; k < more.count; ++k) start[more.id[k]] = more.position.at(k);
    slide.simulation->change([&](sim::Model& model, sim::Ground&, sim::State&) {
        model.releases.push_back({"held", std::numeric_limits<double>::infinity(), before, before + more.count});
    });
    slide.run(20);
    const sim::State& state = slide.simulation->state();
    ASSERT_EQ(with_ids_from(state, before), more.count);
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (state.id[i] < before) continue;
        EXPECT_EQ(state.position.x[i], start[state.id[i] - before].x) << "held debris stays";
    }
    slide.simulation->change(
        [&](sim::Model& model, sim::Ground&, sim::State& s) { model.releases.back().start_time = s.time; });
    slide.run(40);
    EXPECT_GT(slide.simulation->state().max_speed, 1);
    EXPECT_EQ(std::count(slide.simulation->state().held.begin(),
                         slide.simulation->state().held.begin() + slide.simulation->state().count, 1),
              0);
}

TEST(Change, takes_particles_away_and_keeps_the_balance) {
    Slide slide;
    slide.run(20);
    const std::uint32_t before = slide.simulation->state().count;
    slide.simulation->change([&](sim::Model&, sim::Ground&, sim::State& state) { remove_particles(state, 100, 500); });
    const sim::State& state = slide.simulation->state();
    EXPECT_EQ(state.count, before - 400);
    EXPECT_EQ(state.removed, 400U);
    EXPECT_EQ(state.seeded, state.count + state.outflow + state.removed);
    EXPECT_EQ(with_ids_from(state, 100), before - 500);
    slide.run(20);
    // What was taken makes room for others, up to what there was.
    const sim::State more = slide.more(40);
    ASSERT_LE(more.count, 400U);
    slide.simulation->change([&](sim::Model&, sim::Ground&, sim::State& s) { append_particles(s, more, s.seeded); });
    slide.run(20);
    EXPECT_EQ(slide.simulation->state().count, before - 400 + more.count);
}

TEST(Change, without_any_leaves_the_run_as_it_is) {
    Slide changed, unchanged;
    for (int k = 0; k < 30; ++k) {
        changed.run(1);
        unchanged.run(1);
        changed.simulation->change([](sim::Model&, sim::Ground&, sim::State&) {});
    }
    EXPECT_EQ(hash_state(changed.simulation->state()), hash_state(unchanged.simulation->state()));
}

TEST(Change, wakes_what_lies_within) {
    sim::State state = state_of({{0, 0, 0}, {5, 0, 0}, {10, 0, 0}});
    std::fill(state.asleep.begin(), state.asleep.end(), 1);
    wake(state, {4, -1, 6, 1});
    EXPECT_EQ(state.asleep[0], 1);
    EXPECT_EQ(state.asleep[1], 0);
    EXPECT_EQ(state.asleep[2], 1);
}

TEST(Change, clears_solids_without_giving_speed_or_packing_debris) {
    Slide slide;
    slide.run(60);
    const double energy = kinetic_energy(slide.simulation->model(), slide.simulation->state());
    const LocalFrame& frame = slide.terrain.frame();
    std::vector<terrain::Building> buildings(1);
    buildings[0].footprint = {rectangle(16, 17, 18, 23)};
    buildings[0].height = 4;
    place_buildings(slide.terrain, buildings);
    const auto inside = [&] {
        const sim::Simulation& s = *slide.simulation;
        std::uint32_t count = 0;
        for (std::uint32_t i = 0; i < s.state().count; ++i) count += s.ground().solids.inside(s.state().position.at(i));
        return count;
    };
    slide.simulation->change([&](sim::Model& model, sim::Ground& ground, sim::State&) {
        ground = sim::Ground(slide.terrain, buildings, model.support_radius);
    });
    ASSERT_GT(inside(), 20U) << "the test is about debris that is in the way";
    slide.simulation->change([&](sim::Model& model, sim::Ground& ground, sim::State& state) {
        clear_solids(model, ground, state,
                     {16 - frame.origin.x, 17 - frame.origin.y, 18 - frame.origin.x, 23 - frame.origin.y});
    });
    EXPECT_EQ(inside(), 0U);
    EXPECT_LE(kinetic_energy(slide.simulation->model(), slide.simulation->state()), energy);
    slide.run(1);
    EXPECT_LT(slide.simulation->state().mean_compression, 0.02);
    EXPECT_LT(kinetic_energy(slide.simulation->model(), slide.simulation->state()), 1.03 * energy);
    slide.run(30);
}

}  // namespace
}  // namespace talus::testing
