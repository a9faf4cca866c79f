#include "session/scenarios.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "messages/messages.hpp"
#include "twin/answers.hpp"
#include "twin/live_run.hpp"
#include "twin/trigger.hpp"

namespace talus::session {
namespace {

using nlohmann::json;

constexpr std::chrono::milliseconds state_interval{200};

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

Scenarios::Scenarios(std::unique_ptr<twin::Scenario> first, Watcher& watcher, Elsewhere elsewhere)
    : watcher_(watcher), elsewhere_(std::move(elsewhere)) {
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

/// After a change of which scenarios run: time and rates are counted from now.
void Scenarios::start_clock() {
    pace_.restart();
    for (Slot& slot : slots_) slot.rate.restart();
    want_all();
}

void Scenarios::advance(Slot& slot) {
    slot.scenario->advance();
    slot.frame_wanted = true;
    // What is over does not go on by itself when something is changed later.
    if (!slot.ready()) slot.running = false;
}

Scenarios::Slots Scenarios::all() {
    Slots list;
    for (Slot& slot : slots_) {
        if (slot.scenario) list.push_back(&slot);
    }
    return list;
}

Scenarios::Slot* Scenarios::furthest_behind(const Slots& slots) {
    Slot* behind = nullptr;
    for (Slot* slot : slots) {
        if (slot->ready() && (behind == nullptr || slot->scenario->time() < behind->scenario->time())) behind = slot;
    }
    return behind;
}

json Scenarios::state(int index) const {
    const Slot& slot = slots_[static_cast<std::size_t>(index)];
    const bool steps = slot.steps();
    messages::State state{.run_state = twin::state_of(*slot.scenario, !steps),
                          .scenario = name_of(index),
                          .speed_factor = pace_.factor(),
                          .real_time_factor = steps ? slot.rate.real_time_factor() : 0.0,
                          .steps_per_second = steps ? slot.rate.steps_per_second() : 0.0,
                          .preparing = {}};
    if (slot.ready()) state.run_state.status = slot.running ? "running" : "paused";
    if (slot.job) state.preparing = messages::Preparation{.what = slot.job->what, .share = slot.job->share.load()};
    return twin::with_short_numbers(state);
}

json Scenarios::setup(int index) const {
    json setup = twin::setup_json(*slots_[static_cast<std::size_t>(index)].scenario);
    setup["scenario"] = name_of(index);
    setup["name"] = title(index);
    return setup;
}

twin::FramePtr Scenarios::frame(int index, unsigned stride) const {
    const Slot& slot = slots_[static_cast<std::size_t>(index)];
    return slot.scenario->run().frame(stride, slot.steps() ? twin::frame_running : 0);
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

/// Of a run that was started again, the alarms of the run before are forgotten.
void Scenarios::tell_alerts(int index) {
    Slot& slot = slots_[static_cast<std::size_t>(index)];
    const json* trigger = twin::started_by(*slot.scenario);
    const std::vector<twin::RaisedAlarm>& alarms = slot.scenario->run().alarms();
    if (slot.told_trigger == (trigger != nullptr) && slot.told_alarms == alarms.size()) return;
    const std::size_t known = alarms.size() < slot.told_alarms ? 0 : slot.told_alarms;
    slot.told_trigger = trigger != nullptr;
    slot.told_alarms = alarms.size();
    watcher_.alerts(index, {trigger != nullptr ? *trigger : json(), alarms, alarms.size() - known});
}

void Scenarios::tell_setup(int index) {
    Slot& slot = slots_[static_cast<std::size_t>(index)];
    json now = setup(index);
    if (now == slot.told_setup) return;
    slot.told_setup = now;
    watcher_.setup(index, std::move(now), slot.scenario->run().setup());
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

std::optional<Clock::time_point> Scenarios::work(const Now& clock) {
    Clock::time_point now = clock();
    std::optional<Clock::time_point> next;
    const auto wait_for = [&](Clock::time_point when) { next = next ? std::min(*next, when) : when; };

    bool stepped = false;
    Slots going = all();
    std::erase_if(going, [](const Slot* slot) { return !slot->steps(); });
    if (Slot* behind = furthest_behind(going)) {
        const Clock::time_point due = pace_.due(behind->scenario->time(), now);
        if (due <= now) {
            const double before = behind->scenario->time();
            advance(*behind);
            now = clock();
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
        tell_alerts(i);
        if (slot.job) {
            slot.state_wanted = slot.state_wanted || now >= slot.next_state;
            wait_for(now + state_interval);
        }
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

}  // namespace talus::session
