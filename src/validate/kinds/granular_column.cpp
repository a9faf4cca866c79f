#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "sim/sources/seed.hpp"
#include "validate/grid_flow.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/laws.hpp"
#include "validate/measure.hpp"
#include "validate/rows.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace granular_column {

constexpr double front_percentile = 0.99;
constexpr double covered = 0.5;  // layers of particles that still cover the ground

constexpr Quantity quantities[] = {
    {"run_out", "1", true, Quantity::Site::none,
     "(final - initial extent) / initial extent; the front is the 99th percentile of the particles' distances"},
    {"run_out_edge", "1", true, Quantity::Site::none,
     "the same up to where the deposit is half a layer of particles thick"},
    {"height", "1", true, Quantity::Site::none,
     "final height / initial extent, from the five highest particles; of two laws that disagree, the nearer is "
     "expected"},
    {"residual_speed", "1", false, Quantity::Site::none, "mean speed at the end over sqrt(g initial height)"},
};

struct ColumnSpec {
    bool planar = false;
    std::vector<double> aspects, resolutions;  // height / extent; spacings per extent
    double extent = 0;                         // m, radius or half-width
    int width = 0;                             // spacings, of a planar column's slice
    double duration = 0;                       // sqrt(initial height / g)
    std::vector<NumberPair> reference;         // aspect, run-out of a published computation
};

struct Measured {
    double run_out = not_computed, run_out_edge = not_computed, height = not_computed, residual_speed = not_computed;
    std::string problem;
    std::vector<double> distance, thickness;  // final profile, over the initial extent
    std::vector<double> time, front;          // over sqrt(H / g) and the initial extent
};

double run_out_law(const ColumnSpec& spec, double aspect) {
    return spec.planar ? column_run_out_planar(aspect) : column_run_out_axisymmetric(aspect);
}

double height_law(const ColumnSpec& spec, double aspect) {
    return spec.planar ? column_height_planar(aspect) : column_heights_axisymmetric(aspect).lube;
}

double flat_height_law(const ColumnSpec&, double aspect) {
    return column_heights_axisymmetric(aspect).lajeunesse;
}

/// Of two laws that disagree, the nearer one.
double expected_height(const ColumnSpec& spec, double aspect, double computed) {
    const double law = height_law(spec, aspect);
    if (spec.planar) return law;
    const double flat = flat_height_law(spec, aspect);
    return std::abs(computed - flat) < std::abs(computed - law) ? flat : law;
}

Measured measure(const ColumnSpec& spec, double aspect, double resolution, const Setting& setting, const Watch& watch) {
    const double spacing = spec.extent / resolution;
    const double height = aspect * spec.extent;
    const double reach = spec.extent * (1 + 2 * run_out_law(spec, aspect)) + 2 * spacing;
    const double width = spec.planar ? spec.width * spacing : 2 * reach;
    const Incline flat(0, 2 * reach, width + 4);

    // A planar column is one half of a slice, behind a frictionless wall in its plane of symmetry.
    params::MaterialSpec material = setting.material;
    std::vector<terrain::Building> walls;
    if (spec.planar) {
        material.building_friction_coefficient = 0;
        walls = make_slice(flat.terrain(), width, 2 * height);
        const Extent extent = flat.terrain().elevation().geometry.extent();
        walls.push_back(make_wall(flat.terrain(), extent.x_min, extent.y_min, 0, extent.y_max, 2 * height));
    }
    sim::Model model = sim::make_model(material, setting.solver, spacing);
    sim::Ground ground(flat.terrain(), walls, model.support_radius);
    const auto half = static_cast<int>(std::ceil(resolution));
    const auto thickness = [&](double x, double y) {
        return spec.planar || std::hypot(x, y) < spec.extent ? height : 0;
    };
    const auto points =
        spec.planar ? fill_lattice(flat, spacing, 0, half, -width / 2, spec.width, thickness)
                    : fill_lattice(flat, spacing, -half * spacing, 2 * half, -half * spacing, 2 * half, thickness);
    sim::State start = state_under_weight(model, ground, points, flat, thickness);
    Trial trial({std::move(model), std::move(ground), std::move(start)}, watch);

    const sim::State& state = trial.state();
    const auto distance = [&](std::uint32_t i) {
        return spec.planar ? double{state.position.x[i]} : std::hypot(state.position.x[i], state.position.y[i]);
    };
    const auto front = [&] {
        std::vector<double> distances(state.count);
        for (std::uint32_t i = 0; i < state.count; ++i) distances[i] = distance(i);
        return percentile(std::move(distances), front_percentile);
    };
    Measured measured;
    const double unit_time = std::sqrt(height / trial.model().gravity);
    constexpr int samples = 60;
    for (int k = 0; k <= samples; ++k) {
        if (!trial.advance_to(spec.duration * unit_time * k / samples)) {
            measured.problem = trial.problem();
            return measured;
        }
        measured.time.push_back(state.time / unit_time);
        measured.front.push_back(front() / spec.extent);
    }
    measured.run_out = front() / spec.extent - 1;
    measured.height = top_of(trial.model(), state) / spec.extent;
    double speeds = 0;
    for (std::uint32_t i = 0; i < state.count; ++i) speeds += length(state.velocity.at(i));
    measured.residual_speed = speeds / state.count / std::sqrt(trial.model().gravity * height);

    const double cell = spacing;
    const int cells = static_cast<int>(reach / cell);
    std::vector<double> profile =
        thickness_profile(trial.model(), state, 0, cell, cells, spec.planar ? width : 1, distance);
    for (int k = 0; k < cells; ++k) {
        const double middle = (k + 0.5) * cell;
        const double circumference = spec.planar ? 1 : 2 * std::numbers::pi * middle;
        measured.distance.push_back(middle / spec.extent);
        measured.thickness.push_back(profile[static_cast<std::size_t>(k)] / circumference / spec.extent);
    }
    measured.run_out_edge = edge_of(measured.thickness, cell, covered * spacing / spec.extent) / spec.extent - 1;
    return measured;
}

