#include "session/depth_averaged.hpp"

#include <exception>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "twin/json_keys.hpp"

namespace talus::session {

using nlohmann::json;

const char* DepthAveragedResults::name_of(State state) {
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

std::vector<int> DepthAveragedResults::turn(bool on) {
    std::vector<int> changed;
    if (on_ == on) return changed;
    on_ = on;
    for (int i = 0; !on && i < Scenarios::max_count; ++i) {
        if (slot(i).state == State::off) continue;
        slot(i) = {};
        changed.push_back(i);
    }
    return changed;
}

std::vector<int> DepthAveragedResults::look(Scenarios& all) {
    std::vector<int> changed;
    for (int i = 0; on_ && i < Scenarios::max_count; ++i) {
        if (!all.find(Scenarios::name_of(i))) {
            slot(i) = {};
            continue;
        }
        const twin::Scenario& scenario = all.at(i);
        std::string key = twin::setup_key(scenario);
        if (slot(i).state != State::off && slot(i).key == key) continue;
        slot(i) = {
            State::waiting, std::move(key), ++asked_, twin::scene_for_depth_averaged(scenario, limits_), {}, 0, {}};
        changed.push_back(i);
    }
    return changed;
}

std::optional<DepthAveragedResults::Task> DepthAveragedResults::begin() {
    int newest = -1;
    for (int i = 0; i < Scenarios::max_count; ++i) {
        if (slot(i).state == State::waiting && (newest < 0 || slot(i).asked > slot(newest).asked)) newest = i;
    }
    if (newest < 0) return {};
    slot(newest).state = State::running;
    return Task{newest, slot(newest).asked, std::exchange(slot(newest).scene, nullptr)};
}

void DepthAveragedResults::take_share(const Task& task, double share) {
    if (wants(task)) slot(task.scenario).share = share;
}

void DepthAveragedResults::finish(const Task& task, Outcome outcome) {
    if (!wants(task)) return;
    Slot& one = slot(task.scenario);
    one.state = outcome.made ? State::done : outcome.failed.empty() ? State::refused : State::failed;
    one.message = outcome.failed.empty() ? std::move(outcome.refused) : std::move(outcome.failed);
    one.made = std::move(outcome.made);
}

messages::DepthAveragedStatus DepthAveragedResults::describe(int scenario) const {
    const Slot& one = slot(scenario);
    return {.scenario = Scenarios::name_of(scenario),
            .state = name_of(one.state),
            .message = one.message,
            .share = one.state == State::running ? std::optional(one.share) : std::nullopt,
            .result = one.made ? std::optional(one.made->message()) : std::nullopt};
}

std::string DepthAveragedResults::why_none(int scenario) const {
    const Slot& one = slot(scenario);
    return fmt::format("scenario {} has no result of the depth-averaged model: {}", Scenarios::name_of(scenario),
                       one.message.empty() ? std::string("it is ") + name_of(one.state) : one.message);
}

void DepthAveragedInTurns::turn(bool on, Scenarios& all) {
    for (const int scenario : results_.turn(on)) tell(scenario);
    look(all);
}

void DepthAveragedInTurns::look(Scenarios& all) {
    for (const int scenario : results_.look(all)) tell(scenario);
    if (running_ && !results_.wants(running_->task)) running_.reset();
}

bool DepthAveragedInTurns::step(Clock::time_point now) {
    constexpr std::chrono::milliseconds tell_share_every{500};
    try {
        if (!running_) return begin();
        if (!running_->steps->advance()) {
            end({std::make_shared<const twin::DepthAveragedRun>(running_->steps->finish())});
        } else if (now - told_ >= tell_share_every) {
            results_.take_share(running_->task, running_->steps->share());
            tell(running_->task.scenario);
            told_ = now;
        }
    } catch (const std::exception& error) {  // running out of memory here must not end the live run
        end({.failed = fmt::format("The depth-averaged model ended unexpectedly: {}.", error.what())});
    }
    return true;
}

bool DepthAveragedInTurns::begin() {
    auto task = results_.begin();
    if (!task) return false;
    running_.emplace().task = std::move(*task);
    tell(running_->task.scenario);
    Result<scene::Scene> scene = running_->task.scene();
    if (!scene) {
        end({.refused = scene.error().message});
        return true;
    }
    running_->scene = std::make_unique<const scene::Scene>(std::move(*scene));
    auto steps = twin::DepthAveragedSteps::start(*running_->scene, limits);
    if (!steps) {
        end({.failed = steps.error().message});
        return true;
    }
    running_->steps = std::move(*steps);
    return true;
}

void DepthAveragedInTurns::end(DepthAveragedResults::Outcome outcome) {
    if (!running_) return;
    results_.finish(running_->task, std::move(outcome));
    tell(running_->task.scenario);
    running_.reset();
}

Result<bool> read_switch(const json& wanted) {
    const auto on = wanted.is_object() ? wanted.find("on") : wanted.end();
    if (on == wanted.end() || !on->is_boolean()) return Error{"the body is an object with on, true or false"};
    TALUS_TRY(twin::check_keys(wanted, {"on"}));
    return on->get<bool>();
}

messages::Done switched(bool on) {
    return {.done = fmt::format("depth-averaged model {}", on ? "on" : "off"), .created = {}};
}

}  // namespace talus::session
