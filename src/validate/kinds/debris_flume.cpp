#include "validate/kinds/debris_flume.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/angle.hpp"
#include "depth/material.hpp"
#include "depth/solver.hpp"
#include "sim/sources/seed.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/rows.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace debris_flume {

constexpr Quantity quantities[] = {
    {"arrival_time", "s", false, Quantity::Site::none,
     "of debris 2 cm thick at a station, since the gate began to open"},
    {"thickness", "m", false, Quantity::Site::none,
     "at a station about a time: mean over mean_time_s and half a metre of the channel"},
    {"run_up", "m", false, Quantity::Site::none,
     "greatest height above the foot of an obstacle: of debris at a wall, of the ground reached on a ramp"},
};

Measured measure(Flow& flow, const FlumeSpec& spec, const FlumeBed& bed, Obstacle obstacle) {
    Measured measured;
    std::vector<double> places = spec.stations, thickness;
    for (const NumberPair& sample : spec.samples) places.push_back(sample[0]);
    const std::size_t stations = places.size();
    for (double s = Measured::window / 2; obstacle == Obstacle::ramp && s < 8; s += Measured::window) {
        places.push_back(spec.obstacle + s);
    }
    double highest = 0;
    for (int k = 0; k * Measured::interval <= spec.end + 1e-9; ++k) {
        if (!flow.advance_to(k * Measured::interval)) break;
        flow.read(places, thickness);
        measured.time.push_back(k * Measured::interval);
        for (std::size_t p = 0; p < stations; ++p) {
            std::vector<double>& readings = measured.thickness[places[p]];
            if (readings.size() < measured.time.size()) readings.push_back(thickness[p]);
        }
        for (std::size_t p = stations; p < places.size(); ++p) {
            if (thickness[p] < Measured::arrived) continue;
            highest = std::max(highest, bed.at(places[p]).y - bed.at(spec.obstacle).y);
        }
        if (obstacle == Obstacle::wall) highest = std::max(highest, flow.depth_at_wall());
    }
    if (obstacle != Obstacle::none) measured.run_up = highest;
    measured.problem = flow.problem();
    return measured;
}

constexpr int leaf_pairs = 10;

class ParticleFlow : public Flow {
  public:
    ParticleFlow(const FlumeSpec& spec, const FlumeBed& bed, Obstacle obstacle, double spacing, const Setting& setting,
                 const Watch& watch)
        : spec_(spec), bed_(bed), leaves_(opening_gate(spec.shape.width, spec.gate_time, leaf_pairs)) {
        const terrain::Terrain terrain = make_terrain(bed.length() - 1, spec.shape.width + 4, 0.25,
                                                      [&](double x, double) { return bed.at(bed.along(x)).y; });
        std::vector<terrain::Building> walls = make_slice(terrain, spec.shape.width, 5);
        const Extent e = terrain.elevation().geometry.extent();
        if (obstacle == Obstacle::wall) {
            walls.push_back(make_wall(terrain, bed.at(spec.obstacle).x, e.y_min, e.x_max, e.y_max, 5));
        }
        first_leaf_ = walls.size();
        const double gate = bed.at(0).x;
        for (const GateLeaf& leaf : leaves_) {
            walls.push_back(make_wall(terrain, gate, leaf.from, gate + 0.2, leaf.to, 5));
        }
        sim::Model model = sim::make_model(setting.material, setting.solver, spacing);
        sim::Ground ground(terrain, walls, model.support_radius);
        std::vector<double> below;
        const auto points = fill(terrain, spacing, below);
        sim::State start = state_at_rest(points);
        start.previous_time_step = 1;  // s: multipliers are pressure over density, times its square
        for (std::uint32_t i = 0; i < start.count; ++i) {
            start.multiplier[i] = static_cast<float>(-model.gravity * below[i]);
        }
        find_pressures(model, ground, start);
        // Its mass is scaled to the volume: a lattice misses that of its outline a little.
        share_ = spec.shape.volume / static_cast<double>(points.size()) / (Measured::window * spec.shape.width);
        trial_.emplace(run::RunStart{std::move(model), std::move(ground), std::move(start)}, watch, OnFault::note);
    }

