#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "depth/inflow.hpp"
#include "sim/sources/inflow.hpp"
#include "sim/sources/seed.hpp"
#include "validate/grid_flow.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/measure.hpp"
#include "validate/rows.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace inflow_plane {

constexpr Quantity quantities[] = {
    {"thickness", "m", true, Quantity::Site::none, "mean of the steady part of the stream"},
    {"velocity", "m/s", true, Quantity::Site::none, "the same, down the slope"},
    {"discharge", "m3/s", true, Quantity::Site::none, "thickness x velocity x width there"},
    {"particles", "1", true, Quantity::Site::none, "that came in, over the volume of the hydrograph"},
    {"speed_excess", "m/s", false, Quantity::Site::none,
     "greatest speed of a particle near the line, over the inflow's"},
    {"volume", "m3", true, Quantity::Site::none,
     "that came in and is there or beyond the edge, by the depth-averaged model"},
    {"normal_depth", "m", true, Quantity::Site::none,
     "thickness far below the line with Voellmy's law, by the depth-averaged model"},
};

struct PlaneSpec {
    double slope = 0, thickness = 0, velocity = 0, spacing = 0, time = 0;
    int width = 0;                                  // spacings
    double voellmy_friction = 0, voellmy_drag = 0;  // 1, m/s2
};

/// A strip of the plane into which debris flows at place 0, by the depth-averaged model.
struct GridStream {
    GridIncline incline;
    depth::Inflows inflows;
    double volume = 0, law_volume = 0;  // m3, that came in
    std::string problem;
};

GridStream grid_stream(const PlaneSpec& spec, const params::MaterialSpec& material, double friction, double cell,
                       double length, double time, const Watch& watch) {
    GridIncline incline({spec.slope, -10 * cell, length + 10 * cell, 0, cell}, material, friction,
                        [](double, double) { return 0.0; });
    const double width = incline.solver().geometry().cell, discharge = spec.thickness * spec.velocity * width;
    terrain::Inflow inflow;
    inflow.from = {incline.x_at(0), 0};
    inflow.to = {incline.x_at(0), width};
    inflow.hydrograph = {{0, discharge, spec.velocity}, {time, discharge, spec.velocity}};
    GridStream stream{incline, depth::Inflows(incline.solver(), {inflow}), 0, inflow.volume(), ""};
    depth::Solver& solver = stream.incline.solver();
    Grid<float> added(solver.geometry());
    while (stream.problem.empty() && solver.time() < time - 1e-9) {
        const Result<double> came = stream.inflows.advance(solver, time - solver.time(), added);
        stream.problem = !came ? came.error().message : watch.stopped() ? "stopped by the user" : "";
    }
    stream.volume = solver.volume() + solver.volume_left();
    return stream;
}

/// Means over the columns between two places along the slope.
struct StreamMeans {
    double thickness = 0, velocity = 0;
};
StreamMeans means_between(const GridIncline& incline, double first, double last) {
    StreamMeans means;
    int count = 0;
    for (int column = 0; column < incline.columns(); ++column) {
        if (incline.along(column) < first || incline.along(column) >= last) continue;
        means.thickness += incline.thickness(column, 0);
        means.velocity += incline.velocity(column, 0);
        ++count;
    }
    return {means.thickness / count, means.velocity / count};
}

void compute_grid(const PlaneSpec& spec, const Setting& setting, const Watch& watch, double first, double last,
                  Outcome& outcome) {
    Rows rows(watch, outcome, "depth-averaged");
    const GridStream stream = rows.noted(grid_stream(spec, setting.material, std::tan(spec.slope), spec.spacing,
                                                     1.6 * spec.velocity * spec.time, spec.time, watch));
    const StreamMeans means = means_between(stream.incline, first, last);
    const double width = spec.width * spec.spacing;
    rows.add("volume", stream.volume, stream.law_volume);
    rows.add("thickness", means.thickness, spec.thickness);
    rows.add("velocity", means.velocity, spec.velocity);
    rows.add("discharge", means.thickness * means.velocity * width, spec.thickness * spec.velocity * width);

    // v^2 = xi h (sin - f cos) and q = v h.
    const double discharge = spec.thickness * spec.velocity;
    const double drive = std::sin(spec.slope) - spec.voellmy_friction * std::cos(spec.slope);
    if (!(drive > 0)) return;
    const double law = std::cbrt(discharge * discharge / (spec.voellmy_drag * drive)), time = 5 * spec.time;
    params::MaterialSpec voellmy = setting.material;
    voellmy.turbulent_friction = spec.voellmy_drag;
    const double length = 0.8 * discharge / law * time;
    const GridStream far = grid_stream(spec, voellmy, spec.voellmy_friction, 5 * spec.spacing, length, time, watch);
    if (!far.problem.empty()) outcome.notes.push_back("depth-averaged, Voellmy: " + far.problem);
    rows.add("normal_depth", means_between(far.incline, 0.6 * length, 0.8 * length).thickness, law);
}

