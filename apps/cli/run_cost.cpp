#include "run_cost.hpp"

#include <cmath>

#include "run/cost.hpp"
#include "run/run_scene.hpp"
#include "scene/particle_spacing.hpp"

namespace talus::cli {

double seconds_of_run(const scene::Scene& scene, const InterruptWatch& watch) {
    if (scene.spec.solver.model == params::ModelChoice::particles) {
        const double spacing = particle_spacing(scene);
        const auto rehearsal = run::rehearse(scene, spacing, watch.stop_requested());
        return rehearsal ? cost_of(scene, *rehearsal, spacing).wall_time : std::nan("");
    }
    run::RunOptions options;
    options.stop_requested = &watch.stop_requested();
    const auto tried = run_scene(scene, options);
    return tried ? tried->wall_time : std::nan("");
}

}  // namespace talus::cli