    bool advance_to(double time) override {
        for (; open_ < leaves_.size() && leaves_[open_].gone <= time; ++open_) {
            if (!trial_->advance_to(leaves_[open_].gone)) return false;
            trial_->remove_wall(first_leaf_ + open_);
        }
        return trial_->advance_to(time);
    }
    void read(const std::vector<double>& places, std::vector<double>& thickness) override {
        thickness.assign(places.size(), 0.0);
        const sim::State& state = trial_->state();
        const double origin = trial_->ground().terrain.frame().origin.x;
        for (std::uint32_t i = 0; i < state.count; ++i) {
            const double s = bed_.along(state.position.x[i] + origin);
            for (std::size_t p = 0; p < places.size(); ++p) {
                if (std::abs(s - places[p]) < Measured::window / 2) thickness[p] += share_;
            }
        }
    }
    double depth_at_wall() override {
        std::vector<double> thickness;
        read({spec_.obstacle - Measured::window / 2}, thickness);
        return thickness[0];
    }
    [[nodiscard]] std::string problem() const override { return trial_->problem(); }
    [[nodiscard]] std::size_t particles() const { return trial_->state().seeded; }

  private:
    /// Particles in the outline of the fill, none nearer to the gate than half a spacing; `below`: the surface, m.
    std::vector<LocalPoint> fill(const terrain::Terrain& terrain, double spacing, std::vector<double>& below) const {
        const double sine = std::sin(spec_.shape.slope), cosine = std::cos(spec_.shape.slope), gate = bed_.at(0).x;
        const auto across = static_cast<int>(std::lround(spec_.shape.width / spacing));
        const double pitch = spec_.shape.width / across;
        const FlumeFill outline(spec_.shape, bed_);
        std::vector<LocalPoint> points;
        for (double s = -spacing / 2; s > outline.back(); s -= spacing) {
            const PlanPoint ground = bed_.at(s);
            for (double n = spacing / 2; n < outline.height(); n += spacing) {
                const double x = ground.x + n * sine, z = ground.y + n * cosine;
                const double top = outline.top(x);
                if (x > gate - spacing / 2 || z > top) continue;
                for (int j = 0; j < across; ++j) {
                    points.push_back(terrain.frame().to_local({x, -spec_.shape.width / 2 + (j + 0.5) * pitch, z}));
                    below.push_back(top - z);
                }
            }
        }
        return points;
    }

    const FlumeSpec& spec_;
    const FlumeBed& bed_;
    std::vector<GateLeaf> leaves_;
    std::size_t first_leaf_ = 0, open_ = 0;
    double share_ = 0;  ///< m of thickness that a particle adds
    std::optional<Trial> trial_;
};

/// The depth-averaged model on square cells in plan, with a row of walls on either side.
class GridFlow : public Flow {
  public:
    GridFlow(const FlumeSpec& spec, const FlumeBed& bed, Obstacle obstacle, const Setting& setting, const Watch& watch)
        : spec_(spec),
          bed_(bed),
          walled_(obstacle == Obstacle::wall),
          material_(depth::material_of(setting.material)),
          watch_(watch),
          leaves_(opening_gate(spec.shape.width, spec.gate_time, leaf_pairs)),
          inner_(static_cast<int>(std::lround(spec.shape.width / spec.grid_cell))),
          geometry_{-bed.length() / 2, -(inner_ + 2) * spec.grid_cell / 2, spec.grid_cell,
                    static_cast<int>(bed.length() / spec.grid_cell) - 1, inner_ + 2},
          gate_(column_of(0)) {
        solver_.emplace(build());
        const FlumeFill outline(spec.shape, bed);
        Grid<float> depth(geometry_);
        double sum = 0;
        for (int column = 0; column < gate_; ++column) {
            const double x = geometry_.centre(column, 0).x;
            const double h = std::max(0.0, outline.top(x) - bed.at(bed.along(x)).y);
            for (int row = 1; row <= inner_; ++row) {
                depth.at(column, row) = static_cast<float>(h);
                sum += h * geometry_.cell * geometry_.cell;
            }
        }
        for (float& h : depth.values) h *= static_cast<float>(spec.shape.volume / sum);
        solver_->add(depth);
    }

