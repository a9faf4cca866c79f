#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "depth/entrainment.hpp"
#include "sim/sources/seed.hpp"
#include "validate/grid_flow.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/rows.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace growing_slab {

constexpr Quantity quantities[] = {
    {"volume", "1", true, Quantity::Site::none, "of the debris over that at the start, at the end"},
    {"speed", "m/s", true, Quantity::Site::none, "down the slope, mean over all debris, at the end"},
    {"missing", "1", false, Quantity::Site::none,
     "volume that the ground lost, less that by which the debris grew, over the latter"},
    {"jolt", "m/s", false, Quantity::Site::none,
     "most that the mean speed fell below the law's in any step, at the same time"},
};

struct GrowthSpec {
    double slope = 0, friction = 0, growth_rate = 0;         // rad, 1, 1/m
    std::vector<double> spacings;                            // m
    double length = 0, thickness = 0, width = 0, depth = 0;  // m; depth: of the bed
    double end = 0;                                          // s
};

/// With M' = E P and P' = M a, for any shape of the debris: M = M0 cosh(k t), P = M' / E, k = sqrt(E a).
struct GrowthLaw {
    double acceleration, growth_rate;
    [[nodiscard]] double rate() const { return std::sqrt(acceleration * growth_rate); }
    [[nodiscard]] double volume(double time) const { return std::cosh(rate() * time); }
    [[nodiscard]] double speed(double time) const {
        return std::sqrt(acceleration / growth_rate) * std::tanh(rate() * time);
    }
};

terrain::Bed bed_of(const GrowthSpec& spec, std::size_t cells) {
    terrain::Bed bed;
    terrain::BedMaterial material;
    material.growth_rate = spec.growth_rate;
    bed.materials = {material};
    bed.material_at.assign(cells, 1);
    bed.depth.assign(cells, static_cast<float>(spec.depth));
    bed.eroded.assign(cells, 0);
    return bed;
}

void compute_one(const GrowthSpec& spec, double spacing, const Setting& setting, const Watch& watch, Outcome& outcome) {
    Rows rows(watch, outcome, fmt::format("spacing {:.3g} m", spacing));
    params::MaterialSpec material = setting.material;
    material.friction_coefficient = spec.friction;
    material.building_friction_coefficient = 0;
    const double acceleration = sim::Model{}.gravity * (std::sin(spec.slope) - spec.friction * std::cos(spec.slope));
    const GrowthLaw law{acceleration, spec.growth_rate};
    const double furthest = 0.5 * acceleration * spec.end * spec.end;
    const Incline incline(spec.slope, 2 * (spec.length + furthest) + 10, spec.width + 4);
    sim::Model model = sim::make_model(material, setting.solver, spacing);
    sim::Ground ground(incline.terrain(), make_slice(incline.terrain(), spec.width, 3 * spec.thickness),
                       model.support_radius);
    ground.bed = bed_of(spec, ground.terrain.elevation().values.size());
    const auto columns = static_cast<int>(std::lround(spec.length / spacing));
    const auto across = static_cast<int>(std::lround(spec.width / spacing));
    const auto points = fill_lattice(incline, spacing, -columns * spacing / 2, columns, -spec.width / 2, across,
                                     [&](double, double) { return spec.thickness; });
    Trial trial({std::move(model), std::move(ground), state_at_rest(points)}, watch);
    const sim::State& state = trial.state();
    const LocalPoint down = incline.down(1);
    const auto speed = [&] {
        double sum = 0;
        for (std::uint32_t i = 0; i < state.count; ++i) sum += dot(state.velocity.at(i), down);
        return sum / state.count;
    };
    Series computed{rows.name(), Series::Style::line, {}, {}}, grown = computed;
    double jolt = 0;
    if (!trial.advance_to(spec.end, [&] {
            computed.x.push_back(state.time);
            computed.y.push_back(speed());
            grown.x.push_back(state.time);
            grown.y.push_back(static_cast<double>(state.count) / static_cast<double>(points.size()));
            jolt = std::max(jolt, law.speed(state.time) - computed.y.back());
        })) {
        rows.note(trial.problem());
        return;
    }
    const double area = incline.terrain().cell() * incline.terrain().cell();
    double lost = 0;
    for (const float eroded : trial.ground().bed.eroded) lost += eroded * area;
    const double gained = state.entrained * trial.model().particle_volume();
    rows.add("volume", grown.y.back(), law.volume(state.time));
    rows.add("speed", computed.y.back(), law.speed(state.time));
    rows.add("missing", gained > 0 ? lost / gained - 1 : not_computed);
    rows.add("jolt", jolt);
    outcome.charts[0].series.push_back(std::move(computed));
    outcome.charts[1].series.push_back(std::move(grown));
}

