#include "serve/scenarios.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "core/try.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;

constexpr std::chrono::milliseconds state_interval{200};
constexpr double slowest = 0.05, fastest = 100;  // times real time
constexpr double abreast = 0.05;                 // s; closer in time than this, both take a single step

Clock::duration interval_of(double rate_hz) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate_hz));
}

/// The next time of something that recurs and was due at `due`: late ones do not move those after them.
Clock::time_point next_time(Clock::time_point due, Clock::duration interval, Clock::time_point now) {
    return std::max(due + interval, now);
}

/// A power of two, so that the caps of many viewers lead to few frames.
unsigned stride_for(unsigned cap, std::uint32_t slots) {
    unsigned stride = 1;
    while ((slots + stride - 1) / stride > cap) stride *= 2;
    return stride;
}

}  // namespace

Scenarios::Scenarios(std::unique_ptr<twin::Scenario> first, Watcher& watcher) : watcher_(watcher) {
    slots_[0].scenario = std::move(first);
    want_all();
}

std::optional<int> Scenarios::find(const std::string& name) const {
    for (int i = 0; i < max_count; ++i) {
        if (slots_[i].scenario && name == name_of(i)) return i;
    }
    return {};
}

std::vector<std::string> Scenarios::names() const {
    std::vector<std::string> all;
    for (int i = 0; i < max_count; ++i) {
        if (slots_[i].scenario) all.emplace_back(name_of(i));
    }
    return all;
}

void Scenarios::want_all() {
    for (Slot& slot : slots_) slot.frame_wanted = slot.state_wanted = true;
}

void Scenarios::set_running(bool running) {
    running_ = running;
    pace_.restart();
    for (Slot& slot : slots_) slot.rate.restart();
    want_all();
}

void Scenarios::advance(Slot& slot) {
    slot.scenario->advance();
    slot.frame_wanted = true;
}

Scenarios::Slot* Scenarios::furthest_behind() {
    Slot* behind = nullptr;
    for (Slot& slot : slots_) {
        if (slot.ready() && (behind == nullptr || slot.scenario->time() < behind->scenario->time())) behind = &slot;
    }
    return behind;
}

void Scenarios::step_all() {
    const Slot* behind = furthest_behind();
    if (behind == nullptr) return;
    const double limit = behind->scenario->time() + abreast;
    for (Slot& slot : slots_) {
        if (slot.ready() && slot.scenario->time() <= limit) advance(slot);
    }
}

Result<twin::Done> Scenarios::steer(const std::string& name, const json& action) {
    twin::Done done;
    if (name == "set_speed") {
        const auto factor = action.find("factor");
        if (factor == action.end()) return Error{"set_speed needs the key factor: a number, or null for no limit"};
        if (factor->is_null()) {
            pace_.set_factor({});
            done.sentence = "as fast as it goes";
        } else {
            const double value = factor->is_number() ? factor->get<double>() : -1;
            if (!(value >= slowest && value <= fastest)) {
                return Error{
                    fmt::format("factor = {}; allowed are {} to {}, or null", factor->dump(), slowest, fastest)};
            }
            pace_.set_factor(value);
            done.sentence = fmt::format("{} times real time", value);
        }
        want_all();
        return done;
    }
    if (name == "pause") {
        set_running(false);
        done.sentence = "paused";
        return done;
    }
    if (furthest_behind() == nullptr) {
        // At rest, debris may move again when something changes; the request to run is then kept.
        const bool can_come = std::any_of(slots_.begin(), slots_.end(), [](const Slot& slot) {
            return slot.scenario && slot.scenario->phase() == run::RunPhase::at_rest;
        });
        if (name == "step" || !can_come) {
            return Error{
                fmt::format("{}: nothing is left to compute ({}); restart it", name, slots_[0].scenario->message())};
        }
    }
    if (name == "run") {
        set_running(true);
        done.sentence = "running";
        return done;
    }
    if (running_) return Error{"step is for a scenario that is paused; pause it first"};
    step_all();
    want_all();
    done.sentence = "one step";
    return done;
}

Result<twin::Done> Scenarios::act(int index, const json& action, const std::string& by) {
    if (!action.is_object()) return Error{"an action is a JSON object with the key action"};
    const auto named = action.find("action");
    if (named == action.end() || !named->is_string()) return Error{"an action has the key action, a string"};
    const std::string name = named->get<std::string>();
    if (name == "run" || name == "pause" || name == "step" || name == "set_speed") return steer(name, action);

    Slot& slot = slots_[static_cast<std::size_t>(index)];
    const bool nothing_steps = furthest_behind() == nullptr;
    auto done = slot.scenario->apply(action, by);
    if (!done) return done;
    // After the restart of a run that has ended, its initial state is shown first.
    if (name == "restart" && nothing_steps) running_ = false;
    pace_.restart();
    slot.rate.restart();
    want_all();
    tell_setup(index);
    watcher_.done(index, by, done->sentence);
    return done;
}

