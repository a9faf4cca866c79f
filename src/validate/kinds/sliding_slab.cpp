#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/angle.hpp"
#include "sim/sources/seed.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/rows.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace sliding_slab {

constexpr Quantity quantities[] = {
    {"acceleration", "m/s2", true, Quantity::Site::none, "down the slope, of the middle third of the slab"},
    {"drift", "m/s", false, Quantity::Site::none, "mean speed down a slope that friction holds"},
    {"clearance", "1", false, Quantity::Site::none,
     "distance of the lowest layer from the ground, less its touching distance, in spacings"},
};

struct SlabSpec {
    std::vector<double> slopes, frictions;                       // rad, 1: every pair is computed
    double varied_slope = 0, varied_friction = 0;                // at which the lists below are computed
    std::vector<double> time_steps, iteration_counts, spacings;  // one is varied at a time
    double spacing = 0, length = 0;                              // m
    int layers = 0, width = 0;                                   // spacings
    double start = 0, end = 0;                                   // s, the window of measurement of sliding slabs
    double rest_start = 0, rest_end = 0;                         // s, of slabs that must stay
};

/// One slab: its slope and friction, and the numerics.
struct Variant {
    double slope, friction, spacing;
    params::SolverSpec solver;
    std::string name;
};

double coulomb_acceleration(const Variant& variant) {
    return sim::Model{}.gravity * (std::sin(variant.slope) - variant.friction * std::cos(variant.slope));
}

struct Measured {
    double acceleration = not_computed, drift = not_computed, clearance = not_computed;
    std::string problem;
    std::vector<double> time, speed;
};

Measured measure(const SlabSpec& spec, const Variant& variant, const Setting& setting, const Watch& watch) {
    const double acceleration = coulomb_acceleration(variant);
    const double start = acceleration > 0 ? spec.start : spec.rest_start;
    const double end = acceleration > 0 ? spec.end : spec.rest_end;
    const double furthest = 0.5 * std::max(0.0, acceleration) * end * end;
    const double width = spec.width * variant.spacing;
    const Incline incline(variant.slope, spec.length + 2 * furthest + 10, width + 4);
    const auto columns = static_cast<int>(std::lround(spec.length / variant.spacing));
    const double thickness = spec.layers * variant.spacing;

    params::MaterialSpec material = setting.material;
    material.friction_coefficient = variant.friction;
    material.building_friction_coefficient = 0;
    sim::Model model = sim::make_model(material, variant.solver, variant.spacing);
    sim::Ground ground(incline.terrain(), make_slice(incline.terrain(), width, thickness), model.support_radius);
    const auto points = fill_lattice(incline, variant.spacing, -columns * variant.spacing / 2, columns, -width / 2,
                                     spec.width, [&](double, double) { return thickness; });
    Trial trial({std::move(model), std::move(ground), state_at_rest(points)}, watch);

    // The ends spread; the law applies to the middle.
    std::vector<std::uint8_t> middle(points.size()), lowest(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        middle[i] = std::abs(incline.along(points[i])) < spec.length / 6;
        lowest[i] = incline.normal(points[i]) < variant.spacing;
    }
    const sim::State& state = trial.state();
    const auto mean = [&](const std::vector<std::uint8_t>& chosen, const auto& value) {
        double sum = 0;
        int count = 0;
        for (std::uint32_t i = 0; i < state.count; ++i) {
            if (!middle[state.id[i]] || !chosen[state.id[i]]) continue;
            sum += value(i);
            ++count;
        }
        return sum / count;
    };
    const LocalPoint down = incline.down(1);
    const auto speed = [&] { return mean(middle, [&](std::uint32_t i) { return dot(state.velocity.at(i), down); }); };
    const auto place = [&] {
        return mean(middle, [&](std::uint32_t i) { return incline.along(state.position.at(i)); });
    };

    Measured measured;
    const auto record = [&] {
        measured.time.push_back(state.time);
        measured.speed.push_back(speed());
    };
    if (!trial.advance_to(start, record)) {
        measured.problem = trial.problem();
        return measured;
    }
    const double t0 = state.time, v0 = speed(), x0 = place();
    if (!trial.advance_to(end, record)) {
        measured.problem = trial.problem();
        return measured;
    }
    measured.acceleration = (speed() - v0) / (state.time - t0);
    measured.drift = (place() - x0) / (state.time - t0);
    const double gap = mean(lowest, [&](std::uint32_t i) { return incline.normal(state.position.at(i)); });
    measured.clearance = gap / variant.spacing - 0.5;
    return measured;
}

