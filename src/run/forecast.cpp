#include "run/forecast.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "run/stop_rule.hpp"
#include "run/time_left.hpp"
#include "sim/physics/resistance.hpp"

namespace talus::run {
namespace {

constexpr std::size_t sample_size = 100;
constexpr double longest_step = 0.1;  // s
constexpr double pace_window = 0.25;  // of the wall time so far
// Fitted to the looks at 26 runs: hillsides, valleys, bowls, heaps, inflows, Sham Tseng on both terrains with the
// values of five authors, with both models (docs/performance.md).
constexpr double straggling_share = 0.8;  // of the debris: so much of it moves while it coasts together
constexpr double decay_window = 0.4;      // of the simulated time so far
constexpr double falls_before_decay = 2;  // in times that it took to become fastest
constexpr double decay_weight = 0.9;      // beside that of the blocks, once nearly all of it has come to rest
constexpr double even_stop = 1.25;        // time until the last block stops over that until half of them have
constexpr double still_awake = 0.2;       // of what is awake now: the mean of what is later, while debris straggles
constexpr double cost_asleep = 0.5;       // of particles

/// Takes a step along the ground; returns the new speed. No step passes more than a cell.
double slide(const sim::Model& model, const sim::Ground& ground, SlidingBlock& block, double effective_share,
             double time_step) {
    const auto below = ground.terrain.sample(block.position.x, block.position.y);
    const auto resistance = sim::ground_resistance(model, block.position);
    const Vec3<double>& n = below.normal;
    const double speed = length(block.velocity);
    // Along the slope of the new place, at the speed of the old one.
    Vec3<double> v = block.velocity - n * dot(block.velocity, n);
    v = v * (speed / std::max(length(v), 1e-9));
    v = v + (n * n.z - Vec3<double>{0, 0, 1}) * (model.gravity * time_step);
    v = sim::slowed_by_drag(model, resistance, below, 0.0, block.thickness, v, time_step);
    const double before = length(v), weight = model.gravity * n.z;
    const double coefficient = model.laws.moving_friction<double>().at(resistance.friction_coefficient,
                                                                       weight * block.thickness, before * before);
    const double friction =
        coefficient * effective_share * weight + resistance.cohesion / (model.rest_density * block.thickness);
    const double after = std::max(0.0, before - friction * time_step);
    block.velocity = before > 0 ? v * (after / before) : Vec3<double>{};
    block.position.x += block.velocity.x * time_step;
    block.position.y += block.velocity.y * time_step;
    block.position.z = ground.terrain.sample(block.position.x, block.position.y).height + model.contact_distance();
    return after;
}

double stop_time(const sim::Model& model, const sim::Ground& ground, SlidingBlock block, double deposited_speed,
                 double horizon) {
    const double effective_share = 1 - (model.pore_pressure_decay_time > 0 ? 0 : model.pore_pressure_ratio);
    double time = block.start, moved = block.start;
    while (time < horizon) {
        const double time_step = std::min(longest_step, ground.terrain.cell() / std::max(length(block.velocity), 1.0));
        const double speed = slide(model, ground, block, effective_share, time_step);
        time += time_step;
        if (speed >= deposited_speed) moved = time;
        if (speed <= 0 || !ground.terrain.covers(block.position.x, block.position.y)) break;
        if (!ground.solids.empty() && ground.solids.inside(block.position)) break;
    }
    return std::min(moved, horizon);
}

/// When less than `enough` of the debris still moves. `stops` stand for `moving` of it.
double rest_time(const std::vector<double>& stops, double moving, double enough) {
    if (stops.empty() || moving <= enough) return 0;
    const double last = static_cast<double>(stops.size()) * (1 - enough / moving);
    return stops[std::min(stops.size() - 1, static_cast<std::size_t>(last))];
}

double half_of(const std::vector<double>& stops) {
    return stops.empty() ? 0 : stops[stops.size() / 2];
}

double start_of(const sim::Model& model, std::uint32_t id) {
    for (const sim::ReleaseGroup& release : model.releases) {
        if (id >= release.first_particle && id < release.last_particle) return release.start_time;
    }
    return 0;
}

/// Particles per column of the flow, of which slowed_by_drag takes the thickness.
class Columns {
  public:
    Columns(const sim::Model& model, const sim::State& state) : width_(sim::column_width(model)) {
        counts_.reserve(state.count / 4);
        for (std::size_t i = 0; i < state.count; ++i) ++counts_[key(state.position.x[i], state.position.y[i])];
    }
    [[nodiscard]] double at(double x, double y) const {
        const auto found = counts_.find(key(x, y));
        return found == counts_.end() ? 1 : found->second;
    }

  private:
    [[nodiscard]] std::uint64_t key(double x, double y) const {
        const auto cell = [&](double v) {
            return static_cast<std::uint64_t>(
                static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(v / width_))));
        };
        return cell(x) << 32 | cell(y);
    }

    double width_;
    std::unordered_map<std::uint64_t, std::uint32_t> counts_;
};

}  // namespace

