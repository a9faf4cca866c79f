#include "sample_options.hpp"

#include <fmt/format.h>

#include "core/try.hpp"

namespace talus::cli {

void add_sample_options(CLI::App& command, SampleOptions& options, const std::string& runs_help) {
    command.add_option("--plan", options.plan, "plan file with factors and design; options override it")
        ->type_name("FILE");
    command.add_option("--vary", options.factors, "a factor, as of talus ensemble; may be repeated")
        ->type_name("SECTION.KEY=DISTRIBUTION")
        ->allow_extra_args(false);
    command.add_option("--design", options.design, "default: latin_hypercube")->type_name("NAME");
    command.add_option("--runs", options.runs, runs_help)->type_name("N");
    command.add_option("--seed", options.seed, "of the design; default: 1")->type_name("N");
}

Result<ensemble::EnsemblePlan> read_sample(const SampleOptions& options, std::size_t default_runs,
                                           const std::string& instead) {
    ensemble::EnsemblePlan plan;
    plan.runs = default_runs;
    if (!options.plan.empty()) {
        TALUS_ASSIGN(plan, ensemble::read_plan(options.plan));
        if (plan.fast_runs > 0) {
            return Error{fmt::format("{}: ensemble.fast_runs is refused; {}", options.plan, instead)};
        }
    }
    for (const std::string& factor : options.factors) TALUS_TRY(add_factor(plan, factor));
    if (options.design) {
        const auto design = stats::design_of(*options.design);
        if (!design) {
            return Error{fmt::format("--design {} is refused; it must be latin_hypercube, monte_carlo or sobol",
                                     *options.design)};
        }
        plan.design = *design;
    }
    using enum stats::DesignKind;
    if (plan.design != latin_hypercube && plan.design != monte_carlo && plan.design != sobol) {
        return Error{
            fmt::format("design {} is refused; its points are no sample: latin_hypercube, monte_carlo or sobol",
                        design_name(plan.design))};
    }
    plan.runs = options.runs.value_or(plan.runs);
    plan.seed = options.seed.value_or(plan.seed);
    return plan;
}

}  // namespace talus::cli
