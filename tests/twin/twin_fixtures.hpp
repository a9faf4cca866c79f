#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/value_of.hpp"
#include "terrain/release.hpp"
#include "twin/answers.hpp"
#include "twin/live_run.hpp"
#include "twin/results.hpp"
#include "twin/scenario.hpp"

/// Small scenes, made without files.
namespace talus::twin::test {

using nlohmann::json;

inline Polygon rectangle(double x_min, double y_min, double x_max, double y_max) {
    return {{{x_min, y_min}, {x_max, y_min}, {x_max, y_max}, {x_min, y_max}}, {}};
}
inline json ring(double x_min, double y_min, double x_max, double y_max) {
    return {{x_min, y_min}, {x_max, y_min}, {x_max, y_max}, {x_min, y_max}};
}

/// Far from 0, as national grids are: coordinates that are not taken relative to the origin would show.
inline constexpr double west = 824000, south = 825000;

/// A channel that falls to the east, 120 m x 60 m: 30 degrees for 50 m, then flat; banks of 1 : 2 on both sides of its
/// floor of 12 m. 4 m x 8 m of its upper end are released, 1.2 m thick.
inline scene::Scene channel_scene() {
    scene::Scene scene;
    scene.file = "channel.toml";
    scene.spec.scene.title = "Channel";
    Grid<float> grid(GridGeometry{west, south, 1, 120, 60});
    for (int row = 0; row < 60; ++row) {
        for (int column = 0; column < 120; ++column) {
            const PlanPoint p = grid.geometry.centre(column, row);
            const double along = p.x - west, across = std::max(0.0, std::abs(p.y - south - 30) - 6);
            grid.at(column, row) = static_cast<float>(std::max(0.0, 50 - along) * std::tan(M_PI / 6) + across / 2);
        }
    }
    scene.terrain = terrain::Terrain(std::move(grid));
    terrain::Release release;
    release.name = "scar";
    release.patches.push_back({rectangle(west + 8, south + 26, west + 16, south + 34), 1.2});
    release.volume = release_volume(scene.terrain, release);
    scene.releases.push_back(release);
    scene.flow_path = terrain::FlowPath({{west + 5, south + 30}, {west + 115, south + 30}}, 40);
    scene.spec.solver.particle_spacing = 0.6;
    scene.spec.solver.thread_count = 2;
    scene.spec.solver.end_time = 30;
    scene.spec.material.friction_coefficient = 0.25;
    return scene;
}

inline void add_building(scene::Scene& scene, const std::string& name, const Polygon& footprint, double height) {
    std::vector<terrain::Building> placed(1);
    placed[0].name = name;
    placed[0].footprint = {footprint};
    placed[0].height = height;
    place_buildings(scene.terrain, placed);
    scene.buildings.push_back(placed[0]);
}

inline std::unique_ptr<Scenario> open(scene::Scene scene, ScenarioOptions options = {}) {
    return talus::test::value_of(
        Scenario::open(std::make_shared<const scene::Scene>(std::move(scene)), std::move(options)));
}

/// Until a time, or until it is not ready.
inline void run_until(Scenario& scenario, double time) {
    while (scenario.phase() == run::RunPhase::ready && scenario.time() < time) scenario.advance();
}

inline Done act(Scenario& scenario, const json& action) {
    const Result<Done> done = scenario.apply(action, "Ann");
    EXPECT_TRUE(done) << action << ": " << (done ? "" : done.error().message);
    return done ? *done : Done{};
}

/// The error; nothing may have changed.
inline std::string refusal(Scenario& scenario, const json& action) {
    const json setup = setup_json(scenario), state = state_json(scenario);
    const Result<Done> done = scenario.apply(action, "Ann");
    EXPECT_FALSE(done) << action;
    EXPECT_EQ(setup_json(scenario), setup);
    EXPECT_EQ(state_json(scenario), state);
    return done ? "" : done.error().message;
}

/// released + entrained = held + moving + deposited + left.
inline void expect_balance(const Scenario& scenario) {
    const json s = state_json(scenario);
    const double sum = s["volume_held_m3"].get<double>() + s["volume_moving_m3"].get<double>() +
                       s["volume_deposited_m3"].get<double>() + s["volume_left_m3"].get<double>();
    EXPECT_NEAR(s["volume_released_m3"].get<double>() + s["volume_entrained_m3"].get<double>(), sum, 1e-9 * sum);
}

/// A layer as it is now.
inline Grid<float> layer(const Scenario& scenario, const char* name) {
    return (*layer_of(scenario, name))();
}

/// Of the state, as in the journal.
inline std::uint64_t hash(const Scenario& scenario) {
    return hash_state(scenario.run().state());
}

/// A number of the state.
inline double number(const Scenario& scenario, const char* key) {
    return state_json(scenario).at(key).get<double>();
}

}  // namespace talus::twin::test
