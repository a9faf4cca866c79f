#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "messages/messages.hpp"
#include "params/spec.hpp"
#include "serve/alarm_sender.hpp"
#include "serve/mqtt_link.hpp"
#include "serve/session.hpp"
#include "serve/trigger_message.hpp"
#include "session/scenarios.hpp"

namespace talus::serve {

struct AlertSettings {
    bool http = false;  ///< there is a token of triggers
    std::optional<MqttSettings> mqtt;
    AlarmSender::Settings sender;
    bool all_runs = false;                             ///< alarms of runs that people started are sent, too
    std::function<void(const std::string&)> log = {};  ///< from the server's thread
};

/// Triggers and alarms of a session (docs/triggers.md): takes messages, starts runs and feeds their gauges, sends
/// alarms, and tells everybody. For the server's thread.
class Alerts {
  public:
    /// Of `settings` only what the scene has triggers or alarms for is used.
    Alerts(Session& session, std::shared_ptr<const scene::Scene> scene, AlertSettings settings);
    Alerts(const Alerts&) = delete;
    Alerts& operator=(const Alerts&) = delete;

    /// Once the session is open. Errors: as MqttLink::open.
    [[nodiscard]] Status open();
    /// Ends the threads.
    void close();

    /// A message that came over `source`, "HTTP" or "MQTT". The answer is `{"done", "scenario", "started"}`; errors:
    /// 400 for the message, 409 for what is not possible now, 429 for too many.
    void take(const std::string& text, const std::string& source, const Respond& respond);
    /// The triggers of the first scenario, as its setup has them.
    void follow_triggers(std::vector<twin::TableEntry> triggers);
    /// As `GET /api/alerts`.
    [[nodiscard]] messages::Alerts describe() const;

  private:
    /// The run of a trigger, for the loop's thread.
    struct Run {
        bool starting = false;
        bool armed = true;  ///< a gauge may start it: it has been low since the last run
        WallTime began{};   ///< time 0
    };
    using Runs = std::map<std::string, Run>;
    struct Told {  // NOLINT(bugprone-exception-escape): moving JSON does not throw
        RunAlerts alerts;
        std::optional<messages::GaugeValue> reading;               // the last one
        std::map<std::size_t, std::string> raised_at, delivery;    // by alarm; the latter if there is one sentence
        std::map<std::size_t, std::vector<std::string>> outcomes;  // of each receiver, by alarm; empty: not known yet
        std::uint64_t generation = 0;                              // of the run: what is delivered later belongs to it
    };
    struct Job {
        TriggerMessage message;
        std::string source, received_at;
    };
    struct Refused {
        int status;
        std::string sentence;
    };
    using Answered = std::function<void(const std::variant<messages::TriggerAnswer, Refused>& answer)>;

    static void decide(Scenarios& all, Runs& runs, const Job& job, const Answered& answered);
    static void decide(Scenarios& all, Runs& runs, const Job& job, const params::TriggerSpec& trigger,
                       const Answered& answered);
    static void start(Scenarios& all, Run& run, const Job& job, const Answered& answered);
    static void feed(Scenarios& all, int index, const Run& run, const Job& job, const Answered& answered);
    [[nodiscard]] bool listens() const { return !triggers_.empty() && (settings_.http || settings_.mqtt); }
    void reserve();
    [[nodiscard]] bool too_many();
    void refuse(int status, const std::string& sentence, const std::string& source, const Respond& respond);
    void note(const std::string& sentence);
    void follow(int scenario, const RunAlerts& alerts);
    void send(int scenario, std::size_t number);
    void follow_queue(std::size_t receiver, std::size_t waiting);
    [[nodiscard]] messages::RaisedAlarm raised(int scenario, const Told& told, std::size_t number) const;
    [[nodiscard]] std::string delivery_of(const Told& told, std::size_t alarm) const;
    void tell();

    Session& session_;
    std::shared_ptr<const scene::Scene> scene_;
    AlertSettings settings_;
    std::shared_ptr<Runs> runs_ = std::make_shared<Runs>();  // for the loop's thread alone

    std::vector<twin::TableEntry> triggers_;  // of the first scenario
    bool reserved_ = false;                   // a place for their runs
    std::map<int, Told> told_;                // by scenario
    std::vector<bool> behind_;                // receivers, which somebody has been told of
    std::uint64_t generations_ = 0;
    std::deque<messages::AlertNote> notes_;  // the newest last
    std::string mqtt_state_;
    double allowance_ = most_at_once;
    std::chrono::steady_clock::time_point refilled_ = std::chrono::steady_clock::now();
    static constexpr double most_at_once = 20, per_second = 5;
    static constexpr std::size_t most_notes = 20;

    std::unique_ptr<MqttLink> link_;
    std::unique_ptr<AlarmSender> sender_;  // ends first
};

}  // namespace talus::serve
