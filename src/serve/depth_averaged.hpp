#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <string>

#include <nlohmann/json.hpp>

#include "serve/executor.hpp"
#include "serve/session.hpp"
#include "session/depth_averaged.hpp"

namespace talus::serve {

/// The depth-averaged model of the present setup of every scenario, beside the live runs: one run at a time, on one
/// thread of lower priority. A changed setup ends its run and discards its result at once; the scenario that was
/// changed last comes first. Off until it is switched on. Functions may be called from any thread.
class DepthAveraged {
  public:
    explicit DepthAveraged(Session& session);
    ~DepthAveraged();
    DepthAveraged(const DepthAveraged&) = delete;
    DepthAveraged& operator=(const DepthAveraged&) = delete;

    /// For all scenarios, also those to come. Off: results are discarded.
    void turn(bool on);
    /// Ends the run under way; nothing is sent any more. Before the session is closed.
    void close();

    /// As `GET /api/scenarios/{s}/depth_averaged`.
    [[nodiscard]] nlohmann::json describe(int scenario) const;
    /// The result for the present setup; nullptr: there is none yet.
    [[nodiscard]] std::shared_ptr<const twin::DepthAveragedRun> result(int scenario) const;
    [[nodiscard]] std::string why_none(int scenario) const;

  private:
    using Clock = std::chrono::steady_clock;
    using Results = session::DepthAveragedResults;

    void look_again();
    void look(Scenarios& all);
    void run_next();
    [[nodiscard]] Results::Outcome compute(const Results::Task& task);
    void take_share(const Results::Task& task, double share);
    void tell(int scenario);

    Session& session_;
    mutable std::mutex mutex_;  // guards the following members, except stop_
    Results results_;
    bool closed_ = false;
    std::atomic<bool> stop_ = false;  // ends the run under way
    Clock::time_point told_{};
    Lane lane_;  // a task for each question
};

}  // namespace talus::serve
