#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/angle.hpp"
#include "depth/material.hpp"
#include "depth/solver.hpp"
#include "sim/sources/seed.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/measure.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace debris_flume {

constexpr Quantity quantities[] = {
    {"arrival_time", "s", false, Quantity::Site::none,
     "of debris 2 cm thick at a station, since the gate began to open"},
    {"thickness", "m", false, Quantity::Site::none, "at a station and a time, over half a metre of the channel"},
    {"run_up", "m", false, Quantity::Site::none,
     "greatest height above the foot of an obstacle: of debris at a wall, of the ground reached on a ramp"},
};

struct FlumeSpec {
    double slope = 0, pad_slope = 0;      // rad
    double bend_start = 0, bend_end = 0;  // m from the gate along the bed
    double width = 0, volume = 0;         // m, m3
    double gate_time = 0;                 // s
    std::vector<double> spacings;         // m
    std::vector<double> stations;         // m from the gate along the bed
    std::vector<NumberPair> samples;      // station in m, time in s
    double obstacle = 0, ramp_angle = 0;  // m along the bed, rad
    double end = 0;                       // s
};

enum class Obstacle { none, wall, ramp };

/// The bed by the distance s along it from the gate: steep, bent as a circle, nearly level.
class Bed {
  public:
    Bed(const FlumeSpec& spec, Obstacle obstacle) : foot_(spec.obstacle), first_(-start), points_(count) {
        PlanPoint p{};
        for (std::size_t k = 0; k < points_.size(); ++k) {
            points_[k] = p;
            const double s = place(k), bent = (s - spec.bend_start) / (spec.bend_end - spec.bend_start);
            double fall = spec.slope + std::clamp(bent, 0.0, 1.0) * (spec.pad_slope - spec.slope);
            if (obstacle == Obstacle::ramp && s > foot_) fall = -spec.ramp_angle;
            p = {p.x + step * std::cos(fall), p.y - step * std::sin(fall)};
        }
        middle_ = (points_.front().x + points_.back().x) / 2;
    }

    [[nodiscard]] double length() const { return points_.back().x - points_.front().x; }
    /// Plan x in a world around the middle, and elevation, of a place along the bed.
    [[nodiscard]] PlanPoint at(double s) const {
        const double u = std::clamp((s - first_) / step, 0.0, static_cast<double>(points_.size()) - 1.001);
        const auto k = static_cast<std::size_t>(u);
        const double t = u - static_cast<double>(k);
        const PlanPoint &a = points_[k], &b = points_[k + 1];
        return {a.x + t * (b.x - a.x) - middle_, a.y + t * (b.y - a.y)};
    }
    /// The place along the bed below a plan x.
    [[nodiscard]] double along(double x) const {
        const auto next = std::lower_bound(points_.begin(), points_.end(), x + middle_,
                                           [](const PlanPoint& p, double value) { return p.x < value; });
        const auto k = std::clamp<std::ptrdiff_t>(next - points_.begin(), 1, static_cast<std::ptrdiff_t>(count) - 1);
        const PlanPoint &a = points_[static_cast<std::size_t>(k - 1)], &b = points_[static_cast<std::size_t>(k)];
        return place(static_cast<std::size_t>(k - 1)) + step * (x + middle_ - a.x) / (b.x - a.x);
    }

  private:
    static constexpr double step = 0.02, start = 12;  // m; the bed extends this far behind the gate
    static constexpr std::size_t count = 6300;        // to s = 114 m

    [[nodiscard]] double place(std::size_t k) const { return first_ + step * static_cast<double>(k); }

    double foot_, first_, middle_ = 0;
    std::vector<PlanPoint> points_;
};

struct Measured {
    std::vector<double> arrivals, thicknesses;  // by station, by sample
    double run_up = not_computed;
    std::size_t particles = 0;
    std::string problem;
    std::vector<std::vector<double>> time, depth;  // by station
};

