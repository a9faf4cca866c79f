#include "observe/observer.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "observe/building_impact.hpp"
#include "observe/debris.hpp"
#include "observe/device/particles.hpp"
#include "observe/discharge.hpp"
#include "observe/energy.hpp"
#include "observe/erosion.hpp"
#include "observe/front_tracker.hpp"
#include "observe/gauges.hpp"
#include "observe/map_accumulator.hpp"
#include "observe/run_out.hpp"
#include "observe/step_rate.hpp"
#include "sim/compression.hpp"
#include "sim/particle_density.hpp"

namespace talus::observe {
namespace {

TimeSample make_sample(const sim::Model& model, const Debris& debris, double deposited_speed, double front_chainage,
                       double steps_per_second) {
    const sim::StateSummary& state = debris.summary();
    const ParticleSums totals = debris.sums(model, deposited_speed);
    TimeSample sample;
    sample.time = state.time;
    sample.volume_released = state.released() * model.particle_volume();
    sample.volume_entrained = state.entrained * model.particle_volume();
    sample.front_chainage = front_chainage;
    sample.volume_held = totals.held * model.particle_volume();
    sample.volume_moving = totals.moving * model.particle_volume();
    sample.volume_deposited = totals.deposited * model.particle_volume();
    if (state.step == 0) {  // nothing has been let go yet
        sample.volume_held += sample.volume_moving + sample.volume_deposited;
        sample.volume_moving = sample.volume_deposited = 0;
    }
    sample.volume_left = state.outflow * model.particle_volume();
    sample.kinetic_energy = 0.5 * model.particle_mass() * totals.speed_squared;
    sample.momentum = model.particle_mass() * totals.speed;
    sample.potential_energy = model.particle_mass() * model.gravity * totals.height;
    sample.largest_speed = state.max_speed;
    sample.mean_compression = state.mean_compression;
    sample.max_compression = state.max_compression;
    sample.overcompressed_share = state.overcompressed_share;
    sample.time_step = state.step > 0 ? state.time_step : 0;
    sample.steps_per_second = steps_per_second;
    return sample;
}

}  // namespace

struct Observer::Parts {
    /// What reads the particles on a device. A copy of the observer reads those of its own run.
    struct OnDevice {
        const sim::device::Backend* backend = nullptr;
        std::unique_ptr<device::Particles> particles;

        OnDevice() = default;
        OnDevice(const OnDevice& /*of another run*/) {}
        OnDevice& operator=(const OnDevice&) = delete;
        ~OnDevice() = default;
    };

    Parts(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
          const terrain::FlowPath& flow_path, const params::OutputSpec& o, double map_cell)
        : outputs(o),
          maps(model, ground, state, map_cell, o.arrival_depth),
          front(model, ground, state, flow_path, o.chainage_interval, o.front_velocity_window),
          impact(model, ground, state, o),
          energy(model.gravity),
          released(measure_release(ground, state)) {
        keep_starts(state, 0);
        bring(model, ground, state, 0);
    }

    /// Stores the positions of the particles with ids from `first_id`.
    void keep_starts(const sim::State& state, std::uint32_t first_id) {
        start.resize(state.seeded);
        for (std::uint32_t i = 0; i < state.count; ++i) {
            const std::uint32_t id = state.id[i];
            if (id >= first_id && id < start.size()) start[id] = state.position.at(i);
        }
    }

    /// Energy and highest energy line of the particles with ids from `first_id`, which have just come.
    void bring(const sim::Model& model, const sim::Ground& ground, const sim::State& state, std::uint32_t first_id) {
        double mass = 0, heads = 0, highest = std::numeric_limits<double>::lowest(), thickness = 0;
        for (std::uint32_t i = 0; i < state.count; ++i) {
            if (state.id[i] < first_id) continue;
            const LocalPoint p = state.position.at(i), v = state.velocity.at(i);
            const double of_particle = model.particle_volume() * sim::density_of(model, state, i);
            const double head = double{p.z} + dot(v, v) / (2 * model.gravity);
            const double above = p.z - ground.terrain.sample(double{p.x}, double{p.y}).height;
            mass += of_particle;
            heads += of_particle * head;
            highest = std::max(highest, head + model.particle_spacing / 2);
            thickness = std::max(thickness, above + model.particle_spacing / 2);
        }
        energy.bring(mass, model.gravity * heads, highest, thickness);
    }

