#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "core/try.hpp"
#include "depth/material.hpp"
#include "run/depth_grid.hpp"
#include "scene/scene.hpp"
#include "sim/sources/seed.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/point_mass.hpp"
#include "validate/rows.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace profile {

constexpr Quantity quantities[] = {
    {"speed_share", "1", false, Quantity::Site::none,
     "greatest speed along the ground, below the release, over what free fall allows: from the crown's surface, and "
     "its "
     "depth once more, since the front of a dam break has twice the head of its depth (Ritter 1892)"},
    {"energy_gain", "1", false, Quantity::Site::none,
     "largest total energy above that of the start, over that of the mass's fall"},
    {"volume_error", "1", false, Quantity::Site::none, "largest change of the volume, over the volume"},
    {"front", "m", true, Quantity::Site::none,
     "horizontal distance from the crown within which 99 % of the debris lies at the end; the law: where the energy "
     "line from the crown's surface meets the ground"},
    {"front_spread", "m", false, Quantity::Site::none, "largest difference between the fronts on the grids"},
    {"speed", "m/s", true, Quantity::Site::none,
     "speed, by energy, of the debris that passes probe_m; the law: a point mass from the release's middle"},
};

/// Elevation by distance: straight lines between points, whose corners are arcs of one radius, and waves on them.
struct Shape {
    std::vector<NumberPair> points;                           // x, z, m
    double radius = 0;                                        // m; 0: sharp corners
    double wave_height = 0, wave_length = 0, wave_start = 0;  // m

    [[nodiscard]] double start() const { return points.front()[0]; }
    [[nodiscard]] double end() const { return points.back()[0]; }
    [[nodiscard]] double slope_after(std::size_t k) const {  // of the line from point k, rad
        return std::atan2(points[k + 1][1] - points[k][1], points[k + 1][0] - points[k][0]);
    }
    /// From the corner at point k to the ends of its arc.
    [[nodiscard]] double tangent(std::size_t k) const {
        return radius * std::abs(std::tan((slope_after(k) - slope_after(k - 1)) / 2));
    }

    [[nodiscard]] double elevation(double x) const {
        std::size_t k = 0;
        while (k + 2 < points.size() && x > points[k + 1][0]) ++k;
        double z = points[k][1] + std::tan(slope_after(k)) * (x - points[k][0]);
        for (const std::size_t corner : {k, k + 1}) {
            if (corner == 0 || corner + 1 == points.size()) continue;
            const double before = slope_after(corner - 1), after = slope_after(corner), to_end = tangent(corner);
            const double first = points[corner][0] - to_end * std::cos(before);
            if (x <= first || x >= points[corner][0] + to_end * std::cos(after)) continue;
            const double side = after > before ? 1 : -1;  // the centre is above a foot, below a brow
            const double centre = first - side * radius * std::sin(before);
            z = points[corner][1] - to_end * std::sin(before) + side * radius * std::cos(before) -
                side * std::sqrt(radius * radius - (x - centre) * (x - centre));
        }
        if (x <= wave_start || wave_height == 0) return z;
        return z - wave_height / 2 * (1 - std::cos(2 * std::numbers::pi * (x - wave_start) / wave_length));
    }

    [[nodiscard]] Status check() const {
        for (std::size_t k = 0; k + 1 < points.size(); ++k) {
            const double length = std::hypot(points[k + 1][0] - points[k][0], points[k + 1][1] - points[k][1]);
            const double arcs = (k > 0 ? tangent(k) : 0) + (k + 2 < points.size() ? tangent(k + 1) : 0);
            if (points[k + 1][0] > points[k][0] && arcs <= length) continue;
            return Error{
                fmt::format("parameters.profile_m: the line from x = {:g} to {:g} m must lead to larger x, and "
                            "hold its part of the arcs of arc_radius_m at its ends",
                            points[k][0], points[k + 1][0])};
        }
        return points.size() > 1 ? Status{} : Error{"parameters.profile_m must have at least two points"};
    }
};

struct ProfileSpec {
    Shape shape;
    double from = 0, to = 0, thickness = 0;   // m, of the release; thickness normal to the ground
    double ground_cell = 0;                   // m, of the raster that both models have
    double spacing = 0, time = 0, probe = 0;  // m, s, m; probe 0: none
    int width = 0;                            // spacings, of the slice of particles
    std::vector<double> cells;                // m, of the depth-averaged grids
    bool flight = false;                      // whether depth-averaged debris leaves the ground

    [[nodiscard]] double middle() const { return (shape.start() + shape.end()) / 2; }
};

/// The ground as both models have it, by distance along the profile.
struct World {
    terrain::Terrain terrain;
    double middle = 0;                      // of the profile, where the terrain's x is 0, m
    double crown_top = 0, crown_depth = 0;  // m

