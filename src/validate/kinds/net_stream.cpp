#include <cmath>

#include <fmt/format.h>

#include "sim/physics/net.hpp"
#include "sim/sources/seed.hpp"
#include "terrain/barrier.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/laws.hpp"
#include "validate/rows.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace net_stream {

constexpr Quantity quantities[] = {
    {"impulse", "N s/m", true, Quantity::Site::none,
     "on the net per metre of it, against the momentum along the stream that the debris has lost"},
    {"coarse_through", "m3", false, Quantity::Site::none, "beyond the net, in grains larger than its meshes"},
    {"passed_layers", "1", true, Quantity::Site::none,
     "volume through the net per area of it that the stream has filled, in spacings, against passing / (1 - passing)"},
};

struct NetSpec {
    std::vector<double> passing, spacings;                // share, m
    double froude = 0, depth = 0, length = 0, width = 0;  // 1, m, depths, depths
};

struct Measured {
    double impulse = not_computed, lost = not_computed, coarse = not_computed, layers = not_computed;
    std::string problem;
    Series history;
};

/// A stream on level ground, between frictionless walls, whose head is at a net across it when it is released.
Measured measure(const NetSpec& spec, double passing, double spacing, const Setting& setting, const Watch& watch) {
    const auto across = static_cast<int>(std::lround(spec.width * spec.depth / spacing));
    const auto layers = static_cast<int>(std::lround(spec.depth / spacing));
    const auto columns = static_cast<int>(std::lround(spec.length * spec.depth / spacing));
    const double width = across * spacing, wave = std::sqrt(sim::Model{}.gravity * spec.depth);
    const double speed = spec.froude * wave, stream = columns * spacing;
    const double top = 4 * momentum_jump(spec.froude) * spec.depth;
    const terrain::Terrain terrain =
        make_terrain(2 * (stream + 8 * spec.depth), width + 4, 1, [](double, double) { return 0; });
    std::vector<terrain::Building> solids = make_slice(terrain, width, top);
    const double thickness = 2 * spacing, x = thickness / 2;
    const auto net =
        make_barrier(terrain, "net", {{{x, -width / 2 - 0.5}, {x, width / 2 + 0.5}}, top, {}, thickness, {}, passing});
    if (!net) {
        Measured none;
        none.problem = net.error().message;
        return none;
    }
    solids.push_back(*net);
    params::MaterialSpec material = setting.material;
    material.building_friction_coefficient = 0;
    sim::Model model = sim::make_model(material, setting.solver, spacing);
    sim::Ground ground(terrain, solids, model.support_radius);
    sim::State start = state_at_rest(fill_block(0, 0, columns, across, layers, spacing));
    for (std::uint32_t i = 0; i < start.count; ++i) start.velocity.x[i] = static_cast<float>(speed);
    const double before = momentum_along(model, start);
    params::OutputSpec outputs;
    outputs.sample_interval = 0.05 * stream / (speed + wave);
    outputs.map_cell = spec.depth;
    Trial trial({std::move(model), std::move(ground), std::move(start), {}, {}, outputs}, watch, OnFault::note,
                Observed::yes);
    const observe::Observer& observer = trial.observer();
    const bool done = trial.advance_to(stream / (speed + wave));
    Measured measured;
    measured.problem = trial.problem();
    if (!done) return measured;
    const observe::BuildingImpact& impact = observer.impacts()[2];
    const sim::State& state = trial.state();
    const double volume = trial.model().particle_volume();
    measured.impulse = impact.impulse / width;
    measured.lost = (before - momentum_along(trial.model(), state)) / width;
    measured.coarse = 0;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (state.position.x[i] > thickness && sim::grain_rank(state.id[i]) >= static_cast<float>(passing)) {
            measured.coarse += volume;
        }
    }
    const double layer = impact.peak_filling_height * width * spacing;
    measured.layers = impact.passed_volume / layer;
    for (const observe::StructureSample& s : impact.history) {
        measured.history.x.push_back(s.time);
        measured.history.y.push_back(s.passed_volume / layer);
    }
    return measured;
}

Result<Outcome> compute(const NetSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    Chart chart{"passed", "Volume through the net", "time, s", "layers of one spacing", {}};
    double finest = spec.spacings.front();
    for (const double spacing : spec.spacings) finest = std::min(finest, spacing);
    for (const double passing : spec.passing) {
        double end = 0;
        for (const double spacing : spec.spacings) {
            Rows rows(watch, outcome, fmt::format("passing = {:g}, spacing {:g} m", passing, spacing),
                      spacing > finest);
            Measured m = rows.noted(measure(spec, passing, spacing, setting, watch));
            rows.add("impulse", m.impulse, m.lost);
            rows.add("coarse_through", m.coarse);
            rows.add("passed_layers", m.layers, passing / (1 - passing));
            m.history.name = rows.name();
            if (!m.history.x.empty()) end = std::max(end, m.history.x.back());
            chart.series.push_back(std::move(m.history));
        }
        const double law = passing / (1 - passing);
        chart.series.push_back(
            {fmt::format("{:g}, p / (1 - p)", passing), Series::Style::dashed, {0, end}, {law, law}});
    }
    outcome.charts.push_back(std::move(chart));
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    NetSpec spec;
    spec.passing = parameters.numbers("passing_shares", {.low = 0, .high = 1, .high_included = false}, {0.3, 0.6});
    spec.spacings = parameters.numbers("particle_spacings_m", positive, {0.25, 0.125});
    spec.froude = parameters.number("froude_number", {.low = 0, .high = 20, .low_included = false}, 2);
    spec.depth = parameters.number("depth_m", positive, 1);
    spec.length = parameters.number("length_depths", positive, 10);
    spec.width = parameters.number("width_depths", positive, 1);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace net_stream

Kind net_stream_kind() {
    return {"net_stream", "a stream at a net: what it holds, and the load on it", net_stream::quantities,
            net_stream::prepare};
}

}  // namespace talus::validate
