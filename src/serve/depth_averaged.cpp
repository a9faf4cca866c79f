#include "serve/depth_averaged.hpp"

#include <exception>
#include <utility>

#include <fmt/format.h>

namespace talus::serve {
namespace {

using nlohmann::json;

constexpr std::chrono::milliseconds tell_share_every{500};

}  // namespace

DepthAveraged::DepthAveraged(Session& session)
    : session_(session), lane_(session.executor(), "depth-averaged", Priority::background) {
    session_.watch_setups([this] { look_again(); });
}

DepthAveraged::~DepthAveraged() {
    close();
}

void DepthAveraged::close() {
    {
        const std::lock_guard lock(mutex_);
        closed_ = true;
        stop_ = true;
    }
    lane_.close();
}

json DepthAveraged::describe(int scenario) const {
    const std::lock_guard lock(mutex_);
    return results_.describe(scenario);
}

std::shared_ptr<const twin::DepthAveragedRun> DepthAveraged::result(int scenario) const {
    const std::lock_guard lock(mutex_);
    return results_.result(scenario);
}

std::string DepthAveraged::why_none(int scenario) const {
    const std::lock_guard lock(mutex_);
    return results_.why_none(scenario);
}

/// Under the lock.
void DepthAveraged::tell(int scenario) {
    told_ = Clock::now();
    if (!closed_) session_.depth_averaged(scenario, results_.describe(scenario));
}

void DepthAveraged::turn(bool on) {
    {
        const std::lock_guard lock(mutex_);
        if (closed_) return;
        for (const int scenario : results_.turn(on)) tell(scenario);
        if (!on) stop_ = true;
    }
    look_again();
}

/// Under the lock the session's loop exists: close() comes before its end.
void DepthAveraged::look_again() {
    const std::lock_guard lock(mutex_);
    if (closed_ || !results_.on()) return;
    session_.loop().post([this](Scenarios& all) { look(all); });
}

void DepthAveraged::look(Scenarios& all) {
    const std::lock_guard lock(mutex_);
    if (closed_) return;
    for (const int scenario : results_.look(all)) {
        lane_.post([this] { run_next(); });
        tell(scenario);
    }
}

void DepthAveraged::run_next() {
    std::unique_lock lock(mutex_);
    if (closed_) return;
    const auto task = results_.begin();
    if (!task) return;  // the question has been withdrawn
    stop_ = false;
    tell(task->scenario);
    lock.unlock();
    Results::Outcome outcome = compute(*task);
    lock.lock();
    if (closed_ || !results_.wants(*task)) return;  // it is about another setup by now
    results_.finish(*task, std::move(outcome));
    tell(task->scenario);
}

DepthAveraged::Results::Outcome DepthAveraged::compute(const Results::Task& task) {
    try {
        const Result<scene::Scene> scene = task.scene();
        if (!scene) return {.refused = scene.error().message};
        auto run = twin::run_depth_averaged(*scene, stop_, [&](double share) { take_share(task, share); });
        if (!run) return {.failed = run.error().message};
        return {std::make_shared<const twin::DepthAveragedRun>(std::move(*run))};
    } catch (const std::exception& error) {  // running out of memory here must not end the live run
        return {.failed = fmt::format("The depth-averaged model ended unexpectedly: {}.", error.what())};
    }
}

void DepthAveraged::take_share(const Results::Task& task, double share) {
    const std::lock_guard lock(mutex_);
    if (!results_.wants(task)) stop_ = true;
    if (stop_ || Clock::now() - told_ < tell_share_every) return;
    results_.take_share(task, share);
    tell(task.scenario);
}

}  // namespace talus::serve
