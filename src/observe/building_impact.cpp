#include "observe/building_impact.hpp"

#include <algorithm>
#include <cmath>

#include "terrain/barrier.hpp"

namespace talus {

ImpactRecorder::ImpactRecorder(const Model& model, const Ground& ground, const State& state, double filter_window)
    : window_(filter_window), particle_area_(model.particle_spacing * model.particle_spacing) {
    follow(model, ground, state);
    jumped_ = false;
}

void ImpactRecorder::follow(const Model& model, const Ground& ground, const State& state) {
    jumped_ = true;
    impacts_.resize(ground.buildings.size());
    records_.resize(ground.buildings.size());
    crossings_.resize(ground.buildings.size());
    for (std::size_t b = 0; b < impacts_.size(); ++b) {
        impacts_[b].name = ground.buildings[b].name;
        const std::optional<BarrierSpec>& barrier = ground.buildings[b].barrier;
        impacts_[b].is_barrier = barrier.has_value();
        impacts_[b].passing_share = barrier ? barrier->passing_share.value_or(never) : never;
        if (!stands(ground.buildings[b])) {
            crossings_[b].reset();
        } else if (!crossings_[b]) {
            watch(model, ground, state, b);
        } else {
            crossings_[b]->follow(state);
        }
    }
    touched_.reserve(impacts_.size());
    failed_.reserve(impacts_.size());
    if (impacts_.empty()) return;
    const std::uint32_t greatest =
        state.count == 0 ? 0 : *std::max_element(state.id.begin(), state.id.begin() + state.count);
    last_touch_.resize(std::max({last_touch_.size(), std::size_t{state.seeded}, std::size_t{greatest} + 1}));
}

void ImpactRecorder::follow_inflow(const State& state) {
    if (impacts_.empty()) return;
    last_touch_.resize(std::max<std::size_t>(last_touch_.size(), state.seeded));
    for (const auto& crossings : crossings_) {
        if (crossings) crossings->follow(state);
    }
}

void ImpactRecorder::expect(std::uint32_t particles) {
    if (impacts_.empty()) return;
    last_touch_.reserve(particles);
    for (const auto& crossings : crossings_) {
        if (crossings) crossings->expect(particles);
    }
}

void ImpactRecorder::watch(const Model& model, const Ground& ground, const State& state, std::size_t building) {
    const std::optional<BarrierSpec>& barrier = ground.buildings[building].barrier;
    if (!barrier) return;
    crossings_[building] = std::make_unique<Overtopping>(model, ground.terrain, *barrier);
    crossings_[building]->follow(state);
    crossings_[building]->after_step(state);  // where debris is now
}

void ImpactRecorder::forget(const Model& model, const Ground& ground, const State& state, std::size_t building) {
    impacts_[building] = {.name = impacts_[building].name,
                          .is_barrier = impacts_[building].is_barrier,
                          .passing_share = impacts_[building].passing_share};
    records_[building] = {};
    crossings_[building].reset();
    watch(model, ground, state, building);
    for (LastTouch& last : last_touch_) {
        if (last.building == static_cast<std::int32_t>(building)) last = {};
    }
}

void ImpactRecorder::add_contact(const Model& model, const Ground& ground, const State& state,
                                 const BuildingContact& contact, const MapAccumulator& maps) {
    const auto building = static_cast<std::size_t>(contact.building);
    BuildingImpact& impact = impacts_[building];
    Record& record = records_[building];
    const double begin = state.time - window_;
    if (!record.touched) {
        record.touched = true;
        record.impulse = 0;
        touched_.push_back(building);
        // Before this step's touches: a particle that comes back must not be counted twice.
        std::erase_if(record.touches, [&](std::uint32_t id) {
            return last_touch_[id].building != contact.building || last_touch_[id].time <= begin;
        });
    }
    record.impulse += contact.impulse;
    if (!impact.hit) {
        impact.hit = true;
        impact.first_hit_time = state.time;
    }
    const std::uint32_t id = state.id[contact.particle];
    LastTouch& last = last_touch_[id];
    if (last.building != contact.building || last.time <= begin) record.touches.push_back(id);
    last = {contact.building, state.time};

    const LocalPoint p = state.position.at(contact.particle);
    const double depth = p.z + model.particle_spacing / 2 - ground.terrain.sample(p.x, p.y).height;
    impact.peak_depth = std::max(impact.peak_depth, depth);
    const double speed = maps.speed_at(p);
    impact.peak_dynamic_pressure = std::max(impact.peak_dynamic_pressure, maps.density_at(p) * speed * speed);
    impact.peak_speed = std::max(impact.peak_speed, speed);
}

double ImpactRecorder::filtered_force(const Record& record, double time) const {
    const double begin = time - window_;
    double impulse = 0;
    for (const Event& e : record.events) {
        // The oldest step may straddle the edge of the window, or lie before it.
        impulse += e.impulse * std::clamp((e.end - begin) / e.duration, 0.0, 1.0);
    }
    return impulse / window_;
}

void ImpactRecorder::update_peaks(const Ground& ground, std::size_t building, const State& state) {
    Record& record = records_[building];
    record.events.push_back({state.time, state.time_step, record.impulse});
    std::erase_if(record.events, [&](const Event& e) { return e.end <= state.time - window_; });
    const double force = filtered_force(record, state.time);
    const double area = static_cast<double>(record.touches.size()) * particle_area_;
    const double pressure = area > 0 ? force / area : 0;
    BuildingImpact& impact = impacts_[building];
    impact.impulse += record.impulse;
    impact.peak_force = std::max(impact.peak_force, force);
    impact.peak_pressure = std::max(impact.peak_pressure, pressure);

    const Building& body = ground.buildings[building];
    const bool broken = body.barrier && force > body.resistance.force_per_metre * length_of(body.barrier->line);
    if (std::isnan(impact.failure_time) && (broken || pressure > body.resistance.pressure)) {
        impact.failure_time = state.time;
        failed_.push_back(building);
    }
}

void ImpactRecorder::take_overtopping(std::size_t building) {
    const Overtopping* crossings = crossings_[building].get();
    if (crossings == nullptr) return;
    BuildingImpact& impact = impacts_[building];
    impact.overtopped_volume = crossings->volume();
    impact.first_overtopping_time = crossings->first_time();
    impact.passed_volume = crossings->passed_volume();
}

void ImpactRecorder::after_step(const Model& model, const Ground& ground, const State& state,
                                const MapAccumulator& maps) {
    touched_.clear();
    failed_.clear();
    if (last_touch_.size() < state.seeded) last_touch_.resize(state.seeded + state.seeded / 2);
    for (const BuildingContact& contact : state.building_contacts) add_contact(model, ground, state, contact, maps);
    // Between touches the filtered force only falls: nothing to do for the other buildings.
    for (const std::size_t building : touched_) {
        update_peaks(ground, building, state);
        records_[building].touched = false;
    }
    for (std::size_t b = 0; b < crossings_.size(); ++b) {
        if (!crossings_[b]) continue;
        crossings_[b]->after_step(state, jumped_);
        take_overtopping(b);
    }
    jumped_ = false;
    for (const std::size_t building : failed_) {
        if (crossings_[building]) impacts_[building].held_volume = crossings_[building]->filling(state).volume;
        crossings_[building].reset();  // what comes by from now on does not get over it
    }
}

void ImpactRecorder::add_row(const State& state) {
    for (std::size_t b = 0; b < impacts_.size(); ++b) {
        BuildingImpact& impact = impacts_[b];
        if (!impact.hit) continue;
        if (crossings_[b]) {
            const Overtopping::Filling filling = crossings_[b]->filling(state);
            impact.held_volume = filling.volume;
            impact.peak_held_volume = std::max(impact.peak_held_volume, filling.volume);
            impact.peak_filling_height = std::max(impact.peak_filling_height, filling.height);
            impact.history.push_back({state.time, filtered_force(records_[b], state.time), impact.impulse,
                                      impact.overtopped_volume, impact.passed_volume, filling.volume, filling.height});
        } else {
            impact.history.push_back({.time = state.time,
                                      .force = filtered_force(records_[b], state.time),
                                      .impulse = impact.impulse,
                                      .overtopped_volume = impact.overtopped_volume,
                                      .passed_volume = impact.passed_volume});
        }
    }
}

std::vector<BuildingImpact> ImpactRecorder::complete(const State& state) const {
    std::vector<BuildingImpact> impacts = impacts_;
    for (std::size_t b = 0; b < impacts.size(); ++b) {
        if (crossings_[b]) impacts[b].held_volume = crossings_[b]->filling(state).volume;
    }
    return impacts;
}

}  // namespace talus
