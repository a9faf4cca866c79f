#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "sim/sources/seed.hpp"
#include "terrain/release.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/measure.hpp"
#include "validate/rows.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace standing_heap {

constexpr Quantity quantities[] = {
    {"height_loss", "1", false, Quantity::Site::none,
     "share of its height that a heap below its friction angle has lost at the end"},
    {"flowing_height_loss", "1", false, Quantity::Site::none,
     "share of its height that a heap above its friction angle has lost at the end"},
    {"settling_height_loss", "1", false, Quantity::Site::none,
     "share of the cone's height that is missing once the seeded lattice has settled, when the measurement begins"},
    {"residual_speed", "m/s", false, Quantity::Site::none, "mean speed at the end"},
};

struct HeapSpec {
    std::vector<double> angle_shares, time_steps;  // of the friction angle; s
    double spacing = 0;                            // m
    int height = 0;                                // spacings
    double settling_time = 0;                      // s, before the measurement
    double standing_time = 0, flowing_time = 0;    // s
};

struct Measured {
    double height_loss = not_computed, settling_loss = not_computed, residual_speed = not_computed;
    std::string problem;
    std::uint32_t particles = 0;
    std::vector<double> time, height;         // height over that at the start
    std::vector<double> distance, thickness;  // final profile, m
};

/// A cone on level ground as a release, so that it is seeded and loaded like that of a scene.
terrain::Release make_cone(const terrain::Terrain& terrain, double radius, double height) {
    terrain::Release cone;
    cone.name = "cone";
    cone.patches.push_back(
        {{{{-radius, -radius}, {radius, -radius}, {radius, radius}, {-radius, radius}}, {}}, height});
    const double cell = radius / 100;
    Grid<float> thickness(GridGeometry{-radius, -radius, cell, 200, 200});
    for (int row = 0; row < 200; ++row) {
        for (int column = 0; column < 200; ++column) {
            const PlanPoint p = thickness.geometry.centre(column, row);
            thickness.at(column, row) = static_cast<float>(std::max(0.0, height * (1 - std::hypot(p.x, p.y) / radius)));
        }
    }
    cone.thickness_raster = thickness;
    cone.volume = release_volume(terrain, cone);
    return cone;
}

Measured measure(const HeapSpec& spec, double share, double time_step, const Setting& setting, const Watch& watch) {
    Measured measured;
    const double angle = share * std::atan(params::internal_friction_of(setting.material));
    const double height = spec.height * spec.spacing, radius = height / std::tan(angle);
    const Incline flat(0, 6 * radius, 6 * radius);
    params::SolverSpec solver = setting.solver;
    solver.time_step = time_step;
    sim::Model model = sim::make_model(setting.material, solver, spec.spacing);
    sim::Ground ground(flat.terrain());
    Result<sim::State> seeded = seed_releases(model, ground, {make_cone(flat.terrain(), radius, height)});
    if (!seeded) {
        measured.problem = seeded.error().message;
        return measured;
    }
    measured.particles = seeded->count;
    Trial trial({std::move(model), std::move(ground), *std::move(seeded)}, watch);
    const sim::State& state = trial.state();
    // A heap that should flow does so from the first step; one that should stand is measured once its lattice has
    // settled.
    const double begin = share < 1 ? spec.settling_time : 0;
    if (!trial.advance_to(begin)) {
        measured.problem = trial.problem();
        return measured;
    }
    const double start = top_of(trial.model(), state);
    const double duration = share < 1 ? spec.standing_time : spec.flowing_time;
    constexpr int samples = 120;
    for (int k = 0; k <= samples; ++k) {
        if (!trial.advance_to(begin + duration * k / samples)) {
            measured.problem = trial.problem();
            return measured;
        }
        measured.time.push_back(state.time);
        measured.height.push_back(top_of(trial.model(), state) / start);
    }
    measured.settling_loss = 1 - start / height;
    measured.height_loss = 1 - top_of(trial.model(), state) / start;
    double speeds = 0;
    for (std::uint32_t i = 0; i < state.count; ++i) speeds += length(state.velocity.at(i));
    measured.residual_speed = speeds / state.count;

    const double cell = 2 * spec.spacing;
    const int cells = static_cast<int>(1.5 * radius / cell);
    const auto volume_per_length = thickness_profile(trial.model(), state, 0, cell, cells, 1, [&](std::uint32_t i) {
        return std::hypot(state.position.x[i], state.position.y[i]);
    });
    for (int k = 0; k < cells; ++k) {
        measured.distance.push_back((k + 0.5) * cell);
        measured.thickness.push_back(volume_per_length[static_cast<std::size_t>(k)] /
                                     (2 * std::numbers::pi * measured.distance.back()));
    }
    return measured;
}

Result<Outcome> compute(const HeapSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    Chart over_time{"height", "Height of the heap over time", "time, s", "height / height at the start", {}};
    Chart profiles{"profile", "Profile of the heap at the end", "distance from the axis, m", "thickness, m", {}};
    for (const double share : spec.angle_shares) {
        for (const double time_step : spec.time_steps) {
            Rows rows(watch, outcome,
                      fmt::format("{:.0f} % of the friction angle, dt = 1/{:.0f} s", 100 * share, 1 / time_step));
            const Measured m = rows.noted(measure(spec, share, time_step, setting, watch));
            rows.note(fmt::format("{} particles", m.particles));
            rows.add(share < 1 ? "height_loss" : "flowing_height_loss", m.height_loss);
            rows.add("settling_height_loss", m.settling_loss);
            rows.add("residual_speed", m.residual_speed);
            over_time.series.push_back({rows.name(), Series::Style::line, m.time, m.height});
            profiles.series.push_back({rows.name(), Series::Style::line, m.distance, m.thickness});
        }
    }
    outcome.charts = {over_time, profiles};
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    HeapSpec spec;
    spec.angle_shares = parameters.numbers("angle_shares", {.low = 0.1, .high = 2}, {0.9, 1.1});
    spec.time_steps = parameters.numbers("time_steps_s", {.low = 0, .high = 1, .low_included = false}, {1.0 / 60});
    spec.spacing = parameters.number("particle_spacing_m", positive, 0.3);
    spec.height = parameters.whole_number("height_spacings", {.low = 2, .high = 1000}, 10);
    spec.settling_time = parameters.number("settling_time_s", {.low = 0}, 3);
    spec.standing_time = parameters.number("standing_time_s", positive, 60);
    spec.flowing_time = parameters.number("flowing_time_s", positive, 20);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace standing_heap

Kind standing_heap_kind() {
    return {"standing_heap", "a cone near its friction angle that stands, or flows", standing_heap::quantities,
            standing_heap::prepare};
}

}  // namespace talus::validate