Result<Outcome> compute(const PlaneSpec& spec, const Setting& setting, const Watch& watch) {
    const double width = spec.width * spec.spacing, reach = 1.6 * spec.velocity * spec.time;
    const Incline incline(spec.slope, 2 * reach + 10, width + 4);
    params::MaterialSpec material = setting.material;
    material.building_friction_coefficient = 0;
    material.friction_coefficient = std::tan(spec.slope);  // driving force and resistance are equal
    sim::Model model = sim::make_model(material, setting.solver, spec.spacing);
    sim::Ground ground(incline.terrain(), make_slice(incline.terrain(), width, 20 * spec.thickness),
                       model.support_radius);
    terrain::Inflow inflow;
    const LocalPoint line = incline.point(-reach / 2, 0, 0);
    const WorldPoint at = incline.terrain().frame().to_world(line);
    inflow.from = {at.x, at.y - width / 2};
    inflow.to = {at.x, at.y + width / 2};
    const double discharge = spec.thickness * spec.velocity * width;
    inflow.hydrograph = {{0, discharge, spec.velocity}, {spec.time, discharge, spec.velocity}};
    sim::InflowFeeder feeder(model, incline.terrain().frame(), {inflow});
    watch.say(fmt::format("{} particles", feeder.remaining()));
    Trial trial({std::move(model), std::move(ground), sim::State{}, std::move(feeder)}, watch);
    const sim::State& state = trial.state();
    double fastest = 0;
    Outcome outcome;
    while (trial.problem().empty() && state.time < spec.time - 1e-9) {
        trial.advance_to(state.time + 1e-6);
        for (std::uint32_t i = 0; i < state.count; ++i) {
            const double beyond = incline.along(state.position.at(i)) + reach / 2;
            if (beyond < 4 * spec.spacing) fastest = std::max<double>(fastest, length(state.velocity.at(i)));
        }
    }
    trial.inject_inflow();  // the remainder that had not filled a row yet
    if (!trial.problem().empty()) outcome.notes.push_back(trial.problem());
    const double volume = (state.count + state.outflow) * trial.model().particle_volume();
    outcome.measurements.push_back({"particles", "", volume, inflow.volume_until(state.time)});
    // The front has no influence farther upstream than this.
    const double wave = std::sqrt(trial.model().gravity * incline.cosine() * spec.thickness);
    const double first = 10 * spec.spacing, last = 0.9 * (spec.velocity - wave) * state.time;
    double speeds = 0, count = 0;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const double beyond = incline.along(state.position.at(i)) + reach / 2;
        if (beyond < first || beyond >= last) continue;
        speeds += dot(state.velocity.at(i), incline.down(1));
        count += 1;
    }
    const double thickness = count * trial.model().particle_volume() / ((last - first) * width);
    const double velocity = count > 0 ? speeds / count : not_computed;
    outcome.measurements.push_back({"thickness", "", thickness, spec.thickness});
    outcome.measurements.push_back({"velocity", "", velocity, spec.velocity});
    outcome.measurements.push_back({"discharge", "", thickness * velocity * width, discharge});
    outcome.measurements.push_back({"speed_excess", "", fastest - spec.velocity, std::nullopt});
    compute_grid(spec, setting, watch, first, last, outcome);
    const double cell = 5 * spec.spacing;
    const int cells = static_cast<int>(1.2 * spec.velocity * spec.time / cell);
    Series profile{"computed", Series::Style::line, {}, {}}, law{"discharge / velocity", Series::Style::dashed, {}, {}};
    const auto along = thickness_profile(trial.model(), state, 0, cell, cells, width, [&](std::uint32_t i) {
        return incline.along(state.position.at(i)) + reach / 2;
    });
    for (int k = 0; k < cells; ++k) {
        profile.x.push_back((k + 0.5) * cell);
        profile.y.push_back(along[static_cast<std::size_t>(k)]);
        law.x.push_back((k + 0.5) * cell);
        law.y.push_back(profile.x.back() < spec.velocity * state.time ? spec.thickness : 0);
    }
    outcome.charts.push_back({"profile",
                              "Thickness of the stream along the slope",
                              "distance from the line, m",
                              "thickness, m",
                              {law, profile}});
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    PlaneSpec spec;
    spec.slope = parameters.number("slope_deg", {.low = 0, .high = 60}, 25) * std::numbers::pi / 180;
    spec.thickness = parameters.number("thickness_m", positive, 0.6);
    spec.velocity = parameters.number("velocity_mps", positive, 6);
    spec.spacing = parameters.number("particle_spacing_m", positive, 0.1);
    spec.time = parameters.number("time_s", positive, 4);
    spec.width = parameters.whole_number("width_spacings", {.low = 2, .high = 1000}, 8);
    spec.voellmy_friction = parameters.number("voellmy_friction_coefficient", {.low = 0, .high = 10}, 0.2);
    spec.voellmy_drag = parameters.number("voellmy_turbulent_friction_mps2", {.low = 1, .high = 1e6}, 500);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace inflow_plane

Kind inflow_plane_kind() {
    return {"inflow_plane", "a constant inflow on an incline where friction balances gravity", inflow_plane::quantities,
            inflow_plane::prepare};
}

}  // namespace talus::validate
