#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/angle.hpp"
#include "sim/sources/seed.hpp"
#include "validate/grid_flow.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/laws.hpp"
#include "validate/measure.hpp"
#include "validate/rows.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace spreading_cap {

constexpr Quantity quantities[] = {
    {"depth_l2", "1", false, Quantity::Site::none, "relative L2 error of the thickness on square cells of the slope"},
    {"depth_max", "1", false, Quantity::Site::none, "largest error of the thickness over the largest thickness"},
};

struct CapSpec {
    double slope = 0, friction_angle = 0;               // rad
    double length = 0, height = 0, time = 0, cell = 0;  // m, m, s, m
    std::vector<double> spacings;                       // m
    std::vector<double> grids;                          // cells over the length of the spread cap
};

struct Measured {
    double l2 = not_computed, largest = not_computed;
    std::string problem;
    std::uint32_t particles = 0;
    std::vector<double> along, along_exact, along_place;     // through the centre, down the slope
    std::vector<double> across, across_exact, across_place;  // through the centre, across it
};

/// Thickness on square cells along and across the slope, computed and exact.
void compare(const CapSpec& spec, const SpreadingCap& law, const Incline& incline, const Trial& trial,
             Measured& measured) {
    const sim::State& state = trial.state();
    const double margin = 4 * spec.cell;
    const double half_length = law.half_length(state.time) + margin, half_width = law.half_width(state.time) + margin;
    const double first = law.travelled(state.time) - half_length;
    const int columns = static_cast<int>(std::ceil(2 * half_length / spec.cell));
    const int rows = static_cast<int>(std::ceil(2 * half_width / spec.cell));
    const auto size = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    std::vector<double> thickness(size, 0.0), exact(size, 0.0);
    const double share = trial.model().particle_volume() / (spec.cell * spec.cell);
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const LocalPoint p = state.position.at(i);
        const double u = (incline.along(p) - first) / spec.cell, v = (p.y + half_width) / spec.cell;
        if (!(u >= 0 && u < columns && v >= 0 && v < rows)) continue;
        thickness[static_cast<std::size_t>(v) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(u)] +=
            share;
    }
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const double s = first + (column + 0.5) * spec.cell, y = (row + 0.5) * spec.cell - half_width;
            const auto k =
                static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
            exact[k] = law.thickness(s, y, state.time);
            if (row == rows / 2) {
                measured.along_place.push_back(s);
                measured.along.push_back(thickness[k]);
                measured.along_exact.push_back(exact[k]);
            }
            if (column == columns / 2) {
                measured.across_place.push_back(y);
                measured.across.push_back(thickness[k]);
                measured.across_exact.push_back(exact[k]);
            }
        }
    }
    const ErrorNorms norms = error_norms(thickness, exact);
    measured.l2 = norms.relative_l2;
    measured.largest = norms.relative_max;
}

Measured measure(const CapSpec& spec, double spacing, const Setting& setting, const Watch& watch) {
    const SpreadingCap law(spec.slope, spec.friction_angle, spec.length, spec.height, sim::Model{}.gravity,
                           spec.time + 1);
    const double furthest = law.travelled(spec.time) + law.half_length(spec.time);
    const Incline incline(spec.slope, 2.2 * furthest, 2.4 * law.half_width(spec.time));
    params::MaterialSpec material = setting.material;
    material.friction_coefficient = std::tan(spec.friction_angle);
    sim::Model model = sim::make_model(material, setting.solver, spacing);
    sim::Ground ground(incline.terrain());
    const auto half = static_cast<int>(std::ceil(spec.length / spacing));
    const auto thickness = [&](double s, double y) { return law.thickness(s, y, 0); };
    const auto points = fill_lattice(incline, spacing, -half * spacing, 2 * half, -half * spacing, 2 * half, thickness);
    sim::State start = state_under_weight(model, ground, points, incline, thickness);
    Trial trial({std::move(model), std::move(ground), std::move(start)}, watch);
    Measured measured;
    measured.particles = trial.state().count;
    if (trial.advance_to(spec.time)) {
        compare(spec, law, incline, trial, measured);
    } else {
        measured.problem = trial.problem();
    }
    return measured;
}

