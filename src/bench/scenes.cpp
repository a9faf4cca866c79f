#include "bench/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "scene/scene.hpp"
#include "sim/sources/seed.hpp"
#include "terrain/buildings.hpp"
#include "terrain/release.hpp"
#include "terrain/terrain.hpp"

namespace talus::bench {
namespace {

constexpr double usual_speed = 3;  // m/s down the slope: fast enough for friction and viscosity to act

/// A scene before it is filled with particles.
struct World {
    terrain::Terrain terrain;
    std::vector<terrain::Building> buildings;
    std::vector<terrain::Release> releases;
    terrain::FlowPath flow_path;
    params::MaterialSpec material;
    params::SolverSpec solver;
    params::OutputSpec outputs;
    double spacing = 0;  ///< m
    double speed = 0;    ///< m/s down the slope
};

/// Ground around the world's origin, with cells of 1 m.
terrain::Terrain make_terrain(double x_min, double x_max, double y_max, double slope) {
    const int columns = static_cast<int>(std::ceil(x_max - x_min)), rows = 2 * static_cast<int>(std::ceil(y_max));
    Grid<float> grid(GridGeometry{x_min, -rows / 2.0, 1, columns, rows});
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            grid.at(column, row) = static_cast<float>(-std::tan(slope) * (grid.geometry.centre(column, row).x - x_min));
        }
    }
    return terrain::Terrain(std::move(grid));
}

Polygon rectangle(double x_min, double y_min, double x_max, double y_max) {
    return {{{x_min, y_min}, {x_max, y_min}, {x_max, y_max}, {x_min, y_max}}, {}};
}

terrain::Building house(double x_min, double y_min, double edge) {
    terrain::Building house;
    house.name = "house";
    house.footprint = {rectangle(x_min, y_min, x_min + edge, y_min + edge)};
    house.height = 6;
    return house;
}

terrain::Release block(const Polygon& outline, double thickness) {
    terrain::Release release;
    release.name = "block";
    release.patches.push_back({outline, thickness});
    return release;
}

World slab(int particles) {
    constexpr double slope = 25 * M_PI / 180, layers = 10;
    World world;
    world.spacing = 0.2;
    world.speed = usual_speed;
    const double thickness = layers * world.spacing;  // normal to the slope
    // Twice as long as wide, in whole columns of particles.
    const double columns = particles * std::cos(slope) / layers, across = std::round(std::sqrt(columns / 2));
    const double width = across * world.spacing, length = std::round(columns / across) * world.spacing;
    world.terrain = make_terrain(-length - 10, 60, width / 2 + 15, slope);
    world.releases = {block(rectangle(-length, -width / 2, 0, width / 2), thickness)};
    for (const double middle : {-width / 4, width / 4}) {
        world.buildings.push_back(house(world.spacing, middle - width / 12, width / 6));
    }
    world.flow_path = terrain::FlowPath({{-length - 5, 0}, {55, 0}}, width + 20);
    return world;
}

World column(int particles) {
    constexpr double highest = 24;  // layers: a few iterations could not support more
    World world;
    world.spacing = 0.1;
    const double across = std::round(std::sqrt(particles / std::min(std::cbrt(particles), highest)));
    const double height = particles / (across * across) * world.spacing, width = across * world.spacing;
    const double reach = width / 2 + 5 * height + 5;
    world.terrain = make_terrain(-reach, reach, reach, 0);
    world.releases = {block(rectangle(-width / 2, -width / 2, width / 2, width / 2), height)};
    world.buildings = {house(width / 2 + world.spacing, -width / 4, width / 2)};
    world.flow_path = terrain::FlowPath({{0, 0}, {reach - 1, 0}}, 2 * reach);
    return world;
}

Result<World> sham_tseng(int particles, const std::filesystem::path& builtin_scene) {
    TALUS_ASSIGN(scene::Scene scene,
                 scene::load_scene(builtin_scene, {"variant=paper"}));  // the same laws as in the other scenes
    World world;
    world.terrain = std::move(scene.terrain);
    world.buildings = std::move(scene.buildings);
    world.releases = std::move(scene.releases);
    world.flow_path = std::move(scene.flow_path);
    world.material = scene.spec.material;
    world.solver = scene.spec.solver;
    world.outputs = scene.spec.outputs;
    world.speed = usual_speed;
    double volume = 0;
    for (const terrain::Release& release : world.releases) volume += release.volume;
    world.spacing = std::cbrt(volume / particles);
    return world;
}