/// The same by the depth-averaged model, on cells as wide as the finest particles.
Measured measure_grid(const ColumnSpec& spec, double aspect, const Setting& setting, const Watch& watch) {
    const double resolution = *std::max_element(spec.resolutions.begin(), spec.resolutions.end());
    const double cell = spec.extent / resolution, height = aspect * spec.extent;
    const double reach = spec.extent * (1 + 2 * run_out_law(spec, aspect)) + 2 * cell;
    const auto distance = [&](double along, double across) {
        return spec.planar ? std::abs(along) : std::hypot(along, across);
    };
    GridIncline flat({0, -reach, 2 * reach, spec.planar ? 0 : 2 * reach, cell}, setting.material,
                     setting.material.friction_coefficient,
                     [&](double along, double across) { return distance(along, across) < spec.extent ? height : 0; });
    Measured measured;
    const double unit_time = std::sqrt(height / sim::Model{}.gravity);
    measured.problem = flat.advance_to(spec.duration * unit_time, watch);
    if (!measured.problem.empty()) return measured;
    const auto cells = static_cast<std::size_t>(std::ceil(1.5 * reach / cell));
    std::vector<double> volume(cells), count(cells), profile(cells);
    double highest = 0, all = 0, speeds = 0;
    for (int row = 0; row < flat.rows(); ++row) {
        for (int column = 0; column < flat.columns(); ++column) {
            const double depth = flat.thickness(column, row);
            const auto ring = static_cast<std::size_t>(distance(flat.along(column), flat.across(row)) / cell);
            volume.at(ring) += depth;
            count.at(ring) += 1;
            all += depth;
            speeds += depth * std::hypot(flat.solver().u_at(column, row), flat.solver().v_at(column, row));
            highest = std::max(highest, depth);
        }
    }
    double inside = 0;
    std::size_t ring = 0;
    for (; ring + 1 < cells && inside + volume[ring] < front_percentile * all; ++ring) inside += volume[ring];
    const double front = cell * (static_cast<double>(ring) + (front_percentile * all - inside) / volume[ring]);
    for (std::size_t k = 0; k < cells; ++k) {
        profile[k] = count[k] > 0 ? volume[k] / count[k] / spec.extent : 0;
        measured.distance.push_back((static_cast<double>(k) + 0.5) * cell / spec.extent);
    }
    measured.thickness = profile;
    measured.run_out = front / spec.extent - 1;
    measured.run_out_edge = edge_of(profile, cell, covered * cell / spec.extent) / spec.extent - 1;
    measured.height = highest / spec.extent;
    measured.residual_speed = speeds / all / std::sqrt(sim::Model{}.gravity * height);
    return measured;
}

Series law_curve(const ColumnSpec& spec, double (*law)(const ColumnSpec&, double)) {
    Series curve{"law", Series::Style::dashed, {}, {}};
    const double last = *std::max_element(spec.aspects.begin(), spec.aspects.end()) * 1.1;
    for (int k = 0; k <= 200; ++k) {
        curve.x.push_back(last * k / 200);
        curve.y.push_back(law(spec, curve.x.back()));
    }
    return curve;
}

