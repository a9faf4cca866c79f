#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/archive.hpp"
#include "observe/map_accumulator.hpp"
#include "observe/observation.hpp"
#include "observe/overtopping.hpp"
#include "params/spec.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"
#include "sim/step_watcher.hpp"
#include "terrain/flow_path.hpp"

namespace talus::observe {

/// Watches a run: a stage of the step, so that peaks see every step. Its cost depends on the number of particles, its
/// result not on the number of threads.
class Observer final : public sim::StepWatcher {
  public:
    /// `flow_path` may be empty: then there is no front against chainage. `map_cell` in m.
    Observer(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
             const terrain::FlowPath& flow_path, const params::OutputSpec& outputs, double map_cell);
    /// A copy goes on by itself, with a copy of what is observed. It costs what the memory does.
    explicit Observer(const Observer& other);
    Observer& operator=(const Observer&) = delete;
    ~Observer() override;

    /// As a stage of a step: after_step() with the steps per second of wall time.
    void observe(const sim::Model& model, const sim::Ground& ground, const sim::State& state) override;
    bool observe_on(sim::device::Backend& backend, const sim::Model& model, const sim::Ground& ground,
                    const sim::StateSummary& state) override;
    void follow_inflow(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                       std::uint32_t first_new_id) override;
    [[nodiscard]] const std::vector<std::size_t>& failed_buildings() const override;

    /// Measures a completed step. `steps_per_second` is copied to the time series.
    void after_step(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                    double steps_per_second);

    /// Call when model, ground or state were changed between two steps: particles with ids from `first_new_id` are new.
    void follow(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                std::uint32_t first_new_id);
    /// Records the flow at these places from now on.
    void watch(const std::vector<terrain::Gauge>& gauges);
    /// Records what passes these lines from now on.
    void watch(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
               const std::vector<terrain::CrossSection>& sections);
    /// Reserves memory for this number of particles, so that injecting them allocates nothing.
    void expect(std::uint32_t particles);
    /// Resets the record of a building, for example after it was moved.
    void forget_building(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                         std::size_t building);

    /// What has been measured so far: an observer made of the same scene that reads it goes on as this one.
    void save(ArchiveWriter& archive);
    void restore(ArchiveReader& archive);

    /// Debris that has crossed a barrier's line; nullptr: not a barrier, or a failed one.
    [[nodiscard]] const Overtopping* overtopping(std::size_t building) const;

    /// Farthest chainage that the front has reached, m; NaN: none yet.
    [[nodiscard]] double front_chainage() const;
    /// The last row of the time series (one at construction).
    [[nodiscard]] const TimeSample& latest() const;

    /// The current state as a row of the time series.
    [[nodiscard]] TimeSample sample(const sim::Model& model, const sim::State& state) const;

    // What has been measured so far.
    [[nodiscard]] const std::vector<TimeSample>& timeseries() const;
    [[nodiscard]] std::vector<FrontSample> front() const;
    [[nodiscard]] const std::vector<BuildingImpact>& impacts() const;  ///< as in Ground::buildings
    [[nodiscard]] const MapAccumulator& maps() const;
    [[nodiscard]] const std::vector<GaugeRecord>& gauges() const;
    /// With a row for what is left of an interval at `time`, s: now.
    [[nodiscard]] std::vector<DischargeRecord> cross_sections(double time) const;
    [[nodiscard]] const terrain::FlowPath& flow_path() const;

    /// Only what says whether the run can be relied on: peak maps, thickness, compression, energy, and a row of the
    /// time series of now.
    [[nodiscard]] Observation checked(const sim::Model& model, const sim::Ground& ground,
                                      const sim::State& state) const;
    /// The complete results, with the debris in its current position as deposit.
    [[nodiscard]] Observation finish(const sim::Model& model, const sim::Ground& ground, const sim::State& state) const;

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace talus::observe
