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
    : session_(session), worker_(std::make_unique<Worker>("depth-averaged", 5)) {
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
    worker_.reset();
}

const char* DepthAveraged::name_of(State state) {
    switch (state) {
        case State::waiting:
            return "waiting";
        case State::running:
            return "running";
        case State::done:
            return "done";
        case State::refused:
            return "refused";
        case State::failed:
            return "failed";
        case State::off:
            break;
    }
    return "off";
}

json DepthAveraged::describe_now(int scenario) const {
    const Slot& one = slot(scenario);
    return {{"scenario", Scenarios::name_of(scenario)},
            {"state", name_of(one.state)},
            {"message", one.message},
            {"share", one.state == State::running ? json(one.share) : json()},
            {"result", one.made ? one.made->to_json() : json()}};
}

json DepthAveraged::describe(int scenario) const {
    const std::lock_guard lock(mutex_);
    return describe_now(scenario);
}

std::shared_ptr<const twin::DepthAveragedRun> DepthAveraged::result(int scenario) const {
    const std::lock_guard lock(mutex_);
    return slot(scenario).made;
}

void DepthAveraged::tell(int scenario) {
    told_ = Clock::now();
    if (!closed_) session_.depth_averaged(scenario, describe_now(scenario));
}

void DepthAveraged::turn(bool on) {
    {
        const std::lock_guard lock(mutex_);
        if (closed_ || on_ == on) return;
        on_ = on;
        if (!on) {
            for (int i = 0; i < Scenarios::max_count; ++i) {
                if (slot(i).state == State::off) continue;
                drop(i);
                tell(i);
            }
        }
    }
    look_again();
}

/// Under the lock.
void DepthAveraged::drop(int scenario) {
    if (running_ == scenario) stop_ = true;
    slot(scenario) = {};
}

/// Under the lock the session's loop exists: close() comes before its end.
void DepthAveraged::look_again() {
    const std::lock_guard lock(mutex_);
    if (closed_ || !on_) return;
    session_.loop().post([this](Scenarios& all) { look(all); });
}

void DepthAveraged::look(Scenarios& all) {
    const std::lock_guard lock(mutex_);
    if (closed_ || !on_) return;
    for (int i = 0; i < Scenarios::max_count; ++i) {
        if (!all.find(Scenarios::name_of(i))) {
            drop(i);
            continue;
        }
        const twin::Scenario& scenario = all.at(i);
        std::string key = scenario.setup_key();
        if (slot(i).state != State::off && slot(i).key == key) continue;
        drop(i);
        Slot& fresh = slot(i);
        fresh.state = State::waiting;
        fresh.key = std::move(key);
        fresh.asked = ++asked_;
        fresh.scene = scenario.for_depth_averaged();
        worker_->post([this] { run_next(); });
        tell(i);
    }
}

/// The scenario that was asked about last; -1: none waits. Under the lock.
int DepthAveraged::next() const {
    int newest = -1;
    for (int i = 0; i < Scenarios::max_count; ++i) {
        if (slot(i).state == State::waiting && (newest < 0 || slot(i).asked > slot(newest).asked)) newest = i;
    }
    return newest;
}

void DepthAveraged::run_next() {
    std::unique_lock lock(mutex_);
    running_ = next();
    if (closed_ || running_ < 0) return;  // the question has been withdrawn
    const int scenario = running_;
    stop_ = false;
    Slot& one = slot(scenario);
    one.state = State::running;
    const std::uint64_t asked = one.asked;
    const Work scene = std::move(one.scene);
    tell(scenario);
    lock.unlock();
    compute(scenario, asked, scene);
    lock.lock();
    running_ = -1;
}

void DepthAveraged::compute(int scenario, std::uint64_t asked, const Work& work) {
    State state = State::failed;
    std::string message;
    std::shared_ptr<const twin::DepthAveragedRun> made;
    try {
        if (const Result<scene::Scene> scene = work(); !scene) {
            state = State::refused;
            message = scene.error().message;
        } else {
            auto run =
                twin::run_depth_averaged(*scene, stop_, [&](double share) { take_share(scenario, asked, share); });
            if (!run) {
                message = run.error().message;
            } else {
                state = State::done;
                made = std::make_shared<const twin::DepthAveragedRun>(std::move(*run));
            }
        }
    } catch (const std::exception& error) {  // running out of memory here must not end the live run
        message = fmt::format("The depth-averaged model ended unexpectedly: {}.", error.what());
    }
    const std::lock_guard lock(mutex_);
    Slot& one = slot(scenario);
    if (one.asked != asked || closed_) return;  // it is about another setup by now
    one.state = state;
    one.message = std::move(message);
    one.made = std::move(made);
    tell(scenario);
}

void DepthAveraged::take_share(int scenario, std::uint64_t asked, double share) {
    const std::lock_guard lock(mutex_);
    if (slot(scenario).asked != asked || Clock::now() - told_ < tell_share_every) return;
    slot(scenario).share = share;
    tell(scenario);
}

}  // namespace talus::serve
