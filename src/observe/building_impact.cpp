#include "observe/building_impact.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

ImpactRecorder::ImpactRecorder(const Model& model, const State& state, double filter_window)
    : window_(filter_window), particle_area_(model.particle_spacing * model.particle_spacing) {
    follow(model, state);
}

void ImpactRecorder::follow(const Model& model, const State& state) {
    impacts_.resize(model.buildings.size());
    records_.resize(model.buildings.size());
    for (std::size_t b = 0; b < impacts_.size(); ++b) impacts_[b].name = model.buildings[b].name;
    touched_.reserve(impacts_.size());
    if (impacts_.empty() || state.count == 0) return;
    const std::uint32_t greatest = *std::max_element(state.id.begin(), state.id.begin() + state.count);
    last_touch_.resize(std::max({last_touch_.size(), std::size_t{state.seeded}, std::size_t{greatest} + 1}));
}

void ImpactRecorder::forget(std::size_t building) {
    impacts_[building] = {.name = impacts_[building].name};
    records_[building] = {};
    for (LastTouch& last : last_touch_) {
        if (last.building == static_cast<std::int32_t>(building)) last = {};
    }
}

void ImpactRecorder::add_contact(const Model& model, const State& state, const BuildingContact& contact,
                                 const MapAccumulator& maps) {
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
    const double depth = p.z + model.particle_spacing / 2 - model.terrain.sample(p.x, p.y).height;
    impact.peak_depth = std::max(impact.peak_depth, depth);
    const double speed = maps.speed_at(p);
    impact.peak_dynamic_pressure = std::max(impact.peak_dynamic_pressure, model.rest_density * speed * speed);
    impact.peak_speed = std::max(impact.peak_speed, speed);
}

void ImpactRecorder::update_peaks(std::size_t building, const State& state) {
    Record& record = records_[building];
    record.events.push_back({state.time, state.time_step, record.impulse});
    const double begin = state.time - window_;
    std::erase_if(record.events, [&](const Event& e) { return e.end <= begin; });
    double impulse = 0;
    for (const Event& e : record.events) {
        const double inside = std::min(1.0, (e.end - begin) / e.duration);  // the oldest step may straddle the edge
        impulse += e.impulse * inside;
    }
    const double force = impulse / window_;
    const double area = static_cast<double>(record.touches.size()) * particle_area_;
    BuildingImpact& impact = impacts_[building];
    impact.peak_force = std::max(impact.peak_force, force);
    if (area > 0) impact.peak_pressure = std::max(impact.peak_pressure, force / area);
}

void ImpactRecorder::after_step(const Model& model, const State& state, const MapAccumulator& maps) {
    touched_.clear();
    if (last_touch_.size() < state.seeded) last_touch_.resize(state.seeded + state.seeded / 2);
    for (const BuildingContact& contact : state.building_contacts) add_contact(model, state, contact, maps);
    // Between touches the filtered force only falls: nothing to do for the other buildings.
    for (const std::size_t building : touched_) {
        update_peaks(building, state);
        records_[building].touched = false;
    }
}

}  // namespace talus