/// Debris with a level surface behind a gate at right angles to the bed, which is removed instantly.
std::vector<LocalPoint> fill_behind_gate(const FlumeSpec& spec, const Bed& bed, const terrain::Terrain& terrain,
                                         double spacing, std::vector<double>& above) {
    const double deepest = std::sqrt(2 * spec.volume / spec.width * std::tan(spec.slope));
    const double sine = std::sin(spec.slope), cosine = std::cos(spec.slope);
    const auto across = static_cast<int>(std::lround(spec.width / spacing));
    const double pitch = spec.width / across;
    std::vector<LocalPoint> points;
    for (int i = 0; (i + 0.5) * spacing * std::tan(spec.slope) < deepest; ++i) {
        const double s = -(i + 0.5) * spacing, thickness = deepest + s * std::tan(spec.slope);
        const PlanPoint ground = bed.at(s);
        for (int j = 0; j < across; ++j) {
            for (int k = 0; (k + 0.5) * spacing < thickness; ++k) {
                const double n = (k + 0.5) * spacing;
                points.push_back(terrain.frame().to_local(
                    {ground.x + n * sine, -spec.width / 2 + (j + 0.5) * pitch, ground.y + n * cosine}));
                above.push_back(thickness - n);
            }
        }
    }
    return points;
}

Measured measure(const FlumeSpec& spec, Obstacle obstacle, double spacing, const Setting& setting, const Watch& watch) {
    const Bed bed(spec, obstacle);
    const terrain::Terrain terrain =
        make_terrain(bed.length() - 1, spec.width + 4, 0.25, [&](double x, double) { return bed.at(bed.along(x)).y; });
    std::vector<terrain::Building> walls = make_slice(terrain, spec.width, 5);
    const Extent e = terrain.elevation().geometry.extent();
    if (obstacle == Obstacle::wall) {
        walls.push_back(make_wall(terrain, bed.at(spec.obstacle).x, e.y_min, e.x_max, e.y_max, 5));
    }
    sim::Model model = sim::make_model(setting.material, setting.solver, spacing);
    sim::Ground ground(terrain, walls, model.support_radius);
    std::vector<double> above;
    const auto points = fill_behind_gate(spec, bed, terrain, spacing, above);
    sim::State start = state_at_rest(points);
    start.previous_time_step = 1;  // s: multipliers are pressure over density, times its square
    for (std::uint32_t i = 0; i < start.count; ++i) {
        start.multiplier[i] = static_cast<float>(-model.gravity * std::cos(spec.slope) * above[i]);
    }
    find_pressures(model, ground, start);
    // The lattice may be a little wider or narrower than its particles: its mass is scaled to the required volume.
    const double mass_per_particle = spec.volume / static_cast<double>(points.size());

    Measured measured;
    measured.particles = points.size();
    measured.arrivals.assign(spec.stations.size(), not_computed);
    measured.thicknesses.assign(spec.samples.size(), not_computed);
    measured.time.resize(spec.stations.size());
    measured.depth.resize(spec.stations.size());
    Trial trial({std::move(model), std::move(ground), std::move(start)}, watch, OnFault::note);
    const sim::State& state = trial.state();
    constexpr double window = 0.5, arrived = 0.02;
    const double delay = spec.gate_time / 2;
    const auto thickness_at = [&](double s) {
        int inside = 0;
        for (std::uint32_t i = 0; i < state.count; ++i) {
            inside +=
                std::abs(bed.along(state.position.x[i] + trial.ground().terrain.frame().origin.x) - s) < window / 2;
        }
        return inside * mass_per_particle / (window * spec.width);
    };
    double highest = 0;
    const auto look = [&] {
        const double foot = bed.at(spec.obstacle).y;
        if (obstacle == Obstacle::wall) highest = std::max(highest, thickness_at(spec.obstacle - window / 2));
        if (obstacle != Obstacle::ramp) return;
        for (double s = spec.obstacle + window / 2; s < spec.obstacle + 8; s += window) {
            if (thickness_at(s) >= arrived) highest = std::max(highest, bed.at(s).y - foot);
        }
    };
    constexpr double interval = 0.05;
    for (double t = 0; t <= spec.end + 1e-9; t += interval) {
        if (!trial.advance_to(t - delay)) break;
        for (std::size_t k = 0; k < spec.stations.size(); ++k) {
            const double depth = thickness_at(spec.stations[k]);
            if (depth >= arrived && std::isnan(measured.arrivals[k])) measured.arrivals[k] = t;
            measured.time[k].push_back(t);
            measured.depth[k].push_back(depth);
        }
        for (std::size_t k = 0; k < spec.samples.size(); ++k) {
            if (std::abs(spec.samples[k][1] - t) < interval / 2)
                measured.thicknesses[k] = thickness_at(spec.samples[k][0]);
        }
        look();
    }
    if (obstacle != Obstacle::none) measured.run_up = highest;
    measured.problem = trial.problem();
    return measured;
}

