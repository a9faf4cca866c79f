#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "session/json_text.hpp"
#include "session/scenarios.hpp"
#include "twin/json_keys.hpp"
#include "twin/live_run.hpp"
#include "twin/trigger.hpp"

// What people do with scenarios.

namespace talus::session {
namespace {

using nlohmann::json;

constexpr double slowest = 0.05, fastest = 100;  // times real time
constexpr double time_tolerance = 0.05;          // s; closer in time than this, all take a single step
constexpr std::size_t longest_title = 60;

bool is_run_control(const std::string& name) {
    return name == "run" || name == "pause" || name == "step";
}

/// Of what does not change a run; a scenario looks at the keys of the others.
Status check_keys_of(const std::string& name, const json& action) {
    if (name == "set_speed") return twin::check_keys(action, {"action", "factor"});
    if (name == "name_scenario") return twin::check_keys(action, {"action", "name"});
    if (name == "cancel") return twin::check_keys(action, {"action"});
    return is_run_control(name) ? twin::check_keys(action, {"action", "scenarios"}) : Status();
}

}  // namespace

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

void Scenarios::step_all(const Slots& slots) {
    const double limit = furthest_behind(slots)->scenario->time() + time_tolerance;
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

Result<twin::Done> Scenarios::run_control(const std::string& name, const Slots& slots) {
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
        [this, &slot, scenario, action, by, answer](Result<Prepared> prepared) {
            if (prepared && slot.scenario != scenario) prepared = Error{"the scenario has ended"};
            if (!prepared) {
                answer(prepared.error());
                return;
            }
            const twin::Done done = scenario->commit(**prepared);
            tell_setup(index_of(slot));
            // A gauge speaks too often to be announced each time.
            if (action["action"] != "gauge") watcher_.done(index_of(slot), by, done.sentence);
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
    if (const Status known = check_keys_of(name, action); !known) return answer(known.error());
    if (name == "trigger" || name == "gauge") return answer(Error{name + ": comes with the token of triggers alone"});
    Slot& slot = slots_[static_cast<std::size_t>(index)];
    if (name == "set_speed") return answer(set_speed(action));
    if (name == "name_scenario") return answer(give_name(slot, action));
    if (name == "cancel") return answer(cancel(slot));
    if (!is_run_control(name) && name != "restart") return change(slot, action, by, answer);
    const Result<Slots> slots = listed(action, is_run_control(name) ? all() : Slots{&slot});
    if (!slots) return answer(slots.error());
    if (is_run_control(name)) return answer(run_control(name, *slots));
    json alone = action;
    alone.erase("scenarios");
    restart(*slots, alone, by, answer);
}

void Scenarios::copy(int from, const json& action, const std::string& by, const Answer<Copied>& answer) {
    const auto free_slot = [this] {
        const auto people = std::count_if(slots_.begin(), slots_.end(), [](const Slot& slot) {
            return slot.scenario && twin::started_by(*slot.scenario) == nullptr;
        });
        if (people >= max_count - reserved_) return slots_.end();
        return std::find_if(slots_.begin(), slots_.end(), [](const Slot& slot) { return !slot.scenario; });
    };
    const Error full{fmt::format("there are {} scenarios already, the most there can be{}; end one first",
                                 max_count - reserved_, reserved_ > 0 ? " beside one that a trigger starts" : "")};
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

std::optional<int> Scenarios::run_of(const std::string& trigger) const {
    for (int i = 0; i < max_count; ++i) {
        const Slot& slot = slots_[static_cast<std::size_t>(i)];
        const json* started = slot.scenario ? twin::started_by(*slot.scenario) : nullptr;
        if (started != nullptr && slot.ready() && (*started)["trigger"] == trigger) return i;
    }
    return {};
}

/// Best its own earlier run, then a free one, then that of another trigger; none that still goes on.
Scenarios::Slot* Scenarios::place_for(const std::string& trigger) {
    Slot* place = nullptr;
    int best = 0;
    for (Slot& slot : slots_) {
        const json* started = slot.scenario ? twin::started_by(*slot.scenario) : nullptr;
        const bool over = started != nullptr && !slot.ready() && !slot.job;
        const int fits = over && (*started)["trigger"] == trigger ? 3 : !slot.scenario ? 2 : over ? 1 : 0;
        if (fits <= best) continue;
        best = fits;
        place = &slot;
    }
    return place;
}

void Scenarios::start_by_trigger(const json& action, const std::string& by, const Answer<Copied>& answer) {
    struct Made {
        std::shared_ptr<twin::Scenario> scenario;
        twin::Done done;
    };
    const auto made = std::make_shared<Result<Made>>(Error{"the session ends"});
    const auto open = [opening = slots_[0].scenario->opening(), action, by]() -> Result<Made> {
        TALUS_ASSIGN(std::shared_ptr<twin::Scenario> scenario, opening({}));
        TALUS_ASSIGN(const auto prepared, scenario->prepare(action, by));
        twin::Done done = scenario->commit(*prepared);
        return Made{std::move(scenario), std::move(done)};
    };
    elsewhere_(
        [made, open](const std::atomic<bool>&) {
            try {
                *made = open();
            } catch (const std::exception& error) {
                *made = Error{fmt::format("trigger: {}", error.what())};
            }
        },
        [this, made, action, by, answer] {
            if (!*made) return answer(made->error());
            const std::string trigger = action["trigger"];
            Slot* place = place_for(trigger);
            if (place == nullptr) return answer(Error{"every place for a scenario is taken; end one first"});
            *place = Slot();
            place->scenario = (*made)->scenario;
            place->title = tidy_name(trigger, longest_title);
            place->running = true;
            // A gauge measures in real time.
            if (action.value("values", json::object()).contains("discharge_m3ps")) pace_.set_factor(1.0);
            start_clock();
            tell_names();
            tell_setup(index_of(*place));
            tell_alerts(index_of(*place));
            watcher_.done(index_of(*place), by, (*made)->done.sentence);
            answer(Copied{name_of(index_of(*place)), (*made)->done});
        });
}

void Scenarios::follow_gauge(int index, const json& action, const std::string& by, const Answer<twin::Done>& answer) {
    change(slots_[static_cast<std::size_t>(index)], action, by, answer);
}

void Scenarios::put(int index, std::unique_ptr<twin::Scenario> scenario, const std::string& title) {
    Slot& slot = slots_[static_cast<std::size_t>(index)];
    slot = Slot();
    slot.scenario = std::move(scenario);
    slot.title = title;
    slot.told_alarms = slot.scenario->run().alarms().size();  // of a saved session: nobody is warned of them again
    slot.told_trigger = twin::started_by(*slot.scenario) != nullptr;
    watcher_.alerts(index,
                    {slot.told_trigger ? *twin::started_by(*slot.scenario) : json(), slot.scenario->run().alarms(), 0});
    tell_names();
    start_clock();
}

Status Scenarios::remove(int index) {
    if (index == 0) return Error{"scenario A stays; the others can be ended"};
    const Slot ended = std::exchange(slots_[static_cast<std::size_t>(index)], Slot());
    for (const Waiting& change : ended.waiting) change.refuse(Error{"the scenario has ended"});
    watcher_.alerts(index, {});
    start_clock();
    tell_names();
    return {};
}

}  // namespace talus::session