    World(const ProfileSpec& spec, double width)
        : terrain(make_terrain(spec.shape.end() - spec.shape.start(), width, spec.ground_cell,
                               [&](double x, double) { return spec.shape.elevation(x + spec.middle()); })),
          middle(spec.middle()) {
        crown_depth = spec.thickness / terrain.slope_cosine_at({spec.from - middle, 0});
        crown_top = ground(spec.from) + crown_depth;
    }
    [[nodiscard]] double ground(double x) const { return terrain.elevation_at({x - middle, 0}); }
    [[nodiscard]] terrain::Release release(const ProfileSpec& spec, double width) const {
        const double a = spec.from - middle, b = spec.to - middle, half = width / 2;
        terrain::Release release;
        release.name = "block";
        release.patches.push_back({{{{a, -half}, {b, -half}, {b, half}, {a, half}}, {}}, spec.thickness});
        release.volume = release_volume(terrain, release);
        return release;
    }
};

/// What is measured, of either model: add() every piece of debris, then end_step().
class Record {
  public:
    Record(const ProfileSpec& spec, const World& world, double gravity)
        : spec_(spec),
          world_(world),
          gravity_(gravity),
          greatest_(static_cast<std::size_t>((spec.shape.end() - spec.shape.start()) / spec.ground_cell) + 1, 0.0) {}

    /// `flow`: horizontal velocity; `speed`: along the ground, m/s.
    void add(double x, double elevation, double mass, double flow, double speed) {
        places_.push_back({x, mass});
        mass_ += mass;
        fall_ -= mass * elevation;
        energy_ += mass * (elevation + speed * speed / (2 * gravity_));
        if (std::abs(x - spec_.probe) <= spec_.ground_cell) {
            passes_ += mass * flow;
            passes_squared_ += mass * flow * speed * speed;
        }
        const double bin = (x - spec_.shape.start()) / spec_.ground_cell;
        if (bin >= 0 && bin < static_cast<double>(greatest_.size())) {
            double& greatest = greatest_[static_cast<std::size_t>(bin)];
            greatest = std::max(greatest, speed);
        }
        if (x > spec_.to) {
            const double share = speed / free_fall(x);
            speed_share = std::max(speed_share, share);
            if (share > 1) too_fast_ += mass;
        }
    }

    void end_step(double time_step) {
        const double energy = energy_ / mass_, fall = fall_ / mass_;
        if (!started_) {
            first_energy_ = energy;
            first_fall_ = fall;
            first_mass_ = mass_;
            started_ = true;
        }
        volume_error = std::max(volume_error, std::abs(mass_ / first_mass_ - 1));
        too_fast = std::max(too_fast, too_fast_ / first_mass_);
        gain_ = std::max(gain_, energy - first_energy_);
        largest_fall_ = std::max(largest_fall_, fall - first_fall_);
        passed_ += passes_ * time_step;
        passed_squared_ += passes_squared_ * time_step;
        last_.swap(places_);
        places_.clear();
        mass_ = fall_ = energy_ = too_fast_ = passes_ = passes_squared_ = 0;
    }

    /// The greatest speed that free fall allows there, m/s.
    [[nodiscard]] double free_fall(double x) const {
        return std::sqrt(2 * gravity_ * std::max(0.0, world_.crown_top + world_.crown_depth - world_.ground(x)));
    }
    [[nodiscard]] double energy_gain() const { return gain_ / largest_fall_; }
    /// Root mean square of what passed the probe, by mass; NaN: nothing did.
    [[nodiscard]] double speed() const { return std::sqrt(passed_squared_ / passed_); }
    /// `left`: debris has left the terrain.
    [[nodiscard]] double front(bool left) {
        if (left) return spec_.shape.end() - spec_.from;
        std::sort(last_.begin(), last_.end(), [](const Place& a, const Place& b) { return a.x > b.x; });
        double beyond = 0;
        for (const Place& place : last_) {
            beyond += place.mass / first_mass_;
            if (beyond > 0.01) return place.x - spec_.from;
        }
        return not_computed;
    }
    [[nodiscard]] Series greatest_speeds(const std::string& name) const {
        Series series{name, Series::Style::line, {}, {}};
        for (std::size_t k = 0; k < greatest_.size(); ++k) {
            if (!(greatest_[k] > 0)) continue;
            series.x.push_back(spec_.shape.start() + (static_cast<double>(k) + 0.5) * spec_.ground_cell);
            series.y.push_back(greatest_[k]);
        }
        return series;
    }

    double speed_share = 0, volume_error = 0;
    double too_fast = 0;  ///< largest share of the debris that is faster than free fall allows

