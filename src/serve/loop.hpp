#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "core/result.hpp"
#include "run/threads.hpp"
#include "serve/executor.hpp"
#include "session/scenarios.hpp"

namespace talus::serve {

using session::Audience;
using session::Clock;
using session::Copied;
using session::FrameSet;
using session::RunAlerts;
using session::Scenarios;
using session::Watcher;

/// The only thread that uses the scenarios. Others post tasks, which run between two steps, in order; so nothing in the
/// simulation needs a lock. Sleeps while nothing is due.
class Loop {
  public:
    using Task = std::function<void(Scenarios&)>;

    /// Opens the scene as scenario A, paused at time 0. Threads as `solver.thread_count` says. `watcher` is called from
    /// the loop's thread, `failed` is called there once on a failure such as lack of memory; nothing runs after that.
    /// Errors: as twin::Scenario::open.
    [[nodiscard]] static Result<std::unique_ptr<Loop>> start(Executor& executor,
                                                             std::shared_ptr<const scene::Scene> scene,
                                                             twin::ScenarioOptions options, Watcher& watcher,
                                                             std::function<void(std::string)> failed);
    /// Ends after the current step or task; waiting tasks are discarded.
    ~Loop();
    Loop(const Loop&) = delete;
    Loop& operator=(const Loop&) = delete;

    void post(Task task);

  private:
    Loop(Executor& executor, std::unique_ptr<run::Threads> threads, std::unique_ptr<twin::Scenario> first,
         Watcher& watcher, std::function<void(std::string)> failed);
    void run();
    void work_until_done();

    std::unique_ptr<run::Threads> threads_;
    std::atomic<bool> stop_ = false;  // work elsewhere ends soon
    Scenarios scenarios_;
    std::function<void(std::string)> failed_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<Task> tasks_;
    bool done_ = false;
    Lane preparer_;
    std::thread thread_;
};

}  // namespace talus::serve
