#include "calibrate/calibration.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "ensemble/ensemble.hpp"

namespace talus::calibrate {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

const char* kind_name(ensemble::ObservedValue::Kind kind) {
    return kind == ensemble::ObservedValue::Kind::at_least ? "at_least"
           : kind == ensemble::ObservedValue::Kind::below  ? "below"
                                                           : "equal";
}

/// Runs of the scene at the places of a search.
class SceneModel {
  public:
    SceneModel(ensemble::PlannedRuns& runs, const run::SceneSource& source,
               const std::vector<ensemble::ObservedValue>& observed, const ensemble::EnsembleFolder& folder,
               std::size_t most, const CalibrationOptions& options, std::vector<ensemble::RunRecord>& records)
        : runs_(runs),
          source_(source),
          folder_(folder),
          most_(most),
          options_(options),
          records_(records),
          observed_(observed) {}

    Result<std::optional<stats::Points>> predict(const stats::Points& points, SearchPhase phase) {
        runs_.set_points(points);
        ensemble::EnsembleOptions options;
        options.runs_at_once = options_.runs_at_once;
        options.threads_per_run = options_.threads_per_run;
        options.retry_failed = options_.retry_failed;
        options.stop_requested = options_.stop_requested;
        options.verified = verified_;
        options.on_refused = options_.on_refused;
        options.on_progress = [&](const ensemble::EnsembleProgress& now) { tell(now, phase); };
        if (options_.on_run)
            options.on_run = [&](const ensemble::RunRecord& record) { tell_run(record, points, phase); };
        TALUS_ASSIGN(const ensemble::EnsembleOutcome outcome, run_ensemble(runs_, source_, folder_, options));
        if (outcome.interrupted) return std::optional<stats::Points>();
        stats::Points predicted;
        records_.clear();
        for (std::size_t run = 0; run < points.size(); ++run) {
            TALUS_ASSIGN(ensemble::RunRecord record, ensemble::read_run_record(folder_.run_file(run), folder_.plan(),
                                                                               run, ensemble::Verify::header));
            predicted.push_back(predictions_of(record));
            records_.push_back(std::move(record));
        }
        verified_ = points.size();
        return std::optional(std::move(predicted));
    }

  private:
    [[nodiscard]] std::vector<double> predictions_of(const ensemble::RunRecord& record) {
        if (!record.complete() || record.results.size() < observed_.size()) return {};
        std::vector<double> values(record.results.end() - static_cast<std::ptrdiff_t>(observed_.size()),
                                   record.results.end());  // the last of measures_of
        least_misfit_ = std::isnan(least_misfit_) ? misfit_of(observed_, values)
                                                  : std::min(least_misfit_, misfit_of(observed_, values));
        return values;
    }

    void tell_run(const ensemble::RunRecord& record, const stats::Points& points, SearchPhase phase) const {
        CalibrationRun made{record.run, phase, {}, observe::never};
        const std::vector<ensemble::Factor>& factors = runs_.plan().factors;
        const std::vector<double>& point = points[record.run];
        for (std::size_t k = 0; k < factors.size(); ++k)
            made.values.push_back(factors[k].distribution.quantile(point[k]));
        if (record.complete() && record.results.size() >= observed_.size()) {
            made.misfit = misfit_of(observed_, {record.results.end() - static_cast<std::ptrdiff_t>(observed_.size()),
                                                record.results.end()});
            for (std::size_t k = 0; k < factors.size(); ++k)
                made.misfit += prior_misfit(factors[k].distribution, point[k]);
        }
        options_.on_run(made);
    }

    void tell(const ensemble::EnsembleProgress& now, SearchPhase phase) const {
        if (!options_.on_progress) return;
        CalibrationProgress p;
        p.phase = phase;
        p.done = now.done;
        p.failed = now.failed;
        p.most = most_;
        p.least_misfit = least_misfit_;
        double wall = 0;
        for (const ensemble::RunRecord& record : records_)
            wall += record.wall_time / static_cast<double>(records_.size());
        const double left = static_cast<double>(most_) - now.share_done * static_cast<double>(now.count);
        const double here = static_cast<double>(now.count) * (1 - now.share_done);  // of this round
        p.wall_remaining = records_.empty() ? (here > 0 ? now.wall_remaining / here * left : observe::never)
                                            : wall * left / std::max(1, options_.runs_at_once);
        options_.on_progress(p);
    }

    ensemble::PlannedRuns& runs_;
    const run::SceneSource& source_;
    const ensemble::EnsembleFolder& folder_;
    const std::size_t most_;
    const CalibrationOptions options_;
    std::vector<ensemble::RunRecord>& records_;
    const std::vector<ensemble::ObservedValue>& observed_;
    double least_misfit_ = observe::never;
    std::size_t verified_ = 0;  // runs whose records were verified or written by this process
};

}  // namespace