  private:
    struct Place {
        double x, mass;
    };
    const ProfileSpec& spec_;
    const World& world_;
    double gravity_;
    bool started_ = false;
    double mass_ = 0, fall_ = 0, energy_ = 0, too_fast_ = 0, passes_ = 0, passes_squared_ = 0;  // sums of the step
    double passed_ = 0, passed_squared_ = 0;
    double first_energy_ = 0, first_fall_ = 0, first_mass_ = 0, gain_ = 0, largest_fall_ = 0;
    std::vector<Place> places_, last_;
    std::vector<double> greatest_;  // m/s, by cell of the ground
};

/// How a run ended: `problem` empty, if it can be trusted.
struct End {
    std::string problem;
    bool left = false;  ///< debris left the terrain, with which the record ends
};

End run_particles(Trial& trial, const ProfileSpec& spec, const World& world, Record& record) {
    const sim::State& state = trial.state();
    const double bottom = world.terrain.frame().origin.z;
    const auto look = [&] {
        if (state.outflow > 0) return;
        for (std::uint32_t i = 0; i < state.count; ++i) {
            const LocalPoint p = state.position.at(i), v = state.velocity.at(i);
            record.add(world.middle + p.x, bottom + p.z, 1, v.x, length(v));
        }
        record.end_step(state.time_step);
    };
    look();
    constexpr int parts = 100;  // so that a run ends soon after what it is measured for
    for (int part = 1; part <= parts && state.outflow == 0; ++part) {
        if (!trial.advance_to(spec.time * part / parts, look)) return {trial.problem(), false};
    }
    return {"", state.outflow > 0};
}

/// A strip that is the same across, of cells in line with the profile.
Grid<double> strip_of(const World& world, double cell) {
    const Extent e = world.terrain.elevation().geometry.extent();
    Grid<double> bed({e.x_min, -cell / 2, cell, static_cast<int>(std::lround(e.width() / cell)), 1});
    for (int column = 0; column < bed.geometry.columns; ++column) {
        bed.at(column, 0) = world.terrain.elevation_at(bed.geometry.centre(column, 0));
    }
    return bed;
}

End run_grid(const ProfileSpec& spec, double cell, const Setting& setting, const Watch& watch, const World& world,
             Record& record) {
    run::GridGround ground;
    ground.bed = strip_of(world, cell);
    scene::Scene scene;
    scene.terrain = world.terrain;
    depth::Solver solver(ground.bed, depth::material_of(setting.material), {}, depth::Edges::continued);
    if (spec.flight) solver.let_fly();
    solver.add(run::grid_release(scene, world.release(spec, cell), ground));
    const auto look = [&] {
        for (int column = 0; column < ground.bed.geometry.columns; ++column) {
            const double depth = solver.depth_at(column, 0);
            if (!(depth > 0)) continue;
            const double u = solver.u_at(column, 0);
            const double elevation = ground.bed.at(column, 0) + solver.height_at(column, 0) + depth / 2;
            record.add(world.middle + ground.bed.geometry.centre(column, 0).x, elevation, depth, u,
                       std::hypot(u, u * solver.slope_x_at(column, 0) + solver.climb_at(column, 0)));
        }
        record.end_step(solver.time_step());
    };
    look();
    while (solver.time() < spec.time - 1e-9) {
        if (watch.stopped()) return {"stopped by the user", false};
        if (const Status stepped = solver.advance(spec.time - solver.time()); !stepped) {
            return {stepped.error().message, false};
        }
        if (solver.volume_left() > 0) return {"", true};
        look();
    }
    return {"", false};
}

/// Where the energy line of Coulomb friction from the crown's surface meets the ground, from the crown, m; NaN:
/// nowhere.
double energy_line_front(const ProfileSpec& spec, const World& world, double friction) {
    if (!(friction > 0)) return not_computed;
    for (double x = spec.to; x < spec.shape.end(); x += 0.1) {
        if (world.ground(x) >= world.crown_top - friction * (x - spec.from)) return x - spec.from;
    }
    return not_computed;
}

/// Of a point mass from the middle of the release, m/s, where the speed is probed; not computed where it stops before.
double speed_of_point_mass(const ProfileSpec& spec, double friction, double gravity) {
    constexpr double reach = 1e-3, longest = 200;  // m, s
    const auto profile = [&](double x) {
        const double before = spec.shape.elevation(x - reach), here = spec.shape.elevation(x);
        const double after = spec.shape.elevation(x + reach);
        return ProfilePoint{here, (after - before) / (2 * reach), (after - 2 * here + before) / (reach * reach)};
    };
    PointMass mass(profile, friction, gravity, (spec.from + spec.to) / 2, 0);
    for (double time = 0; mass.x() < spec.probe; time += 0.01) {
        if (time > longest) return not_computed;
        mass.advance_to(time + 0.01);
    }
    return mass.speed();
}