Result<std::string> Scenarios::copy(int from) {
    for (int i = 0; i < max_count; ++i) {
        Slot& slot = slots_[i];
        if (slot.scenario) continue;
        TALUS_ASSIGN(auto made, slots_[static_cast<std::size_t>(from)].scenario->copy());
        slot = Slot();
        slot.scenario = std::move(made);
        set_running(running_);
        tell_names();
        return std::string(name_of(i));
    }
    return Error{fmt::format("there are {} scenarios already, the most there can be; end scenario B first", max_count)};
}

Status Scenarios::remove(int index) {
    if (index == 0) return Error{"scenario A stays; scenario B can be ended"};
    slots_[static_cast<std::size_t>(index)] = Slot();
    set_running(running_);
    tell_names();
    return {};
}

json Scenarios::state(int index) const {
    const Slot& slot = slots_[static_cast<std::size_t>(index)];
    const bool steps = running_ && slot.ready();
    json state = slot.scenario->state_json(!steps);
    state["scenario"] = name_of(index);
    state["speed_factor"] = pace_.factor() ? json(*pace_.factor()) : json();
    state["real_time_factor"] = steps ? slot.rate.real_time_factor() : 0.0;
    state["steps_per_second"] = steps ? slot.rate.steps_per_second() : 0.0;
    if (slot.ready()) state["status"] = running_ ? "running" : "paused";
    return state;
}

json Scenarios::setup(int index) const {
    json setup = slots_[static_cast<std::size_t>(index)].scenario->setup_json();
    setup["scenario"] = name_of(index);
    return setup;
}

twin::FramePtr Scenarios::frame(int index, unsigned stride) const {
    const Slot& slot = slots_[static_cast<std::size_t>(index)];
    return slot.scenario->frame(stride, running_ && slot.ready() ? twin::frame_running : 0);
}

void Scenarios::set_audience(const std::vector<Audience>& audience) {
    for (int i = 0; i < max_count; ++i) {
        Slot& slot = slots_[i];
        slot.audience = static_cast<std::size_t>(i) < audience.size() ? audience[i] : Audience();
        if (slot.audience.caps.empty()) continue;
        slot.frame_wanted = true;
        slot.next_frame = {};  // a viewer has just joined
    }
}

void Scenarios::tell_names() {
    watcher_.scenarios(names());
}

void Scenarios::tell_setup(int index) {
    Slot& slot = slots_[static_cast<std::size_t>(index)];
    json now = setup(index);
    if (now == slot.told_setup) return;
    slot.told_setup = now;
    watcher_.setup(index, std::move(now));
}

void Scenarios::tell_state(int index, Clock::time_point now) {
    Slot& slot = slots_[static_cast<std::size_t>(index)];
    tell_setup(index);  // a release that starts by itself changes it without an action
    watcher_.state(index, state(index));
    slot.state_wanted = false;
    slot.next_state = next_time(slot.next_state, state_interval, now);
}

void Scenarios::tell_frames(int index, Clock::time_point now) {
    Slot& slot = slots_[static_cast<std::size_t>(index)];
    FrameSet set;
    set.scenario = index;
    std::vector<std::pair<unsigned, twin::FramePtr>> by_stride;
    for (const unsigned cap : slot.audience.caps) {
        const unsigned stride = stride_for(std::max(cap, lowest_cap), slot.ids);
        auto made = std::find_if(by_stride.begin(), by_stride.end(), [&](const auto& f) { return f.first == stride; });
        if (made == by_stride.end()) {
            by_stride.emplace_back(stride, frame(index, stride));
            made = std::prev(by_stride.end());
            slot.ids = made->second->slots;
        }
        set.frames.emplace_back(cap, made->second);
    }
    watcher_.frames(std::move(set));
    slot.frame_wanted = false;
    slot.next_frame =
        next_time(slot.next_frame, interval_of(std::clamp(slot.audience.rate_hz, 0.1, highest_rate)), now);
}

std::optional<Clock::time_point> Scenarios::work(Clock::time_point now) {
    std::optional<Clock::time_point> next;
    const auto wait_for = [&](Clock::time_point when) { next = next ? std::min(*next, when) : when; };

    bool stepped = false;
    if (Slot* behind = running_ ? furthest_behind() : nullptr) {
        const Clock::time_point due = pace_.due(behind->scenario->time(), now);
        if (due <= now) {
            const double before = behind->scenario->time();
            advance(*behind);
            now = Clock::now();
            behind->rate.count(behind->scenario->time() - before, now);
            // Viewers are told immediately that, and why, the run does not continue.
            if (!behind->ready()) want_all();
            stepped = true;
        } else {
            wait_for(due);
        }
    }
    for (int i = 0; i < max_count; ++i) {
        Slot& slot = slots_[i];
        if (!slot.scenario) continue;
        if (slot.state_wanted || (stepped && now >= slot.next_state)) tell_state(i, now);
        if (!slot.frame_wanted || slot.audience.caps.empty()) continue;
        if (now >= slot.next_frame) {
            tell_frames(i, now);
        } else {
            wait_for(slot.next_frame);
        }
    }
    if (stepped) return now;
    return next;
}

}  // namespace talus::serve
