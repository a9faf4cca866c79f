#include "serve/alerts.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/hash.hpp"
#include "core/try.hpp"
#include "core/visible_text.hpp"
#include "twin/live_run.hpp"
#include "twin/table_entry.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;

std::string person_of(const std::string& trigger) {
    return fmt::format("trigger \"{}\"", trigger);
}

}  // namespace

Alerts::Alerts(Session& session, std::shared_ptr<const scene::Scene> scene, AlertSettings settings)
    : session_(session),
      scene_(std::move(scene)),
      settings_(std::move(settings)),
      triggers_(entries_of(scene_->spec, twin::TableKind::trigger)) {
    // A broker is for scenes whose file has something for it: nobody in the page makes the server connect to it.
    if (scene_->spec.triggers.empty() && scene_->spec.alarms.empty()) settings_.mqtt.reset();
    session_.on_alerts([this](int scenario, const RunAlerts& alerts) { follow(scenario, alerts); });
}

Status Alerts::open() {
    if (settings_.mqtt) mqtt_state_ = "connecting";
    tell();  // the listener's messages come on another thread
    if (settings_.mqtt) {
        const auto nobody = [](const Response&) {};
        MqttLink::Listener listener;
        listener.message = [this, nobody](const std::string& payload) {
            session_.post([this, nobody, payload] { take(payload, "MQTT", nobody); });
        };
        listener.state = [this](bool connected, const std::string& why) {
            session_.post([this, connected, why] {
                const std::string now = connected ? "connected" : "not connected: " + why;
                if (std::exchange(mqtt_state_, now) == now) return;
                note(fmt::format("MQTT broker {}: {}", settings_.mqtt->shown(), now));
            });
        };
        TALUS_ASSIGN(link_, MqttLink::open(*settings_.mqtt, std::move(listener)));
    }
    sender_ = std::make_unique<AlarmSender>(session_.executor(), settings_.sender, link_.get());
    behind_.assign(sender_->receivers().size(), false);
    reserve();
    return {};
}

/// Once: a place for runs of triggers is kept from then on.
void Alerts::reserve() {
    if (!listens() || std::exchange(reserved_, true)) return;
    session_.loop().post([](Scenarios& all) { all.reserve_for_triggers(); });
}

void Alerts::follow_triggers(std::vector<twin::TableEntry> triggers) {
    if (triggers == triggers_) return;
    triggers_ = std::move(triggers);
    reserve();
    tell();
}

void Alerts::close() {
    sender_.reset();
    link_.reset();
}

/// A bucket of messages that fills again with time.
bool Alerts::too_many() {
    const auto now = std::chrono::steady_clock::now();
    allowance_ =
        std::min(most_at_once, allowance_ + per_second * std::chrono::duration<double>(now - refilled_).count());
    refilled_ = now;
    if (allowance_ < 1) return true;
    allowance_ -= 1;
    return false;
}

void Alerts::refuse(int status, const std::string& sentence, const std::string& source, const Respond& respond) {
    note(fmt::format("message over {} refused: {}", source, sentence));
    respond(error_response(status, sentence));
}

void Alerts::note(const std::string& sentence) {
    notes_.push_back({.at = time_text(std::chrono::system_clock::now()), .sentence = sentence});
    if (notes_.size() > most_notes) notes_.pop_front();
    if (settings_.log) settings_.log(visible(sentence));
    tell();
}

void Alerts::tell() {
    session_.alerts(describe());
}

void Alerts::take(const std::string& text, const std::string& source, const Respond& respond) {
    if (triggers_.empty()) return respond(error_response(409, "the scene has no [[trigger]]"));
    if (!listens()) {
        return respond(error_response(409, "triggers are off; start the server with --trigger-token-file or --mqtt"));
    }
    if (too_many()) {  // not noted: notes of a flood would drive out all others
        return respond(
            error_response(429, fmt::format("more than {} messages per second; repeat it later", per_second)));
    }
    const WallTime now = std::chrono::system_clock::now();
    auto message = read_trigger_message(text, now);
    if (!message) return refuse(400, message.error().message, source, respond);
    Job job{std::move(*message), source, time_text(now)};
    const Answered answered = [this, source, respond, job](const auto& outcome) {
        session_.post([this, source, respond, job, outcome] {
            if (const auto* no = std::get_if<Refused>(&outcome))
                return refuse(no->status, no->sentence, source, respond);
            const auto& answer = std::get<messages::TriggerAnswer>(outcome);
            if (answer.scenario && job.message.discharge()) {
                told_[answer.scenario->front() - 'A'].reading = {.discharge_m3ps = *job.message.discharge(),
                                                                 .received_at = job.received_at};
            }
            // Values of a gauge come too often for a list.
            if (answer.started) {
                note(fmt::format("scenario {}: {}", *answer.scenario, answer.done));
            } else {
                tell();
            }
            respond(json_response(200, answer));
        });
    };
    session_.loop().post([runs = runs_, job, answered](Scenarios& all) { decide(all, *runs, job, answered); });
}