std::vector<Variant> variants_of(const SlabSpec& spec, const params::SolverSpec& solver) {
    std::vector<Variant> variants;
    const auto add = [&](double slope, double friction, const std::string& more) -> Variant& {
        variants.push_back(
            {slope, friction, spec.spacing, solver,
             fmt::format("slope {:.3g} degrees, f = {:.3g}{}", slope / radians_per_degree, friction, more)});
        return variants.back();
    };
    for (const double slope : spec.slopes) {
        for (const double friction : spec.frictions) add(slope, friction, "");
    }
    for (const double time_step : spec.time_steps) {
        add(spec.varied_slope, spec.varied_friction, fmt::format(", dt = 1/{:.0f} s", 1 / time_step)).solver.time_step =
            time_step;
    }
    for (const double count : spec.iteration_counts) {
        add(spec.varied_slope, spec.varied_friction, fmt::format(", {:.0f} iterations", count)).solver.iteration_count =
            static_cast<int>(count);
    }
    for (const double spacing : spec.spacings) {
        add(spec.varied_slope, spec.varied_friction, fmt::format(", spacing {:.3g} m", spacing)).spacing = spacing;
    }
    return variants;
}

Result<Outcome> compute(const SlabSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    Chart chart{"acceleration",
                "Acceleration of a slab against the law of Coulomb friction",
                "g (sin t - f cos t), m/s2",
                "computed, m/s2",
                {}};
    Series law{"law", Series::Style::dashed, {}, {}}, computed{"computed", Series::Style::marks, {}, {}};
    for (const Variant& variant : variants_of(spec, setting.solver)) {
        Rows rows(watch, outcome, variant.name);
        const Measured measured = rows.noted(measure(spec, variant, setting, watch));
        const double expected = coulomb_acceleration(variant);
        if (expected > 0) {
            rows.add("acceleration", measured.acceleration, expected);
            rows.add("clearance", measured.clearance);
            law.x.push_back(expected);
            law.y.push_back(expected);
            computed.x.push_back(expected);
            computed.y.push_back(measured.acceleration);
        } else {
            rows.add("drift", measured.drift);
        }
    }
    chart.series = {law, computed};
    outcome.charts.push_back(chart);
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range slopes{.low = 0, .high = 89};
    constexpr params::Range positive{.low = 0, .low_included = false};
    SlabSpec spec;
    spec.slopes = parameters.numbers("slopes_deg", slopes, {30});
    spec.frictions = parameters.numbers("friction_coefficients", {.low = 0, .high = 10}, {0.4});
    spec.varied_slope = parameters.number("varied_slope_deg", slopes, 30) * radians_per_degree;
    spec.varied_friction = parameters.number("varied_friction_coefficient", {.low = 0, .high = 10}, 0.4);
    spec.time_steps = parameters.numbers("time_steps_s", {.low = 0, .high = 1, .low_included = false}, {});
    spec.iteration_counts = parameters.numbers("iteration_counts", {.low = 1, .high = 1000}, {});
    spec.spacings = parameters.numbers("spacings_m", positive, {});
    spec.spacing = parameters.number("particle_spacing_m", positive, 0.3);
    spec.length = parameters.number("length_m", positive, 24);
    spec.layers = parameters.whole_number("layers", {.low = 1, .high = 100}, 3);
    spec.width = parameters.whole_number("width_spacings", {.low = 2, .high = 1000}, 5);
    spec.start = parameters.number("start_s", {.low = 0}, 0.2);
    spec.end = parameters.number("end_s", positive, 1.2);
    spec.rest_start = parameters.number("rest_start_s", {.low = 0}, 2);
    spec.rest_end = parameters.number("rest_end_s", positive, 4);
    for (double& slope : spec.slopes) slope *= radians_per_degree;
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace sliding_slab

Kind sliding_slab_kind() {
    return {"sliding_slab", "a slab on an incline between frictionless walls", sliding_slab::quantities,
            sliding_slab::prepare};
}

}  // namespace talus::validate
