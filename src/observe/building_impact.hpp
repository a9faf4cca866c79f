#pragma once

#include <cstdint>
#include <vector>

#include "observe/map_accumulator.hpp"
#include "observe/observation.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus {

/// What debris does to the buildings, from the impulses of every step.
///
/// Force is the impulse of the last `filter_window` seconds divided by the window: the force of a single step hangs on
/// its length, an average over a fixed time does not. Pressure is that force over the wall area touched within the same
/// window, one spacing^2 per particle that touched it. The area is not averaged: a first particle's knock would then
/// count at its unfiltered pressure.
class ImpactRecorder {
  public:
    /// `filter_window` in s.
    ImpactRecorder(const Model& model, const State& state, double filter_window);

    /// Call when model or state were changed between two steps. Buildings keep their index; new ones come behind.
    void follow(const Model& model, const State& state);
    /// Begins a building's record anew, as for one that was moved.
    void forget(std::size_t building);

    /// `maps` as of this step.
    void after_step(const Model& model, const State& state, const MapAccumulator& maps);

    [[nodiscard]] const std::vector<BuildingImpact>& impacts() const { return impacts_; }

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

    void add_contact(const Model& model, const State& state, const BuildingContact& contact,
                     const MapAccumulator& maps);
    void update_peaks(std::size_t building, const State& state);

    double window_ = 0, particle_area_ = 0;
    std::vector<BuildingImpact> impacts_;
    std::vector<Record> records_;
    std::vector<LastTouch> last_touch_;  // by particle id
    std::vector<std::size_t> touched_;   // buildings of this step
};

}  // namespace talus
