#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::sim::device {
class Backend;
}

namespace talus::sim {

/// Takes part in the steps of a Simulation from outside the solver: measures, and decides from that which structures
/// fail.
class StepWatcher {
  public:
    StepWatcher() = default;
    StepWatcher(const StepWatcher&) = delete;
    StepWatcher& operator=(const StepWatcher&) = delete;
    virtual ~StepWatcher() = default;

    /// Called when inflow has added the particles with ids from `first_new_id`.
    virtual void follow_inflow(const Model& model, const Ground& ground, const State& state,
                               std::uint32_t first_new_id) = 0;
    /// Called after every step.
    virtual void observe(const Model& model, const Ground& ground, const State& state) = 0;
    /// Called in its place where a device has the particles. False: nothing was measured, and observe() is called.
    virtual bool observe_on(device::Backend& /*device*/, const Model& /*model*/, const Ground& /*ground*/,
                            const StateSummary& /*state*/) {
        return false;
    }
    /// Buildings whose resistance was exceeded in the last observed step: they are removed.
    [[nodiscard]] virtual const std::vector<std::size_t>& failed_buildings() const = 0;
};

}  // namespace talus::sim
