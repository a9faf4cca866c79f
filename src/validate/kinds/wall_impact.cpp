#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sim/sources/seed.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/laws.hpp"
#include "validate/rows.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace wall_impact {

constexpr Quantity quantities[] = {
    {"impulse", "N s/m", true, Quantity::Site::none,
     "on the wall per metre of it, against the momentum along the stream that the debris has lost"},
    {"force", "N/m", true, Quantity::Site::none,
     "mean on the wall per metre of it while the stream arrives, against momentum flux and static share"},
    {"peak_force", "N/m", true, Quantity::Site::none, "greatest filtered force, against the same"},
};

struct ImpactSpec {
    std::vector<double> froudes;
    double depth = 0, spacing = 0, length = 0;  // m, m, depths
    int width = 0;                              // spacings
};

struct Measured {
    double impulse = not_computed, lost = 0, force = not_computed, peak = not_computed;
    std::string problem;
    Series history;
};

/// A stream on level ground, between frictionless walls, whose head is at a wall across it when it is released.
Measured measure(const ImpactSpec& spec, double froude, const Setting& setting, const Watch& watch) {
    const double width = spec.width * spec.spacing, wave = std::sqrt(sim::Model{}.gravity * spec.depth);
    const double speed = froude * wave, stream = spec.length * spec.depth;
    const terrain::Terrain terrain =
        make_terrain(2 * (stream + 8 * spec.depth), width + 4, 1, [](double, double) { return 0; });
    const double top = 4 * momentum_jump(froude) * spec.depth;
    std::vector<terrain::Building> walls = make_slice(terrain, width, top);
    const Extent e = terrain.elevation().geometry.extent();
    walls.push_back(make_wall(terrain, 0, e.y_min, e.x_max, e.y_max, top));
    params::MaterialSpec material = setting.material;
    material.building_friction_coefficient = 0;
    sim::Model model = sim::make_model(material, setting.solver, spec.spacing);
    sim::Ground ground(terrain, walls, model.support_radius);
    const auto columns = static_cast<int>(std::lround(stream / spec.spacing));
    const auto layers = static_cast<int>(std::lround(spec.depth / spec.spacing));
    sim::State start = state_at_rest(fill_block(0, 0, columns, spec.width, layers, spec.spacing));
    for (std::uint32_t i = 0; i < start.count; ++i) start.velocity.x[i] = static_cast<float>(speed);
    const double before = momentum_along(model, start);
    params::OutputSpec outputs;
    outputs.impact_filter_window = 0.2 * spec.depth / wave;
    outputs.sample_interval = 0.05 * stream / (speed + wave);
    outputs.map_cell = spec.depth;
    Trial trial({std::move(model), std::move(ground), std::move(start), {}, {}, outputs}, watch, OnFault::note,
                Observed::yes);
    const observe::Observer& observer = trial.observer();
    // Until the stream's other end affects the wall, without the splash of the first fifth.
    const double end = stream / (speed + wave);
    double early = 0;
    const auto look = [&] {
        if (trial.state().time < end / 5) early = observer.impacts()[2].impulse;
    };
    Measured measured;
    if (!trial.advance_to(end, look)) {
        measured.problem = trial.problem();
        return measured;
    }
    measured.problem = trial.problem();
    const observe::BuildingImpact& wall = observer.impacts()[2];
    measured.impulse = wall.impulse / width;
    measured.lost = (before - momentum_along(trial.model(), trial.state())) / width;
    measured.force = (wall.impulse - early) / (0.8 * end) / width;
    measured.peak = wall.peak_force / width;
    for (const observe::StructureSample& s : wall.history) {
        measured.history.x.push_back(s.time);
        measured.history.y.push_back(s.force / width / 1e3);
    }
    return measured;
}

Result<Outcome> compute(const ImpactSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    Chart chart{"force", "Force on the wall", "time, s", "force, kN/m", {}};
    const double gravity = sim::Model{}.gravity, density = setting.material.rest_density;
    for (const double froude : spec.froudes) {
        Rows rows(watch, outcome, fmt::format("Fr = {:g}", froude));
        Measured m = rows.noted(measure(spec, froude, setting, watch));
        // A stream that is reflected as a jump of x times its depth: rho h v (v + w) + rho g h^2 / 2 with the jump's
        // own speed w = v / (x - 1), which is the static force of the water behind the jump, rho g (x h)^2 / 2.
        const double jump = momentum_jump(froude) * spec.depth, law = density * gravity * jump * jump / 2;
        rows.add("impulse", m.impulse, m.lost);
        rows.add("force", m.force, law);
        rows.add("peak_force", m.peak, law);
        m.history.name = rows.name();
        const double end = m.history.x.empty() ? 0 : m.history.x.back();
        chart.series.push_back(std::move(m.history));
        chart.series.push_back(
            {rows.name() + ", momentum relation", Series::Style::dashed, {0, end}, {law / 1e3, law / 1e3}});
    }
    outcome.charts.push_back(std::move(chart));
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    ImpactSpec spec;
    spec.froudes = parameters.numbers("froude_numbers", {.low = 0, .high = 20, .low_included = false}, {2});
    spec.depth = parameters.number("depth_m", positive, 1);
    spec.spacing = parameters.number("particle_spacing_m", positive, 0.125);
    spec.length = parameters.number("length_depths", positive, 15);
    spec.width = parameters.whole_number("width_spacings", {.low = 2, .high = 1000}, 5);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace wall_impact

Kind wall_impact_kind() {
    return {"wall_impact", "force and impulse of a stream on a rigid wall", wall_impact::quantities,
            wall_impact::prepare};
}

}  // namespace talus::validate
