#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "core/angle.hpp"
#include "report/number_text.hpp"
#include "report/results.hpp"
#include "sim/compression.hpp"

namespace talus::report {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A change of direction of the flow path in plan.
struct Bend {
    double chainage, turn;  ///< turn in degrees, positive to the left looking downstream
};

/// Bends of more than 30 degrees, measured between the directions `reach` metres before and after.
std::vector<Bend> bends(const terrain::FlowPath& path, double end) {
    const double reach = std::clamp(0.05 * path.length(), 6.0, 20.0);
    const auto turn_at = [&](double c) {
        const PlanPoint a = path.point_at(c - reach), m = path.point_at(c), b = path.point_at(c + reach);
        const double ux = m.x - a.x, uy = m.y - a.y, vx = b.x - m.x, vy = b.y - m.y;
        return degrees_per_radian * std::atan2(ux * vy - uy * vx, ux * vx + uy * vy);
    };
    std::vector<Bend> found;
    for (double c = reach; c <= end - reach; c += 1) {
        const double turn = turn_at(c);
        if (std::abs(turn) < 30) continue;
        if (!found.empty() && c - found.back().chainage < 2 * reach) {
            if (std::abs(turn) > std::abs(found.back().turn)) found.back() = {c, turn};
        } else {
            found.push_back({c, turn});
        }
    }
    return found;
}

struct Profile {
    std::vector<double> chainage, elevation;
    ValueRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

    [[nodiscard]] double at(double c) const {
        const auto i = static_cast<std::size_t>(std::max(0L, std::lround(c / step)));
        return i < elevation.size() ? elevation[i] : nan;
    }
    double step = 1;
};

Profile profile_along(const scene::Scene& scene, double end) {
    Profile p;
    p.step = end / 600;
    for (int i = 0; i <= 600; ++i) {
        const double c = i * p.step;
        p.chainage.push_back(c);
        p.elevation.push_back(scene.terrain.elevation_at(scene.flow_path.point_at(c)));
        p.range.include(p.elevation.back());
    }
    return p;
}

struct Columns {
    std::vector<double> chainage, velocity, speed, arrival;
};

Columns front_columns(const observe::Observation& observation) {
    Columns c;
    for (const observe::FrontSample& s : observation.front) {
        c.chainage.push_back(s.chainage);
        c.velocity.push_back(s.front_velocity);
        c.speed.push_back(s.particle_speed);
        c.arrival.push_back(s.arrival_time);
    }
    return c;
}

void draw_profile(Plot& plot, const scene::Scene& scene, const run::RunResult& result, const Profile& profile,
                  double end) {
    const std::vector<double> floor(profile.chainage.size(), profile.range.low);
    std::vector<double> top = profile.elevation;
    for (double& z : top) z = std::isnan(z) ? profile.range.low : z;
    plot.band(profile.chainage, floor, top, "ground-fill");
    plot.line(profile.chainage, profile.elevation, "ground-line");

    const observe::RunOut& run_out = result.observation.run_out;
    const auto crown = scene.flow_path.locate(run_out.crown), toe = scene.flow_path.locate(run_out.toe);
    if (crown && toe && toe->chainage > crown->chainage) {
        const double foot = profile.at(toe->chainage);
        const std::vector<double> x = {crown->chainage, toe->chainage}, z = {foot + run_out.drop, foot};
        plot.line(x, z, "energy-line");
        plot.label(x[0] + 0.62 * (x[1] - x[0]), z[0] + 0.62 * (z[1] - z[0]), 12, -6, "start", "note-strong",
                   fmt::format("run-out angle {}°", fixed(run_out.runout_angle * degrees_per_radian, 1)));
    }
    if (std::isfinite(run_out.front_chainage)) {
        plot.vertical(run_out.front_chainage, "toe-line");
        plot.label(run_out.front_chainage, profile.range.high, run_out.front_chainage > 0.85 * end ? -6 : 6, 14,
                   run_out.front_chainage > 0.85 * end ? "end" : "start", "note",
                   fmt::format("front to chainage {} m", fixed(run_out.front_chainage, length_decimals(scene))));
    }
    for (const Bend& bend : bends(scene.flow_path, end)) {
        plot.vertical(bend.chainage, "bend-line");
        plot.label(bend.chainage, profile.range.low, 5, -8, "start", "ground-note",
                   fmt::format("bend {}° {}", fixed(std::abs(bend.turn), 0), bend.turn > 0 ? "left" : "right"));
    }
    // The steepest ten metres: in a profile of true proportions a waterfall is visible only if it is marked.
    double steepest = 0, place = 0;
    for (double c = 0; c + 10 <= end; c += profile.step) {
        const double drop = profile.at(c) - profile.at(c + 10);
        if (drop > steepest) {
            steepest = drop;
            place = c;
        }
    }
    if (steepest > 5) {
        // Below the ground, which falls to the right; to the right of it where there is no room on the left.
        const bool room = place > 0.25 * end;
        plot.label(place + 5, (profile.at(place) + profile.at(place + 10)) / 2, room ? -9 : 9, room ? 16 : -9,
                   room ? "end" : "start", "ground-note", fmt::format("steepest 10 m: falls {} m", fixed(steepest, 1)));
    }
}

}  // namespace

