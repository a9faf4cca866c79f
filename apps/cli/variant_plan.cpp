#include "variant_plan.hpp"

#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"

namespace talus::cli {

VariantPlan::VariantPlan(run::SceneSource source, std::vector<run::Variant> variants, std::size_t refinement_count)
    : source_(std::move(source)),
      variants_(std::move(variants)),
      refinement_count_(refinement_count),
      clock_(variants_) {}

Result<VariantPlan> VariantPlan::make(const RunArguments& arguments, const run::SceneSource& source,
                                      const scene::Scene& scene) {
    std::vector<run::Variant> wanted;
    if (arguments.convergence) wanted = run::refinements(scene);
    const std::size_t refinement_count = wanted.size();
    if (arguments.named_variants) {
        if (scene.spec.variants.empty()) {
            return Error{"--variants: the scene has no [[variant]]"};
        }
        const std::vector<run::Variant> named = run::named_variants(scene.spec);
        wanted.insert(wanted.end(), named.begin(), named.end());
    }
    for (const std::string& text : arguments.variations) {
        TALUS_ASSIGN(const auto more, run::variations(text));
        wanted.insert(wanted.end(), more.begin(), more.end());
    }
    TALUS_ASSIGN(auto prepared, prepare_variants(source, scene, std::move(wanted)));
    return VariantPlan(source, std::move(prepared), refinement_count);
}

void VariantPlan::report_base(ProgressReporter& reporter, const run::Progress& now) {
    reporter.report(now, empty() ? std::nullopt : std::optional(clock_.at(now)));
}

std::vector<run::Comparison> VariantPlan::run(const scene::Scene& scene, const run::RunResult& base,
                                              ProgressReporter& reporter, const std::atomic<bool>& stop_requested) {
    clock_.base_ended(base);
    run::RunOptions options;
    options.stop_requested = &stop_requested;
    options.on_progress = [&](const run::Progress& now) { reporter.report(now, clock_.at(now)); };
    std::vector<run::VariantRun> runs;
    for (const run::Variant& variant : variants_) {
        if (base.status == run::RunStatus::fault) {
            runs.push_back({variant, std::nullopt, "not run because of the fault in the run as given"});
        } else {
            runs.push_back(run_variant(source_, variant, options));
        }
        clock_.variant_ended();
    }
    const auto middle = runs.begin() + static_cast<std::ptrdiff_t>(refinement_count_);
    std::vector<run::VariantRun> varied(std::make_move_iterator(middle), std::make_move_iterator(runs.end()));
    runs.erase(middle, runs.end());
    std::vector<run::Comparison> comparisons;
    if (!runs.empty()) comparisons.push_back(compare(run::ComparisonKind::convergence, scene, base, std::move(runs)));
    if (!varied.empty())
        comparisons.push_back(compare(run::ComparisonKind::sensitivity, scene, base, std::move(varied)));
    return comparisons;
}

}  // namespace talus::cli
