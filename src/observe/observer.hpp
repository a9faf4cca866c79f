#pragma once

#include <memory>

#include "observe/observation.hpp"
#include "params/spec.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"
#include "terrain/flow_path.hpp"

namespace talus {

/// Watches a run: a stage of the step, so that peaks see every step. Its cost follows the particles, its result does
/// not depend on the number of threads.
class Observer {
  public:
    /// `flow_path` may be empty: then there is no front against chainage. `map_cell` in m.
    Observer(const Model& model, const State& state, const FlowPath& flow_path, const OutputSpec& outputs,
             double map_cell);
    ~Observer();
    Observer(const Observer&) = delete;
    Observer& operator=(const Observer&) = delete;

    /// Call after every step. `steps_per_second` goes into the time series as it is.
    void after_step(const Model& model, const State& state, double steps_per_second);

    /// Farthest chainage that the front has reached, m; NaN: none yet.
    [[nodiscard]] double front_chainage() const;
    /// The last row of the time series (one at construction).
    [[nodiscard]] const TimeSample& latest() const;

    /// What was measured, with the deposit as it lies now. Call at the end.
    [[nodiscard]] Observation finish(const Model& model, const State& state);

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

/// The default map cell, m: a whole fraction or multiple of the terrain's cell, near 2.5 particle spacings.
[[nodiscard]] double default_map_cell(double terrain_cell, double particle_spacing);

}  // namespace talus