    bool advance_to(double time) override {
        while (open_ < leaves_.size() && leaves_[open_].gone <= time) {
            const double gone = leaves_[open_].gone;
            if (!step_to(gone)) return false;
            while (open_ < leaves_.size() && leaves_[open_].gone <= gone) ++open_;
            take_over(build());
        }
        return step_to(time);
    }
    void read(const std::vector<double>& places, std::vector<double>& thickness) override {
        thickness.clear();
        for (const double s : places) {
            const int first = column_of(s - Measured::window / 2), last = column_of(s + Measured::window / 2);
            double depth = 0;
            for (int column = first; column < last; ++column) depth += mean_depth(column);
            const double along = bed_.along(geometry_.centre(last, 0).x) - bed_.along(geometry_.centre(first, 0).x);
            thickness.push_back(depth * geometry_.cell / along);
        }
    }
    double depth_at_wall() override { return mean_depth(column_of(spec_.obstacle) - 1); }
    [[nodiscard]] std::string problem() const override { return problem_; }

  private:
    [[nodiscard]] int column_of(double s) const {
        return static_cast<int>((bed_.at(s).x - geometry_.x_min) / geometry_.cell);
    }
    [[nodiscard]] double mean_depth(int column) const {
        double sum = 0;
        for (int row = 1; row <= inner_; ++row) sum += double{solver_->depth_at(column, row)};
        return sum / inner_;
    }
    bool step_to(double time) {
        while (solver_->time() < time - begun_ - 1e-9) {
            const Status stepped = solver_->advance(time - begun_ - solver_->time());
            if (!stepped) problem_ = stepped.error().message;
            if (!stepped || watch_.stopped()) return false;
        }
        return true;
    }
    /// Without debris, and without the leaves that are gone.
    [[nodiscard]] depth::Solver build() const {
        Grid<double> ground(geometry_);
        depth::GroundValues values;
        for (int row = 0; row < geometry_.rows; ++row) {
            for (int column = 0; column < geometry_.columns; ++column) {
                const PlanPoint centre = geometry_.centre(column, row);
                const double s = bed_.along(centre.x);
                const bool closed =
                    column == gate_ &&
                    std::any_of(leaves_.begin() + static_cast<std::ptrdiff_t>(open_), leaves_.end(),
                                [&](const GateLeaf& leaf) { return centre.y >= leaf.from && centre.y < leaf.to; });
                const bool built = row == 0 || row > inner_ || closed || (walled_ && s > spec_.obstacle);
                ground.at(column, row) = bed_.at(s).y + (built ? 5 : 0);
                values.structure.push_back(built ? 1.0F : 0.0F);
            }
        }
        return {ground, material_, values};
    }
    /// The debris goes on over other ground.
    void take_over(depth::Solver next) {
        for (int row = 1; row <= inner_; ++row) {
            for (int column = 0; column < geometry_.columns; ++column) {
                const double depth = solver_->depth_at(column, row);
                if (!(depth > 0)) continue;
                std::optional<double> solid_fraction, pore_pressure_ratio;
                if (solver_->pore_pressure_evolves()) {
                    solid_fraction = solver_->solid_fraction_at(column, row);
                    pore_pressure_ratio = solver_->pore_pressure_ratio_at(column, row);
                }
                next.inject(column, row, depth, solver_->u_at(column, row), solver_->v_at(column, row), solid_fraction,
                            pore_pressure_ratio);
            }
        }
        begun_ += solver_->time();
        solver_.emplace(std::move(next));
    }

