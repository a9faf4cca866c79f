#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>

#include "core/result.hpp"
#include "ensemble/ensemble_folder.hpp"
#include "ensemble/plan.hpp"
#include "run/run_result.hpp"
#include "run/time_left.hpp"
#include "run/variants.hpp"
#include "scene/scene.hpp"

namespace talus::ensemble {

/// Progress of an ensemble.
struct EnsembleProgress {
    std::size_t done = 0, failed = 0, count = 0;  ///< runs of this process, earlier ones included
    double share_done = 0;                        ///< 0 to 1, runs under way counted by their simulated time
    double runs_per_minute = 0;                   ///< of this process so far
    double wall_remaining = 0;                    ///< s, an estimate; NaN: too little is done to say
};

struct EnsembleOptions {
    int runs_at_once = 1;                               ///< each on its own thread
    int threads_per_run = 1;                            ///< several where runs_at_once is 1
    std::size_t shard = 0, shard_count = 1;             ///< this process computes runs shard, shard + shard_count, ...
    bool retry_failed = false;                          ///< runs that failed before are run again
    const std::atomic<bool>* stop_requested = nullptr;  ///< runs in progress are discarded, completed ones are kept
    std::function<void(const EnsembleProgress&)> on_progress = {};  ///< from any of the runs' threads, one at a time
    std::function<void(const RunRecord&)> on_run = {};              ///< likewise, when a run of this call is recorded
    std::size_t verified = 0;  ///< records of runs before this one were verified or written by this process
    std::function<void(const std::string&)> on_refused = {};  ///< why a record is not used and its run made again
    std::function<Status(scene::Scene&)> prepare =
        {};  ///< changes every scene once it is loaded; the definition says how
    /// Keeps more of a complete run than its record, before that is written; an error is a fault of the run. From any
    /// of the runs' threads.
    std::function<Status(std::size_t run, const run::RunResult&)> keep = {};
    /// Whether what an earlier call kept of a run is there; if not the run is made again.
    std::function<bool(std::size_t run)> kept = {};
    run::WorkClock* clock = nullptr;  ///< where these runs are part of more: the clock of all, a run per number
};

struct EnsembleOutcome {
    std::size_t done = 0, failed = 0, count = 0;  ///< of this process's share
    std::size_t resumed = 0;                      ///< of those, done before
    bool interrupted = false;
    double wall_time = 0;  ///< s, of this call
};

/// Computes the runs of this process's share that are missing in the folder, damaged or of another plan. A run that
/// fails is recorded with its fault and the rest continue. Errors: a record cannot be written.
[[nodiscard]] Result<EnsembleOutcome> run_ensemble(const PlannedRuns& runs, const run::SceneSource& source,
                                                   const EnsembleFolder& folder, const EnsembleOptions& options);

}  // namespace talus::ensemble
