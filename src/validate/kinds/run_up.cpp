#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "sim/sources/seed.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/laws.hpp"
#include "validate/measure.hpp"
#include "validate/rows.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace run_up {

constexpr Quantity quantities[] = {
    {"run_up", "1", true, Quantity::Site::none,
     "greatest height over the depth of the stream: of debris at a wall, of the ground reached on a ramp"},
};

struct RunUpSpec {
    std::vector<double> froudes;
    double depth = 0, spacing = 0, ramp_angle = 0;  // m, m, rad
    double length = 0;                              // depths
    int width = 0;                                  // spacings
};

struct Measured {
    double run_up = not_computed;
    std::string problem;
};

/// A stream of finite length hits a wall, or a ramp, at x = 0, where its head starts.
Measured measure(const RunUpSpec& spec, bool ramp, double froude, const Setting& setting, const Watch& watch) {
    const double width = spec.width * spec.spacing, gravity = sim::Model{}.gravity;
    const double wave = std::sqrt(gravity * spec.depth), speed = froude * wave;
    const double stream = spec.length * spec.depth;
    const double reach = stream + 5 * spec.depth + 2 * momentum_jump(froude) * spec.depth / std::tan(spec.ramp_angle);
    const double slope = std::tan(spec.ramp_angle);
    const terrain::Terrain terrain = make_terrain(2 * reach, width + 4, spec.depth / 4,
                                                  [&](double x, double) { return ramp && x > 0 ? slope * x : 0; });
    const double top = 4 * momentum_jump(froude) * spec.depth;
    std::vector<terrain::Building> walls = make_slice(terrain, width, top);
    const Extent e = terrain.elevation().geometry.extent();
    if (!ramp) walls.push_back(make_wall(terrain, 0, e.y_min, e.x_max, e.y_max, top));
    params::MaterialSpec material = setting.material;
    material.building_friction_coefficient = 0;
    sim::Model model = sim::make_model(material, setting.solver, spec.spacing);
    sim::Ground ground(terrain, walls, model.support_radius);
    const auto columns = static_cast<int>(std::lround(stream / spec.spacing));
    const auto layers = static_cast<int>(std::lround(spec.depth / spec.spacing));
    sim::State start = state_at_rest(fill_block(0, 0, columns, spec.width, layers, spec.spacing));
    for (std::uint32_t i = 0; i < start.count; ++i) start.velocity.x[i] = static_cast<float>(speed);
    // Jets at the obstacle are faster than a fall explains. The run-up is the required result, so the run continues.
    Trial trial({std::move(model), std::move(ground), std::move(start)}, watch, OnFault::note);
    const sim::State& state = trial.state();
    const double cell = spec.depth / 2;
    const int cells = ramp ? static_cast<int>(reach / cell) : 1;
    double highest = 0;
    const auto look = [&] {
        const auto thickness = thickness_profile(trial.model(), state, ramp ? 0 : -cell, cell, cells, width,
                                                 [&](std::uint32_t i) { return double{state.position.x[i]}; });
        for (int k = 0; k < cells; ++k) {
            const double here = thickness[static_cast<std::size_t>(k)];
            if (ramp && here < 0.1 * spec.depth) continue;
            highest = std::max(highest, ramp ? slope * (k + 0.5) * cell : here);
        }
    };
    // Until the stream's other end affects the obstacle.
    const bool trusted = trial.advance_to(stream / (speed + wave), look);
    Measured measured;
    if (trusted) measured.run_up = highest / spec.depth;
    measured.problem = trial.problem();
    return measured;
}

Result<Outcome> compute(const RunUpSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    Series law{"momentum jump", Series::Style::dashed, {}, {}}, head{"v² / 2g", Series::Style::dashed, {}, {}};
    const double last = *std::max_element(spec.froudes.begin(), spec.froudes.end());
    for (int k = 0; k <= 100; ++k) {
        const double froude = last * k / 100;
        law.x.push_back(froude);
        law.y.push_back(momentum_jump(froude));
        head.x.push_back(froude);
        head.y.push_back(1 + froude * froude / 2);
    }
    Chart chart{"run_up", "Run-up against the Froude number", "Froude number", "run-up / depth", {law, head}};
    for (const bool ramp : {false, true}) {
        const std::string obstacle =
            ramp ? fmt::format("{:.0f} degree ramp", spec.ramp_angle * 180 / std::numbers::pi) : "vertical wall";
        Series computed{obstacle, Series::Style::marks, {}, {}};
        for (const double froude : spec.froudes) {
            Rows rows(watch, outcome, fmt::format("{}, Fr = {:g}", obstacle, froude));
            const Measured m = rows.noted(measure(spec, ramp, froude, setting, watch));
            rows.add("run_up", m.run_up, momentum_jump(froude));
            computed.x.push_back(froude);
            computed.y.push_back(m.run_up);
        }
        chart.series.push_back(computed);
    }
    outcome.charts.push_back(chart);
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    RunUpSpec spec;
    spec.froudes = parameters.numbers("froude_numbers", {.low = 0, .high = 20, .low_included = false}, {2});
    spec.depth = parameters.number("depth_m", positive, 1);
    spec.spacing = parameters.number("particle_spacing_m", positive, 0.1);
    spec.ramp_angle = parameters.number("ramp_deg", {.low = 1, .high = 60}, 30) * std::numbers::pi / 180;
    spec.length = parameters.number("length_depths", positive, 15);
    spec.width = parameters.whole_number("width_spacings", {.low = 2, .high = 1000}, 5);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace run_up

Kind run_up_kind() {
    return {"run_up", "a stream runs up a wall and a ramp", run_up::quantities, run_up::prepare};
}

}  // namespace talus::validate
