#include "ensemble/ensemble.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/hash.hpp"
#include "core/try.hpp"
#include "products/fault_files.hpp"
#include "run/run_scene.hpp"

namespace talus::ensemble {
namespace {

using Clock = std::chrono::steady_clock;

double now_in_seconds() {
    return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

/// The runs of one process, taken one after the other by its threads.
class Workers {
  public:
    Workers(const PlannedRuns& runs, const run::SceneSource& source, const EnsembleFolder& folder,
            const EnsembleOptions& options)
        : runs_(runs),
          source_(source),
          folder_(folder),
          options_(options),
          own_clock_(efforts(), options.runs_at_once),
          clock_(options.clock ? *options.clock : own_clock_) {}

    Result<EnsembleOutcome> work();

  private:
    [[nodiscard]] std::vector<double> efforts() const;
    void find_work();
    [[nodiscard]] Result<RunRecord> recorded(std::size_t run) const;
    void take_runs(std::size_t worker);
    [[nodiscard]] bool stopped() const {
        return failed_ || (options_.stop_requested && options_.stop_requested->load());
    }
    /// Empty if the run was interrupted.
    [[nodiscard]] std::optional<std::pair<RunRecord, HazardMaps>> compute(std::size_t run, std::size_t worker);
    void finish(const RunRecord& record, const HazardMaps& maps, std::size_t worker);
    void report(std::size_t worker, double share);
    void estimate(double now);

    const PlannedRuns& runs_;
    const run::SceneSource& source_;
    const EnsembleFolder& folder_;
    const EnsembleOptions& options_;

    std::vector<std::size_t> todo_;
    std::atomic<std::size_t> next_{0};
    std::atomic<bool> failed_{false};
    std::mutex loading_;  // inputs are read by one thread at a time: it is fast, and not every driver is thread-safe
    std::mutex mutex_;    // guards what follows
    EnsembleOutcome outcome_;
    Status status_;
    std::vector<double> under_way_;  // per thread, share done of its run
    run::WorkClock own_clock_;
    run::WorkClock& clock_;
    double wall_remaining_ = observe::never, next_estimate_ = 0;  // s
    std::size_t computed_ = 0;
    Clock::time_point start_ = Clock::now();
};

/// The record of an earlier call. Errors: as read_run_record, of other values.
Result<RunRecord> Workers::recorded(std::size_t run) const {
    const auto file = folder_.run_file(run);
    TALUS_ASSIGN(RunRecord record,
                 read_run_record(file, folder_.plan(), run, run < options_.verified ? Verify::header : Verify::bytes));
    if (record.values != runs_.at(run).values) {
        return Error{fmt::format("{}: is of other values than this program chooses", file.string())};
    }
    if (options_.kept && record.complete() && !options_.kept(run)) {
        return Error{fmt::format("{}: what belongs to it is missing or damaged", file.string())};
    }
    return record;
}

/// Runs of other processes are none of this one's work.
std::vector<double> Workers::efforts() const {
    if (options_.clock) return {};
    std::vector<double> efforts(runs_.count(), 0);
    for (std::size_t run = options_.shard; run < efforts.size(); run += options_.shard_count) efforts[run] = 1;
    return efforts;
}

void Workers::find_work() {
    for (std::size_t run = options_.shard; run < runs_.count(); run += options_.shard_count) {
        ++outcome_.count;
        std::error_code error;
        if (std::filesystem::exists(folder_.run_file(run), error)) {
            const Result<RunRecord> record = recorded(run);
            if (record && (record->complete() || !options_.retry_failed)) {
                ++outcome_.resumed;
                if (run >= options_.verified) clock_.found(run, record->wall_time);
                record->complete() ? ++outcome_.done : ++outcome_.failed;
                continue;
            }
            if (!record && options_.on_refused) options_.on_refused(record.error().message + "; the run is made again");
        }
        todo_.push_back(run);
    }
}

std::optional<std::pair<RunRecord, HazardMaps>> Workers::compute(std::size_t run, std::size_t worker) {
    const PlannedRun planned = runs_.at(run);
    {
        const std::lock_guard lock(mutex_);
        clock_.begin(run, now_in_seconds());
    }
    std::vector<std::string> overrides = source_.overrides;
    overrides.insert(overrides.end(), planned.overrides.begin(), planned.overrides.end());
    overrides.push_back(fmt::format("solver.thread_count={}", options_.threads_per_run));

    std::pair<RunRecord, HazardMaps> made;
    RunRecord& record = made.first;
    record.run = run;
    record.values = planned.values;
    const Result<scene::Scene> scene = [&]() -> Result<scene::Scene> {
        const std::lock_guard lock(loading_);
        TALUS_ASSIGN(scene::Scene loaded, scene::load_scene(source_.file, overrides));
        if (options_.prepare) TALUS_TRY(options_.prepare(loaded));
        return loaded;
    }();
    if (!scene) {
        record.fault = scene.error().message;
        return made;
    }
    record.model = scene->spec.solver.model == params::ModelChoice::depth_averaged ? "depth_averaged" : "particles";
    run::RunOptions run_options;
    run_options.stop_requested = options_.stop_requested;
    run_options.on_progress = [&](const run::Progress& now) {
        {
            const std::lock_guard lock(mutex_);
            clock_.tick(run, now_in_seconds(), now.wall_remaining);
        }
        report(worker, now.share_done);
    };
    Result<run::RunResult> result = run_scene(*scene, run_options);
    if (!result) {
        record.fault = result.error().message;
        return made;
    }
    if (result->status == run::RunStatus::interrupted) return std::nullopt;
    record.simulated_time = result->simulated_time;
    record.wall_time = result->wall_time;
    record.particles = result->particles;
    record.hash = to_hex(result->hash);
    if (result->status == run::RunStatus::fault) {
        record.fault = result->stop_reason;
        const auto kept = folder_.path() / "faults" / fmt::format("run_{}", run);
        const Status written = result->fault ? products::write_fault(*result->fault, kept) : Status();
        if (!written) record.fault += "; nothing more is kept of it: " + written.error().message;
        return made;
    }
    if (options_.keep) {
        if (const Status kept = options_.keep(run, *result); !kept) {
            record.fault = kept.error().message;
            return made;
        }
    }
    record.results = measure(*scene, *result);
    record.verdict = judge(*result);
    record.buildings = std::move(result->observation.buildings);
    for (observe::BuildingImpact& building : record.buildings) building.history.clear();
    record.geometry = result->observation.maps.peak_depth.geometry;
    made.second = std::move(result->observation.maps);
    return made;
}

void Workers::report(std::size_t worker, double share) {
    if (!options_.on_progress) return;
    const std::lock_guard lock(mutex_);
    under_way_[worker] = share;
    EnsembleProgress p;
    p.done = outcome_.done;
    p.failed = outcome_.failed;
    p.count = outcome_.count;
    // Most runs end before solver.end_time_s, so shares of it are a lower bound.
    double part = 0;
    for (const double s : under_way_) part += s;
    const double before = static_cast<double>(outcome_.done + outcome_.failed);
    p.share_done = p.count > 0 ? (before + part) / static_cast<double>(p.count) : 1;
    const double wall = std::chrono::duration<double>(Clock::now() - start_).count();
    const double computed = static_cast<double>(computed_);
    p.runs_per_minute = wall > 0 ? 60 * computed / wall : 0;
    estimate(now_in_seconds());
    p.wall_remaining = wall_remaining_;
    options_.on_progress(p);
}

/// Now and then: it goes over all runs, and a run reports every step.
void Workers::estimate(double now) {
    if (now < next_estimate_) return;
    wall_remaining_ = clock_.wall_remaining(now);
    next_estimate_ = now + 0.1;
}

void Workers::finish(const RunRecord& record, const HazardMaps& maps, std::size_t worker) {
    const Status written = write_run_record(folder_.run_file(record.run), folder_.plan(), record, maps);
    {
        const std::lock_guard lock(mutex_);
        under_way_[worker] = 0;
        clock_.end(record.run, now_in_seconds());
        if (!written) {
            status_ = written;
            failed_ = true;
            return;
        }
        ++computed_;
        record.complete() ? ++outcome_.done : ++outcome_.failed;
        if (options_.on_run) options_.on_run(record);
    }
    report(worker, 0);
}

void Workers::take_runs(std::size_t worker) {
    while (!stopped()) {
        const std::size_t k = next_++;
        if (k >= todo_.size()) return;
        try {
            const auto made = compute(todo_[k], worker);
            if (!made) return;
            finish(made->first, made->second, worker);
        } catch (const std::exception& error) {  // out of memory in one run is no reason to lose the rest
            RunRecord record;
            record.run = todo_[k];
            record.values = runs_.at(todo_[k]).values;
            record.fault = std::string("the run ended unexpectedly: ") + error.what();
            finish(record, {}, worker);
        }
    }
}

Result<EnsembleOutcome> Workers::work() {
    find_work();
    const std::size_t workers = std::min(todo_.size(), static_cast<std::size_t>(std::max(1, options_.runs_at_once)));
    under_way_.assign(workers, 0);
    start_ = Clock::now();
    std::vector<std::thread> threads;
    for (std::size_t w = 0; w < workers; ++w) threads.emplace_back([this, w] { take_runs(w); });
    for (std::thread& thread : threads) thread.join();
    TALUS_TRY(std::move(status_));
    outcome_.wall_time = std::chrono::duration<double>(Clock::now() - start_).count();
    outcome_.interrupted = outcome_.done + outcome_.failed < outcome_.count;
    return outcome_;
}

}  // namespace

Result<EnsembleOutcome> run_ensemble(const PlannedRuns& runs, const run::SceneSource& source,
                                     const EnsembleFolder& folder, const EnsembleOptions& options) {
    return Workers(runs, source, folder, options).work();
}

}  // namespace talus::ensemble