void Alerts::decide(Scenarios& all, Runs& runs, const Job& job, const Answered& answered) {
    const std::vector<params::TriggerSpec> triggers = twin::triggers_of(all.at(0).run().setup());
    const auto found = std::find_if(triggers.begin(), triggers.end(), [&](const params::TriggerSpec& trigger) {
        return trigger.name == job.message.trigger;
    });
    if (found != triggers.end()) return decide(all, runs, job, *found, answered);
    answered(Refused{400, fmt::format("trigger = \"{}\": there is no such trigger", job.message.trigger)});
}

void Alerts::decide(Scenarios& all, Runs& runs, const Job& job, const params::TriggerSpec& trigger,
                    const Answered& answered) {
    Run& run = runs[job.message.trigger];
    const auto index = all.run_of(job.message.trigger);
    const auto refused = [&](const std::string& sentence) { answered(Refused{409, sentence}); };
    const auto idle = [&](const std::string& sentence) {
        answered(messages::TriggerAnswer{.done = sentence, .scenario = {}, .started = false});
    };
    if (run.starting) return refused(fmt::format("the run of trigger \"{}\" is being prepared", job.message.trigger));
    if (index) {
        if (!job.message.is_reading()) {
            return refused(fmt::format("trigger \"{}\" runs already, as scenario {}; only discharge_m3ps can change it",
                                       job.message.trigger, Scenarios::name_of(*index)));
        }
        if (run.began == WallTime()) return refused("that run was opened from a file; it has no gauge");
        return feed(all, *index, run, job, answered);
    }
    if (const auto discharge = job.message.discharge(); discharge && *discharge >= 0) {
        if (*discharge <= trigger.start_discharge) {
            run.armed = true;
            return idle(fmt::format("{:.6g} m3/s does not start it; above {:.6g} m3/s does", *discharge,
                                    trigger.start_discharge));
        }
        if (!run.armed) {
            return idle(fmt::format("its last run is over; it starts again after a value of {:.6g} m3/s or less",
                                    trigger.start_discharge));
        }
    }
    start(all, run, job, answered);
}

void Alerts::start(Scenarios& all, Run& run, const Job& job, const Answered& answered) {
    if (!all.has_place(job.message.trigger)) {
        return answered(Refused{409, "every place for a scenario is taken; end one first"});
    }
    json action = {{"action", "trigger"},
                   {"trigger", job.message.trigger},
                   {"source", job.source},
                   {"received_at", job.received_at},
                   {"values", job.message.values}};
    if (!job.message.reason.empty()) action["reason"] = job.message.reason;
    run.starting = true;
    all.start_by_trigger(action, person_of(job.message.trigger), [&run, job, answered](const Result<Copied>& made) {
        run.starting = false;
        if (!made) return answered(Refused{400, made.error().message});
        run.began = job.message.time;
        run.armed = false;
        answered(messages::TriggerAnswer{.done = made->done.sentence, .scenario = made->name, .started = true});
    });
}

void Alerts::feed(Scenarios& all, int index, const Run& run, const Job& job, const Answered& answered) {
    const double time = std::chrono::duration<double>(job.message.time - run.began).count();
    const json action = {{"action", "gauge"},    {"trigger", job.message.trigger},
                         {"source", job.source}, {"received_at", job.received_at},
                         {"time_s", time},       {"discharge_m3ps", job.message.values["discharge_m3ps"]}};
    all.follow_gauge(index, action, person_of(job.message.trigger), [index, answered](const Result<twin::Done>& done) {
        if (!done) return answered(Refused{400, done.error().message});
        answered(
            messages::TriggerAnswer{.done = done->sentence, .scenario = Scenarios::name_of(index), .started = false});
    });
}

void Alerts::follow(int scenario, const RunAlerts& alerts) {
    const auto before = told_.find(scenario);
    if (alerts.trigger.is_null() && alerts.alarms.empty()) {
        if (before == told_.end()) return;
        told_.erase(before);
        return tell();
    }
    Told& told = told_[scenario];
    const std::size_t first = alerts.alarms.size() - alerts.news;
    if (first == 0) {
        std::optional<messages::GaugeValue> reading;
        if (told.alerts.trigger == alerts.trigger) reading = told.reading;
        told = Told();
        told.reading = std::move(reading);
        told.generation = ++generations_;
    }
    told.alerts = alerts;
    for (std::size_t k = first; k < alerts.alarms.size(); ++k) send(scenario, k);
    tell();
}

