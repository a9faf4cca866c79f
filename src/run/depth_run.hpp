#pragma once

#include <memory>

#include "core/result.hpp"
#include "run/run_scene.hpp"

namespace talus::run {

/// Whether debris of the depth-averaged model has friction inside, as particles have it.
enum class Inside { frictionless, as_particles };

/// A run of the depth-averaged model, step by step, for callers that do other things between two steps. Buildings and
/// barriers stand on the cells whose centres they cover or whose line they cross.
class DepthRun {
  public:
    /// Both must live as long as the run. Errors: an inflow that no cell takes; a state that is not one of this scene.
    [[nodiscard]] static Result<DepthRun> start(const scene::Scene& scene, const RunOptions& options,
                                                Inside inside = Inside::frictionless);
    DepthRun(DepthRun&&) noexcept;
    DepthRun& operator=(DepthRun&&) noexcept;
    ~DepthRun();

    /// A step. False: it is over, or options.stop_requested is set.
    bool advance();
    /// Once, at its end or before.
    [[nodiscard]] RunResult finish();
    /// All steps that are left, and finish().
    [[nodiscard]] RunResult complete();

  private:
    struct Parts;
    explicit DepthRun(std::unique_ptr<Parts> parts);
    std::unique_ptr<Parts> parts_;
};

/// Runs a scene with the depth-averaged model, as run_scene() does where the scene asks for it.
[[nodiscard]] Result<RunResult> run_depth_averaged(const scene::Scene& scene, const RunOptions& options,
                                                   Inside inside = Inside::frictionless);

}  // namespace talus::run
