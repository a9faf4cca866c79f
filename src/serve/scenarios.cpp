#include "serve/scenarios.hpp"

#include <algorithm>
#include <exception>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "serve/json_text.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;

constexpr std::chrono::milliseconds state_interval{200};
constexpr double slowest = 0.05, fastest = 100;  // times real time
constexpr double abreast = 0.05;                 // s; closer in time than this, all take a single step
constexpr std::size_t longest_title = 60;

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

Result<Scenarios::Slots> Scenarios::listed(const json& action, Slots otherwise) {
    const auto names = action.find("scenarios");
    if (names == action.end()) return otherwise;
    Slots list;
    for (const json& name : names->is_array() ? *names : json::array()) {
        const auto index = find(name.is_string() ? name.get<std::string>() : "");
        if (!index) return Error{fmt::format("scenarios: there is no scenario {}", tidy_name(name.dump(), 20))};
        list.push_back(&slots_[static_cast<std::size_t>(*index)]);
    }
    if (list.empty()) return Error{"scenarios: must be a list of the names of scenarios"};
    return list;
}

Scenarios::Slot* Scenarios::furthest_behind(const Slots& slots) {
    Slot* behind = nullptr;
    for (Slot* slot : slots) {
        if (slot->ready() && (behind == nullptr || slot->scenario->time() < behind->scenario->time())) behind = slot;
    }
    return behind;
}

void Scenarios::step_all(const Slots& slots) {
    const double limit = furthest_behind(slots)->scenario->time() + abreast;
    for (Slot* slot : slots) {
        if (slot->ready() && slot->scenario->time() <= limit) advance(*slot);
    }
}

Result<twin::Done> Scenarios::set_speed(const json& action) {
    const auto factor = action.find("factor");
    if (factor == action.end()) return Error{"set_speed needs the key factor: a number, or null for no limit"};
    if (factor->is_null()) {
        pace_.set_factor({});
        want_all();
        return twin::Done{"as fast as it goes", ""};
    }
    const double value = factor->is_number() ? factor->get<double>() : -1;
    if (!(value >= slowest && value <= fastest)) {
        return Error{fmt::format("factor = {}; allowed are {} to {}, or null", factor->dump(), slowest, fastest)};
    }
    pace_.set_factor(value);
    want_all();
    return twin::Done{fmt::format("{} times real time", value), ""};
}

Result<twin::Done> Scenarios::steer(const std::string& name, const Slots& slots) {
    if (name == "pause") {
        for (Slot* slot : slots) slot->running = false;
        start_clock();
        return twin::Done{"paused", ""};
    }
    if (furthest_behind(slots) == nullptr) {
        return Error{
            fmt::format("{}: nothing is left to compute ({}); restart it", name, slots.front()->scenario->message())};
    }
    if (name == "run") {
        for (Slot* slot : slots) slot->running = slot->ready();
        start_clock();
        return twin::Done{"running", ""};
    }
    if (std::any_of(slots.begin(), slots.end(), [](const Slot* slot) { return slot->steps(); })) {
        return Error{"step is for a scenario that is paused; pause it first"};
    }
    if (std::any_of(slots.begin(), slots.end(), [](const Slot* slot) { return slot->job != nullptr; })) {
        return Error{"step: a change is being prepared; wait for it, or cancel it"};
    }
    step_all(slots);
    want_all();
    return twin::Done{"one step", ""};
}