Measured measure_grid(const CapSpec& spec, int cells, const Setting& setting, const Watch& watch) {
    const SpreadingCap law(spec.slope, spec.friction_angle, spec.length, spec.height, sim::Model{}.gravity,
                           spec.time + 1);
    const double half_length = 1.1 * law.half_length(spec.time), half_width = 1.1 * law.half_width(spec.time);
    const double from = -1.1 * spec.length, to = law.travelled(spec.time) + half_length;
    GridIncline flow({spec.slope, from, to - from, 2 * half_width, 2 * half_length / cells}, setting.material,
                     std::tan(spec.friction_angle), [&](double s, double y) { return law.thickness(s, y, 0); });
    Measured measured;
    measured.problem = flow.advance_to(spec.time, watch);
    if (!measured.problem.empty()) return measured;
    std::vector<double> thickness, exact;
    for (int row = 0; row < flow.rows(); ++row) {
        for (int column = 0; column < flow.columns(); ++column) {
            thickness.push_back(flow.thickness(column, row));
            exact.push_back(law.thickness(flow.along(column), flow.across(row), spec.time));
            if (row != flow.rows() / 2 || exact.back() + thickness.back() <= 0) continue;
            measured.along_place.push_back(flow.along(column));
            measured.along.push_back(thickness.back());
        }
    }
    const ErrorNorms norms = error_norms(thickness, exact);
    measured.l2 = norms.relative_l2;
    measured.largest = norms.relative_max;
    return measured;
}

Result<Outcome> compute(const CapSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    Chart along{"along",
                fmt::format("Thickness of the cap after {:g} s, down the slope", spec.time),
                "along the slope, m",
                "thickness, m",
                {}};
    Chart across{"across",
                 fmt::format("Thickness of the cap after {:g} s, across the slope", spec.time),
                 "across the slope, m",
                 "thickness, m",
                 {}};
    const double finest = *std::min_element(spec.spacings.begin(), spec.spacings.end());
    for (const double spacing : spec.spacings) {
        Rows rows(watch, outcome, fmt::format("spacing {:g} m", spacing), spacing > finest);
        const Measured m = rows.noted(measure(spec, spacing, setting, watch));
        rows.note(fmt::format("{} particles, cells of {:g} m", m.particles, spec.cell));
        rows.add("depth_l2", m.l2);
        rows.add("depth_max", m.largest);
        if (along.series.empty()) {
            along.series.push_back({"exact", Series::Style::dashed, m.along_place, m.along_exact});
            across.series.push_back({"exact", Series::Style::dashed, m.across_place, m.across_exact});
        }
        along.series.push_back({rows.name(), Series::Style::line, m.along_place, m.along});
        across.series.push_back({rows.name(), Series::Style::line, m.across_place, m.across});
    }
    for (const double cells : spec.grids) {
        Rows rows(watch, outcome, grid_name(static_cast<int>(cells)));
        const Measured m = rows.noted(measure_grid(spec, static_cast<int>(cells), setting, watch));
        rows.add("depth_l2", m.l2);
        rows.add("depth_max", m.largest);
        along.series.push_back({rows.name(), Series::Style::line, m.along_place, m.along});
    }
    outcome.charts = {along, across};
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range angles{.low = 0, .high = 80};
    constexpr params::Range positive{.low = 0, .low_included = false};
    CapSpec spec;
    spec.slope = parameters.number("slope_deg", angles, 35) * radians_per_degree;
    spec.friction_angle = parameters.number("friction_angle_deg", angles, 25) * radians_per_degree;
    spec.length = parameters.number("length_m", positive, 80);
    spec.height = parameters.number("height_m", positive, 4);
    spec.time = parameters.number("time_s", positive, 5);
    spec.cell = parameters.number("cell_m", positive, 5);
    spec.spacings = parameters.numbers("spacings_m", positive, {1});
    spec.grids = parameters.numbers("grid_cells", {.low = 10, .high = 10000}, {100});
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace spreading_cap

Kind spreading_cap_kind() {
    return {"spreading_cap", "a parabolic cap that slides and spreads on a plane", spreading_cap::quantities,
            spreading_cap::prepare};
}

}  // namespace talus::validate
