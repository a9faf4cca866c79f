// Scenes that nobody would make: what must hold whatever the terrain, the material and the structures are.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/hash.hpp"
#include "run/run.hpp"
#include "sim/physics/net.hpp"
#include "terrain/barrier.hpp"
#include "twin/journal.hpp"
#include "twin/section_values.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

class Dice {
  public:
    explicit Dice(unsigned seed) : random_(seed) {}
    double from(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    int below(int limit) { return std::uniform_int_distribution<int>(0, limit - 1)(random_); }
    bool once_in(int times) { return below(times) == 0; }

  private:
    std::mt19937 random_;
};

constexpr int abused_columns = 60, abused_rows = 40;

/// A slope to the east with spikes, pits, walls, steps and holes.
Grid<float> rough_terrain(Dice& dice) {
    Grid<float> grid(GridGeometry{west, south, 1, abused_columns, abused_rows});
    const double slope = dice.from(0.1, 1.2), roughness = dice.from(0, 0.4);
    for (int row = 0; row < abused_rows; ++row) {
        for (int column = 0; column < abused_columns; ++column) {
            grid.at(column, row) = static_cast<float>(100 - slope * column + roughness * dice.from(-1, 1));
        }
    }
    for (int k = dice.below(12); k > 0; --k) {
        const int column = dice.below(abused_columns), row = dice.below(abused_rows), length = 1 + dice.below(8);
        const auto height = static_cast<float>(dice.from(-15, 15));
        const bool hole = dice.once_in(3) && column > 20, lengthways = dice.once_in(2);
        for (int i = 0; i < length; ++i) {
            const int c = std::min(abused_columns - 1, column + (lengthways ? i : 0));
            const int r = std::min(abused_rows - 1, row + (lengthways ? 0 : i));
            float& z = grid.at(c, r);
            z = hole ? std::numeric_limits<float>::quiet_NaN() : z + height;
        }
    }
    if (dice.once_in(3)) {  // a step across
        const int from = 20 + dice.below(30);
        const auto drop = static_cast<float>(dice.from(-5, 20));
        for (int row = 0; row < abused_rows; ++row) {
            for (int column = from; column < abused_columns; ++column) grid.at(column, row) -= drop;
        }
    }
    return grid;
}

scene::Scene abused_scene(unsigned seed) {
    Dice dice(seed);
    scene::Scene scene = channel_scene();
    scene.terrain = terrain::Terrain(rough_terrain(dice));
    terrain::Release& release = scene.releases.front();
    release.patches.front() = {
        rectangle(west + 3, south + 15, west + 3 + dice.from(4, 10), south + 15 + dice.from(4, 10)), dice.from(0.5, 3)};
    release.volume = release_volume(scene.terrain, release);
    scene.flow_path = {};
    params::MaterialSpec& material = scene.spec.material;
    material.friction_coefficient = dice.from(0, 1);
    material.viscosity = dice.from(0, 0.5);
    if (dice.once_in(2)) material.turbulent_friction = dice.from(50, 2000);
    if (dice.once_in(3)) material.laminar_viscosity = dice.from(0, 0.2);
    if (dice.once_in(3)) material.cohesion = dice.from(0, 5000);
    if (dice.once_in(3)) material.pore_pressure_ratio = dice.from(0, 0.9);
    if (dice.once_in(3)) material.internal_friction_coefficient = dice.from(0, 1);
    scene.spec.solver.particle_spacing = 1;
    scene.spec.solver.end_time = 60;
    for (int k = dice.below(4); k > 0; --k) {
        const double x = west + dice.from(15, 50), y = south + dice.from(8, 30);
        if (dice.once_in(2)) {
            add_building(scene, "house", rectangle(x, y, x + dice.from(1, 6), y + dice.from(1, 6)), dice.from(0.5, 10));
            if (!std::isfinite(scene.buildings.back().roof_elevation)) scene.buildings.pop_back();
            continue;
        }
        params::BarrierSpec shape;
        shape.line = {{x, y}, {x + dice.from(-3, 3), std::min(y + dice.from(2, 12), south + abused_rows - 3)}};
        shape.height = dice.from(1, 6);
        shape.thickness = dice.from(0.5, 2);
        if (dice.once_in(3)) shape.passing_share = dice.from(0, 0.8);
        const auto barrier = make_barrier(scene.terrain, "dam", shape);
        if (barrier) scene.buildings.push_back(*barrier);
    }
    return scene;
}

void expect_sound(const run::Run& run) {
    const sim::State& state = run.state();
    const terrain::Terrain& terrain = run.ground().terrain;
    ASSERT_EQ(state.seeded, state.count + state.outflow + state.removed);
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const LocalPoint p = state.position.at(i), v = state.velocity.at(i);
        ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) << "particle " << state.id[i];
        ASSERT_TRUE(std::isfinite(dot(v, v))) << "particle " << state.id[i];
        const float ground = terrain.sample(p.x, p.y).height;
        ASSERT_FALSE(p.z < ground - 1e-3F) << "particle " << state.id[i] << " is " << ground - p.z << " m below ground";
        const auto wall = run.ground().solids.nearest(p, sim::grain_rank(state.id[i]));
        ASSERT_FALSE(wall.building >= 0 && wall.distance < -1e-3F)
            << "particle " << state.id[i] << " is " << -wall.distance << " m inside a structure";
    }
    const observe::TimeSample now = run.observer().sample(run.model(), state);
    const double there = now.volume_held + now.volume_moving + now.volume_deposited + now.volume_left;
    ASSERT_NEAR(now.volume_released + now.volume_entrained, there, 1e-9 * std::max(1.0, there));
}