/// One at a time for each scenario; those that come meanwhile wait.
template <class Made>
void Scenarios::prepare(Slot& slot, const std::string& what, bool holds,
                        std::function<Result<Made>(const sim::Progress&)> work,
                        std::function<void(Result<Made>)> then) {
    const auto refuse = [then](const Error& why) { then(why); };
    const auto begin = [this, &slot, what, holds, work = std::move(work), then] {
        auto job = std::make_shared<Job>();
        job->what = what;
        job->holds = holds;
        slot.job = job;
        slot.state_wanted = true;
        const auto made = std::make_shared<std::optional<Result<Made>>>();
        elsewhere_(
            [job, made, work](const std::atomic<bool>& stop) {
                try {
                    made->emplace(work([&](double share) {
                        job->share = share;
                        return !job->cancelled && !stop;
                    }));
                } catch (const std::exception& error) {
                    made->emplace(Error{fmt::format("{}: {}", job->what, error.what())});
                }
            },
            [this, job, made, then] {
                then(std::move(**made));
                prepare_next(job.get());
                start_clock();
            });
    };
    if (slot.job && slot.waiting.size() >= max_waiting) {
        refuse(Error{fmt::format("{}: {} changes of scenario {} wait already, the most there can be; repeat it later",
                                 what, max_waiting, name_of(index_of(slot)))});
    } else if (slot.job) {
        slot.waiting.push_back({begin, refuse});
    } else {
        begin();
    }
}

void Scenarios::prepare_next(const Job* ended) {
    for (Slot& slot : slots_) {
        if (slot.job.get() != ended) continue;
        slot.job = nullptr;
        if (slot.waiting.empty()) continue;
        const auto next = std::move(slot.waiting.front());
        slot.waiting.pop_front();
        next.begin();
    }
}

twin::Done Scenarios::cancel(Slot& slot) {
    if (!slot.job) return twin::Done{"nothing is being prepared", ""};
    slot.job->cancelled = true;
    return twin::Done{"cancelled: " + slot.job->what, ""};
}

void Scenarios::change(Slot& slot, const json& action, const std::string& by, const Answer<twin::Done>& answer) {
    std::string what = action.value("action", "");
    std::replace(what.begin(), what.end(), '_', ' ');
    using Prepared = std::shared_ptr<twin::Scenario::Prepared>;
    const auto scenario = slot.scenario;
    prepare<Prepared>(
        slot, what, true,
        [scenario, action, by](const sim::Progress& progress) { return scenario->prepare(action, by, progress); },
        [this, &slot, scenario, by, answer](Result<Prepared> prepared) {
            if (prepared && slot.scenario != scenario) prepared = Error{"the scenario has ended"};
            if (!prepared) {
                answer(prepared.error());
                return;
            }
            const twin::Done done = scenario->commit(**prepared);
            tell_setup(index_of(slot));
            watcher_.done(index_of(slot), by, done.sentence);
            answer(done);
        });
}

/// Answers once, when all have started again or one could not.
void Scenarios::restart(const Slots& slots, const json& action, const std::string& by,
                        const Answer<twin::Done>& answer) {
    const auto left = std::make_shared<std::size_t>(slots.size());
    for (Slot* slot : slots) {
        change(*slot, action, by, [left, answer](Result<twin::Done> done) {
            if (*left == 0 || (done && --*left > 0)) return;
            *left = 0;
            answer(std::move(done));
        });
    }
}

Result<twin::Done> Scenarios::give_name(Slot& slot, const json& action) {
    const auto name = action.find("name");
    if (name == action.end() || !name->is_string()) return Error{"name_scenario needs the key name, a string"};
    slot.title = tidy_name(name->get<std::string>(), longest_title);
    tell_setup(index_of(slot));
    return twin::Done{fmt::format("scenario {} is named \"{}\"", name_of(index_of(slot)), slot.title), ""};
}

void Scenarios::act(int index, const json& action, const std::string& by, const Answer<twin::Done>& answer) {
    const auto named = action.is_object() ? action.find("action") : action.end();
    if (!action.is_object() || named == action.end() || !named->is_string()) {
        answer(Error{"an action is a JSON object with the key action, a string"});
        return;
    }
    const std::string name = named->get<std::string>();
    Slot& slot = slots_[static_cast<std::size_t>(index)];
    if (name == "set_speed") return answer(set_speed(action));
    if (name == "name_scenario") return answer(give_name(slot, action));
    if (name == "cancel") return answer(cancel(slot));
    const bool drives = name == "run" || name == "pause" || name == "step";
    if (!drives && name != "restart") return change(slot, action, by, answer);
    const Result<Slots> slots = listed(action, drives ? all() : Slots{&slot});
    if (!slots) return answer(slots.error());
    if (drives) return answer(steer(name, *slots));
    json alone = action;
    alone.erase("scenarios");
    restart(*slots, alone, by, answer);
}

