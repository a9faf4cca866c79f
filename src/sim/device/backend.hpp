#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/motion.hpp"
#include "sim/state.hpp"

/// The stages of a step as kernels: functors over a particle or a cell that an executor runs, on a graphics card or as
/// plain loops on the processor (docs/gpu.md).
namespace talus::sim::device {

/// The device fails in the middle of a step: it has no memory left, or was lost.
class DeviceFailure : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Bytes that were copied so far.
struct Traffic {
    std::uint64_t to_device = 0, to_host = 0;
};

/// The third backend of step(), beside the processor's and the reference. The particles are on the device; the `state`
/// that stages are given holds the numbers about all of them, and its arrays are as follow() or fetch() left them.
/// Every function may throw a DeviceFailure.
class Backend {
  public:
    Backend() = default;
    Backend(const Backend&) = delete;
    Backend& operator=(const Backend&) = delete;
    virtual ~Backend() = default;

    /// Takes model, ground and particles over, after they changed outside a step.
    virtual void follow(const Model& model, const Ground& ground, const State& state) = 0;
    /// Copies the particles back.
    virtual void fetch(State& state) = 0;
    /// Copies positions, velocities, ids, and what is held or asleep, within the device.
    virtual void keep(const StateSummary& state) = 0;
    /// Copies that back; `state` has the count that keep() was given.
    virtual void fetch_kept(State& state) = 0;
    /// Over all particles.
    [[nodiscard]] virtual Motion count_motion(const StateSummary& state, const MotionCount& count) const = 0;
    /// Over the particles whose ids are in [first, last).
    [[nodiscard]] virtual PlaceSum sum_places(const StateSummary& state, std::uint32_t first,
                                              std::uint32_t last) const = 0;

    virtual void begin_step(const Model& model, const State& state) = 0;
    virtual void release_held(const Model& model, State& state) = 0;
    virtual void apply_drag(const Model& model, const Ground& ground, State& state) = 0;
    virtual void predict_positions(const Model& model, const Ground& ground, State& state) = 0;
    virtual void sort_particles(const Model& model, State& state) = 0;
    virtual void find_neighbours(const Model& model, State& state) = 0;
    virtual void prepare_particles(const Model& model, const Ground& ground, State& state) = 0;
    virtual void warm_start(const Model& model, const Ground& ground, State& state) = 0;
    virtual void solve_density(const Model& model, const Ground& ground, State& state) = 0;
    virtual void solve_contacts(const Model& model, const Ground& ground, State& state) = 0;
    virtual void measure_compression(const Model& model, State& state) = 0;
    virtual void resolve_penetration(const Model& model, const Ground& ground, State& state) = 0;
    virtual void enforce_boundaries(const Model& model, const Ground& ground, State& state) = 0;
    virtual void update_velocities(const Model& model, const Ground& ground, State& state) = 0;
    virtual void measure_impacts(const Model& model, const Ground& ground, State& state) = 0;
    virtual void apply_viscosity(const Model& model, const Ground& ground, State& state) = 0;
    virtual void update_sleep(const Model& model, const Ground& ground, State& state) = 0;
    virtual void remove_outflow(const Model& model, const Ground& ground, State& state) = 0;

    /// What runs the kernels: the name of the card, or "host".
    [[nodiscard]] virtual std::string name() const = 0;
    /// Allocated on the device.
    [[nodiscard]] virtual std::size_t bytes() const = 0;
    [[nodiscard]] virtual Traffic traffic() const = 0;
    /// Mean number of neighbours of an awake particle in the last step.
    [[nodiscard]] virtual double mean_neighbours() const = 0;
};

/// Plain loops on the processor.
[[nodiscard]] std::unique_ptr<Backend> make_host_backend();
/// The first graphics card; card() must have found one.
[[nodiscard]] std::unique_ptr<Backend> make_cuda_backend();

}  // namespace talus::sim::device