Result<Outcome> compute(const ProfileSpec& spec, const Setting& setting, const Watch& watch) {
    TALUS_TRY(spec.shape.check());
    const double width = spec.width * spec.spacing, friction = setting.material.friction_coefficient;
    const World world(spec, width + 4 * spec.ground_cell);
    const double gravity = sim::Model{}.gravity, line_front = energy_line_front(spec, world, friction);
    std::optional<double> law_front, law_speed;
    if (std::isfinite(line_front)) law_front = line_front;
    if (spec.probe > 0) law_speed = speed_of_point_mass(spec, friction, gravity);

    Outcome outcome;
    Chart chart{"speed", "Greatest speed along the ground", "distance, m", "speed, m/s", {}};
    const auto report = [&](Rows rows, const End& end, Record& record) {
        const bool good = end.problem.empty();
        if (!good) rows.note(end.problem);
        if (end.left) rows.note("measured until debris left the terrain");
        if (record.too_fast > 0) {
            rows.note(fmt::format("at most {:.2g} % of the debris at once are faster than free fall allows",
                                  100 * record.too_fast));
        }
        const double front = good ? record.front(end.left) : not_computed;
        rows.add("speed_share", good ? record.speed_share : not_computed);
        rows.add("energy_gain", good ? record.energy_gain() : not_computed);
        rows.add("volume_error", good ? record.volume_error : not_computed);
        rows.add("front", front, law_front);
        if (law_speed) rows.add("speed", good ? record.speed() : not_computed, law_speed);
        chart.series.push_back(record.greatest_speeds(rows.name()));
        return front;
    };

    params::MaterialSpec material = setting.material;
    material.building_friction_coefficient = 0;
    sim::Model model = sim::make_model(material, setting.solver, spec.spacing);
    sim::Ground ground(world.terrain, make_slice(world.terrain, width, 10), model.support_radius);
    TALUS_ASSIGN(sim::State seeded, seed_releases(model, ground, {world.release(spec, width)}));
    outcome.notes.push_back(fmt::format("{} particles", seeded.count));
    const Rows by_particles(watch, outcome, "particles");
    Record of_particles(spec, world, gravity);
    Trial trial({std::move(model), std::move(ground), std::move(seeded)}, watch);
    const End end = run_particles(trial, spec, world, of_particles);
    report(by_particles, end, of_particles);

    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const double cell : spec.cells) {
        const Rows rows(watch, outcome, fmt::format("depth-averaged, cells of {:g} m", cell));
        Record record(spec, world, gravity);
        const double front = report(rows, run_grid(spec, cell, setting, watch, world, record), record);
        least = std::isnan(front) ? front : std::min(least, front);
        most = std::max(most, front);
    }
    outcome.measurements.push_back({"front_spread", "depth-averaged", most - least, {}});

    Series fall{"free fall from the crown", Series::Style::dashed, {}, {}};
    for (double x = spec.to; x <= spec.shape.end(); x += spec.ground_cell) {
        fall.x.push_back(x);
        fall.y.push_back(of_particles.free_fall(x));
    }
    chart.series.insert(chart.series.begin(), std::move(fall));
    outcome.charts.push_back(std::move(chart));
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range any{}, not_negative{.low = 0}, positive{.low = 0, .low_included = false};
    ProfileSpec spec;
    spec.shape.points = parameters.pairs("profile_m", any, true);
    spec.shape.radius = parameters.number("arc_radius_m", not_negative, 0);
    spec.shape.wave_height = parameters.number("wave_height_m", not_negative, 0);
    spec.shape.wave_length = parameters.number("wave_length_m", positive, 60);
    spec.shape.wave_start = parameters.number("wave_start_m", any, 0);
    spec.from = parameters.number("release_from_m", any, 20);
    spec.to = parameters.number("release_to_m", any, 60);
    spec.thickness = parameters.number("thickness_m", positive, 2);
    spec.ground_cell = parameters.number("ground_cell_m", positive, 5);
    spec.cells = parameters.numbers("grid_cells_m", positive, {5, 2.5, 1.25});
    spec.spacing = parameters.number("particle_spacing_m", positive, 1);
    spec.width = parameters.whole_number("width_spacings", {.low = 2, .high = 1000}, 6);
    spec.time = parameters.number("time_s", positive, 40);
    spec.probe = parameters.number("probe_m", not_negative, 0);
    spec.flight = parameters.choice("depth_averaged_flight", {"off", "on"}, "off") == "on";
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace profile

Kind profile_kind() {
    return {"profile", "debris slides down a profile: no speed above free fall, no energy made", profile::quantities,
            profile::prepare};
}

}  // namespace talus::validate
