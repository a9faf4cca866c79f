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

/// Runs of the scene at the places of a search.
class SceneModel {
  public:
    SceneModel(ensemble::PlannedRuns& runs, const run::SceneSource& source,
               const std::vector<ensemble::ObservedValue>& observed, const ensemble::EnsembleFolder& folder,
               const CalibrationOptions& options, ModelRuns made, ModelRuns other, bool fast)
        : runs_(runs),
          source_(source),
          folder_(folder),
          most_(made.most),
          clock_(*made.clock),
          other_(other),
          fast_(fast),
          options_(options),
          records_(*made.records),
          observed_(observed) {}

    Result<std::optional<stats::Points>> predict(const stats::Points& points, SearchPhase phase) {
        runs_.set_points(points);
        ensemble::EnsembleOptions options;
        options.runs_at_once = options_.runs_at_once;
        options.threads_per_run = options_.threads_per_run;
        options.retry_failed = options_.retry_failed;
        options.stop_requested = options_.stop_requested;
        options.verified = verified_;
        options.clock = &clock_;
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
        CalibrationRun made{record.run, phase, fast_, {}, observe::never};
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
        p.fast = fast_;
        p.done = now.done;
        p.failed = now.failed;
        p.most = most_;
        p.least_misfit = least_misfit_;
        const double now_s = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
        double elapsed = clock_.elapsed(now_s), left = clock_.left(now_s);
        if (other_.clock) {
            elapsed = std::max(elapsed, other_.clock->elapsed(now_s));
            left += other_.clock->left(now_s);
        }
        p.wall_remaining = run::told_left(elapsed, left);
        options_.on_progress(p);
    }

    ensemble::PlannedRuns& runs_;
    const run::SceneSource& source_;
    const ensemble::EnsembleFolder& folder_;
    const std::size_t most_;
    run::WorkClock& clock_;
    const ModelRuns other_;
    const bool fast_;
    const CalibrationOptions options_;
    std::vector<ensemble::RunRecord>& records_;
    const std::vector<ensemble::ObservedValue>& observed_;
    double least_misfit_ = observe::never;
    std::size_t verified_ = 0;  // runs whose records were verified or written by this process
};

// The fit of an emulator takes the cube of the runs: with 500 about ten seconds for each observation, after every
// round.
constexpr std::size_t most_fast_runs = 500;

ensemble::EnsemblePlan ensemble_of(const CalibrationPlan& plan) {
    ensemble::EnsemblePlan ensemble;
    ensemble.runs = std::clamp<std::size_t>(plan.search.runs, 1, 2000);
    ensemble.seed = plan.search.seed;
    ensemble.factors = plan.factors;
    return ensemble;
}

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
    Result<ensemble::PlannedRuns> made = ensemble::PlannedRuns::make(ensemble_of(plan), source, base);
    if (!made) return made;
    const std::size_t factors = plan.factors.size();
    const auto check = [&](const char* what, std::size_t runs, std::size_t least, std::size_t most) -> Status {
        if (runs >= least && runs <= most) return {};
        return Error{fmt::format("{} = {} is refused; it must be {} to {} with {} factor{}", what, runs, least, most,
                                 factors, factors == 1 ? "" : "s")};
    };
    const bool two = plan.search.fast_runs > 0;
    TALUS_TRY(check("runs", plan.search.runs, two ? min_runs_beside_fast : min_runs(factors), 2000));
    if (two) TALUS_TRY(check("fast runs", plan.search.fast_runs, min_runs(factors), most_fast_runs));
    return made;
}

Result<ensemble::FastModel> plan_fast_model(const CalibrationPlan& plan, const run::SceneSource& source,
                                            const scene::Scene& base) {
    return ensemble::fast_model(ensemble_of(plan), source, base);
}

Json calibration_definition(const std::string& kind, const CalibrationPlan& plan, const ensemble::PlannedRuns& runs,
                            const run::SceneSource& source, const scene::Scene& base,
                            const std::vector<ensemble::ObservedValue>& observed, const std::string& scene_name) {
    Json definition = ensemble_definition(runs, source, base, scene_name);
    definition["kind"] = kind;
    definition["runs"] = plan.search.runs;
    definition["search"] = {
        {"design", plan.search.design}, {"checks", plan.search.checks}, {"at_once", plan.search.at_once}};
    if (plan.fast) {  // not null without, so that earlier folders can be resumed
        definition["fast"] = {{"runs", plan.search.fast_runs}, {"overrides", plan.fast->source.overrides}};
    }
    definition["observed"] = Json::array();
    for (const ensemble::ObservedValue& o : observed) {
        definition["observed"].push_back(
            {{"key", o.key}, {"is", o.is()}, {"value", o.value}, {"uncertainty", o.uncertainty}});
    }
    return definition;
}

ForwardModel scene_model(ensemble::PlannedRuns& runs, const run::SceneSource& source,
                         const std::vector<ensemble::ObservedValue>& observed, const ensemble::EnsembleFolder& folder,
                         const CalibrationOptions& options, ModelRuns made, ModelRuns other, bool fast) {
    auto model = std::make_shared<SceneModel>(runs, source, observed, folder, options, made, other, fast);
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
    run::WorkClock clock(std::vector<double>(plan.search.runs, 1), options.runs_at_once);
    run::WorkClock fast_clock(std::vector<double>(plan.search.fast_runs, 1), options.runs_at_once);
    const ModelRuns own{plan.search.runs, &made.records, &clock};
    const ModelRuns others{plan.search.fast_runs, &made.fast_records, &fast_clock};
    const ForwardModel model =
        scene_model(runs, source, observed, folder, options, own, plan.fast ? others : ModelRuns());
    std::optional<ensemble::FastModel> fast = plan.fast;
    std::optional<ensemble::EnsembleFolder> fast_folder;
    ForwardModel fast_model;
    if (fast) {
        TALUS_ASSIGN(auto opened,
                     ensemble::EnsembleFolder::open(
                         folder.path() / "fast",
                         calibration_definition("fast part of a calibration", plan, fast->runs, fast->source,
                                                *fast->scene, observed, source.file.string())));
        fast_folder.emplace(std::move(opened));
        fast_model = scene_model(fast->runs, fast->source, observed, *fast_folder, options, others, own, true);
    }
    const FitReader on_fit = [&](const SearchResult& so_far) {
        Calibration now;
        now.scene = &base;
        now.factors = made.factors;
        now.observed = observed;
        now.result = so_far;
        options.on_fit(now);
    };
    Result<SearchResult> found =
        search(priors, observed, model, plan.search, options.on_fit ? on_fit : FitReader(), fast_model);
    if (!found) {
        const auto complete = [](const ensemble::RunRecord& record) { return record.complete(); };
        const std::vector<ensemble::RunRecord>& last = made.records.empty() ? made.fast_records : made.records;
        if (last.empty() || std::any_of(last.begin(), last.end(), complete)) return found.error();
        made.fault = found.error().message + "; the first: " + last.front().fault;
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