/// The same by the depth-averaged model on a strip of cells of so many m in plan.
Measured measure_grid(const FlumeSpec& spec, Obstacle obstacle, double cell, const Setting& setting,
                      const Watch& watch) {
    const Bed bed(spec, obstacle);
    Grid<double> ground({-bed.length() / 2, 0, cell, static_cast<int>(bed.length() / cell) - 1, 1});
    const GridGeometry& g = ground.geometry;
    const double deepest = std::sqrt(2 * spec.volume / spec.width * std::tan(spec.slope));
    const double level = bed.at(0).y + deepest * std::cos(spec.slope);
    std::vector<double> places;
    Grid<float> depth(g);
    depth::GroundValues values;
    double sum = 0;
    for (int column = 0; column < g.columns; ++column) {
        const double x = g.centre(column, 0).x, s = bed.along(x), z = bed.at(s).y;
        places.push_back(s);
        const bool wall = obstacle == Obstacle::wall && s > spec.obstacle;
        ground.at(column, 0) = wall ? z + 5 : z;
        values.structure.push_back(wall ? 1.0F : 0.0F);
        // Level behind a gate at right angles to the bed, which leans over what lies before its foot.
        const double beyond = x - bed.at(0).x;
        const double below_gate = beyond > 0 ? beyond / std::tan(spec.slope) : 0;
        depth.at(column, 0) = static_cast<float>(std::max(0.0, level - std::max(z, bed.at(0).y + below_gate)));
        sum += depth.at(column, 0) * cell * spec.width;
    }
    for (float& h : depth.values) h *= static_cast<float>(spec.volume / sum);
    depth::Solver solver(ground, depth::material_of(setting.material), values, depth::Edges::continued);
    solver.add(depth);

    Measured measured;
    measured.arrivals.assign(spec.stations.size(), not_computed);
    measured.thicknesses.assign(spec.samples.size(), not_computed);
    measured.time.resize(spec.stations.size());
    measured.depth.resize(spec.stations.size());
    constexpr double window = 0.5, arrived = 0.02, interval = 0.05;
    const auto column_of = [&](double s) { return static_cast<int>((bed.at(s).x - g.x_min) / cell); };
    const auto thickness_at = [&](double s) {
        const int first = column_of(s - window / 2), last = column_of(s + window / 2);
        double volume = 0;
        for (int column = first; column < last; ++column) volume += double{solver.depth_at(column, 0)} * cell;
        return volume / (places[static_cast<std::size_t>(last)] - places[static_cast<std::size_t>(first)]);
    };
    double highest = 0;
    for (double t = 0; t <= spec.end + 1e-9; t += interval) {
        while (solver.time() < t - spec.gate_time / 2 - 1e-9) {
            const Status stepped = solver.advance(t - spec.gate_time / 2 - solver.time());
            if (!stepped) measured.problem = stepped.error().message;
            if (!stepped || watch.stopped()) return measured;
        }
        for (std::size_t k = 0; k < spec.stations.size(); ++k) {
            const double thickness = thickness_at(spec.stations[k]);
            if (thickness >= arrived && std::isnan(measured.arrivals[k])) measured.arrivals[k] = t;
            measured.time[k].push_back(t);
            measured.depth[k].push_back(thickness);
        }
        for (std::size_t k = 0; k < spec.samples.size(); ++k) {
            if (std::abs(spec.samples[k][1] - t) < interval / 2)
                measured.thicknesses[k] = thickness_at(spec.samples[k][0]);
        }
        if (obstacle == Obstacle::wall) {
            highest = std::max(highest, double{solver.depth_at(column_of(spec.obstacle) - 1, 0)});
        }
        for (double s = spec.obstacle + window / 2; obstacle == Obstacle::ramp && s < spec.obstacle + 8; s += window) {
            if (thickness_at(s) >= arrived) highest = std::max(highest, bed.at(s).y - bed.at(spec.obstacle).y);
        }
    }
    if (obstacle != Obstacle::none) measured.run_up = highest;
    return measured;
}

