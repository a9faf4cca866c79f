#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "observe/map_accumulator.hpp"
#include "observe/observation.hpp"
#include "observe/overtopping.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus {

/// What debris does to buildings and barriers, from the impulses of every step and from what crosses a barrier's line.
///
/// Force is the impulse of the last `filter_window` seconds divided by the window: the force of a single step depends
/// on its length, an average over a fixed time does not. Pressure is that force over the wall area touched within the
/// same window, one spacing^2 per particle that touched it. The area is not averaged: a first particle's knock would
/// then count at its unfiltered pressure.
class ImpactRecorder {
  public:
    /// `filter_window` in s.
    ImpactRecorder(const Model& model, const Ground& ground, const State& state, double filter_window);

    /// Call when model or state were changed between two steps. Buildings keep their index; new ones come behind.
    void follow(const Model& model, const Ground& ground, const State& state);
    /// Call when particles came in between two steps and nothing else was changed.
    void follow_inflow(const State& state);
    /// Makes room for so many particles.
    void expect(std::uint32_t particles);
    /// Begins a building's record anew, as for one that was moved.
    void forget(const Model& model, const Ground& ground, const State& state, std::size_t building);

    /// `maps` as of this step.
    void after_step(const Model& model, const Ground& ground, const State& state, const MapAccumulator& maps);

    /// Adds a sample to the history of what has been hit.
    void add_row(const State& state);

    /// Without what only complete() fills in.
    [[nodiscard]] const std::vector<BuildingImpact>& impacts() const { return impacts_; }
    /// With what barriers hold back now.
    [[nodiscard]] std::vector<BuildingImpact> complete(const State& state) const;
    /// Buildings whose resistance was exceeded in the last step.
    [[nodiscard]] const std::vector<std::size_t>& failed() const { return failed_; }
    /// nullptr: no barrier, or none that stands.
    [[nodiscard]] const Overtopping* overtopping(std::size_t building) const { return crossings_[building].get(); }

  private:
    /// A step in which a building was touched.
    struct Event {
        double end, duration;  // s
        double impulse;        // kg m/s
    };
    struct Record {
        double impulse = 0;                  // of this step, kg m/s
        bool touched = false;                // in this step
        std::vector<Event> events;           // within the window
        std::vector<std::uint32_t> touches;  // ids of particles that touched within the window
    };
    struct LastTouch {
        std::int32_t building = -1;
        double time = 0;
    };

    void add_contact(const Model& model, const Ground& ground, const State& state, const BuildingContact& contact,
                     const MapAccumulator& maps);
    void update_peaks(const Ground& ground, std::size_t building, const State& state);
    /// Of the window that ends now, N.
    [[nodiscard]] double filtered_force(const Record& record, double time) const;
    /// Begins to watch a barrier's line, if it is one and stands.
    void watch(const Model& model, const Ground& ground, const State& state, std::size_t building);
    void take_overtopping(std::size_t building);

    double window_ = 0, particle_area_ = 0;
    std::vector<BuildingImpact> impacts_;
    std::vector<Record> records_;
    std::vector<LastTouch> last_touch_;                    // by particle id
    std::vector<std::size_t> touched_;                     // buildings of this step
    std::vector<std::size_t> failed_;                      // in this step
    std::vector<std::unique_ptr<Overtopping>> crossings_;  // by building
    bool jumped_ = false;                                  // particles were moved since the last step
};

}  // namespace talus
