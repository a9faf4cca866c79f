#pragma once

#include <atomic>
#include <functional>
#include <memory>

#include "serve/job.hpp"
#include "serve/library.hpp"
#include "serve/message.hpp"
#include "serve/worker.hpp"

namespace talus::serve {

/// What a job may be given before it starts: the factors of a scene, what a run of it costs here, the cases. Scenes are
/// loaded and tried on a thread of their own. Functions may be called from any thread.
class JobForms {
  public:
    JobForms() = default;
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
    std::atomic<int> asked_{0};  // estimates, so that an earlier one can see that it is not wanted any more
    std::unique_ptr<Worker> worker_ = std::make_unique<Worker>("job-forms");
};

}  // namespace talus::serve
