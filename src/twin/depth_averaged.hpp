#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "messages/messages.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"

/// The depth-averaged model beside a live run: a view of its setup. Nothing of it enters the run, its journal or its
/// hash.
namespace talus::twin {

class Scenario;

/// What a run of it may cost beside a live run.
struct DepthAveragedLimits {
    double most_cells = 4e6;               ///< of its grid; a scene that has more gets coarser cells
    double longest = 300;                  ///< s of processor time, after which it ends as it is
    std::size_t depth_bytes = 64'000'000;  ///< of the depths over time; when full, every second one is removed
};

/// A run of a setup from time 0, by this model.
struct DepthAveragedRun {
    /// Depths at one moment.
    struct Moment {
        double time = 0;    ///< s
        Grid<float> depth;  ///< m, over the part of the grid that has debris; 0 where there is none
    };

    run::RunResult result;
    std::vector<Moment> moments;     ///< in order of time
    std::vector<std::string> notes;  ///< sentences on what the model leaves out
    double processor_time = 0;       ///< s

    [[nodiscard]] messages::DepthAveragedResult message() const;
    /// `depth` or one of named_maps on its own cells; NaN: no value. SI units. Depth at a time, s, or at the end;
    /// arrivals until a time; the others are of the whole run. Error: no such layer.
    [[nodiscard]] Result<Grid<float>> layer(const std::string& name, std::optional<double> time = {}) const;
};

/// A scene as this model runs it beside a live run, on one thread. Errors: a sentence that names what the model does
/// not have.
[[nodiscard]] Result<scene::Scene> for_depth_averaged(scene::Scene scene, const DepthAveragedLimits& limits = {});

/// A run of a scene of for_depth_averaged(), step by step, for callers with one thread for it and the live run.
class DepthAveragedSteps {
  public:
    /// `scene` must live as long. Errors: as of run::run_scene().
    [[nodiscard]] static Result<DepthAveragedSteps> start(const scene::Scene& scene,
                                                          const DepthAveragedLimits& limits = {});
    DepthAveragedSteps(DepthAveragedSteps&&) noexcept;
    DepthAveragedSteps& operator=(DepthAveragedSteps&&) noexcept;
    ~DepthAveragedSteps();

    /// A step. False: it is over.
    bool advance();
    /// Of the time, from 0 to 1.
    [[nodiscard]] double share() const;
    /// Once, at its end or before.
    [[nodiscard]] DepthAveragedRun finish();

  private:
    struct Parts;
    explicit DepthAveragedSteps(std::unique_ptr<Parts> parts);
    std::unique_ptr<Parts> parts_;
};

/// Runs a scene of for_depth_averaged(), until `stop` or to its end. `progress` is called between two steps with the
/// share of the time that has passed. Errors: as of run::run_scene().
[[nodiscard]] Result<DepthAveragedRun> run_depth_averaged(const scene::Scene& scene, const std::atomic<bool>& stop,
                                                          const std::function<void(double share)>& progress = {},
                                                          const DepthAveragedLimits& limits = {});

// Beside a scenario. The work is for any thread, while the scenario continues.

/// Its present setup as a text: setups of one scene are the same to this model if their texts are.
[[nodiscard]] std::string setup_key(const Scenario& scenario);
/// Makes the scene of its present setup, from time 0, for this model. Errors: as for_depth_averaged().
[[nodiscard]] std::function<Result<scene::Scene>()> scene_for_depth_averaged(const Scenario& scenario,
                                                                             const DepthAveragedLimits& limits = {});
/// `{"time_s", "over", "rows", ...}` of docs/protocol.md: its run so far beside this one.
[[nodiscard]] std::function<nlohmann::json()> comparison_with(const Scenario& scenario,
                                                              std::shared_ptr<const DepthAveragedRun> other);

}  // namespace talus::twin
