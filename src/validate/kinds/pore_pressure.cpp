#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/angle.hpp"
#include "sim/model.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/rows.hpp"

namespace talus::validate {
namespace pore_pressure {

using Soil = sim::Soil<double>;

constexpr Quantity quantities[] = {
    {"consolidation", "1", true, Quantity::Site::none,
     "rate at which a small excess at rest falls, over that of the law"},
    {"first_mode", "1", true, Quantity::Site::none, "the same over that of the first mode of diffusion"},
    {"undrained_change", "1", false, Quantity::Site::none, "of the pressure ratio at rest, where no water moves"},
    {"drained_excess", "1", false, Quantity::Site::none,
     "of the pressure ratio over hydrostatic, where water moves freely"},
    {"liquefaction_time", "s", true, Quantity::Site::none, "from the start until pressure bears 95 % of the weight"},
    {"creep_speed", "m/s", true, Quantity::Site::none, "at the end, and that at which water is sucked in"},
    {"way", "m", false, Quantity::Site::none, "in 10 s from when the slope is about to fail"},
};

struct SoilSpec {
    double slope = 0, thickness = 0;               // rad, m
    std::vector<double> liquefies, creeps, moves;  // solid fractions at the start
    double time_step = 0;                          // s
};

/// A slab on an infinite slope, about to fail, by the law that particles carry.
class Slab {
  public:
    Slab(const SoilSpec& spec, const Setting& setting, double fraction)
        : spec_(spec),
          law_(sim::evolving_pressure_of(setting.material)),
          friction_(setting.material.friction_coefficient) {
        const double psi = fraction - law_.critical_solid_fraction;
        const double angle = (friction_ + psi) / (1 - friction_ * psi);
        soil_ = {fraction, 1 - std::tan(spec.slope) / angle + 1e-4, spec.thickness, psi};
    }

    void advance() {
        const double pull = gravity_ * std::sin(spec_.slope);
        const double holds = normal_gravity() * friction_ * sim::friction_share(soil_, friction_);
        speed_ = std::max(0.0, speed_ + (pull - holds) * spec_.time_step);
        soil_ = sim::evolve(law_, soil_, normal_gravity(), spec_.thickness, speed_, spec_.time_step);
        way_ += speed_ * spec_.time_step;
        time_ += spec_.time_step;
    }

    [[nodiscard]] double time() const { return time_; }
    [[nodiscard]] double speed() const { return speed_; }
    [[nodiscard]] double way() const { return way_; }
    [[nodiscard]] double pressure_ratio() const { return soil_.pressure_ratio; }
    /// Water is sucked in through the pressure that the slope leaves, at the rate at which shear dilates: u = k (p_h -
    /// p) / (mu h tan psi).
    [[nodiscard]] double creep_of_law() const {
        const double m = soil_.solid_fraction, h = spec_.thickness;
        const double weight = (law_.grain_density * m + law_.fluid_density * (1 - m)) * normal_gravity() * h;
        const double k = law_.permeability * std::exp((law_.solid_fraction - m) / sim::permeability_fall);
        const double below = law_.fluid_density * normal_gravity() * h - soil_.pressure_ratio * weight;
        return k * below / (law_.viscosity * h * soil_.dilatancy);
    }

  private:
    [[nodiscard]] double normal_gravity() const { return gravity_ * std::cos(spec_.slope); }

