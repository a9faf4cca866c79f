#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/angle.hpp"
#include "core/try.hpp"
#include "depth/material.hpp"
#include "run/depth_grid.hpp"
#include "scene/scene.hpp"
#include "sim/sources/seed.hpp"
#include "terrain/release.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace energy_line {

constexpr Quantity quantities[] = {
    {"energy_line", "1", false, Quantity::Site::none,
     "largest change of z + u^2 / 2g + s f, averages over the mass, over the largest drop"},
    {"energy_line_with_curvature", "1", false, Quantity::Site::none,
     "the same with the share of friction that bent ground adds: f times the ground's whole normal force"},
};

enum class Surface { plane, bowl, scene };

struct EnergySpec {
    Surface surface = Surface::plane;
    double slope = 0;                // rad, of the plane
    double radius = 0, start = 0;    // m, of the bowl; rad from its bottom
    double side = 0, thickness = 0;  // m, of the block that is released
    double spacing = 0, time = 0;    // m, s
    std::filesystem::path scene;
};

struct World {
    terrain::Terrain terrain;
    std::vector<terrain::Release> releases;
};

terrain::Release block_at(const terrain::Terrain& terrain, double x, double side, double thickness) {
    terrain::Release release;
    release.name = "block";
    const double a = x - side / 2, b = x + side / 2, half = side / 2;
    release.patches.push_back({{{{a, -half}, {b, -half}, {b, half}, {a, half}}, {}}, thickness});
    release.volume = release_volume(terrain, release);
    return release;
}

Result<World> make_world(const EnergySpec& spec) {
    if (spec.surface == Surface::scene) {
        TALUS_ASSIGN(scene::Scene scene, scene::load_scene(spec.scene));
        return World{scene.terrain, scene.releases};
    }
    World world;
    if (spec.surface == Surface::plane) {
        const double length = sim::Model{}.gravity * std::sin(spec.slope) * spec.time * spec.time + 40;
        world.terrain = make_terrain(length, 60, 1, [&](double x, double) { return -std::tan(spec.slope) * x; });
        world.releases.push_back(block_at(world.terrain, -length / 2 + 20, spec.side, spec.thickness));
    } else {
        const double across = 2 * spec.radius * std::sin(std::min(1.2 * spec.start, 1.4));
        world.terrain = make_terrain(across, across, 1, [&](double x, double y) {
            return spec.radius - std::sqrt(std::max(0.0, spec.radius * spec.radius - x * x - y * y));
        });
        world.releases.push_back(
            block_at(world.terrain, -spec.radius * std::sin(spec.start), spec.side, spec.thickness));
    }
    return world;
}

/// Sums over the path of every particle.
class Ways {
  public:
    explicit Ways(const Trial& trial) : trial_(trial), ways_(trial.state().count) { look(nullptr); }

    void after_step() {
        const double time_step = trial_.state().time_step;
        look(&time_step);
    }

    /// Averages over the mass, m: elevation, velocity head, horizontal distance, distance weighted with the normal
    /// force.
    struct Means {
        double elevation = 0, head = 0, way = 0, loaded_way = 0;
    };
    [[nodiscard]] Means means() const {
        const sim::State& state = trial_.state();
        Means m;
        for (std::uint32_t i = 0; i < state.count; ++i) {
            const LocalPoint v = state.velocity.at(i);
            m.elevation += double{state.position.z[i]} / state.count;
            m.head += dot(v, v) / (2 * trial_.model().gravity) / state.count;
            m.way += ways_[state.id[i]].way / state.count;
            m.loaded_way += ways_[state.id[i]].loaded_way / state.count;
        }
        return m;
    }

  private:
    struct Way {
        LocalPoint position, normal;
        double way = 0, loaded_way = 0;
    };

    void look(const double* time_step) {
        const sim::State& state = trial_.state();
        const double gravity = trial_.model().gravity;
        for (std::uint32_t i = 0; i < state.count; ++i) {
            Way& way = ways_[state.id[i]];
            const LocalPoint p = state.position.at(i), v = state.velocity.at(i);
            const LocalPoint normal = trial_.ground().terrain.sample(p.x, p.y).normal;
            if (time_step != nullptr) {
                const LocalPoint moved = p - way.position;
                way.way += std::hypot(moved.x, moved.y);
                // Normal force over weight: the component of gravity, and the centripetal part from the curvature of
                // the ground.
                const double force = normal.z - dot(v, normal - way.normal) / (gravity * *time_step);
                way.loaded_way += std::max(0.0, force) * length(moved);
            }
            way.position = p;
            way.normal = normal;
        }
    }