    const FlumeSpec& spec_;
    const FlumeBed& bed_;
    bool walled_;
    depth::Material material_;
    const Watch& watch_;
    std::vector<GateLeaf> leaves_;
    std::size_t open_ = 0;  ///< leaves that are gone
    int inner_;             ///< rows of the channel, after the first
    GridGeometry geometry_;
    int gate_;          ///< the column on which it stands
    double begun_ = 0;  ///< s since the gate began to open, when the solver did
    std::string problem_;
    std::optional<depth::Solver> solver_;
};

Measured run(const FlumeSpec& spec, Obstacle obstacle, double spacing, const Setting& setting, const Watch& watch) {
    const FlumeBed bed = bed_of(spec, obstacle);
    if (spacing > 0) {
        ParticleFlow flow(spec, bed, obstacle, spacing, setting, watch);
        Measured measured = measure(flow, spec, bed, obstacle);
        measured.particles = flow.particles();
        return measured;
    }
    GridFlow flow(spec, bed, obstacle, setting, watch);
    return measure(flow, spec, bed, obstacle);
}

Result<Outcome> compute(const FlumeSpec& spec, const Setting& setting, const Watch& watch) {
    if (!FlumeFill(spec.shape, FlumeBed(spec.shape)).holds_volume()) {
        return Error{
            fmt::format("volume_m3 = {:g} is refused; gate_height_m, top_length_m and top_slope_deg hold more, "
                        "or debris would begin behind the flume",
                        spec.shape.volume)};
    }
    Outcome outcome;
    Chart chart{"thickness", "Thickness at the stations", "time since the gate began to open (s)", "thickness (m)", {}};
    const double finest = *std::min_element(spec.spacings.begin(), spec.spacings.end());
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
            Rows rows(watch, outcome, kind + end, coarse);
            const Measured m = rows.noted(run(spec, obstacle, spacing, setting, watch));
            if (obstacle != Obstacle::none) {
                rows.add("run_up", m.run_up);
                continue;
            }
            if (spacing > 0) outcome.notes.push_back(fmt::format("spacing {:g} m: {} particles", spacing, m.particles));
            for (const double station : spec.stations) {
                const std::string name = fmt::format("{:g} m{}", station, end);
                Rows(outcome, name, coarse).add("arrival_time", m.arrival(station));
                chart.series.push_back({name, Series::Style::line, m.time, m.thickness.at(station)});
            }
            for (const auto& [station, time] : spec.samples) {
                Rows(outcome, fmt::format("{:g} m at {:g} s{}", station, time, end), coarse)
                    .add("thickness", m.mean(station, time, spec.mean_time));
            }
        }
    }
    outcome.charts.push_back(chart);
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    FlumeSpec spec;
    spec.shape.slope = parameters.number("slope_deg", {.low = 1, .high = 60}, 31) * radians_per_degree;
    spec.shape.pad_slope = parameters.number("pad_slope_deg", {.low = 0, .high = 60}, 2.4) * radians_per_degree;
    spec.shape.bend_start = parameters.number("bend_start_m", {.low = 1, .high = 90}, 74);
    spec.shape.bend_end =
        std::max(spec.shape.bend_start + 1, parameters.number("bend_end_m", {.low = 2, .high = 100}, 84));
    spec.shape.width = parameters.number("width_m", positive, 2);
    spec.shape.volume = parameters.number("volume_m3", {.low = 0, .high = 50, .low_included = false}, 10);
    spec.shape.gate_height = parameters.number("gate_height_m", {.low = 0.1, .high = 5}, 1.9);
    spec.shape.top_length = parameters.number("top_length_m", {.low = 0.1, .high = 8}, 3.3);
    spec.shape.top_slope = parameters.number("top_slope_deg", {.low = 0, .high = 60}, 17) * radians_per_degree;
    spec.gate_time = parameters.number("gate_opening_s", {.low = 0}, 0.85);
    spec.mean_time = parameters.number("mean_time_s", positive, 0.5);
    spec.grid_cell = parameters.number("grid_cell_m", positive, 0.1);
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
