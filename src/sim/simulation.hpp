#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "core/archive.hpp"
#include "core/result.hpp"
#include "sim/cpu/backend.hpp"
#include "sim/device/backend.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/motion.hpp"
#include "sim/sources/entrainment.hpp"
#include "sim/sources/inflow.hpp"
#include "sim/stage_times.hpp"
#include "sim/state.hpp"
#include "sim/step_watcher.hpp"

namespace talus::sim {

/// A model, its ground and state, its inflows, and the backend that advances it.
class Simulation {
  public:
    /// Memory for all particles of `inflow` is allocated at once. The backend is that of model.solver, which must be
    /// usable (see check_backend()).
    Simulation(Model model, Ground ground, State state, InflowFeeder inflow = {});

    /// A copy that goes on by itself, to the same bits. It costs what the memory of the particles does: what a step
    /// works with is made by its first one.
    explicit Simulation(const Simulation& other);
    Simulation& operator=(const Simulation&) = delete;
    ~Simulation() = default;

    /// Takes one step, calling `watcher` if there is one. Returns why the step cannot be trusted, if it cannot; the
    /// state is then that after the step.
    Status advance(StepWatcher* watcher = nullptr);

    /// Adds the particles of inflows that are due. A step begins with it.
    void inject_inflow(StepWatcher* watcher = nullptr);

    /// Lets a user's `edit` change model, ground and state between two steps; nothing else changes a model in a run. It
    /// must not change terrain, particle spacing, kernel or time. The contacts of the last step are dropped.
    void change(const std::function<void(Model&, Ground&, State&)>& edit);

    /// Replaces the hydrograph of an inflow between two steps by one that is the same until now. Contacts stay.
    void follow_gauge(std::size_t inflow, const std::vector<params::InflowSample>& hydrograph);

    [[nodiscard]] const Model& model() const { return model_; }
    [[nodiscard]] const Ground& ground() const { return ground_; }
    /// After steps on a device its particles are copied back first. Throws a DeviceFailure if that fails. Between two
    /// steps several threads may call this and all that is const below: one at a time uses the device.
    [[nodiscard]] const State& state() const {
        fetch();
        return state_;
    }
    /// What it knows of all particles together: nothing is copied.
    [[nodiscard]] const StateSummary& summary() const { return state_; }
    /// How many particles are faster than `deposited_speed`, m/s, and ten times that: nothing is copied.
    [[nodiscard]] Motion motion(double deposited_speed) const;
    /// Keeps a copy of where the particles are now and how they move; on the device, if they are there.
    void keep();
    /// That copy, with positions, velocities, ids, and what is held or asleep; without particles if a lost device had
    /// it.
    [[nodiscard]] const State& kept();

    /// What its steps have changed, between two of them: one of the same model, ground and inflows that reads it goes
    /// on as this one.
    void save(ArchiveWriter& archive);
    void restore(ArchiveReader& archive);

    [[nodiscard]] const InflowFeeder& inflow() const { return inflow_; }
    [[nodiscard]] const StageTimes& stage_times() const { return times_; }
    /// What moves the particles; never `automatic`.
    [[nodiscard]] params::BackendChoice backend() const { return backend_; }
    /// The same by its own name: the instruction set of the processor, or the device.
    [[nodiscard]] std::string instruction_set() const;
    /// Mean number of neighbours of the particles that the last step moved.
    [[nodiscard]] double mean_neighbours() const;
    /// Allocated on the device; 0 for the processor.
    [[nodiscard]] std::size_t device_bytes() const;
    /// Copied to the device and back so far; none for the processor.
    [[nodiscard]] device::Traffic device_traffic() const;

  private:
    struct StepHooks;

    /// Nothing for the processor.
    [[nodiscard]] std::unique_lock<std::mutex> lock_device() const;
    void follow_change();
    void fetch() const;
    void hand_over();
    /// Whether the device has the particles as they are now, and will have them after the next step.
    [[nodiscard]] bool on_device() const { return device_ != nullptr && !device_is_older_ && ground_.bed.empty(); }
    void make_device();
    void measure_energy_and_speed();
    void make_room(std::uint32_t count);
    [[nodiscard]] Status entrain_bed();

    Model model_;  // const except to change()
    Ground ground_;
    mutable State state_;                   // its arrays follow the device when somebody reads them
    mutable bool device_is_newer_ = false;  // than the arrays of the state
    bool device_is_older_ = true;           // than model, ground and state
    StateSummary last_read_;                // of the arrays that the state has while a device is newer
    State kept_;
    bool kept_on_device_ = false;
    InflowFeeder inflow_;
    std::uint32_t expected_ = 0;  // total number of particles from inflows
    std::uint32_t capacity_ = 0;  // particles that the backend has memory for
    params::BackendChoice backend_;
    std::optional<cpu::Backend> processor_;    // replaced when there are more; of a copy, from its first step on
    std::unique_ptr<device::Backend> device_;  // in place of the processor
    std::unique_ptr<std::mutex> device_lock_ = std::make_unique<std::mutex>();  // can be moved with this
    Entrainment entrainment_;
    StageTimes times_;
    double highest_energy_head_;
};

/// Hash of time, ids, positions and velocities in id order: equal for equal results, whatever the number of threads.
[[nodiscard]] std::uint64_t hash_state(const State& state);

/// Of the particles now.
[[nodiscard]] Motion motion_of(const State& state, double deposited_speed);

/// Of the particles whose ids are in [first, last).
[[nodiscard]] PlaceSum sum_places(const State& state, std::uint32_t first, std::uint32_t last);

/// Sum of m v^2 / 2 over the particles, J.
[[nodiscard]] double kinetic_energy(const Model& model, const State& state);
/// Sum of m g z over the particles, J, z above the frame's origin.
[[nodiscard]] double potential_energy(const Model& model, const State& state);

}  // namespace talus::sim