    [[nodiscard]] Energy measure_energy(const sim::Model& model, const sim::Ground& ground,
                                        const HazardMaps& hazard) const {
        const GridGeometry& g = hazard.peak_speed.geometry;
        Grid<float> height(g);
        for (int row = 0; row < g.rows; ++row) {
            for (int column = 0; column < g.columns; ++column) {
                const double elevation = ground.terrain.elevation_at(g.centre(column, row));
                height.at(column, row) = static_cast<float>(elevation - ground.terrain.frame().origin.z);
            }
        }
        return energy.measure(hazard, height, model.particle_spacing);
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

    void watch_compression(const sim::Model& model, const sim::StateSummary& state) {
        const auto keep = [&](double value, double& worst, double& time) {
            if (value <= worst) return;
            worst = value;
            time = state.time;
        };
        keep(state.mean_compression, compression.worst_mean, compression.worst_mean_time);
        keep(state.max_compression, compression.worst_max, compression.worst_max_time);
        keep(state.overcompressed_share, compression.worst_overcompressed_share, compression.worst_overcompressed_time);
        if (too_compressed(state)) compressed_time += state.time_step;
        if (state.iterations > model.solver.iteration_count) iterated_time += state.time_step;
        iterations += static_cast<std::uint64_t>(state.iterations);
        ++steps;
    }

    void add_row(const sim::Model& model, const Debris& debris) {
        timeseries.push_back(make_sample(model, debris, outputs.deposited_speed, front.current(), steps_per_second));
        energy.add(timeseries.back(), debris.summary().count * model.particle_mass(), model.rest_density);
        impact.add_row(debris);
    }

    void after_step(const sim::Model& model, const sim::Ground& ground, const Debris& debris, double rate_now) {
        debris.add_to(maps);
        front.after_step(ground, debris);
        impact.after_step(model, ground, debris);
        sections.after_step(debris);
        const sim::StateSummary& state = debris.summary();
        watch_compression(model, state);
        steps_per_second = rate_now;
        // Rows at multiples of the interval, or just after one where a step is longer; a millionth of it absorbs
        // rounding.
        const double intervals = state.time / outputs.sample_interval + 1e-6;
        const bool row = intervals >= static_cast<double>(next_row);
        read_gauges(state.time, row);
        if (row) {
            add_row(model, debris);
            next_row = static_cast<std::uint64_t>(intervals) + 1;
        }
    }

    void read_gauges(double time, bool row) {
        gauges.after_step(time, row, [&](const PlanPoint& place) { return maps.at(place); });
    }

    template <class Archive>
    void keep(Archive& archive) {
        archive(maps, gauges, sections, front, impact, energy, released, start, injected, timeseries, next_row,
                compression.worst_mean, compression.worst_max, compression.worst_overcompressed_share,
                compression.worst_mean_time, compression.worst_max_time, compression.worst_overcompressed_time,
                compressed_time, iterated_time, iterations, steps);
    }

    params::OutputSpec outputs;
    OnDevice on_device;
    MapAccumulator maps;
    GaugeRecorder gauges;
    ParticleSections sections;
    FrontTracker front;
    ImpactRecorder impact;
    EnergyAccount energy;
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

Observer::Observer(const Observer& other) : StepWatcher(), parts_(std::make_unique<Parts>(*other.parts_)) {}

Observer::~Observer() = default;

void Observer::observe(const sim::Model& model, const sim::Ground& ground, const sim::State& state) {
    after_step(model, ground, state, parts_->rate.update(state.step));
}

bool Observer::observe_on(sim::device::Backend& backend, const sim::Model& model, const sim::Ground& ground,
                          const sim::StateSummary& state) {
    Parts& p = *parts_;
    if (p.on_device.backend != &backend) {
        p.on_device.particles = device::make_particles(backend);
        p.on_device.backend = &backend;
    }
    if (!p.on_device.particles) return false;
    p.after_step(model, ground, Debris(*p.on_device.particles, state), p.rate.update(state.step));
    return true;
}

void Observer::after_step(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                          double steps_per_second) {
    parts_->after_step(model, ground, state, steps_per_second);
}

void Observer::follow(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                      std::uint32_t first_new_id) {
    Parts& p = *parts_;
    p.keep_starts(state, first_new_id);
    p.bring(model, ground, state, first_new_id);
    p.energy.follow(sample(model, state), state.released() * model.particle_mass());
    p.released = p.measure_starts(model, ground);
    p.maps.follow(model, state);
    p.maps.add(state);
    p.front.follow(state);
    p.impact.follow(model, ground, state);
    p.sections.forget_places();
    if (p.on_device.particles) p.on_device.particles->forget_walls();
}

void Observer::follow_inflow(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                             std::uint32_t first_new_id) {
    Parts& p = *parts_;
    if (first_new_id == state.seeded) return;
    p.keep_starts(state, first_new_id);
    p.bring(model, ground, state, first_new_id);
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

void Observer::watch(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                     const std::vector<terrain::CrossSection>& sections) {
    parts_->sections = ParticleSections(model, ground.terrain, sections, state);
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

void Observer::save(ArchiveWriter& archive) {
    archive(*parts_);
}

void Observer::restore(ArchiveReader& archive) {
    archive(*parts_);
    if (parts_->timeseries.empty()) archive.fail();  // it has a row from the beginning on
    if (parts_->on_device.particles) parts_->on_device.particles->forget_walls();
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

const std::vector<GaugeRecord>& Observer::gauges() const {
    return parts_->gauges.records();
}

std::vector<DischargeRecord> Observer::cross_sections(double time) const {
    return parts_->sections.records(time);
}

const terrain::FlowPath& Observer::flow_path() const {
    return parts_->front.flow_path();
}

Observation Observer::checked(const sim::Model& model, const sim::Ground& ground, const sim::State& state) const {
    const Parts& p = *parts_;
    Observation observation;
    observation.maps = p.maps.maps();
    observation.energy = p.measure_energy(model, ground, observation.maps);
    observation.thickness = measure_thickness(observation.maps.peak_depth, ground.terrain, p.outputs.arrival_depth);
    observation.timeseries = {sample(model, state)};
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

Observation Observer::finish(const sim::Model& model, const sim::Ground& ground, const sim::State& state) const {
    const Parts& p = *parts_;
    Observation observation = checked(model, ground, state);
    const TimeSample now = observation.timeseries.back();
    observation.deposit = measure_deposit(observation.maps.deposit_depth, p.outputs.arrival_depth);
    observation.front = p.front.samples();
    const ReleasedMass released = p.injected.empty() ? p.released : p.measure_starts(model, ground);
    observation.run_out = measure_run_out(ground, state, observation.maps.peak_depth, released, p.front.farthest());
    observation.buildings = p.impact.complete(state);
    observation.timeseries = p.timeseries;
    observation.gauges = p.gauges.records();
    observation.cross_sections = p.sections.records(state.time);
    if (p.timeseries.back().time < state.time) observation.timeseries.push_back(now);
    observation.erosion = measure_erosion(ground, p.front.flow_path(), p.outputs.chainage_interval);
    observation.volume_released = state.released() * model.particle_volume();
    return observation;
}

}  // namespace talus::observe
