#include "variant_plan.hpp"

#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"

namespace talus {

VariantPlan::VariantPlan(SceneSource source, std::vector<Variant> variants, std::size_t refinement_count)
    : source_(std::move(source)),
      variants_(std::move(variants)),
      refinement_count_(refinement_count),
      clock_(variants_) {}

Result<VariantPlan> VariantPlan::make(const RunArguments& arguments, const SceneSource& source, const Scene& scene) {
    std::vector<Variant> wanted;
    if (arguments.convergence) wanted = refinements(scene);
    const std::size_t refinement_count = wanted.size();
    if (arguments.named_variants) {
        if (scene.spec.variants.empty()) {
            return Error{"--variants: the scene has no [[variant]]"};
        }
        const std::vector<Variant> named = named_variants(scene.spec);
        wanted.insert(wanted.end(), named.begin(), named.end());
    }
    for (const std::string& text : arguments.variations) {
        TALUS_ASSIGN(const auto more, variations(text));
        wanted.insert(wanted.end(), more.begin(), more.end());
    }
    TALUS_ASSIGN(auto prepared, prepare_variants(source, scene, std::move(wanted)));
    return VariantPlan(source, std::move(prepared), refinement_count);
}

void VariantPlan::report_base(ProgressReporter& reporter, const Progress& now) const {
    reporter.report(now, empty() ? std::nullopt : std::optional(clock_.at(now)));
}

std::vector<Comparison> VariantPlan::run(const Scene& scene, const RunResult& base, ProgressReporter& reporter,
                                         const std::atomic<bool>& stop_requested) {
    clock_.base_ended(base);
    RunOptions options;
    options.stop_requested = &stop_requested;
    options.on_progress = [&](const Progress& now) { reporter.report(now, clock_.at(now)); };
    std::vector<VariantRun> runs;
    for (const Variant& variant : variants_) {
        if (base.status == RunStatus::fault) {
            runs.push_back({variant, std::nullopt, "not run because of the fault in the run as given"});
        } else {
            runs.push_back(run_variant(source_, variant, options));
        }
        clock_.variant_ended();
    }
    const auto middle = runs.begin() + static_cast<std::ptrdiff_t>(refinement_count_);
    std::vector<VariantRun> varied(std::make_move_iterator(middle), std::make_move_iterator(runs.end()));
    runs.erase(middle, runs.end());
    std::vector<Comparison> comparisons;
    if (!runs.empty()) comparisons.push_back(compare(ComparisonKind::convergence, scene, base, std::move(runs)));
    if (!varied.empty()) comparisons.push_back(compare(ComparisonKind::sensitivity, scene, base, std::move(varied)));
    return comparisons;
}

}  // namespace talus