    const Trial& trial_;
    std::vector<Way> ways_;
};

/// The same means of the debris of the depth-averaged model.
class GridWays {
  public:
    explicit GridWays(const depth::Solver& solver) : solver_(solver) {}

    void after_step() {
        const Ways::Means now = means();
        way_ += now.way * solver_.time_step();
        loaded_way_ += now.loaded_way * solver_.time_step();
    }
    /// Now, with the ways so far.
    [[nodiscard]] Ways::Means now() const {
        Ways::Means m = means();
        m.way = way_;
        m.loaded_way = loaded_way_;
        return m;
    }

  private:
    /// With rates of the ways, m/s.
    [[nodiscard]] Ways::Means means() const {
        const GridGeometry& g = solver_.geometry();
        const double gravity = solver_.material().gravity;
        Ways::Means m;
        double all = 0;
        for (int row = 1; row + 1 < g.rows; ++row) {
            for (int column = 1; column + 1 < g.columns; ++column) {
                const double depth = solver_.depth_at(column, row);
                if (!(depth > 0)) continue;
                const double u = solver_.u_at(column, row), v = solver_.v_at(column, row);
                const double slope_x = solver_.slope_x_at(column, row), slope_y = solver_.slope_y_at(column, row);
                const double w = u * slope_x + v * slope_y, square = u * u + v * v + w * w;
                const double turn_x = solver_.slope_x_at(column + 1, row) - solver_.slope_x_at(column - 1, row);
                const double turn_y = solver_.slope_y_at(column, row + 1) - solver_.slope_y_at(column, row - 1);
                const double turn_xy = solver_.slope_x_at(column, row + 1) - solver_.slope_x_at(column, row - 1);
                const double bent = (u * u * turn_x + 2 * u * v * turn_xy + v * v * turn_y) / (2 * g.cell);
                const double stretch = std::sqrt(1 + slope_x * slope_x + slope_y * slope_y);
                all += depth;
                m.elevation += depth * (solver_.bed_at(column, row) + depth / 2);
                m.head += depth * square / (2 * gravity);
                m.way += depth * std::hypot(u, v);
                m.loaded_way += depth * std::max(0.0, 1 + bent / gravity) / stretch * std::sqrt(square);
            }
        }
        return {m.elevation / all, m.head / all, m.way / all, m.loaded_way / all};
    }

    const depth::Solver& solver_;
    double way_ = 0, loaded_way_ = 0;
};

void compute_grid(const EnergySpec& spec, const World& world, const Setting& setting, const Watch& watch,
                  Outcome& outcome) {
    const std::string name = "depth-averaged";
    watch.say(name);
    scene::Scene scene;
    scene.terrain = world.terrain;
    scene.spec.solver.grid_cell = world.terrain.cell() / std::ceil(world.terrain.cell() / (2 * spec.spacing));
    const run::GridGround ground = run::grid_ground(scene);
    depth::Solver solver(ground.bed, depth::material_of(setting.material));
    for (const terrain::Release& release : world.releases) solver.add(run::grid_release(scene, release, ground));
    GridWays ways(solver);
    const Ways::Means first = ways.now();
    double drop = 0, worst = 0, worst_loaded = 0;
    Series line{"depth-averaged", Series::Style::line, {}, {}};
    while (solver.time() < spec.time - 1e-9 && !(solver.volume_left() > 0)) {
        const Status stepped = solver.advance(spec.time - solver.time());
        if (!stepped || watch.stopped()) {
            outcome.notes.push_back(name + ": " + (stepped ? "stopped by the user" : stepped.error().message));
            return;
        }
        ways.after_step();
        const Ways::Means now = ways.now();
        const double friction = setting.material.friction_coefficient;
        const double plain = now.elevation + now.head + friction * now.way - first.elevation;
        const double whole = now.elevation + now.head + friction * now.loaded_way - first.elevation;
        drop = std::max(drop, first.elevation - now.elevation);
        if (std::abs(plain) > std::abs(worst)) worst = plain;
        if (std::abs(whole) > std::abs(worst_loaded)) worst_loaded = whole;
        if (solver.time() < spec.time / 200 * static_cast<double>(line.x.size())) continue;
        line.x.push_back(solver.time());
        line.y.push_back(whole);
    }
    if (solver.volume_left() > 0) outcome.notes.push_back(name + ": counted until debris left the terrain");
    outcome.measurements.push_back({"energy_line", name, worst / drop, {}});
    outcome.measurements.push_back({"energy_line_with_curvature", name, worst_loaded / drop, {}});
    outcome.charts.back().series.push_back(std::move(line));
}

