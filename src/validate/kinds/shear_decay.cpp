#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "sim/sources/seed.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/rows.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace shear_decay {

constexpr Quantity quantities[] = {
    {"kinematic_viscosity", "m2/s", true, Quantity::Site::none, "from the decay of a shear mode, without gravity"},
};

/// Near the block's sides particles have fewer neighbours. This effect spreads inwards like shear itself: by a fraction
/// of the height within this share of the mode's lifetime.
constexpr double share_of_life = 0.2;

struct ShearSpec {
    std::vector<double> viscosities, time_steps, spacings;  // mu; s; m
    double time_step = 0, spacing = 0;                      // s, m, where the others are varied
    int height = 0, width = 0;                              // spacings
};

struct Measured {
    double viscosity = not_computed, law = not_computed;
    std::string problem;
    std::vector<double> time, amplitude;
};

/// A free block whose layers slide over each other as a cosine of the height, with no shear at its top and bottom: it
/// decays as exp(-nu k^2 t). Slow enough that other effects are negligible.
Measured measure(const ShearSpec& spec, double viscosity, double time_step, double spacing, const Setting& setting,
                 const Watch& watch) {
    constexpr double fastest = 1e-3;  // m/s
    const double height = spec.height * spacing, width = spec.width * spacing, above = 10 * spacing;
    const Incline flat(0, 4 * width + 4, 4 * width + 4);
    params::MaterialSpec material = setting.material;
    material.viscosity = viscosity;
    material.friction_coefficient = 0;
    material.internal_friction_coefficient = 0;
    params::SolverSpec solver = setting.solver;
    solver.time_step = time_step;
    sim::Model model = sim::make_model(material, solver, spacing);
    sim::Ground ground(flat.terrain());
    model.gravity = 0;
    std::vector<LocalPoint> points = fill_lattice(flat, spacing, -width / 2, spec.width, -width / 2, spec.width,
                                                  [&](double, double) { return height; });
    sim::State start = state_at_rest(points);
    const double wave_number = std::numbers::pi / height;
    std::vector<std::uint8_t> middle(points.size());
    for (std::uint32_t i = 0; i < start.count; ++i) {
        middle[i] = std::abs(points[i].x) < width / 6 && std::abs(points[i].y) < width / 6;
        start.velocity.x[i] = static_cast<float>(fastest * std::cos(wave_number * points[i].z));
        start.position.z[i] += static_cast<float>(above);
    }
    Trial trial({std::move(model), std::move(ground), std::move(start)}, watch);
    const sim::State& state = trial.state();
    const auto amplitude = [&] {
        double sum = 0;
        int count = 0;
        for (std::uint32_t i = 0; i < state.count; ++i) {
            if (!middle[state.id[i]]) continue;
            sum += state.velocity.x[i] * std::cos(wave_number * (state.position.z[i] - above));
            ++count;
        }
        return 2 * sum / count / fastest;
    };
    Measured measured;
    measured.law = trial.model().kinematic_viscosity;
    const double life = 1 / (measured.law * wave_number * wave_number);
    constexpr int samples = 40;
    for (int k = 0; k <= samples; ++k) {
        if (!trial.advance_to(share_of_life * life * k / samples)) {
            measured.problem = trial.problem();
            return measured;
        }
        measured.time.push_back(state.time / life);
        measured.amplitude.push_back(amplitude());
    }
    measured.viscosity =
        -std::log(measured.amplitude.back() / measured.amplitude.front()) / (state.time * wave_number * wave_number);
    return measured;
}

Result<Outcome> compute(const ShearSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    Chart chart{"decay",
                "Decay of a shear mode",
                "time over the mode's life 1 / (nu k²)",
                "amplitude",
                {{"exp(-nu k² t)", Series::Style::dashed, {}, {}}}};
    for (int k = 0; k <= 100; ++k) {
        chart.series[0].x.push_back(share_of_life * k / 100);
        chart.series[0].y.push_back(std::exp(-share_of_life * k / 100));
    }
    const auto add = [&](double viscosity, double time_step, double spacing) {
        Rows rows(watch, outcome,
                  fmt::format("mu = {:g}, dt = 1/{:.0f} s, spacing {:g} m", viscosity, 1 / time_step, spacing));
        const Measured m = rows.noted(measure(spec, viscosity, time_step, spacing, setting, watch));
        rows.add("kinematic_viscosity", m.viscosity, m.law);
        chart.series.push_back({rows.name(), Series::Style::line, m.time, m.amplitude});
    };
    for (const double viscosity : spec.viscosities) add(viscosity, spec.time_step, spec.spacing);
    for (const double time_step : spec.time_steps) add(spec.viscosities.front(), time_step, spec.spacing);
    for (const double spacing : spec.spacings) add(spec.viscosities.front(), spec.time_step, spacing);
    outcome.charts.push_back(chart);
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    constexpr params::Range time_steps{.low = 0, .high = 1, .low_included = false};
    ShearSpec spec;
    spec.viscosities =
        parameters.numbers("viscosities", {.low = 0, .high = 1, .low_included = false, .high_included = false}, {0.1});
    spec.time_steps = parameters.numbers("time_steps_s", time_steps, {});
    spec.spacings = parameters.numbers("spacings_m", positive, {});
    spec.time_step = parameters.number("time_step_s", time_steps, 1.0 / 60);
    spec.spacing = parameters.number("particle_spacing_m", positive, 0.3);
    spec.height = parameters.whole_number("height_spacings", {.low = 4, .high = 1000}, 16);
    spec.width = parameters.whole_number("width_spacings", {.low = 6, .high = 1000}, 24);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace shear_decay

Kind shear_decay_kind() {
    return {"shear_decay", "a shear mode decays by viscosity alone", shear_decay::quantities, shear_decay::prepare};
}

}  // namespace talus::validate