/// Steps times particles; `hash`: of the state at the end.
double run_abused(unsigned seed, int threads, int steps, std::uint64_t& hash) {
    scene::Scene scene = abused_scene(seed);
    scene.spec.solver.thread_count = threads;
    const auto run = run::Run::start(scene);
    EXPECT_TRUE(run) << run.error().message;
    double particle_steps = 0;
    for (int step = 0; step < steps && (*run)->phase() == run::RunPhase::ready; ++step) {
        particle_steps += (*run)->state().count;
        (*run)->advance();
        if (step % 10 == 0) expect_sound(**run);
        if (testing::Test::HasFatalFailure()) break;
    }
    expect_sound(**run);
    EXPECT_NE((*run)->phase(), run::RunPhase::fault) << (*run)->stop_reason();
    hash = hash_state((*run)->state());
    return particle_steps;
}

double from_environment(const char* name, double otherwise) {
    const char* wanted = std::getenv(name);
    return wanted != nullptr ? std::strtod(wanted, nullptr) : otherwise;
}

/// PARTICLE_STEPS=1e9 in the environment: as many instead of a million.
double wanted_particle_steps() {
    return from_environment("PARTICLE_STEPS", 1e6);
}

/// FIRST_SEED=3663 in the environment: begins there, to repeat what a long search has found.
unsigned first_seed(unsigned otherwise) {
    return static_cast<unsigned>(from_environment("FIRST_SEED", otherwise));
}

TEST(Abuse, neither_terrain_nor_material_nor_structures_break_what_must_hold) {
    double done = 0;
    for (unsigned seed = first_seed(1); done < wanted_particle_steps(); ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        std::uint64_t one = 0, four = 0;
        done += run_abused(seed, 1, 300, one);
        if (seed % 4 == 0) {
            done += run_abused(seed, 4, 300, four);
            EXPECT_EQ(one, four) << "of 1 and 4 threads";
        }
        if (HasFailure()) break;
    }
}

/// Of a range, its ends and the values near zero as often as those between.
json any_value(Dice& dice, const params::Parameter& parameter) {
    const double low = std::max(0.0, parameter.range.low), high = std::min(1e7, parameter.range.high);
    switch (dice.below(4)) {
        case 0:
            return dice.once_in(2) ? low : high;
        case 1:
            return dice.from(low, high);
        default:
            return std::clamp(high * std::pow(10, dice.from(-6, 0)), low, high);
    }
}