Result<ensemble::PlannedRuns> plan_calibration(const CalibrationPlan& plan, const run::SceneSource& source,
                                               const scene::Scene& base) {
    for (const ensemble::Factor& f : plan.factors) {
        if (f.distribution.kind != stats::DistributionKind::list) continue;
        return Error{
            fmt::format("factor {}: a list has nothing between its values; give a range such as low:high", f.key)};
    }
    const std::vector<ensemble::ObservedValue> observed = ensemble::observed_values(base);
    if (observed.empty()) {
        return Error{
            fmt::format("{}: has nothing to calibrate against; add [[observation]], [[arrival]], [[run_up]] or "
                        "another of the sections in docs/ensembles.md",
                        source.file.string())};
    }
    for (std::size_t i = 0; i < base.spec.observations.size(); ++i) {
        const double chainage = base.spec.observations[i].chainage;
        if (!base.flow_path.empty() && chainage <= base.flow_path.length()) continue;
        return Error{
            fmt::format("observation[{}].chainage_m = {:.6g} lies beyond the flow path, which is {:.1f} m long", i,
                        chainage, base.flow_path.empty() ? 0 : base.flow_path.length())};
    }
    for (const ensemble::ObservedValue& o : observed) {
        if (o.uncertainty > 0) continue;
        return Error{fmt::format("{} = {:.6g} has no uncertainty; set one above 0", o.key, o.value)};
    }
    ensemble::EnsemblePlan ensemble;
    ensemble.runs = std::clamp<std::size_t>(plan.search.runs, 1, 2000);
    ensemble.seed = plan.search.seed;
    ensemble.factors = plan.factors;
    Result<ensemble::PlannedRuns> made = ensemble::PlannedRuns::make(ensemble, source, base);
    if (!made) return made;
    const std::size_t factors = plan.factors.size(), runs = plan.search.runs;
    if (runs < min_runs(factors) || runs > 2000) {
        return Error{fmt::format("runs = {} is refused; it must be {} to 2000 with {} factor{}", runs,
                                 min_runs(factors), factors, factors == 1 ? "" : "s")};
    }
    return made;
}

Json calibration_definition(const std::string& kind, const CalibrationPlan& plan, const ensemble::PlannedRuns& runs,
                            const run::SceneSource& source, const scene::Scene& base,
                            const std::vector<ensemble::ObservedValue>& observed, const std::string& scene_name) {
    Json definition = ensemble_definition(runs, source, base, scene_name);
    definition["kind"] = kind;
    definition["runs"] = plan.search.runs;
    definition["search"] = {
        {"design", plan.search.design}, {"checks", plan.search.checks}, {"at_once", plan.search.at_once}};
    definition["observed"] = Json::array();
    for (const ensemble::ObservedValue& o : observed) {
        definition["observed"].push_back(
            {{"key", o.key}, {"is", kind_name(o.kind)}, {"value", o.value}, {"uncertainty", o.uncertainty}});
    }
    return definition;
}

ForwardModel scene_model(ensemble::PlannedRuns& runs, const run::SceneSource& source,
                         const std::vector<ensemble::ObservedValue>& observed, const ensemble::EnsembleFolder& folder,
                         std::size_t most, const CalibrationOptions& options,
                         std::vector<ensemble::RunRecord>& records) {
    auto model = std::make_shared<SceneModel>(runs, source, observed, folder, most, options, records);
    return [model](const stats::Points& points, SearchPhase phase) { return model->predict(points, phase); };
}

Result<Calibration> calibrate(const CalibrationPlan& plan, ensemble::PlannedRuns runs, const run::SceneSource& source,
                              const scene::Scene& base, const std::vector<ensemble::ObservedValue>& observed,
                              const ensemble::EnsembleFolder& folder, const CalibrationOptions& options) {
    const auto start = Clock::now();
    Calibration made;
    made.scene = &base;
    made.factors = runs.plan().factors;
    made.observed = observed;
    std::vector<stats::Distribution> priors;
    for (const ensemble::Factor& f : made.factors) priors.push_back(f.distribution);
    const ForwardModel model = scene_model(runs, source, observed, folder, plan.search.runs, options, made.records);
    const FitReader on_fit = [&](const SearchResult& so_far) {
        Calibration now;
        now.scene = &base;
        now.factors = made.factors;
        now.observed = observed;
        now.result = so_far;
        options.on_fit(now);
    };
    Result<SearchResult> found = search(priors, observed, model, plan.search, options.on_fit ? on_fit : FitReader());
    if (!found) {
        const auto complete = [](const ensemble::RunRecord& record) { return record.complete(); };
        if (made.records.empty() || std::any_of(made.records.begin(), made.records.end(), complete)) {
            return found.error();
        }
        made.fault = found.error().message + "; the first: " + made.records.front().fault;
        return made;
    }
    made.result = *std::move(found);
    if (made.result.best) {
        for (const std::string& value : runs.at(*made.result.best).overrides) {
            if (!value.starts_with("outputs.series=")) made.best_overrides.push_back(value);
        }
    }
    made.wall_time = std::chrono::duration<double>(Clock::now() - start).count();
    return made;
}

}  // namespace talus::calibrate