Result<Outcome> compute(const FlumeSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    Chart chart{"thickness", "Thickness at the stations", "time since the gate began to open (s)", "thickness (m)", {}};
    const double finest = *std::min_element(spec.spacings.begin(), spec.spacings.end());
    constexpr double grid_cell = 0.1;
    std::vector<double> spacings = spec.spacings;
    spacings.push_back(0);  // the depth-averaged model
    for (const double spacing : spacings) {
        const bool coarse = spacing > finest;
        const std::string end = spacing > 0 ? fmt::format(", spacing {:g} m", spacing) : ", depth-averaged";
        for (const Obstacle obstacle : {Obstacle::none, Obstacle::wall, Obstacle::ramp}) {
            // The coarse channel shows the effect of the spacing; its obstacles would add little for twice the time.
            if (coarse && obstacle != Obstacle::none) continue;
            const std::string kind = obstacle == Obstacle::none   ? "open channel"
                                     : obstacle == Obstacle::wall ? "wall"
                                                                  : "ramp";
            watch.say(kind + end);
            const Measured m = spacing > 0 ? measure(spec, obstacle, spacing, setting, watch)
                                           : measure_grid(spec, obstacle, grid_cell, setting, watch);
            if (!m.problem.empty()) outcome.notes.push_back(kind + end + ": " + m.problem);
            if (obstacle != Obstacle::none) {
                outcome.measurements.push_back({"run_up", kind + end, m.run_up, std::nullopt, coarse});
                continue;
            }
            if (spacing > 0) outcome.notes.push_back(fmt::format("spacing {:g} m: {} particles", spacing, m.particles));
            for (std::size_t k = 0; k < spec.stations.size(); ++k) {
                const std::string station = fmt::format("{:g} m", spec.stations[k]);
                outcome.measurements.push_back({"arrival_time", station + end, m.arrivals[k], std::nullopt, coarse});
                chart.series.push_back({station + end, Series::Style::line, m.time[k], m.depth[k]});
            }
            for (std::size_t k = 0; k < spec.samples.size(); ++k) {
                outcome.measurements.push_back(
                    {"thickness", fmt::format("{:g} m at {:g} s{}", spec.samples[k][0], spec.samples[k][1], end),
                     m.thicknesses[k], std::nullopt, coarse});
            }
        }
    }
    outcome.charts.push_back(chart);
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    FlumeSpec spec;
    spec.slope = parameters.number("slope_deg", {.low = 1, .high = 60}, 31) * radians_per_degree;
    spec.pad_slope = parameters.number("pad_slope_deg", {.low = 0, .high = 60}, 2.4) * radians_per_degree;
    spec.bend_start = parameters.number("bend_start_m", {.low = 1, .high = 90}, 74);
    spec.bend_end = std::max(spec.bend_start + 1, parameters.number("bend_end_m", {.low = 2, .high = 100}, 84));
    spec.width = parameters.number("width_m", positive, 2);
    spec.volume = parameters.number("volume_m3", {.low = 0, .high = 50, .low_included = false}, 10);
    spec.gate_time = parameters.number("gate_opening_s", {.low = 0}, 0.85);
    spec.spacings = parameters.numbers("spacings_m", positive, {0.08});
    spec.stations = parameters.numbers("stations_m", {.low = 0, .high = 110}, {32, 66});
    spec.samples = parameters.pairs("samples_m_s", {.low = 0, .high = 200}, false);
    spec.obstacle = parameters.number("obstacle_m", {.low = 1, .high = 100}, 91);
    spec.ramp_angle = parameters.number("ramp_deg", {.low = 1, .high = 60}, 30) * radians_per_degree;
    spec.end = parameters.number("end_s", positive, 14);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace debris_flume

Kind debris_flume_kind() {
    return {"debris_flume", "wet debris is released into a flume", debris_flume::quantities, debris_flume::prepare};
}

}  // namespace talus::validate