std::string any_id(Dice& dice, const char* kind) {
    return fmt::format("{}-{}", kind, 1 + dice.below(3));
}

json any_action(Dice& dice) {
    const double x = west + dice.from(4, 45), y = south + dice.from(5, 28);
    const json outline = ring(x, y, x + dice.from(1, 12), y + dice.from(1, 12));
    if (dice.once_in(3)) {
        const auto& all = live_parameters();
        const params::Parameter& parameter = *all[static_cast<std::size_t>(dice.below(static_cast<int>(all.size())))];
        return {
            {"action", "set_parameter"}, {"key", "material." + parameter.key}, {"value", any_value(dice, parameter)}};
    }
    const json actions[] = {
        {{"action", "put_barrier"},
         {"line", {{x, y}, {x + dice.from(-2, 2), y + dice.from(2, 8)}}},
         {"height_m", dice.from(1, 5)},
         {"thickness_m", dice.from(0.5, 2)}},
        {{"action", "put_building"}, {"polygon", outline}, {"height_m", dice.from(1, 8)}},
        {{"action", "put_release"}, {"polygon", outline}, {"thickness_m", dice.from(0.5, 2)}},
        {{"action", "trigger_release"}, {"id", any_id(dice, "release")}},
        {{"action", "put_zone"}, {"polygon", outline}, {"friction_coefficient", dice.from(0, 2)}},
        {{"action", "put_zone"}, {"polygon", outline}, {"cohesion_Pa", std::pow(10, dice.from(0, 7))}},
        {{"action", "put_zone"}, {"polygon", outline}, {"turbulent_friction_mps2", std::pow(10, dice.from(0, 6))}},
        {{"action", "put_bed"}, {"polygon", outline}, {"thickness_m", dice.from(0.1, 2)}},
        {{"action", "remove_barrier"}, {"id", any_id(dice, "barrier")}},
        {{"action", "remove_building"}, {"id", any_id(dice, "building")}},
        {{"action", "remove_zone"}, {"id", any_id(dice, "zone")}},
        {{"action", "restart"}},
        {{"action", "undo"}},
        {{"action", "undo"}},
        {{"action", "redo"}}};
    return actions[dice.below(std::size(actions))];
}

TEST(Abuse, edits_while_it_runs_are_replayed_to_the_same_state) {
    const unsigned first = first_seed(101);
    const auto sessions = static_cast<unsigned>(std::max(4.0, wanted_particle_steps() / 1e6));
    for (unsigned seed = first; seed < first + sessions; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Dice dice(seed);
        scene::Scene made = abused_scene(seed);
        made.flow_path = terrain::FlowPath({{west + 3, south + 20}, {west + 55, south + 20}}, 20);
        const auto scene = std::make_shared<const scene::Scene>(std::move(made));
        auto opened = Scenario::open(scene);
        ASSERT_TRUE(opened) << opened.error().message;
        for (int k = 0; k < 12; ++k) {
            (void)(*opened)->apply(any_action(dice), "Ann");  // refused or done
            for (int step = dice.below(20); step > 0; --step) (*opened)->advance();
            ASSERT_NE((*opened)->phase(), run::RunPhase::fault)
                << (*opened)->message() << " after " << journal_json(**opened)["actions"] << " from "
                << journal_json(**opened)["first_setup"]["material"];
        }
        const auto journal = read_journal(journal_json(**opened).dump());
        ASSERT_TRUE(journal) << journal.error().message;
        const auto replayed = replay(*journal, scene, {});
        ASSERT_TRUE(replayed) << replayed.error().message;
        EXPECT_EQ(replayed->hash, to_hex(hash(**opened)));
    }
}

}  // namespace
}  // namespace talus::twin::test