/// The same by the depth-averaged model, on a strip of the plane.
void compute_grid(const GrowthSpec& spec, double cell, const Setting& setting, const Watch& watch, Outcome& outcome) {
    Rows rows(watch, outcome, "depth-averaged");
    const double acceleration = sim::Model{}.gravity * (std::sin(spec.slope) - spec.friction * std::cos(spec.slope));
    const GrowthLaw law{acceleration, spec.growth_rate};
    const double furthest = 0.5 * acceleration * spec.end * spec.end;
    GridIncline incline({spec.slope, -2 * spec.length, 4 * spec.length + 2 * furthest, 0, cell}, setting.material,
                        spec.friction,
                        [&](double along, double) { return std::abs(along) < spec.length / 2 ? spec.thickness : 0; });
    depth::Solver& solver = incline.solver();
    depth::Entrainment bed(bed_of(spec, solver.geometry().size()));
    const double before = solver.volume();
    double entrained = 0, jolt = 0;
    const auto speed = [&] {
        double mass = 0, momentum = 0;
        for (int column = 0; column < incline.columns(); ++column) {
            mass += incline.thickness(column, 0);
            momentum += incline.thickness(column, 0) * incline.velocity(column, 0);
        }
        return momentum / mass;
    };
    Series computed{rows.name(), Series::Style::line, {}, {}}, grown = computed;
    while (solver.time() < spec.end - 1e-9) {
        const Status stepped = solver.advance(spec.end - solver.time());
        if (!stepped || watch.stopped()) {
            rows.note(stepped ? "stopped by the user" : stepped.error().message);
            return;
        }
        entrained += bed.entrain(solver);
        computed.x.push_back(solver.time());
        computed.y.push_back(speed());
        grown.x.push_back(solver.time());
        grown.y.push_back(solver.volume() / before);
        jolt = std::max(jolt, law.speed(solver.time()) - computed.y.back());
    }
    const double gained = solver.volume() - before;
    rows.add("volume", grown.y.back(), law.volume(spec.end));
    rows.add("speed", computed.y.back(), law.speed(spec.end));
    rows.add("missing", gained > 0 ? entrained / gained - 1 : not_computed);
    rows.add("jolt", jolt);
    outcome.charts[0].series.push_back(std::move(computed));
    outcome.charts[1].series.push_back(std::move(grown));
}

Result<Outcome> compute(const GrowthSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    outcome.charts.push_back({"speed", "Mean speed of a slab that entrains its bed", "time, s", "m/s", {}});
    outcome.charts.push_back({"volume", "Its volume over that at the start", "time, s", "1", {}});
    const double acceleration = sim::Model{}.gravity * (std::sin(spec.slope) - spec.friction * std::cos(spec.slope));
    const GrowthLaw law{acceleration, spec.growth_rate};
    Series speed{"law", Series::Style::dashed, {}, {}}, volume = speed;
    for (int k = 0; k <= 100; ++k) {
        const double t = spec.end * k / 100;
        speed.x.push_back(t);
        speed.y.push_back(law.speed(t));
        volume.x.push_back(t);
        volume.y.push_back(law.volume(t));
    }
    outcome.charts[0].series.push_back(speed);
    outcome.charts[1].series.push_back(volume);
    for (const double spacing : spec.spacings) compute_one(spec, spacing, setting, watch, outcome);
    compute_grid(spec, spec.spacings.back(), setting, watch, outcome);
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    GrowthSpec spec;
    spec.slope = parameters.number("slope_deg", {.low = 1, .high = 89}, 30) * std::numbers::pi / 180;
    spec.friction = parameters.number("friction_coefficient", {.low = 0, .high = 10}, 0.4);
    spec.growth_rate = parameters.number("growth_rate_per_m", {.low = 0, .high = 1, .low_included = false}, 0.01);
    spec.spacings = parameters.numbers("spacings_m", positive, {0.3});
    spec.length = parameters.number("length_m", positive, 6);
    spec.thickness = parameters.number("thickness_m", positive, 0.9);
    spec.width = parameters.number("width_m", positive, 1.8);
    spec.depth = parameters.number("bed_depth_m", positive, 1);
    spec.end = parameters.number("end_s", positive, 8);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace growing_slab

Kind growing_slab_kind() {
    return {"growing_slab", "a slab on an incline that entrains its bed", growing_slab::quantities,
            growing_slab::prepare};
}

}  // namespace talus::validate
