#include "observe/observer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "observe/building_impact.hpp"
#include "observe/erosion.hpp"
#include "observe/front_tracker.hpp"
#include "observe/gauges.hpp"
#include "observe/map_accumulator.hpp"
#include "observe/run_out.hpp"
#include "observe/step_rate.hpp"
#include "sim/compression.hpp"
#include "sim/particle_density.hpp"
#include "simd/parallel.hpp"

namespace talus::observe {
namespace {

/// Counts and energies over the particles, as far as they are summed for every row.
struct Totals {
    std::uint32_t held = 0, moving = 0, deposited = 0;
    double speed_squared = 0;  ///< sum, m2/s2
    double height = 0;         ///< sum over the particles, m above the lowest terrain
};                             ///< both weighed by density over rest density

Totals sum_up(const sim::Model& model, const sim::State& state, double deposited_speed) {
    const bool own_densities = !state.density_of_id.empty();
    return simd::reduce_ranges(
        state.count, 1024, Totals{},
        [&](std::size_t first, std::size_t last, Totals sum) {
            for (std::size_t i = first; i < last; ++i) {
                const LocalPoint v = state.velocity.at(i);
                const double speed_squared = dot(v, v);
                const double weight = own_densities ? density_of(model, state, i) / model.rest_density : 1;
                sum.speed_squared += weight * speed_squared;
                sum.height += weight * static_cast<double>(state.position.z[i]);
                if (state.held[i] != 0) {
                    ++sum.held;
                } else if (speed_squared < deposited_speed * deposited_speed) {
                    ++sum.deposited;
                } else {
                    ++sum.moving;
                }
            }
            return sum;
        },
        [](const Totals& a, const Totals& b) {
            return Totals{a.held + b.held, a.moving + b.moving, a.deposited + b.deposited,
                          a.speed_squared + b.speed_squared, a.height + b.height};
        });
}

TimeSample make_sample(const sim::Model& model, const sim::State& state, double deposited_speed, double front_chainage,
                       double steps_per_second) {
    const Totals totals = sum_up(model, state, deposited_speed);
    TimeSample sample;
    sample.time = state.time;
    sample.volume_released = state.released() * model.particle_volume();
    sample.volume_entrained = state.entrained * model.particle_volume();
    sample.front_chainage = front_chainage;
    sample.volume_held = totals.held * model.particle_volume();
    sample.volume_moving = totals.moving * model.particle_volume();
    sample.volume_deposited = totals.deposited * model.particle_volume();
    sample.volume_left = state.outflow * model.particle_volume();
    sample.kinetic_energy = 0.5 * model.particle_mass() * totals.speed_squared;
    sample.potential_energy = model.particle_mass() * model.gravity * totals.height;
    sample.largest_speed = state.max_speed;
    sample.mean_compression = state.mean_compression;
    sample.max_compression = state.max_compression;
    sample.squeezed_share = state.squeezed_share;
    sample.time_step = state.time_step;
    sample.steps_per_second = steps_per_second;
    return sample;
}

}  // namespace

struct Observer::Parts {
    Parts(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
          const terrain::FlowPath& flow_path, const params::OutputSpec& o, double map_cell)
        : outputs(o),
          maps(model, ground, state, map_cell, o.arrival_depth),
          front(model, ground, state, flow_path, o.chainage_interval, o.front_velocity_window),
          impact(model, ground, state, o),
          released(measure_release(ground, state)) {
        keep_starts(state, 0);
    }

    /// Stores the positions of the particles with ids from `first_id`.
    void keep_starts(const sim::State& state, std::uint32_t first_id) {
        start.resize(state.seeded);
        for (std::uint32_t i = 0; i < state.count; ++i) {
            const std::uint32_t id = state.id[i];
            if (id >= first_id && id < start.size()) start[id] = state.position.at(i);
        }
    }

    /// The debris of all existing releases at its start.
    [[nodiscard]] ReleasedMass measure_starts(const sim::Model& model, const sim::Ground& ground) const {
        sim::State lay;
        lay.resize(start.size());
        const auto add = [&](std::uint32_t first, std::uint32_t last) {
            for (std::uint32_t id = first; id < last; ++id) lay.position.set(lay.count++, start[id]);
        };
        for (const sim::ReleaseGroup& release : model.releases) add(release.first_particle, release.last_particle);
        for (const auto& [first, last] : injected) add(first, last);
        return measure_release(ground, lay);
    }

    void watch_compression(const sim::Model& model, const sim::State& state) {
        const auto keep = [&](double value, double& worst, double& time) {
            if (value <= worst) return;
            worst = value;
            time = state.time;
        };
        keep(state.mean_compression, compression.worst_mean, compression.worst_mean_time);
        keep(state.max_compression, compression.worst_max, compression.worst_max_time);
        keep(state.squeezed_share, compression.worst_squeezed_share, compression.worst_squeezed_time);
        if (too_compressed(state)) compressed_time += state.time_step;
        if (state.iterations > model.solver.iteration_count) iterated_time += state.time_step;
        iterations += static_cast<std::uint64_t>(state.iterations);
        ++steps;
    }

    void add_row(const sim::Model& model, const sim::State& state) {
        timeseries.push_back(make_sample(model, state, outputs.deposited_speed, front.current(), steps_per_second));
        impact.add_row(state);
    }

    void read_gauges(double time, bool row) {
        gauges.after_step(time, row, [&](const PlanPoint& place) { return maps.at(place); });
    }

