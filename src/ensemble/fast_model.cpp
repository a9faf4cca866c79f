#include "ensemble/fast_model.hpp"

#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"

namespace talus::ensemble {

Result<FastModel> fast_model(const EnsemblePlan& plan, const run::SceneSource& source, const scene::Scene& base) {
    if (base.spec.solver.model == params::ModelChoice::depth_averaged) {
        return Error{
            fmt::format("{}: solver.model = \"depth_averaged\" is the faster model itself; two models need particles "
                        "as the scene's",
                        source.file.string())};
    }
    run::SceneSource fast = source;
    fast.overrides.emplace_back("solver.model=depth_averaged");
    Result<scene::Scene> scene = scene::load_scene(fast.file, fast.overrides);
    if (!scene) return scene.error();
    TALUS_ASSIGN(auto runs, PlannedRuns::make(plan, fast, *scene));
    return FastModel{std::move(fast), std::make_shared<const scene::Scene>(*std::move(scene)), std::move(runs)};
}

Result<FastModel> fast_ensemble(const PlannedRuns& runs, const run::SceneSource& source, const scene::Scene& base) {
    const EnsemblePlan& plan = runs.plan();
    const bool sample = plan.design == stats::DesignKind::latin_hypercube ||
                        plan.design == stats::DesignKind::monte_carlo || plan.design == stats::DesignKind::sobol;
    if (!sample) {
        return Error{fmt::format(
            "fast runs = {} is refused with the design {}; its points are no sample of the distributions, as those of "
            "latin_hypercube, monte_carlo and sobol are",
            plan.fast_runs, design_name(plan.design))};
    }
    if (plan.fast_runs <= runs.count()) {
        return Error{
            fmt::format("fast runs = {} is refused; they must be more than the {} runs of particles, beside each "
                        "of which one is made",
                        plan.fast_runs, runs.count())};
    }
    EnsemblePlan all = plan;
    all.runs = plan.fast_runs;
    TALUS_ASSIGN(auto fast, fast_model(all, source, base));
    stats::Points points = runs.points();
    // A Latin hypercube of all would have other points; what is more than the runs is one of its own.
    const bool hypercube = plan.design == stats::DesignKind::latin_hypercube;
    const std::size_t more = plan.fast_runs - points.size();
    const stats::Points others =
        hypercube ? sample_points(plan.design, more, plan.factors.size(), plan.seed + 1) : fast.runs.points();
    points.insert(points.end(), others.end() - static_cast<std::ptrdiff_t>(more), others.end());
    fast.runs.set_points(std::move(points));
    return Result<FastModel>(std::move(fast));
}

}  // namespace talus::ensemble