void include_observations(const scene::Scene& scene, ValueRange& chainages, ValueRange& speeds) {
    for (const params::ObservationSpec& o : scene.spec.observations) {
        chainages.include(o.chainage);
        speeds.include(o.value() + o.standard_deviation());
    }
}

void mark_observations(const scene::Scene& scene, Plot& velocity) {
    const double cap = 4 * (velocity.x_range.high - velocity.x_range.low) / velocity.width;  // half of it, 4 SVG units
    for (const params::ObservationSpec& o : scene.spec.observations) {
        const double low = std::max(0.0, o.value() - o.standard_deviation());
        const double high = o.value() + o.standard_deviation();
        const std::vector<double> middle(2, o.chainage), ends{o.chainage - cap, o.chainage + cap};
        velocity.line(middle, std::vector<double>{low, high}, "whisker");
        for (const double end : {low, high}) velocity.line(ends, std::vector<double>(2, end), "whisker");
        velocity.mark(o.chainage, o.value(), "observation");
    }
}

Json front_chart(const scene::Scene& scene, const run::RunResult& result) {
    const Columns front = front_columns(result.observation);
    ValueRange reached{0, front.chainage.empty() ? 0 : front.chainage.back()}, speeds{0, 1}, times{0, 1};
    include_observations(scene, reached, speeds);
    const double last = reached.high;
    if (scene.flow_path.empty() || !(last > 0)) return {};
    const double end = std::min(1.12 * last, std::max(last, scene.flow_path.length()));
    const ValueRange x{0, end};

    for (const double v : front.velocity) speeds.include(v);
    for (const double v : front.speed) speeds.include(v);
    for (const double t : front.arrival) times.include(t);
    speeds.high *= scene.spec.observations.empty() ? 1.1 : 1.4;
    times.high *= 1.08;

    constexpr double left = 66, width = 916;
    Plot velocity(left, 34, width, 270, x, speeds);
    velocity.axes("", "front velocity, m/s");
    velocity.line(front.chainage, front.velocity, "series blue", "front velocity d(chainage)/dt");
    velocity.line(front.chainage, front.speed, "series orange",
                  result.depth_averaged() ? "speed of the flow at the front" : "mean particle speed at the front");
    std::vector<double> row_ends;  // SVG x up to which each row of labels is taken
    for (const params::ObservationSpec& o : scene.spec.observations) {
        velocity.vertical(o.chainage, "observation-line");
        // Labels stand above the curves; one that would overlap its neighbour moves down a row.
        const std::string value = fmt::format("{}observed {} m/s at {} m", o.debris_speed ? "debris " : "",
                                              plain(o.value()), plain(o.chainage));
        const std::string name = shortened(o.name, 40), source = shortened(o.source, 40);
        const double length = 7.3 * static_cast<double>(std::max({value.size(), name.size(), source.size()}));
        const bool leftward = velocity.px(o.chainage) + length > left + width;
        const double start = velocity.px(o.chainage) - (leftward ? length : 0);
        std::size_t row = 0;
        while (row < row_ends.size() && row_ends[row] > start) ++row;
        if (row == row_ends.size()) row_ends.push_back(0);
        row_ends[row] = start + length + 20;
        const double dx = leftward ? -7 : 7, dy = 16 + 48 * static_cast<double>(row);
        const char* anchor = leftward ? "end" : "start";
        velocity.label(o.chainage, speeds.high, dx, dy, anchor, "note-strong", value);
        velocity.label(o.chainage, speeds.high, dx, dy + 15, anchor, "note", name);
        velocity.label(o.chainage, speeds.high, dx, dy + 29, anchor, "note", source);
    }

    mark_observations(scene, velocity);

    const Profile profile = profile_along(scene, end);
    ValueRange heights = profile.range;
    if (!(heights.high > heights.low)) heights = {0, 1};
    Plot ground(left, 332, width, 200, x, heights);
    ground.axes("", "elevation, m");
    draw_profile(ground, scene, result, profile, end);

    Plot arrival(left, 560, width, 130, x, times);
    arrival.axes("chainage along the flow path, m", "arrival, s");
    arrival.line(front.chainage, front.arrival, "series green");
    return chart_json({"Front velocity, ground profile and arrival time against chainage",
                       1000,
                       735,
                       {std::move(velocity), std::move(ground), std::move(arrival)}});
}