Result<Outcome> compute(const EnergySpec& spec, const Setting& setting, const Watch& watch) {
    TALUS_ASSIGN(World world, make_world(spec));
    sim::Model model = sim::make_model(setting.material, setting.solver, spec.spacing);
    sim::Ground ground(world.terrain);
    TALUS_ASSIGN(sim::State seeded, seed_releases(model, ground, world.releases));
    Trial trial({std::move(model), std::move(ground), std::move(seeded)}, watch);
    const sim::State& state = trial.state();
    const double friction = setting.material.friction_coefficient;

    Ways ways(trial);
    const Ways::Means first = ways.means();
    double drop = 0, worst = 0, worst_loaded = 0;
    Series line{"z + u² / 2g + s f", Series::Style::line, {}, {}};
    Series loaded{"with the curvature's share", Series::Style::line, {}, {}};
    Series elevation{"z", Series::Style::line, {}, {}}, start{"at the start", Series::Style::dashed, {}, {}};
    const double unit_time = spec.time / 200;
    const auto look = [&] {
        if (state.outflow > 0) return;  // averages over the remaining debris would be meaningless
        ways.after_step();
        const Ways::Means now = ways.means();
        const double plain = now.elevation + now.head + friction * now.way - first.elevation;
        const double whole = now.elevation + now.head + friction * now.loaded_way - first.elevation;
        drop = std::max(drop, first.elevation - now.elevation);
        if (std::abs(plain) > std::abs(worst)) worst = plain;
        if (std::abs(whole) > std::abs(worst_loaded)) worst_loaded = whole;
        if (state.time < unit_time * static_cast<double>(line.x.size())) return;
        for (Series* series : {&line, &loaded, &elevation, &start}) series->x.push_back(state.time);
        line.y.push_back(plain);
        loaded.y.push_back(whole);
        elevation.y.push_back(now.elevation - first.elevation);
        start.y.push_back(0);
    };
    const bool trusted = trial.advance_to(spec.time, look);
    Outcome outcome;
    outcome.notes.push_back(fmt::format("{} particles, largest drop {:.1f} m", state.seeded, drop));
    if (!trusted) outcome.notes.push_back(trial.problem());
    if (state.outflow > 0) outcome.notes.emplace_back("counted until the first particle left the terrain");
    outcome.measurements = {{"energy_line", "", trusted ? worst / drop : not_computed, {}},
                            {"energy_line_with_curvature", "", trusted ? worst_loaded / drop : not_computed, {}}};
    outcome.charts.push_back(
        {"energy", "Energy line of the mass, above its start", "time, s", "m", {start, line, loaded, elevation}});
    compute_grid(spec, world, setting, watch, outcome);
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    constexpr params::Range angles{.low = 1, .high = 70};
    EnergySpec spec;
    const std::string ground = parameters.choice("ground", {"plane", "bowl", "scene"}, "plane");
    if (ground == "bowl") spec.surface = Surface::bowl;
    if (ground == "scene") {
        spec.surface = Surface::scene;
        spec.scene = parameters.path("scene");
    }
    spec.slope = parameters.number("slope_deg", angles, 30) * radians_per_degree;
    spec.radius = parameters.number("bowl_radius_m", positive, 150);
    spec.start = parameters.number("bowl_start_deg", angles, 35) * radians_per_degree;
    spec.side = parameters.number("block_side_m", positive, 6);
    spec.thickness = parameters.number("block_thickness_m", positive, 0.9);
    spec.spacing = parameters.number("particle_spacing_m", positive, 0.3);
    spec.time = parameters.number("time_s", positive, 8);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace energy_line

Kind energy_line_kind() {
    return {"energy_line", "energy of a mass slowed by Coulomb friction only", energy_line::quantities,
            energy_line::prepare};
}

}  // namespace talus::validate
