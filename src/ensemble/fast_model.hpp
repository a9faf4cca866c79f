#pragma once

#include <memory>

#include "core/result.hpp"
#include "ensemble/plan.hpp"
#include "run/variants.hpp"
#include "scene/scene.hpp"

namespace talus::ensemble {

/// The scene with the depth-averaged model, whose runs are many beside few of particles.
struct FastModel {
    run::SceneSource source;
    std::shared_ptr<const scene::Scene> scene;
    PlannedRuns runs;
};

/// The plan's runs by that model. Errors: the scene's model is that one; the scene is not for it, as load_scene says;
/// as PlannedRuns::make.
[[nodiscard]] Result<FastModel> fast_model(const EnsemblePlan& plan, const run::SceneSource& source,
                                           const scene::Scene& base);

/// The same for an ensemble with plan.fast_runs: at the places of its runs, then at more of them. Errors: also a design
/// whose points are no sample; fewer of them than runs.
[[nodiscard]] Result<FastModel> fast_ensemble(const PlannedRuns& runs, const run::SceneSource& source,
                                              const scene::Scene& base);

}  // namespace talus::ensemble