Json time_chart(const run::RunResult& result) {
    const auto& rows = result.observation.timeseries;
    if (rows.size() < 2) return {};
    const std::size_t stride = std::max<std::size_t>(1, rows.size() / 800);
    std::vector<double> t, kinetic, potential, total, speed, mean_compression, overcompressed, zero, deposited, moving,
        held, left;
    double lowest = std::numeric_limits<double>::infinity(), max_energy = 0;
    for (const observe::TimeSample& s : rows) lowest = std::min(lowest, s.potential_energy);
    for (const observe::TimeSample& s : rows)
        max_energy = std::max(max_energy, s.kinetic_energy + s.potential_energy - lowest);
    const bool mega = max_energy >= 2e6;
    const double unit = mega ? 1e-6 : 1e-3;
    ValueRange energies{0, 0}, speeds{0, 1}, compressions{0, 100 * sim::overcompressed_share_limit * 1.1};
    for (std::size_t i = 0; i < rows.size(); i += stride) {
        const observe::TimeSample& s = rows[i];
        t.push_back(s.time);
        kinetic.push_back(s.kinetic_energy * unit);
        potential.push_back((s.potential_energy - lowest) * unit);
        total.push_back(kinetic.back() + potential.back());
        energies.include(total.back());
        speed.push_back(s.largest_speed);
        speeds.include(s.largest_speed);
        mean_compression.push_back(100 * s.mean_compression);
        overcompressed.push_back(100 * s.overcompressed_share);
        if (!result.depth_averaged()) {
            compressions.include(mean_compression.back());
            compressions.include(overcompressed.back());
        }
        zero.push_back(0);
        deposited.push_back(s.volume_deposited);
        moving.push_back(deposited.back() + s.volume_moving);
        held.push_back(moving.back() + s.volume_held);
        left.push_back(held.back() + s.volume_left);
    }
    const ValueRange time{0, rows.back().time};
    energies.high *= 1.05;
    speeds.high *= 1.08;
    compressions.high *= 1.05;
    constexpr double first = 66, second = 570, width = 412, height = 210, below = 340;

    Plot energy(first, 34, width, height, time, energies);
    energy.axes("time, s", mega ? "energy, MJ" : "energy, kJ");
    energy.line(t, total, "series black", "sum");
    energy.line(t, potential, "series green", "potential");
    energy.line(t, kinetic, "series orange", "kinetic");

    const double max_volume = result.observation.volume_released + result.observation.erosion.volume;
    Plot volume(second, 34, width, height, time, {0, 1.05 * std::max(1e-9, max_volume)});
    volume.axes("time, s", "volume, m³");
    volume.band(t, zero, deposited, "area deposited", "deposited");
    volume.band(t, deposited, moving, "area moving", "moving");
    volume.band(t, moving, held, "area held", "held");
    volume.band(t, held, left, "area left", fmt::format("left the {}", result.domain()));

    Plot fastest(first, below, width, height, time, speeds);
    fastest.axes("time, s", "speed, m/s");
    fastest.line(t, speed, "series blue", result.depth_averaged() ? "largest speed" : "largest particle speed");
    Chart chart{"Energy, volumes and largest speed over time", 1000, 600, {}};
    chart.plots = {std::move(energy), std::move(volume), std::move(fastest)};
    if (result.depth_averaged()) return chart_json(chart);

    Plot compressed(second, below, width, height, time, compressions);
    compressed.axes("time, s", "compression and overcompressed share, %");
    compressed.line(t, mean_compression, "series blue", "mean compression");
    compressed.line(t, overcompressed, "series purple", "overcompressed share");
    static_assert(sim::mean_compression_limit == sim::overcompressed_share_limit);  // one line for both
    compressed.horizontal(100 * sim::mean_compression_limit, "limit blue", "limit of both");
    chart.title = "Energy, volumes, largest speed and compression over time";
    chart.plots.push_back(std::move(compressed));
    return chart_json(chart);
}

}  // namespace talus::report