    params::OutputSpec outputs;
    MapAccumulator maps;
    GaugeRecorder gauges;
    FrontTracker front;
    ImpactRecorder impact;
    ReleasedMass released;
    std::vector<LocalPoint> start;                                  ///< by particle id
    std::vector<std::pair<std::uint32_t, std::uint32_t>> injected;  ///< ids [first, last) injected during the run
    std::vector<TimeSample> timeseries;
    std::uint64_t next_row = 1;  ///< due at next_row * sample_interval
    StepRate rate;
    double steps_per_second = 0;
    Compression compression;                        ///< its worst values; finish() adds the rest
    double compressed_time = 0, iterated_time = 0;  ///< s
    std::uint64_t iterations = 0, steps = 0;
};

Observer::Observer(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                   const terrain::FlowPath& flow_path, const params::OutputSpec& outputs, double map_cell)
    : parts_(std::make_unique<Parts>(model, ground, state, flow_path, outputs, map_cell)) {
    parts_->maps.add(state);
    parts_->add_row(model, state);
}

Observer::~Observer() = default;

void Observer::observe(const sim::Model& model, const sim::Ground& ground, const sim::State& state) {
    after_step(model, ground, state, parts_->rate.update(state.step));
}

void Observer::after_step(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                          double steps_per_second) {
    Parts& p = *parts_;
    p.maps.add(state);
    p.front.after_step(ground, state);
    p.impact.after_step(model, ground, state);
    p.watch_compression(model, state);
    p.steps_per_second = steps_per_second;
    // Rows at multiples of the interval, or just after one where a step is longer; a millionth of it absorbs rounding.
    const double intervals = state.time / p.outputs.sample_interval + 1e-6;
    const bool row = intervals >= static_cast<double>(p.next_row);
    p.read_gauges(state.time, row);
    if (row) {
        p.add_row(model, state);
        p.next_row = static_cast<std::uint64_t>(intervals) + 1;
    }
}

void Observer::follow(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                      std::uint32_t first_new_id) {
    Parts& p = *parts_;
    p.keep_starts(state, first_new_id);
    p.released = p.measure_starts(model, ground);
    p.maps.follow(model, state);
    p.maps.add(state);
    p.front.follow(state);
    p.impact.follow(model, ground, state);
}

void Observer::follow_inflow(const sim::State& state, std::uint32_t first_new_id) {
    Parts& p = *parts_;
    if (first_new_id == state.seeded) return;
    p.keep_starts(state, first_new_id);
    if (!p.injected.empty() && p.injected.back().second == first_new_id) {
        p.injected.back().second = state.seeded;
    } else {
        p.injected.emplace_back(first_new_id, state.seeded);
    }
    p.maps.make_room(state.count);
    p.front.follow(state);
    p.impact.follow_inflow(state);
}

void Observer::watch(const std::vector<terrain::Gauge>& gauges) {
    parts_->gauges = GaugeRecorder(gauges, parts_->outputs.arrival_depth);
    parts_->read_gauges(parts_->timeseries.back().time, true);
}

void Observer::expect(std::uint32_t particles) {
    parts_->start.reserve(particles);
    parts_->maps.make_room(particles);
    parts_->front.expect(particles);
    parts_->impact.expect(particles);
}

void Observer::forget_building(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                               std::size_t building) {
    parts_->impact.forget(model, ground, state, building);
}

const std::vector<std::size_t>& Observer::failed_buildings() const {
    return parts_->impact.failed();
}

const Overtopping* Observer::overtopping(std::size_t building) const {
    return parts_->impact.overtopping(building);
}

double Observer::front_chainage() const {
    return parts_->front.farthest();
}

const TimeSample& Observer::latest() const {
    return parts_->timeseries.back();
}

TimeSample Observer::sample(const sim::Model& model, const sim::State& state) const {
    const Parts& p = *parts_;
    return make_sample(model, state, p.outputs.deposited_speed, p.front.current(), p.steps_per_second);
}

const std::vector<TimeSample>& Observer::timeseries() const {
    return parts_->timeseries;
}

std::vector<FrontSample> Observer::front() const {
    return parts_->front.samples();
}

const std::vector<BuildingImpact>& Observer::impacts() const {
    return parts_->impact.impacts();
}

const MapAccumulator& Observer::maps() const {
    return parts_->maps;
}

const terrain::FlowPath& Observer::flow_path() const {
    return parts_->front.flow_path();
}

Observation Observer::finish(const sim::Model& model, const sim::Ground& ground, const sim::State& state) const {
    const Parts& p = *parts_;
    Observation observation;
    observation.maps = p.maps.maps();
    observation.thickness = measure_thickness(observation.maps.peak_depth, ground.terrain, p.outputs.arrival_depth);
    observation.deposit = measure_deposit(observation.maps.deposit_depth, p.outputs.arrival_depth);
    observation.front = p.front.samples();
    const ReleasedMass released = p.injected.empty() ? p.released : p.measure_starts(model, ground);
    observation.run_out = measure_run_out(ground, state, observation.maps.peak_depth, released, p.front.farthest());
    observation.buildings = p.impact.complete(state);
    observation.timeseries = p.timeseries;
    observation.gauges = p.gauges.records();
    if (p.timeseries.back().time != state.time) observation.timeseries.push_back(sample(model, state));
    observation.erosion = measure_erosion(ground, p.front.flow_path(), p.outputs.chainage_interval);
    observation.volume_released = state.released() * model.particle_volume();
    observation.compression = p.compression;
    if (state.time > 0) {
        observation.compression.time_share_above = p.compressed_time / state.time;
        observation.compression.time_share_iterated = p.iterated_time / state.time;
    }
    if (p.steps > 0) {
        observation.compression.mean_iterations = static_cast<double>(p.iterations) / static_cast<double>(p.steps);
    }
    return observation;
}

}  // namespace talus::observe
