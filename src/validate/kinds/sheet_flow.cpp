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
namespace sheet_flow {

constexpr Quantity quantities[] = {
    {"mean_velocity", "m/s", true, Quantity::Site::none, "down the slope, over the thickness"},
    {"surface_velocity", "m/s", true, Quantity::Site::none, "down the slope, of the uppermost layer"},
    {"profile_l2", "1", false, Quantity::Site::none, "relative L2 error of the velocity by height"},
    {"profile_max", "1", false, Quantity::Site::none, "its largest error over the surface velocity"},
};

struct SheetSpec {
    std::string law;
    std::vector<double> slopes, start_shares;  // rad; 1, of the law's velocity at the start
    double spacing = 0, length = 0;            // m
    int layers = 0, width = 0;                 // spacings
    double start = 0, end = 0;                 // s, the window of measurement
};

struct Measured {
    std::vector<double> height, velocity, law;  // m, m/s, by layer
    double mean = not_computed, law_mean = not_computed;
    std::string problem;
};

/// The law's velocity at a height above the ground.
double law_velocity(const SheetSpec& spec, const SheetFlow& sheet, const sim::Model& model,
                    const params::MaterialSpec& material, double height) {
    if (spec.law == "drag" && model.laws.samosat.on) {
        return sheet.with_samosat(model.friction_coefficient, model.laws.samosat.fluidization,
                                  sim::wall_drag(model.laws, sheet.thickness));
    }
    if (spec.law == "drag") {
        const double share = sheet.thickness / material.turbulent_friction_thickness.value_or(sheet.thickness);
        return sheet.with_drag(model.friction_coefficient, material.turbulent_friction.value_or(0) * std::cbrt(share),
                               model.laws.laminar_viscosity);
    }
    if (spec.law == "bingham") {
        return sheet.bingham(height, model.cohesion / model.rest_density, model.kinematic_viscosity);
    }
    return sheet.bagnold(height, model.internal_friction_coefficient,
                         model.internal_friction_coefficient + model.inertial_friction.rise, material.inertial_number,
                         material.grain_diameter, material.rest_density / material.grain_density);
}

/// Velocity and number of the particles of every layer, summed over the window of measurement.
struct Layers {
    std::vector<double> velocity, count, height;

    explicit Layers(int layers)
        : velocity(static_cast<std::size_t>(layers)), count(velocity.size()), height(velocity.size()) {}