void Alerts::send(int scenario, std::size_t number) {
    Told& told = told_[scenario];
    const twin::RaisedAlarm& alarm = told.alerts.alarms[number];
    told.raised_at[number] = time_text(std::chrono::system_clock::now());
    if (settings_.log) {
        settings_.log(visible(
            fmt::format("alarm {} in scenario {}: {}", alarm.name, Scenarios::name_of(scenario), alarm.sentence)));
    }
    if (!sender_ || behind_.empty()) return;
    if (told.alerts.trigger.is_null() && !settings_.all_runs) {
        told.delivery[number] = "not sent: no trigger started this run";
        return;
    }
    json message = raised(scenario, told, number);
    message.erase("delivery");
    message["scene"] = scene_->spec.scene.title;
    message["trigger"] = told.alerts.trigger.is_null() ? json() : told.alerts.trigger["trigger"];
    told.outcomes[number].resize(behind_.size());
    sender_->send(message.dump(-1, ' ', false, json::error_handler_t::replace),
                  [this, scenario, number, generation = told.generation,
                   alarm = alarm.name](const AlarmSender::Outcome& outcome) {
                      session_.post([this, scenario, number, generation, alarm, outcome] {
                          const auto found = told_.find(scenario);
                          if (found != told_.end() && found->second.generation == generation) {
                              found->second.outcomes[number][outcome.receiver] = outcome.sentence;
                          }
                          if (!outcome.reached) note(fmt::format("alarm {}: {}", alarm, outcome.sentence));
                          follow_queue(outcome.receiver, outcome.waiting);
                          tell();
                      });
                  });
    for (std::size_t k = 0; k < behind_.size(); ++k) follow_queue(k, sender_->waiting(k));
}

/// Says once that a receiver is behind, and once that it is not any more.
void Alerts::follow_queue(std::size_t receiver, std::size_t waiting) {
    constexpr std::size_t many = 3;
    if (behind_[receiver] ? waiting > 0 : waiting < many) return;
    behind_[receiver] = !behind_[receiver];
    const std::string name = sender_->receivers()[receiver];
    note(behind_[receiver] ? fmt::format("{} is behind: {} alarms wait for it", name, waiting)
                           : fmt::format("{} is not behind any more", name));
}

std::string Alerts::delivery_of(const Told& told, std::size_t alarm) const {
    if (told.delivery.contains(alarm)) return told.delivery.at(alarm);
    const auto found = told.outcomes.find(alarm);
    if (found == told.outcomes.end()) return "";
    std::vector<std::string> parts;
    for (std::size_t k = 0; k < found->second.size(); ++k) {
        const std::string& outcome = found->second[k];
        parts.push_back(!outcome.empty() ? outcome : "is being sent to " + sender_->receivers()[k]);
    }
    return fmt::format("{}", fmt::join(parts, "; "));
}

messages::RaisedAlarm Alerts::raised(int scenario, const Told& told, std::size_t number) const {
    const twin::RaisedAlarm& alarm = told.alerts.alarms[number];
    const auto raised_at = told.raised_at.find(number);
    return {.scenario = Scenarios::name_of(scenario),
            .alarm = alarm.name,
            .sentence = alarm.sentence,
            .message = alarm.message,
            .time_s = alarm.time,
            .expected_s = alarm.expected,
            .step = alarm.step,
            .hash = to_hex(alarm.hash),
            .raised_at = raised_at != told.raised_at.end() ? std::optional(raised_at->second) : std::nullopt,
            .delivery = delivery_of(told, number)};
}

messages::Alerts Alerts::describe() const {
    messages::Alerts all{.listening = {.http = settings_.http && !triggers_.empty(), .mqtt = {}},
                         .triggers = {},
                         .runs = {},
                         .alarms = {},
                         .notes = {}};
    if (settings_.mqtt) all.listening.mqtt = mqtt_state_;
    for (const twin::TableEntry& trigger : triggers_) {
        json takes = json::object();
        const std::pair<const char*, const char*> limits[] = {{"volume_m3", "volume_limit_m3"},
                                                              {"pore_pressure_ratio", "pore_pressure_ratio_limit"},
                                                              {"discharge_m3ps", "discharge_limit_m3ps"}};
        for (const auto& [key, limit] : limits) {
            const auto most = trigger.values.find(limit);
            if (most != trigger.values.end()) takes[key] = std::get<double>(most->second);
        }
        all.triggers.push_back({.name = trigger.name(), .limits = std::move(takes)});
    }
    for (const auto& [scenario, told] : told_) {
        if (!told.alerts.trigger.is_null()) {
            const json& action = told.alerts.trigger;
            all.runs.push_back({.scenario = Scenarios::name_of(scenario),
                                .trigger = action["trigger"],
                                .source = action.value("source", ""),
                                .received_at = action.value("received_at", ""),
                                .reason = action.value("reason", ""),
                                .values = action.value("values", json::object()),
                                .reading = told.reading});
        }
        for (std::size_t k = 0; k < told.alerts.alarms.size(); ++k) all.alarms.push_back(raised(scenario, told, k));
    }
    all.notes = {notes_.begin(), notes_.end()};
    return all;
}

}  // namespace talus::serve
