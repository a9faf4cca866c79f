#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>

#include "serve/executor.hpp"
#include "serve/job.hpp"
#include "serve/library.hpp"
#include "serve/message.hpp"

namespace talus::serve {

/// What a job may be given before it starts: the factors of a scene, what a run of it costs here, the cases. Scenes are
/// loaded and tried on a lane. Functions may be called from any thread.
class JobForms {
  public:
    explicit JobForms(Executor& executor) : lane_(executor, "job-forms") {}
    ~JobForms();
    JobForms(const JobForms&) = delete;
    JobForms& operator=(const JobForms&) = delete;

    /// As `GET /api/jobs/form/{scene}`.
    void describe(const KnownScene& scene, const Respond& respond);
    /// As `GET /api/jobs/estimate/{scene}`: some seconds of a run. A later question ends an earlier one.
    void estimate(const KnownScene& scene, const Respond& respond);
    /// As `GET /api/jobs/cases`.
    void cases(const Respond& respond);
    /// Calls `then` if the command would accept this for the scene, otherwise answers why not.
    void check(const WantedJob& wanted, const KnownScene& scene, const Respond& respond, std::function<void()> then);

  private:
    using Stop = std::shared_ptr<std::atomic<bool>>;
    /// Of the latest estimate, after it has ended an earlier one.
    [[nodiscard]] Stop begin_estimate();

    std::mutex mutex_;  // guards the following
    Stop stop_ = std::make_shared<std::atomic<bool>>(false);
    Lane lane_;
};

}  // namespace talus::serve
