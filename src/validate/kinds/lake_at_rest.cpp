#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "depth/solver.hpp"
#include "sim/sources/seed.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/rows.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace lake_at_rest {

constexpr Quantity quantities[] = {
    {"depth", "m", true, Quantity::Site::none, "mean depth of the lake; its volume over its area"},
    {"unevenness", "1", false, Quantity::Site::none,
     "largest distance of a part of the surface from its mean level, in particle spacings"},
    {"residual_speed", "m/s", false, Quantity::Site::none, "mean speed at the end"},
};

struct LakeSpec {
    double length = 0, depth = 0, relief = 0;  // m; relief: maximum rise of the ground
    double spacing = 0, time = 0;              // m, s
    int width = 0, cell = 0;                   // spacings
};

/// A shape of the ground: its height over x in [-1, 1], from 0 to 1.
struct Shape {
    const char* name;
    double (*height)(double x, double riser);  ///< riser: length of a step's face over half the lake's length
};

constexpr std::array shapes = {
    Shape{"flat", [](double, double) { return 0.0; }},
    Shape{"stepped at 30 degrees",
          [](double x, double riser) {  // two equal steps
              return 0.5 * std::clamp((x + 1.0 / 3) / riser, 0.0, 1.0) +
                     0.5 * std::clamp((x - 1.0 / 3) / riser, 0.0, 1.0);
          }},
    Shape{"curved", [](double x, double) { return x * x; }},
};

struct Measured {
    double depth = not_computed, expected_depth = not_computed, unevenness = not_computed, speed = not_computed;
    std::string problem;
    std::vector<double> place, level, bed;
};

Measured measure(const LakeSpec& spec, const Shape& shape, const Setting& setting, const Watch& watch) {
    const double half = spec.length / 2, width = spec.width * spec.spacing;
    const double riser = spec.relief / 2 / std::tan(std::numbers::pi / 6) / half;
    const auto bed = [&](double x) { return spec.relief * shape.height(x / half, riser); };
    const terrain::Terrain terrain =
        make_terrain(spec.length + 4, width + 4, spec.spacing, [&](double x, double) { return bed(x); });
    std::vector<terrain::Building> walls = make_slice(terrain, width, 2 * spec.depth);
    const Extent e = terrain.elevation().geometry.extent();
    walls.push_back(make_wall(terrain, e.x_min, e.y_min, -half, e.y_max, 2 * spec.depth));
    walls.push_back(make_wall(terrain, half, e.y_min, e.x_max, e.y_max, 2 * spec.depth));
    sim::Model model = sim::make_model(setting.material, setting.solver, spec.spacing);
    sim::Ground ground(terrain, walls, model.support_radius);

    const auto columns = static_cast<int>(std::lround(spec.length / spec.spacing));
    std::vector<LocalPoint> points;
    for (int j = 0; j < spec.width; ++j) {
        for (int i = 0; i < columns; ++i) {
            const auto x = static_cast<float>(-half + (i + 0.5) * spec.spacing);
            const auto y = static_cast<float>(-width / 2 + (j + 0.5) * spec.spacing);
            const terrain::GroundSample<float> below = terrain.sample(x, y);
            const double bottom = below.height + spec.spacing / 2 / below.normal.z;
            for (double z = bottom; z + spec.spacing / 2 < spec.depth + 1e-6; z += spec.spacing) {
                points.push_back({x, y, static_cast<float>(z)});
            }
        }
    }
    const Incline flat(0, spec.length, width);
    const auto surface = [&](double, double) { return spec.depth; };
    sim::State start = state_under_weight(model, ground, points, flat, surface);
    Trial trial({std::move(model), std::move(ground), std::move(start)}, watch);
    const sim::State& state = trial.state();
    Measured measured;
    if (!trial.advance_to(spec.time)) {
        measured.problem = trial.problem();
        return measured;
    }
    double mean_bed = 0;
    constexpr int parts = 1000;
    for (int k = 0; k < parts; ++k) mean_bed += bed(-half + (k + 0.5) / parts * spec.length) / parts;
    measured.expected_depth = state.count * trial.model().particle_volume() / (spec.length * width);

    // The surface of a part: the mean of its highest particles, half as many as a layer has, plus half a spacing.
    const double cell = spec.cell * spec.spacing;
    const int cells = static_cast<int>(spec.length / cell + 1e-6);
    std::vector<std::vector<double>> elevations(static_cast<std::size_t>(cells));
    double speeds = 0;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const double at = (state.position.x[i] + half) / cell;
        if (at >= 0 && at < cells) elevations[static_cast<std::size_t>(at)].push_back(state.position.z[i]);
        speeds += length(state.velocity.at(i));
    }
    measured.speed = speeds / state.count;
    double mean_level = 0;
    for (int k = 0; k < cells; ++k) {
        std::vector<double>& z = elevations[static_cast<std::size_t>(k)];
        std::sort(z.begin(), z.end(), std::greater<>());
        const auto n = std::min(z.size(), static_cast<std::size_t>(spec.cell * spec.width / 2));
        const double level =
            std::accumulate(z.begin(), z.begin() + static_cast<std::ptrdiff_t>(n), 0.0) / static_cast<double>(n) +
            spec.spacing / 2;
        measured.place.push_back(-half + (k + 0.5) * cell);
        measured.level.push_back(level);
        measured.bed.push_back(bed(measured.place.back()));
        mean_level += level / cells;
    }
    measured.depth = mean_level - mean_bed;
    measured.unevenness = 0;
    for (const double level : measured.level) {
        measured.unevenness = std::max(measured.unevenness, std::abs(level - mean_level) / spec.spacing);
    }
    return measured;
}

