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
namespace dam_break {

constexpr Quantity quantities[] = {
    {"depth_l2", "1", false, Quantity::Site::none, "relative L2 error of the thickness on cells along the slope"},
    {"front", "m", true, Quantity::Site::none,
     "of the depth-averaged model: where the thickness falls below a hundredth of the dam's, from the dam"},
    {"depth_max", "1", false, Quantity::Site::none, "largest error of the thickness over the dam's"},
};

struct DamSpec {
    double slope = 0, friction_angle = 0;  // rad
    double depth = 0, time = 0, cell = 0;  // m, s, m
    std::vector<double> spacings;          // m
    int width = 0;                         // spacings
    std::vector<double> grids;             // cells over what is compared
};

struct Measured {
    double l2 = not_computed, largest = not_computed;
    double front = not_computed, exact_front = not_computed;  // m, where the thickness falls below a hundredth
    std::string problem;
    std::uint32_t particles = 0;
    std::vector<double> place, thickness, exact;
};

Measured measure(const DamSpec& spec, double spacing, const Setting& setting, const Watch& watch) {
    const DamBreak law(spec.slope, spec.friction_angle, spec.depth, sim::Model{}.gravity);
    // Long enough that its other end does not affect the compared thickness.
    const double margin = 3 * spec.depth;
    const double reservoir = 2 * law.wave_speed() * spec.time + 2 * margin;
    const double width = spec.width * spacing;
    const Incline incline(spec.slope, 2 * (reservoir + law.front(spec.time)), width + 4);
    params::MaterialSpec material = setting.material;
    material.friction_coefficient = std::tan(spec.friction_angle);
    material.building_friction_coefficient = 0;
    sim::Model model = sim::make_model(material, setting.solver, spacing);
    sim::Ground ground(incline.terrain(), make_slice(incline.terrain(), width, 3 * spec.depth), model.support_radius);
    const auto columns = static_cast<int>(std::lround(reservoir / spacing));
    const auto thickness = [&](double, double) { return spec.depth; };
    const auto points = fill_lattice(incline, spacing, -columns * spacing, columns, -width / 2, spec.width, thickness);
    sim::State start = state_under_weight(model, ground, points, incline, thickness);
    Trial trial({std::move(model), std::move(ground), std::move(start)}, watch);
    const sim::State& state = trial.state();
    Measured measured;
    measured.particles = state.count;
    if (!trial.advance_to(spec.time)) {
        measured.problem = trial.problem();
        return measured;
    }
    const double first = std::floor((law.back(state.time) - margin) / spec.cell) * spec.cell;
    const int cells = static_cast<int>(std::ceil((law.front(state.time) + margin - first) / spec.cell));
    measured.thickness = thickness_profile(trial.model(), state, first, spec.cell, cells, width,
                                           [&](std::uint32_t i) { return incline.along(state.position.at(i)); });
    for (int k = 0; k < cells; ++k) {
        measured.place.push_back(first + (k + 0.5) * spec.cell);
        measured.exact.push_back(law.thickness(measured.place.back(), state.time));
    }
    const ErrorNorms norms = error_norms(measured.thickness, measured.exact);
    measured.l2 = norms.relative_l2;
    measured.largest = norms.relative_max;
    return measured;
}

/// The last place with at least a hundredth of the dam's depth.
double front_of(const std::vector<double>& place, const std::vector<double>& thickness, double depth) {
    double front = not_computed;
    for (std::size_t k = 0; k < place.size(); ++k) {
        if (thickness[k] >= 0.01 * depth) front = place[k];
    }
    return front;
}

Measured measure_grid(const DamSpec& spec, int cells, const Setting& setting, const Watch& watch) {
    const DamBreak law(spec.slope, spec.friction_angle, spec.depth, sim::Model{}.gravity);
    const double margin = 3 * spec.depth, first = law.back(spec.time) - margin;
    const double cell = (law.front(spec.time) + margin - first) / cells;
    const double reservoir = 2 * law.wave_speed() * spec.time + 2 * margin;
    const auto before = static_cast<int>(std::ceil((first + reservoir) / cell));
    GridIncline flow({spec.slope, first - before * cell, (before + cells) * cell, 0, cell}, setting.material,
                     std::tan(spec.friction_angle), [&](double s, double) { return s < 0 ? spec.depth : 0; });
    Measured measured;
    measured.problem = flow.advance_to(spec.time, watch);
    if (!measured.problem.empty()) return measured;
    for (int k = before; k < flow.columns(); ++k) {
        measured.place.push_back(flow.along(k));
        measured.thickness.push_back(flow.thickness(k, 0));
        measured.exact.push_back(law.thickness(flow.along(k), spec.time));
    }
    const ErrorNorms norms = error_norms(measured.thickness, measured.exact);
    measured.l2 = norms.relative_l2;
    measured.largest = norms.relative_max;
    measured.front = front_of(measured.place, measured.thickness, spec.depth);
    measured.exact_front = front_of(measured.place, measured.exact, spec.depth);
    return measured;
}

Result<Outcome> compute(const DamSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    Chart profile{"profile",
                  fmt::format("Thickness of a broken dam after {:g} s", spec.time),
                  "along the slope, m",
                  "thickness, m",
                  {}};
    Chart trend{"trend",
                "Error of the thickness, by spacing",
                "particle spacing, m",
                "relative L2 error",
                {{"computed", Series::Style::marks, {}, {}}}};
    const double finest = *std::min_element(spec.spacings.begin(), spec.spacings.end());
    for (const double spacing : spec.spacings) {
        Rows rows(watch, outcome, fmt::format("spacing {:g} m", spacing), spacing > finest);
        const Measured m = rows.noted(measure(spec, spacing, setting, watch));
        rows.note(fmt::format("{} particles, cells of {:g} m", m.particles, spec.cell));
        rows.add("depth_l2", m.l2);
        rows.add("depth_max", m.largest);
        if (profile.series.empty()) profile.series.push_back({"exact", Series::Style::dashed, m.place, m.exact});
        profile.series.push_back({rows.name(), Series::Style::line, m.place, m.thickness});
        trend.series[0].x.push_back(spacing);
        trend.series[0].y.push_back(m.l2);
    }
    for (const double cells : spec.grids) {
        Rows rows(watch, outcome, grid_name(static_cast<int>(cells)));
        const Measured m = rows.noted(measure_grid(spec, static_cast<int>(cells), setting, watch));
        rows.add("depth_l2", m.l2);
        rows.add("depth_max", m.largest);
        rows.add("front", m.front, m.exact_front);
        profile.series.push_back({rows.name(), Series::Style::line, m.place, m.thickness});
    }
    outcome.charts = {profile, trend};
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range angles{.low = 0, .high = 80};
    constexpr params::Range positive{.low = 0, .low_included = false};
    DamSpec spec;
    spec.slope = parameters.number("slope_deg", angles, 0) * radians_per_degree;
    spec.friction_angle = parameters.number("friction_angle_deg", angles, 0) * radians_per_degree;
    spec.depth = parameters.number("depth_m", positive, 1);
    spec.time = parameters.number("time_s", positive, 5);
    spec.cell = parameters.number("cell_m", positive, 0.5);
    spec.spacings = parameters.numbers("spacings_m", positive, {0.1});
    spec.width = parameters.whole_number("width_spacings", {.low = 2, .high = 1000}, 5);
    spec.grids = parameters.numbers("grid_cells", {.low = 10, .high = 10000}, {200});
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace dam_break

Kind dam_break_kind() {
    return {"dam_break", "a dam that breaks on a slope with Coulomb friction, as a thin slice", dam_break::quantities,
            dam_break::prepare};
}

}  // namespace talus::validate
