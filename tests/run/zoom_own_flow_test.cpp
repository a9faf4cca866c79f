// The zoom without the difference between the models: fed by what crossed the boundary in a run of particles alone.
#include <cmath>
#include <cstdlib>
#include <optional>
#include <unordered_map>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "depth/solver.hpp"
#include "run/boundary_flow.hpp"
#include "run/run.hpp"
#include "run/run_scene.hpp"
#include "scene/builtin.hpp"
#include "scene/scene_folder.hpp"

namespace talus::run {
namespace {

struct OwnFlow {
    RunResult whole;
    std::vector<terrain::Inflow> inflows;
    double volume = 0;
};

/// Runs the whole event with particles and records what crosses the boundary of an area. Debris that leaves is let go.
OwnFlow run_whole(scene::Scene scene, const Polygon& area) {
    scene.zoom.reset();
    const Grid<float>& ground = scene.terrain.elevation();
    Grid<double> bed(ground.geometry);
    std::copy(ground.values.begin(), ground.values.end(), bed.values.begin());
    BoundaryFlow flow(depth::Solver(bed, {}), area);
    const auto started = test::value_of(run::Run::start(scene));
    run::Run& event = *started;
    const WorldPoint origin = event.ground().terrain.frame().origin;
    const double particle = event.model().particle_volume();
    std::unordered_map<std::uint32_t, bool> was_inside;
    for (bool more = true; more;) {
        more = event.advance();
        const sim::State& state = event.state();
        for (std::uint32_t i = 0; i < state.count; ++i) {
            const LocalPoint at = state.position.at(i), velocity = state.velocity.at(i);
            const PlanPoint place{origin.x + static_cast<double>(at.x), origin.y + static_cast<double>(at.y)};
            const bool inside = contains(area, place);
            bool& before = was_inside.try_emplace(state.id[i], inside).first->second;
            if (inside && !before) {
                flow.bring(place, state.time, particle, static_cast<double>(velocity.x),
                           static_cast<double>(velocity.y));
            }
            before = inside;
        }
    }
    return {event.result(), flow.inflows(event.model().particle_spacing), flow.volumes().in};
}

/// Force, impact pressure and first hit of the structures that took a tenth of the greatest force, in both.
void expect_alike(const RunResult& whole, const RunResult& zoomed, double limit) {
    double greatest = 0;
    for (const observe::BuildingImpact& impact : whole.observation.buildings) {
        greatest = std::max(greatest, impact.peak_force);
    }
    ASSERT_GT(greatest, 0);
    for (std::size_t k = 0; k < whole.observation.buildings.size(); ++k) {
        const observe::BuildingImpact &a = whole.observation.buildings[k], &b = zoomed.observation.buildings[k];
        if (a.peak_force < greatest / 10) continue;
        fmt::print("{}: {:.1f} and {:.1f} s, {:.1f} and {:.1f} kN, {:.1f} and {:.1f} kPa\n", a.name, a.first_hit_time,
                   b.first_hit_time, a.peak_force / 1e3, b.peak_force / 1e3, a.peak_impact_pressure / 1e3,
                   b.peak_impact_pressure / 1e3);
        EXPECT_NEAR(b.peak_force, a.peak_force, limit * a.peak_force) << a.name;
        EXPECT_NEAR(b.first_hit_time, a.first_hit_time, 0.5) << a.name;
    }
}

class ZoomFedByItsOwnFlow : public scene::SceneFolder {
  protected:
    void compare(const scene::Scene& scene, double limit) const {
        const OwnFlow own = run_whole(scene, scene.zoom.value());
        scene::Scene zoomed = scene;
        zoomed.zoom.reset();
        zoomed.releases.clear();
        zoomed.inflows = own.inflows;
        const auto result = run_scene(zoomed, {});
        ASSERT_TRUE(result) << result.error().message;
        EXPECT_NEAR(result->observation.volume_released, own.volume, 1e-6 * own.volume);
        fmt::print("{:.1f} m3 of {:.1f} m3 crossed the boundary\n", own.volume, total_volume(scene));
        expect_alike(own.whole, *result, limit);
    }
};

TEST_F(ZoomFedByItsOwnFlow, has_the_impact_of_the_whole_event) {
    write_valley(
        fmt::format("[[barrier]]\nname = \"dam\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nheight_m = 12\n"
                    "[zoom]\nstructure = \"dam\"\n",
                    west + 100, south + 70, south + 130));
    const auto scene = scene::load_scene(
        folder / "scene.toml",
        {"solver.particle_spacing_m=0.8", "solver.end_time_s=16", "material.friction_coefficient=0.2"});
    ASSERT_TRUE(scene) << scene.error().message;
    compare(*scene, 0.15);
}

/// The same at House 38; takes a minute: ZOOM_BUILTIN=1.
TEST_F(ZoomFedByItsOwnFlow, has_the_impact_of_the_whole_event_at_house_38) {
    if (std::getenv("ZOOM_BUILTIN") == nullptr) GTEST_SKIP() << "set ZOOM_BUILTIN=1 to run it";
    const auto scene = scene::load_builtin_scene(folder, {"solver.particle_spacing_m=0.3", "zoom.structure=House 38"});
    ASSERT_TRUE(scene) << scene.error().message;
    compare(*scene, 0.15);
}

}  // namespace
}  // namespace talus::run