    SoilSpec spec_;
    sim::EvolvingPressure law_;
    double friction_, gravity_ = sim::ModelValues{}.gravity;
    Soil soil_;
    double time_ = 0, speed_ = 0, way_ = 0;
};

double hydrostatic(const sim::EvolvingPressure& law, double fraction) {
    return law.fluid_density / (law.grain_density * fraction + law.fluid_density * (1 - fraction));
}

Soil at_rest_after(const sim::EvolvingPressure& law, Soil soil, double thickness, double time, int steps) {
    const double gravity = sim::ModelValues{}.gravity;
    for (int k = 0; k < steps; ++k) soil = sim::evolve(law, soil, gravity, thickness, 0.0, time / steps);
    return soil;
}

void add_consolidation(const Setting& setting, const Watch& watch, Outcome& outcome) {
    constexpr double thickness = 0.001, excess = 0.01;  // so thin that its weight is nothing beside sigma_0
    const sim::EvolvingPressure law = sim::evolving_pressure_of(setting.material);
    const double m = law.solid_fraction, gravity = sim::ModelValues{}.gravity, rest = hydrostatic(law, m);
    const double density = law.fluid_density / rest, buoyant = density - law.fluid_density;
    const double stress = buoyant * gravity * thickness + sim::reference_stress;
    const double diffusivity = law.permeability * m * stress / (law.compressibility * law.viscosity);
    const double weight_term =
        law.permeability * gravity * law.fluid_density * buoyant / (2 * thickness * law.viscosity * density);
    const double expected = 3 * diffusivity / (thickness * thickness) + weight_term;
    const double first_mode = std::numbers::pi * std::numbers::pi / 4 * diffusivity / (thickness * thickness);
    for (const int steps : {1, 100}) {
        Rows rows(watch, outcome, steps == 1 ? "at rest, one step" : fmt::format("at rest, {} steps", steps));
        const double time = 1 / expected;
        const Soil after = at_rest_after(law, {m, rest + excess, thickness, 0}, thickness, time, steps);
        const double rate = -std::log((after.pressure_ratio - rest) / excess) / time;
        rows.add("consolidation", rate / expected, 1);
        rows.add("first_mode", rate / first_mode, 1);
    }
}

void add_limits(const Setting& setting, const Watch& watch, Outcome& outcome) {
    constexpr double thickness = 1, high = 0.9;
    const sim::EvolvingPressure law = sim::evolving_pressure_of(setting.material);
    for (const double step : {1e-4, 0.01, 1.0}) {
        Rows rows(watch, outcome, fmt::format("limits, dt = {:g} s", step));
        sim::EvolvingPressure tight = law, open = law;
        tight.permeability = 0;
        open.permeability = 1e-3;
        const Soil start{law.solid_fraction, high, thickness, 0};
        rows.add("undrained_change", at_rest_after(tight, start, thickness, step, 1).pressure_ratio - high);
        const Soil drained = at_rest_after(open, start, thickness, 20 * step, 20);
        rows.add("drained_excess", drained.pressure_ratio - hydrostatic(law, drained.solid_fraction));
    }
}

Result<Outcome> compute(const SoilSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    add_consolidation(setting, watch, outcome);
    add_limits(setting, watch, outcome);
    Chart chart{"slope", "A slope that is about to fail, by its solid fraction", "time, s", "pore-pressure ratio", {}};
    const auto run = [&](double fraction, double end, const auto& until) {
        Slab slab(spec, setting, fraction);
        Series series{fmt::format("m = {:g}", fraction), Series::Style::line, {}, {}};
        double next = 0;
        while (slab.time() < end && !until(slab)) {
            slab.advance();
            if (slab.time() < next) continue;
            series.x.push_back(slab.time());
            series.y.push_back(slab.pressure_ratio());
            next += 0.05;
        }
        chart.series.push_back(series);
        return slab;
    };
    const auto never = [](const Slab&) { return false; };
    for (const double fraction : spec.liquefies) {
        Rows rows(watch, outcome, fmt::format("slope, m = {:g}", fraction));
        const Slab slab = run(fraction, 30, [](const Slab& s) { return s.pressure_ratio() > 0.95; });
        rows.add("liquefaction_time", slab.pressure_ratio() > 0.95 ? slab.time() : not_computed);
    }
    for (const double fraction : spec.creeps) {
        Rows rows(watch, outcome, fmt::format("slope, m = {:g}", fraction));
        const Slab slab = run(fraction, 60, never);  // the swing of the start has died away by then
        rows.add("creep_speed", slab.speed(), slab.creep_of_law());
    }
    for (const double fraction : spec.moves) {
        Rows rows(watch, outcome, fmt::format("slope, m = {:g}", fraction));
        rows.add("way", run(fraction, 10, never).way());
    }
    outcome.charts.push_back(chart);
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range fractions{.low = 0.4, .high = 0.75};
    SoilSpec spec;
    spec.slope = parameters.number("slope_deg", {.low = 1, .high = 60}, 31) * radians_per_degree;
    spec.thickness = parameters.number("thickness_m", {.low = 0.01, .high = 100}, 0.65);
    spec.liquefies = parameters.numbers("liquefies_at", fractions, {0.48});
    spec.creeps = parameters.numbers("creeps_at", fractions, {0.59});
    spec.moves = parameters.numbers("moves_at", fractions, {0.555, 0.565});
    spec.time_step = parameters.number("time_step_s", {.low = 1e-5, .high = 0.01}, 2e-4);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace pore_pressure

Kind pore_pressure_kind() {
    return {"pore_pressure", "pore pressure of soil at rest and on a slope about to fail", pore_pressure::quantities,
            pore_pressure::prepare};
}

}  // namespace talus::validate