    /// For the middle quarter of the sheet at its current position: its ends spread.
    void add(const sim::State& state, const Incline& incline, const LocalPoint& down, double length, double spacing) {
        double middle = 0;
        for (std::uint32_t i = 0; i < state.count; ++i) middle += incline.along(state.position.at(i));
        middle /= state.count;
        for (std::uint32_t i = 0; i < state.count; ++i) {
            const LocalPoint p = state.position.at(i);
            if (std::abs(incline.along(p) - middle) > length / 8) continue;
            const double z = incline.normal(p);
            const auto layer =
                static_cast<std::size_t>(std::clamp(z / spacing, 0.0, static_cast<double>(velocity.size()) - 0.5));
            velocity[layer] += dot(state.velocity.at(i), down);
            height[layer] += z;
            count[layer] += 1;
        }
    }
};

Measured measure(const SheetSpec& spec, double slope, double start_share, const Setting& setting, const Watch& watch) {
    const double thickness = spec.layers * spec.spacing, width = spec.width * spec.spacing;
    const SheetFlow sheet{slope, thickness, sim::Model{}.gravity};
    params::MaterialSpec material = setting.material;
    material.building_friction_coefficient = 0;
    sim::Model model = sim::make_model(material, setting.solver, spec.spacing);
    const auto law = [&](double height) { return law_velocity(spec, sheet, model, setting.material, height); };
    Measured measured;
    if (!(law(thickness) > 0)) {
        measured.problem = "the law has no steady flow on this slope";
        return measured;
    }
    const double travel = 2 * law(thickness) * std::max(1.0, start_share) * spec.end;
    const Incline incline(slope, 2 * (spec.length + travel), width + 4);
    const auto columns = static_cast<int>(std::lround(spec.length / spec.spacing));
    const auto even = [&](double, double) { return thickness; };
    const auto points =
        fill_lattice(incline, spec.spacing, -columns * spec.spacing / 2, columns, -width / 2, spec.width, even);
    sim::Ground ground(incline.terrain(), make_slice(incline.terrain(), width, 2 * thickness), model.support_radius);
    sim::State start = state_under_weight(model, ground, points, incline, [&](double along, double) {
        return std::abs(along) < spec.length / 2 ? thickness : 0;
    });
    const LocalPoint down = incline.down(1);
    for (std::uint32_t i = 0; i < start.count; ++i) {
        start.velocity.set(i, incline.down(start_share * law(incline.normal(start.position.at(i)))));
    }
    Trial trial({std::move(model), std::move(ground), std::move(start)}, watch);
    Layers layers(spec.layers);
    const bool trusted = trial.advance_to(spec.start) && trial.advance_to(spec.end, [&] {
        layers.add(trial.state(), incline, down, spec.length, spec.spacing);
    });
    measured.problem = trial.problem();
    if (!trusted) return measured;
    double sum = 0, law_sum = 0, count = 0;
    for (std::size_t k = 0; k < layers.count.size(); ++k) {
        if (layers.count[k] == 0) continue;
        measured.height.push_back(layers.height[k] / layers.count[k]);
        measured.velocity.push_back(layers.velocity[k] / layers.count[k]);
        measured.law.push_back(law(measured.height.back()));
        sum += layers.velocity[k];
        law_sum += measured.law.back() * layers.count[k];
        count += layers.count[k];
    }
    measured.mean = sum / count;
    measured.law_mean = law_sum / count;
    return measured;
}

/// Mean velocity in the middle of the sheet, and the law's, by the depth-averaged model.
Measured measure_grid(const SheetSpec& spec, double slope, double start_share, const Setting& setting,
                      const Watch& watch) {
    const double thickness = spec.layers * spec.spacing;
    const SheetFlow sheet{slope, thickness, sim::Model{}.gravity};
    const sim::Model model = sim::make_model(setting.material, setting.solver, spec.spacing);
    Measured measured;
    constexpr int parts = 1000;
    double law = 0;
    for (int k = 0; k < parts; ++k) {
        law += law_velocity(spec, sheet, model, setting.material, (k + 0.5) / parts * thickness) / parts;
    }
    measured.law_mean = law;
    const double travel = law * std::max(1.0, start_share) * spec.end, before = 2 * travel + 4 * spec.length;
    GridIncline flow({slope, -before, 2 * before, 0, thickness}, setting.material, model.friction_coefficient,
                     [&](double, double) { return thickness; });
    flow.set_velocity(start_share * law);
    measured.problem = flow.advance_to(spec.end, watch);
    if (measured.problem.empty()) measured.mean = flow.velocity(flow.columns() / 2, 0);
    return measured;
}

Result<Outcome> compute(const SheetSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    Chart chart{"profile", "Velocity by height above the ground", "velocity (m/s)", "height (m)", {}};
    for (const double slope : spec.slopes) {
        for (const double share : spec.start_shares) {
            Rows rows(watch, outcome,
                      fmt::format("slope {:.3g} degrees, from {:g} of the law's velocity", slope / radians_per_degree,
                                  share));
            const Measured m = rows.noted(measure(spec, slope, share, setting, watch));
            const bool computed = !m.velocity.empty();
            const ErrorNorms norms = computed ? error_norms(m.velocity, m.law) : ErrorNorms{not_computed, not_computed};
            rows.add("mean_velocity", m.mean, m.law_mean);
            rows.add("surface_velocity", computed ? m.velocity.back() : not_computed,
                     computed ? m.law.back() : not_computed);
            rows.add("profile_l2", norms.relative_l2);
            rows.add("profile_max", norms.relative_max);
            if (share == spec.start_shares.front()) {
                chart.series.push_back({fmt::format("law, {:.3g} degrees", slope / radians_per_degree),
                                        Series::Style::dashed, m.law, m.height});
            }
            chart.series.push_back({rows.name(), Series::Style::marks, m.velocity, m.height});
            if (spec.law == "bagnold") continue;  // a law of what happens inside
            Rows by_grid(outcome, "depth-averaged, " + rows.name());
            const Measured grid = by_grid.noted(measure_grid(spec, slope, share, setting, watch));
            by_grid.add("mean_velocity", grid.mean, grid.law_mean);
        }
    }
    outcome.charts.push_back(chart);
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    SheetSpec spec;
    spec.law = parameters.choice("law", {"drag", "bingham", "bagnold"}, "drag");
    spec.slopes = parameters.numbers("slopes_deg", {.low = 0, .high = 60, .low_included = false}, {20});
    for (double& slope : spec.slopes) slope *= radians_per_degree;
    spec.start_shares = parameters.numbers("start_shares", {.low = 0, .high = 10}, {1});
    spec.spacing = parameters.number("particle_spacing_m", positive, 0.1);
    spec.length = parameters.number("length_m", positive, 20);
    spec.layers = parameters.whole_number("layers", {.low = 2, .high = 1000}, 10);
    spec.width = parameters.whole_number("width_spacings", {.low = 2, .high = 1000}, 5);
    spec.start = parameters.number("start_s", {.low = 0}, 2);
    spec.end = parameters.number("end_s", positive, 3);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace sheet_flow

Kind sheet_flow_kind() {
    return {"sheet_flow", "a sheet that flows steadily down a plane", sheet_flow::quantities, sheet_flow::prepare};
}

}  // namespace talus::validate