std::vector<double> stop_times(const sim::Model& model, const sim::Ground& ground, std::vector<SlidingBlock> blocks,
                               double deposited_speed, double horizon) {
    std::vector<double> stops(blocks.size());
    for (std::size_t k = 0; k < blocks.size(); ++k) {
        stops[k] = stop_time(model, ground, blocks[k], deposited_speed, horizon);
    }
    std::sort(stops.begin(), stops.end());
    return stops;
}

Outlook outlook_of(const sim::Simulation& simulation, double deposited_speed) {
    const sim::Model& model = simulation.model();
    const sim::State& state = simulation.state();
    const double debris = std::max<double>(state.count, 1);
    Outlook outlook;
    outlook.enough_share = std::clamp(model.solver.stop_moving_share, std::min(1.0, 5 / debris), 1.0);
    outlook.moving_share = simulation.motion(deposited_speed).moving / debris;
    for (std::size_t i = 0; i < state.awake; ++i) {
        const LocalPoint v = state.velocity.at(i);
        outlook.energy += v.x * v.x + v.y * v.y + v.z * v.z;
    }

    // What sleeps is deposit.
    std::vector<SlidingBlock> blocks;
    const Columns columns(model, state);
    const double every = std::max(1.0, static_cast<double>(state.awake) / sample_size);
    for (double place = every / 2; place < state.awake; place += every) {
        const auto i = static_cast<std::size_t>(place);
        const LocalPoint p = state.position.at(i), v = state.velocity.at(i);
        const auto below = simulation.ground().terrain.sample<double>(p.x, p.y);
        SlidingBlock block{{p.x, p.y, p.z}, {v.x, v.y, v.z}, sim::flow_thickness(model, below, columns.at(p.x, p.y))};
        if (state.held[i] != 0) {
            block.start = start_of(model, state.id[i]) - state.time;
            if (!std::isfinite(block.start)) continue;  // until somebody triggers it
            outlook.moving_share += every / debris;     // as it will
        }
        blocks.push_back(block);
    }
    const auto stops =
        stop_times(model, simulation.ground(), std::move(blocks), deposited_speed, model.solver.end_time - state.time);
    outlook.coasting = rest_time(stops, state.awake, outlook.enough_share * debris);
    outlook.half_stopped = half_of(stops);
    outlook.awake_share = state.awake / debris;
    outlook.cost_asleep = cost_asleep;
    return outlook;
}

Outlook outlook_of(const depth::Solver& solver, const sim::Model& model, const sim::Ground& ground,
                   double deposited_speed) {
    struct Cell {
        PlanPoint place;
        float depth, u, v;
    };
    std::vector<Cell> cells;
    Outlook outlook;
    double awake = 0, moving = 0;  // m, of all cells
    const GridGeometry& geometry = solver.geometry();
    solver.for_each_active_row_in_turn([&](const depth::CellRow& row) {
        for (int k = 0; k < row.last - row.first; ++k) {
            if (row.depth[k] <= 0) continue;
            cells.push_back({geometry.centre(row.first + k, row.row), row.depth[k], row.u[k], row.v[k]});
            awake += row.depth[k];
            const double speed = std::hypot(row.u[k], row.v[k]);
            outlook.energy += row.depth[k] * speed * speed;
            if (speed >= deposited_speed) moving += row.depth[k];
        }
    });
    // A block for each equal part of the volume.
    std::vector<SlidingBlock> blocks;
    double sum = 0;
    for (const Cell& cell : cells) {
        sum += cell.depth;
        if (sum < (static_cast<double>(blocks.size()) + 0.5) * awake / sample_size) continue;
        const LocalPoint p = ground.terrain.frame().to_local({cell.place.x, cell.place.y, 0});
        const auto below = ground.terrain.sample<double>(p.x, p.y);
        const double rise = -(below.normal.x * cell.u + below.normal.y * cell.v) / below.normal.z;
        blocks.push_back({{p.x, p.y, below.height + model.contact_distance()},
                          {cell.u, cell.v, rise},
                          std::max(cell.depth * below.normal.z, 0.01)});
    }
    const double debris = std::max(solver.volume() / (geometry.cell * geometry.cell), 1e-9);
    outlook.enough_share = model.solver.stop_moving_share;
    outlook.moving_share = std::min(1.0, moving / debris);
    const auto stops =
        stop_times(model, ground, std::move(blocks), deposited_speed, model.solver.end_time - solver.time());
    outlook.coasting = rest_time(stops, awake, outlook.enough_share * debris);
    outlook.half_stopped = half_of(stops);
    return outlook;
}

template <class Accepts>
RunClock::Mark RunClock::latest_mark(const Accepts& accepts) const {
    const auto found = std::find_if(marks_.rbegin(), marks_.rend(), accepts);
    return found == marks_.rend() ? Mark{} : *found;
}