/// Debris of one release, in columns on the spacing's lattice as seed_releases() stacks them.
class Stack {
  public:
    Stack(const sim::Model& model, const terrain::Terrain& terrain, const terrain::Release& release, double speed,
          sim::State& state)
        : model_(model), terrain_(terrain), release_(release), speed_(speed), state_(state) {}

    /// Adds the release's particles to the state, until that has `most`.
    void fill(std::uint32_t most) {
        const double spacing = model_.particle_spacing;
        const Extent extent = release_.extent();
        // Rounding must not add a column beyond the outline.
        const int columns = static_cast<int>(std::ceil(extent.width() / spacing - 1e-6));
        const int rows = static_cast<int>(std::ceil(extent.height() / spacing - 1e-6));
        for (int row = 0; row < rows; ++row) {
            for (int column = 0; column < columns; ++column) {
                // Rounding by an additive low-discrepancy sequence (Roberts 2018) spreads the odd particles evenly.
                double whole = 0;
                const double threshold = std::modf(column * 0.7548776662466927 + row * 0.5698402909980532, &whole);
                add_column({extent.x_min + (column + 0.5) * spacing, extent.y_min + (row + 0.5) * spacing}, threshold,
                           most);
            }
        }
    }

  private:
    void add_column(const PlanPoint& centre, double threshold, std::uint32_t most) {
        const double thickness = release_.thickness_at(centre), cosine = terrain_.slope_cosine_at(centre);
        if (!(thickness > 0) || !(cosine > 0)) return;
        const LocalPoint plan = terrain_.frame().to_local({centre.x, centre.y, 0});
        const terrain::GroundSample<float> ground = terrain_.sample(plan.x, plan.y);
        const LocalPoint velocity = downhill(ground.normal);
        const double spacing = model_.particle_spacing, depth = thickness / cosine;
        const int layers = static_cast<int>(depth / spacing + threshold);
        for (int layer = 0; layer < layers && state_.count < most; ++layer) {
            const std::uint32_t i = state_.count++;
            const double height = spacing / 2 / cosine + layer * spacing;
            state_.position.set(i, {plan.x, plan.y, static_cast<float>(ground.height + height)});
            state_.velocity.set(i, velocity);
            state_.id[i] = i;
            // The weight of the debris above, for a step of 1 s: a multiplier is pressure over density times its
            // square.
            const double above = std::max(0.0, depth - height);
            state_.multiplier[i] = static_cast<float>(-model_.gravity * cosine * cosine * above);
        }
    }

    [[nodiscard]] LocalPoint downhill(const LocalPoint& normal) const {
        const LocalPoint down = LocalPoint{0, 0, -1} + normal * normal.z;
        const float size = length(down);
        return size > 1e-4F ? down * (static_cast<float>(speed_) / size) : LocalPoint{};
    }

    const sim::Model& model_;
    const terrain::Terrain& terrain_;
    const terrain::Release& release_;
    double speed_;
    sim::State& state_;
};

Start fill(std::string_view scene, World world, int particles) {
    Start start;
    start.scene = scene;
    start.flow_path = std::move(world.flow_path);
    start.outputs = world.outputs;
    place_buildings(world.terrain, world.buildings);
    start.model = sim::make_model(world.material, world.solver, world.spacing);
    start.ground = sim::Ground(std::move(world.terrain), std::move(world.buildings), start.model.support_radius);
    // Columns on an outline make it a few particles more or fewer than requested.
    const auto most = static_cast<std::uint32_t>(1.05 * particles);
    sim::State& state = start.state;
    state.resize(most);
    for (const terrain::Release& release : world.releases) {
        const std::uint32_t first = state.count;
        Stack(start.model, start.ground.terrain, release, world.speed, state).fill(most);
        start.model.releases.push_back({release.name, 0, first, state.count});
    }
    state.seeded = state.count;
    state.resize(state.count);
    state.previous_time_step = 1;  // s, that of the multipliers
    return start;
}

}  // namespace

const std::vector<std::string>& scene_names() {
    static const std::vector<std::string> names = {"slab", "column", "sham_tseng"};
    return names;
}

Result<Start> make_start(std::string_view scene, int particles, const std::filesystem::path& builtin_scene) {
    if (scene == "slab") return fill(scene, slab(particles), particles);
    if (scene == "column") return fill(scene, column(particles), particles);
    if (scene == "sham_tseng") {
        TALUS_ASSIGN(World world, sham_tseng(particles, builtin_scene));
        return fill(scene, std::move(world), particles);
    }
    return Error{fmt::format("no scene is called '{}'; there are slab, column and sham_tseng", scene)};
}

}  // namespace talus::bench
