#include "observe/building_impact.hpp"

#include <algorithm>
#include <cmath>

#include "terrain/barrier.hpp"

namespace talus::observe {
namespace {

/// Width of the area on which a particle presses, and length of the debris that arrives with it, in spacings. The
/// debris that it represents extends as far as its kernel, about two spacings around: with one spacing the highest
/// patch pressure would be that of a ragged front, and would rise as the number of particles falls.
constexpr double contact_spacings = 2;

/// How long the debris of a particle takes to arrive at a wall, s. A stream of particles is a row of blows, one for
/// each spacing; the debris that it represents comes without gaps. Debris at rest passes on changes of pressure at the
/// speed of waves of its depth, of which a spacing is the least.
double arrival_time(const sim::Model& model, double speed) {
    const double length = contact_spacings * model.particle_spacing;
    return length / std::max(speed, std::sqrt(model.gravity * model.particle_spacing));
}

}  // namespace

ImpactRecorder::ImpactRecorder(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                               const params::OutputSpec& outputs)
    : edge_(outputs.impact_patch_edge),
      contact_size_(std::max(edge_, contact_spacings * model.particle_spacing)),
      least_depth_(outputs.arrival_depth),
      deposited_speed_(outputs.deposited_speed),
      approach_(edge_),
      sums_(outputs.impact_filter_window) {
    follow(model, ground, state);
    jumped_ = false;
}

void ImpactRecorder::follow(const sim::Model& model, const sim::Ground& ground, const sim::State& state) {
    jumped_ = true;
    impacts_.resize(ground.buildings.size());
    records_.resize(ground.buildings.size());
    crossings_.resize(ground.buildings.size());
    for (std::size_t b = 0; b < impacts_.size(); ++b) {
        impacts_[b].name = ground.buildings[b].name;
        const std::optional<params::BarrierSpec>& barrier = ground.buildings[b].barrier;
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
    patches_ = WallPatches(ground.terrain, ground.buildings, edge_, contact_size_ / 2 + edge_);
    for (std::size_t b = 0; b < records_.size(); ++b) {
        if (records_[b].first_slot != no_slot && records_[b].patches != patches_.patches_of(b)) drop_slots(b);
    }
}

void ImpactRecorder::follow_inflow(const sim::State& state) {
    for (const auto& crossings : crossings_) {
        if (crossings) crossings->follow(state);
    }
}

void ImpactRecorder::expect(std::uint32_t particles) {
    for (const auto& crossings : crossings_) {
        if (crossings) crossings->expect(particles);
    }
}

void ImpactRecorder::watch(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                           std::size_t building) {
    const std::optional<params::BarrierSpec>& barrier = ground.buildings[building].barrier;
    if (!barrier) return;
    crossings_[building] = std::make_unique<Overtopping>(model, ground.terrain, *barrier, deposited_speed_);
    crossings_[building]->follow(state);
    crossings_[building]->after_step(state);  // initialises with the current positions
}

void ImpactRecorder::forget(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                            std::size_t building) {
    impacts_[building] = {.name = impacts_[building].name,
                          .is_barrier = impacts_[building].is_barrier,
                          .passing_share = impacts_[building].passing_share};
    drop_slots(building);
    records_[building] = {};
    crossings_[building].reset();
    watch(model, ground, state, building);
}

void ImpactRecorder::give_slots(std::size_t building) {
    Record& record = records_[building];
    record.first_slot = sums_.size();
    record.patches = patches_.patches_of(building);
    sums_.resize(record.first_slot + 1 + record.patches);
    slot_building_.resize(sums_.size(), static_cast<std::uint32_t>(building));
}

void ImpactRecorder::drop_slots(std::size_t building) {
    Record& record = records_[building];
    if (record.first_slot != no_slot) sums_.clear(record.first_slot, 1 + std::size_t{record.patches});
    record.first_slot = no_slot;
}

void ImpactRecorder::add_contact(const sim::Model& model, const sim::StateSummary& state,
                                 const sim::BuildingContact& contact) {
    const auto building = static_cast<std::size_t>(contact.building);
    BuildingImpact& impact = impacts_[building];
    if (records_[building].first_slot == no_slot) give_slots(building);
    const double impulse = contact.impulse, duration = arrival_time(model, contact.speed);
    const std::size_t whole = records_[building].first_slot, first = whole + 1;
    sums_.add(whole, impulse, duration);
    patches_.spread(contact.building, contact.place, contact_size_,
                    [&](std::uint32_t patch, double share) { sums_.add(first + patch, share * impulse, duration); });
    impact.impulse += impulse;
    if (!impact.hit) {
        impact.hit = true;
        impact.first_hit_time = state.time;
    }
}

double ImpactRecorder::force_on(const Record& record) const {
    return record.first_slot == no_slot ? 0 : sums_.rate(record.first_slot);
}

double ImpactRecorder::highest_pressure(const Record& record) const {
    if (record.first_slot == no_slot) return 0;
    double highest = 0;
    for (std::uint32_t k = 0; k < record.patches; ++k) {
        highest = std::max(highest, sums_.rate(record.first_slot + 1 + k));
    }
    return highest;
}

void ImpactRecorder::take_approach(const sim::Model& model, const sim::Ground& ground, const Debris& debris) {
    for (Record& record : records_) record.depth = record.dynamic_pressure = 0;
    approach_.update(model, debris, patches_);
    for (const WallApproach::Flow& flow : approach_.flows()) {
        const auto building = static_cast<std::size_t>(flow.building);
        if (!stands(ground.buildings[building])) continue;
        Record& record = records_[building];
        record.depth = std::max(record.depth, flow.depth);
        record.peak_depth = std::max(record.peak_depth, flow.depth);
        if (flow.depth < least_depth_) continue;
        const double to_wall = std::max(0.0, flow.to_wall), pressure = flow.density * to_wall * to_wall;
        record.dynamic_pressure = std::max(record.dynamic_pressure, pressure);
        record.peak_dynamic_pressure = std::max(record.peak_dynamic_pressure, pressure);
        record.peak_speed = std::max(record.peak_speed, flow.speed);
    }
    for (std::size_t b = 0; b < impacts_.size(); ++b) {
        if (!impacts_[b].hit) continue;
        const Record& record = records_[b];
        const bool measured = record.peak_depth >= least_depth_;  // thinner debris has no velocity
        impacts_[b].peak_depth = record.peak_depth;
        impacts_[b].peak_dynamic_pressure = measured ? record.peak_dynamic_pressure : never;
        impacts_[b].peak_speed = measured ? record.peak_speed : never;
    }
}

void ImpactRecorder::take_pressures() {
    for (const std::uint32_t slot : sums_.added()) {
        const std::size_t building = slot_building_[slot];
        Record& record = records_[building];
        if (!record.touched) {
            record.touched = true;
            record.pressure = 0;
            touched_.push_back(building);
        }
        if (slot != record.first_slot) record.pressure = std::max(record.pressure, sums_.rate(slot));
    }
}

void ImpactRecorder::update_peaks(const sim::Ground& ground, std::size_t building, const sim::StateSummary& state) {
    const Record& record = records_[building];
    const double force = force_on(record), pressure = record.pressure;
    BuildingImpact& impact = impacts_[building];
    impact.peak_force = std::max(impact.peak_force, force);
    impact.peak_impact_pressure = std::max(impact.peak_impact_pressure, pressure);

    const terrain::Building& body = ground.buildings[building];
    const bool broken =
        body.barrier && force > body.resistance.force_per_metre * terrain::length_of(body.barrier->line);
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

void ImpactRecorder::after_step(const sim::Model& model, const sim::Ground& ground, const Debris& debris) {
    const sim::StateSummary& state = debris.summary();
    touched_.clear();
    failed_.clear();
    if (impacts_.empty()) return;
    for (const sim::BuildingContact& contact : state.building_contacts) add_contact(model, state, contact);
    sums_.advance(state.time, state.time_step);
    take_approach(model, ground, debris);
    take_pressures();
    // Where nothing arrives, filtered forces only decrease: nothing to do for the other buildings.
    for (const std::size_t building : touched_) {
        update_peaks(ground, building, state);
        records_[building].touched = false;
    }
    for (std::size_t b = 0; b < crossings_.size(); ++b) {
        if (!crossings_[b]) continue;
        crossings_[b]->after_step(debris, jumped_);
        take_overtopping(b);
    }
    jumped_ = false;
    for (const std::size_t building : failed_) {
        if (crossings_[building]) impacts_[building].retained_volume = crossings_[building]->filling(debris).volume;
        crossings_[building].reset();  // debris that passes from now on does not overtop it
    }
}

void ImpactRecorder::add_row(const Debris& debris) {
    for (std::size_t b = 0; b < impacts_.size(); ++b) {
        BuildingImpact& impact = impacts_[b];
        if (!impact.hit) continue;
        const double depth = records_[b].depth;
        const bool too_thin = depth > 0 && depth < least_depth_;  // to have a velocity
        StructureSample sample{.time = debris.summary().time,
                               .force = force_on(records_[b]),
                               .impact_pressure = highest_pressure(records_[b]),
                               .depth = depth,
                               .dynamic_pressure = too_thin ? never : records_[b].dynamic_pressure,
                               .impulse = impact.impulse,
                               .overtopped_volume = impact.overtopped_volume,
                               .passed_volume = impact.passed_volume};
        if (crossings_[b]) {
            const Overtopping::Filling filling = crossings_[b]->filling(debris);
            sample.retained_volume = impact.retained_volume = filling.volume;
            sample.filling_height = filling.height;
            impact.peak_retained_volume = std::max(impact.peak_retained_volume, filling.volume);
            impact.peak_filling_height = std::max(impact.peak_filling_height, filling.height);
        }
        impact.history.push_back(sample);
    }
}

std::vector<BuildingImpact> ImpactRecorder::complete(const Debris& debris) const {
    std::vector<BuildingImpact> impacts = impacts_;
    for (std::size_t b = 0; b < impacts.size(); ++b) {
        if (crossings_[b]) impacts[b].retained_volume = crossings_[b]->filling(debris).volume;
    }
    return impacts;
}

}  // namespace talus::observe