Result<Outcome> compute(const ColumnSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    Chart run_outs{"run_out",
                   "Run-out against aspect ratio",
                   "initial height / extent",
                   "run-out / extent",
                   {law_curve(spec, run_out_law)}};
    Chart heights{"height",
                  "Final height against aspect ratio",
                  "initial height / extent",
                  "final height / extent",
                  {law_curve(spec, height_law)}};
    if (!spec.planar) heights.series.push_back(law_curve(spec, flat_height_law));
    Chart trend{
        "trend", "Computed over expected run-out, by resolution", "spacings per extent", "computed / expected", {}};
    Chart profiles{"profile", "Final profile at the finest resolution", "distance / extent", "thickness / extent", {}};
    Chart fronts{"front", "The front over time at the finest resolution", "time / sqrt(H / g)", "front / extent", {}};
    if (!spec.reference.empty()) {
        Series others{"other simulation", Series::Style::marks, {}, {}};
        for (const NumberPair& p : spec.reference) {
            others.x.push_back(p[0]);
            others.y.push_back(p[1]);
        }
        run_outs.series.push_back(others);
    }
    const double finest = *std::max_element(spec.resolutions.begin(), spec.resolutions.end());
    std::vector<Series> trends(spec.aspects.size());
    for (const double resolution : spec.resolutions) {
        const std::string by_resolution = fmt::format("{:g} spacings", resolution);
        Series run_out{by_resolution, Series::Style::marks, {}, {}}, height = run_out;
        for (std::size_t k = 0; k < spec.aspects.size(); ++k) {
            const double aspect = spec.aspects[k];
            const std::string aspect_name = fmt::format("a = {:g}", aspect);
            Rows rows(watch, outcome, fmt::format("{}, {}", aspect_name, by_resolution), resolution < finest);
            const Measured m = rows.noted(measure(spec, aspect, resolution, setting, watch));
            const double law = run_out_law(spec, aspect);
            rows.add("run_out", m.run_out, law);
            rows.add("run_out_edge", m.run_out_edge, law);
            rows.add("height", m.height, expected_height(spec, aspect, m.height));
            rows.add("residual_speed", m.residual_speed);
            run_out.x.push_back(aspect);
            run_out.y.push_back(m.run_out);
            height.x.push_back(aspect);
            height.y.push_back(m.height);
            trends[k].name = aspect_name;
            trends[k].x.push_back(resolution);
            trends[k].y.push_back(m.run_out / run_out_law(spec, aspect));
            if (resolution != finest) continue;
            profiles.series.push_back({aspect_name, Series::Style::line, m.distance, m.thickness});
            fronts.series.push_back({aspect_name, Series::Style::line, m.time, m.front});
        }
        run_outs.series.push_back(run_out);
        heights.series.push_back(height);
    }
    Series by_grid{"depth-averaged", Series::Style::marks, {}, {}}, grid_height = by_grid;
    for (const double aspect : spec.aspects) {
        Rows rows(watch, outcome, fmt::format("depth-averaged, a = {:g}", aspect));
        const Measured m = rows.noted(measure_grid(spec, aspect, setting, watch));
        const double law = run_out_law(spec, aspect);
        rows.add("run_out", m.run_out, law);
        rows.add("run_out_edge", m.run_out_edge, law);
        rows.add("height", m.height, expected_height(spec, aspect, m.height));
        rows.add("residual_speed", m.residual_speed);
        by_grid.x.push_back(aspect);
        by_grid.y.push_back(m.run_out);
        grid_height.x.push_back(aspect);
        grid_height.y.push_back(m.height);
        profiles.series.push_back({rows.name(), Series::Style::dashed, m.distance, m.thickness});
    }
    run_outs.series.push_back(by_grid);
    heights.series.push_back(grid_height);
    trend.series = trends;
    outcome.charts = {run_outs, heights, trend, profiles, fronts};
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    ColumnSpec spec;
    spec.planar = parameters.choice("geometry", {"axisymmetric", "planar"}, "axisymmetric") == "planar";
    spec.aspects = parameters.numbers("aspect_ratios", positive, {1});
    spec.resolutions = parameters.numbers("spacings_per_extent", {.low = 2, .high = 1000}, {12});
    spec.extent = parameters.number("extent_m", positive, 5);
    spec.width = parameters.whole_number("width_spacings", {.low = 2, .high = 1000}, 6);
    spec.duration = parameters.number("duration", positive, 12);
    spec.reference = parameters.pairs("reference_run_outs", {.low = 0}, false);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace granular_column

Kind granular_column_kind() {
    return {"granular_column", "a column of granular material that collapses on a rough bed",
            granular_column::quantities, granular_column::prepare};
}

}  // namespace talus::validate
