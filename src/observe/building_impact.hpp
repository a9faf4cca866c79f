#pragma once

#include <cstdint>
#include <vector>

#include "core/copied.hpp"
#include "observe/debris.hpp"
#include "observe/moving_sums.hpp"
#include "observe/observation.hpp"
#include "observe/overtopping.hpp"
#include "observe/wall_approach.hpp"
#include "observe/wall_patches.hpp"
#include "params/spec.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::observe {

/// Impact of debris on buildings and barriers, from the impulses of every step and the particles that cross a barrier's
/// line.
///
/// Force is the impulse of the last `filter_window` seconds divided by the window: the force of a single step depends
/// on its length, an average over a fixed time does not. Pressure is the same for a patch of the wall, divided by its
/// area. A particle presses on a square two spacings wide, and at least as wide as the patches' edge: otherwise the
/// pressure would be that of a single particle where particles are larger than patches, and that of chance contact
/// points where they are far smaller. Its impulse arrives over the time in which two spacings pass at its speed, or at
/// sqrt(g spacing) if that is faster: a regular stream of density rho, depth h and speed v presses with rho v^2 h,
/// whatever its spacing. Depth and velocity are those of the flow in front of the wall.
class ImpactRecorder {
  public:
    /// Uses from `outputs` the filter window, the patch edge and the depth above which debris has a velocity.
    ImpactRecorder(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                   const params::OutputSpec& outputs);

    /// Call when model or state were changed between two steps. Buildings keep their index; new ones follow.
    void follow(const sim::Model& model, const sim::Ground& ground, const sim::State& state);
    /// Call when particles were injected between two steps and nothing else was changed.
    void follow_inflow(const sim::State& state);
    /// Reserves memory for this number of particles.
    void expect(std::uint32_t particles);
    /// Resets a building's record, for example after it was moved.
    void forget(const sim::Model& model, const sim::Ground& ground, const sim::State& state, std::size_t building);

    void after_step(const sim::Model& model, const sim::Ground& ground, const Debris& debris);

    /// Adds a sample to the history of every structure that has been hit.
    void add_row(const Debris& debris);

    /// Without the values that complete() fills in.
    [[nodiscard]] const std::vector<BuildingImpact>& impacts() const { return impacts_; }
    /// Including the debris that barriers hold back now.
    [[nodiscard]] std::vector<BuildingImpact> complete(const Debris& debris) const;
    /// Buildings whose resistance was exceeded in the last step.
    [[nodiscard]] const std::vector<std::size_t>& failed() const { return failed_; }
    /// nullptr: not a barrier, or a failed one.
    [[nodiscard]] const Overtopping* overtopping(std::size_t building) const { return crossings_[building].get(); }

    /// Of the same structures.
    template <class Archive>
    void keep(Archive& archive);

  private:
    static constexpr std::size_t no_slot = static_cast<std::size_t>(-1);
    struct Record {
        std::size_t first_slot = no_slot;  // of the whole structure; those of its patches follow. From the first hit on
        std::uint32_t patches = 0;
        bool touched = false;                    // something of the impulses arrived in this step
        double pressure = 0;                     // Pa, highest of the patches touched in this step
        double depth = 0, dynamic_pressure = 0;  // of the flow in front of it, now
        double peak_depth = 0, peak_dynamic_pressure = 0, peak_speed = 0;  // so far, hit or not
    };

    void add_contact(const sim::Model& model, const sim::StateSummary& state, const sim::BuildingContact& contact);
    void give_slots(std::size_t building);
    void drop_slots(std::size_t building);
    void take_approach(const sim::Model& model, const sim::Ground& ground, const Debris& debris);
    /// The highest pressure on every building at whose walls something arrived in this step.
    void take_pressures();
    void update_peaks(const sim::Ground& ground, std::size_t building, const sim::StateSummary& state);
    /// Now, of the patch where it is highest, Pa.
    [[nodiscard]] double highest_pressure(const Record& record) const;
    [[nodiscard]] double force_on(const Record& record) const;  // N
    /// Starts watching a building's line if it is a barrier that stands.
    void watch(const sim::Model& model, const sim::Ground& ground, const sim::State& state, std::size_t building);
    void take_overtopping(std::size_t building);

    double edge_, contact_size_, least_depth_;  // m
    double deposited_speed_;                    // m/s
    WallPatches patches_;
    WallApproach approach_;
    MovingSums sums_;                           // impulse by structure, and per area by patch, of those hit
    std::vector<std::uint32_t> slot_building_;  // the building of each slot
    std::vector<BuildingImpact> impacts_;
    std::vector<Record> records_;
    std::vector<std::size_t> touched_;            // buildings of this step
    std::vector<std::size_t> failed_;             // in this step
    std::vector<Copied<Overtopping>> crossings_;  // by building
    bool jumped_ = false;                         // particles were moved since the last step
};

template <class Archive>
void ImpactRecorder::keep(Archive& archive) {
    archive(patches_, sums_, slot_building_, impacts_, records_, touched_, failed_, jumped_);
    for (auto& crossings : crossings_) {
        bool stands = static_cast<bool>(crossings);
        archive(stands);
        if (!stands) crossings.reset();
        if (crossings) archive(*crossings);
    }
}

}  // namespace talus::observe