double RunClock::straggling(const Outlook& now, double time) const {
    // The decay of the moving share over the latest part of the run, and that since debris was fastest.
    const Mark before = latest_mark([&](const Mark& mark) { return mark.time <= (1 - decay_window) * time; });
    const double fallen = std::max(0.0, std::log(std::max(before.moving_share, 1e-9) / now.moving_share));
    const double fastest = std::max_element(marks_.begin(), marks_.end(), [](const Mark& x, const Mark& y) {
                               return x.energy < y.energy;
                           })->time;
    const double long_decay = (time + falls_before_decay * fastest) / -std::log(now.moving_share);
    const double decay = (time - before.time + long_decay) / (fallen + 1);
    const double by_decay = decay * std::log(now.moving_share / now.enough_share);
    const double weight = decay_weight * std::sqrt(1 - now.moving_share);
    return std::pow(std::max(now.coasting, 0.1), 1 - weight) * std::pow(by_decay, weight);
}

/// s, until energy or momentum ends the run, as the energy fell over the latest part of it; infinity: by neither.
double RunClock::declining(const Outlook& now, double time) const {
    // Of the same debris momentum falls as the root of the energy.
    const double share = std::max(solver_.stop_energy_share, std::pow(solver_.stop_momentum_share, 2));
    const Mark before = latest_mark([&](const Mark& mark) { return mark.time <= (1 - decay_window) * time; });
    if (!(share > 0) || now.wait > 0 || !(now.energy > 0) || before.energy <= now.energy) {
        return std::numeric_limits<double>::infinity();
    }
    double peak = 0;
    for (const Mark& mark : marks_) peak = std::max(peak, mark.energy);
    const double decay = (time - before.time) / std::log(before.energy / now.energy);
    return decay * std::max(0.0, std::log(now.energy / (share * peak))) + solver_.stop_duration;
}

RunClock::Course RunClock::course_after(const Outlook& now, double time) const {
    const double most = std::min(std::max(0.0, solver_.end_time - time), declining(now, time));
    if (solver_.stop_moving_share <= 0) return {most, 0};
    Course course;
    const bool speeds_up =
        std::all_of(marks_.begin(), marks_.end(), [&](const Mark& m) { return m.energy <= now.energy; });
    if (now.moving_share >= straggling_share || speeds_up) {
        course.coasting = now.wait + now.coasting;
        const double unevenness = now.coasting / std::max(now.half_stopped, 0.1) - even_stop;
        course.straggling = (time + now.coasting) / 2 * std::clamp(unevenness, 0.0, 1.0);
    } else {
        course.straggling = now.wait + (now.moving_share > now.enough_share ? straggling(now, time) : now.coasting);
    }
    course.coasting = std::min(course.coasting, most);
    course.straggling = std::min(course.straggling + solver_.stop_duration, most - course.coasting);
    return course;
}

double RunClock::wall_time_of(const Course& course, double wall_time, double time) const {
    const Mark before = latest_mark([&](const Mark& mark) { return mark.wall_time <= (1 - pace_window) * wall_time; });
    if (time <= before.time || marks_.empty()) return remaining_;
    const double pace = (wall_time - before.wall_time) / (time - before.time);
    const double step = (time - before.time) / std::max(1.0, steps_ - before.steps);
    // Between the latest steps and the longest, as far as runs have shown.
    const double longer_steps = std::sqrt(std::min(1.0, step / longest_step_));
    const auto cost = [&](double awake) { return cost_asleep_ + (1 - cost_asleep_) * awake; };
    const double awake = marks_.back().awake_share;
    const double straggling = longer_steps * cost(still_awake * awake) / cost((awake + before.awake_share) / 2);
    return pace * (course.coasting * (1 + longer_steps) / 2 + course.straggling * straggling);
}

double RunClock::wall_remaining() const {
    return share_done_ < least_share_done ? std::numeric_limits<double>::quiet_NaN() : remaining_;
}

void RunClock::tick(double wall_time, double time, const std::function<Outlook()>& look) {
    using Clock = std::chrono::steady_clock;
    ++steps_;
    longest_step_ = std::max(longest_step_, time - last_time_);
    last_time_ = time;
    const bool halfway = time - course_from_ > (course_.coasting + course_.straggling) / 2;
    if (wall_time >= (halfway ? next_look_if_halfway_ : next_look_)) {
        const auto start = Clock::now();
        const Outlook now = look();
        marks_.push_back({wall_time, time, steps_, now.moving_share, now.awake_share, now.energy});
        cost_asleep_ = now.cost_asleep;
        course_ = course_after(now, time);
        course_from_ = time;
        end_ = time + course_.coasting + course_.straggling;
        const double cost = std::chrono::duration<double>(Clock::now() - start).count();
        next_look_ = std::max(1.03 * wall_time, wall_time + 50 * cost);
        next_look_if_halfway_ = std::max(1.03 * wall_time, wall_time + 5 * cost);
    }
    const double passed = time - course_from_, straggled = std::max(0.0, passed - course_.coasting);
    remaining_ = wall_time_of({std::max(0.0, course_.coasting - passed), std::max(0.0, course_.straggling - straggled)},
                              wall_time, time);
    share_done_ = std::max(share_done_, wall_time / std::max(wall_time + remaining_, 1e-9));
}

}  // namespace talus::run