/// The same lake in a basin of cells, the ground rising beyond its shore.
Measured measure_grid(const LakeSpec& spec, const Shape& shape, const Watch& watch) {
    const double half = spec.length / 2;
    const double riser = spec.relief / 2 / std::tan(std::numbers::pi / 6) / half;
    const auto columns = static_cast<int>(std::lround(spec.length / spec.spacing)) + 2;
    Grid<double> bed({-half - spec.spacing, 0, spec.spacing, columns, 1});
    for (int k = 0; k < columns; ++k) {
        const double x = bed.geometry.centre(k, 0).x;
        bed.at(k, 0) = std::abs(x) > half ? 2 * spec.depth : spec.relief * shape.height(x / half, riser);
    }
    depth::Material material;
    depth::Solver solver(bed, material, {}, depth::Edges::continued);
    Measured measured;
    for (int k = 0; k < columns; ++k) solver.inject(k, 0, spec.depth - bed.at(k, 0), 0, 0);
    measured.expected_depth = solver.volume() / (spec.length * spec.spacing);
    while (solver.time() < spec.time) {
        const Status stepped = solver.advance(spec.time / 100);
        measured.problem = !stepped ? stepped.error().message : watch.stopped() ? "stopped by the user" : "";
        if (!measured.problem.empty()) return measured;
    }
    measured.depth = solver.volume() / (spec.length * spec.spacing);
    measured.unevenness = measured.speed = 0;
    for (int k = 1; k + 1 < columns; ++k) {
        const double level = double{solver.bed_at(k, 0)} + solver.depth_at(k, 0);
        measured.unevenness = std::max(measured.unevenness, std::abs(level - spec.depth) / spec.spacing);
        measured.speed += std::abs(solver.u_at(k, 0)) / (columns - 2);
    }
    return measured;
}

void report(const Measured& m, Rows& rows) {
    rows.add("depth", m.depth, m.expected_depth);
    rows.add("unevenness", m.unevenness);
    rows.add("residual_speed", m.speed);
}

Result<Outcome> compute(const LakeSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    for (const Shape& shape : shapes) {
        Rows rows(watch, outcome, shape.name);
        const Measured m = rows.noted(measure(spec, shape, setting, watch));
        report(m, rows);
        outcome.charts.push_back(
            {shape.name,
             fmt::format("Surface of a lake at rest, ground {}", shape.name),
             "place, m",
             "elevation, m",
             {{"surface", Series::Style::line, m.place, m.level}, {"ground", Series::Style::dashed, m.place, m.bed}}});
    }
    outcome.charts[1].name = "stepped";
    for (const Shape& shape : shapes) {
        Rows rows(watch, outcome, std::string("depth-averaged, ") + shape.name);
        report(rows.noted(measure_grid(spec, shape, watch)), rows);
    }
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    LakeSpec spec;
    spec.length = parameters.number("length_m", positive, 12);
    spec.depth = parameters.number("depth_m", positive, 3.6);
    spec.relief = parameters.number("relief_m", positive, 1.8);
    spec.spacing = parameters.number("particle_spacing_m", positive, 0.3);
    spec.time = parameters.number("time_s", positive, 10);
    spec.width = parameters.whole_number("width_spacings", {.low = 2, .high = 1000}, 8);
    spec.cell = parameters.whole_number("cell_spacings", {.low = 1, .high = 1000}, 4);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace lake_at_rest

Kind lake_at_rest_kind() {
    return {"lake_at_rest", "a lake between walls on flat, stepped and curved ground", lake_at_rest::quantities,
            lake_at_rest::prepare};
}

}  // namespace talus::validate