void Scenarios::copy(int from, const json& action, const std::string& by, const Answer<Copied>& answer) {
    const auto free_slot = [this] {
        return std::find_if(slots_.begin(), slots_.end(), [](const Slot& slot) { return !slot.scenario; });
    };
    const Error full{fmt::format("there are {} scenarios already, the most there can be; end one first", max_count)};
    if (free_slot() == slots_.end()) return answer(full);
    struct Made {
        std::shared_ptr<twin::Scenario> scenario;
        twin::Done done;
    };
    Slot& origin = slots_[static_cast<std::size_t>(from)];
    prepare<Made>(
        origin, "new scenario", false,
        [copying = origin.scenario->copying(), action, by](const sim::Progress& progress) -> Result<Made> {
            TALUS_ASSIGN(auto scenario, copying(progress));
            Made made{std::move(scenario), {}};
            if (action.is_null()) return made;
            TALUS_ASSIGN(const auto prepared, made.scenario->prepare(action, by, progress));
            made.done = made.scenario->commit(*prepared);
            return made;
        },
        [this, &origin, from, action, by, answer, free_slot, full](Result<Made> made) {
            const auto slot = free_slot();
            if (!made || slot == slots_.end()) return answer(made ? full : made.error());
            const std::string name = name_of(index_of(*slot));
            Copied copied{name, made->done};
            if (action.is_null()) copied.done.sentence = fmt::format("scenario {}, a copy of {}", name, name_of(from));
            *slot = Slot();
            slot->scenario = made->scenario;
            slot->running = !action.is_null() && origin.steps();
            tell_names();
            watcher_.done(index_of(*slot), by,
                          (action.is_null() ? "" : "new scenario from the start: ") + copied.done.sentence);
            answer(std::move(copied));
        });
}

Status Scenarios::remove(int index) {
    if (index == 0) return Error{"scenario A stays; the others can be ended"};
    const Slot ended = std::exchange(slots_[static_cast<std::size_t>(index)], Slot());
    for (const Waiting& change : ended.waiting) change.refuse(Error{"the scenario has ended"});
    start_clock();
    tell_names();
    return {};
}

json Scenarios::state(int index) const {
    const Slot& slot = slots_[static_cast<std::size_t>(index)];
    const bool steps = slot.steps();
    json state = slot.scenario->state_json(!steps);
    state["scenario"] = name_of(index);
    state["speed_factor"] = pace_.factor() ? json(*pace_.factor()) : json();
    state["real_time_factor"] = steps ? slot.rate.real_time_factor() : 0.0;
    state["steps_per_second"] = steps ? slot.rate.steps_per_second() : 0.0;
    if (slot.ready()) state["status"] = slot.running ? "running" : "paused";
    state["preparing"] = slot.job ? json{{"what", slot.job->what}, {"share", slot.job->share.load()}} : json();
    return state;
}

json Scenarios::setup(int index) const {
    json setup = slots_[static_cast<std::size_t>(index)].scenario->setup_json();
    setup["scenario"] = name_of(index);
    setup["name"] = slots_[static_cast<std::size_t>(index)].title;
    return setup;
}

twin::FramePtr Scenarios::frame(int index, unsigned stride) const {
    const Slot& slot = slots_[static_cast<std::size_t>(index)];
    return slot.scenario->frame(stride, slot.steps() ? twin::frame_running : 0);
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
    Slots going = all();
    std::erase_if(going, [](const Slot* slot) { return !slot->steps(); });
    if (Slot* behind = furthest_behind(going)) {
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

}  // namespace talus::serve
