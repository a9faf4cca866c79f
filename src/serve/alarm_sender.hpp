#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "serve/executor.hpp"
#include "serve/mqtt_link.hpp"
#include "serve/webhook.hpp"

namespace talus::serve {

/// Delivers messages to a webhook and a broker, each with a bounded number of tries. Each receiver has a lane of its
/// own, so that nothing waits for a receiver, and none for another.
class AlarmSender {
  public:
    struct Settings {
        std::optional<WebhookTarget> webhook;
        std::vector<std::chrono::milliseconds> waits{std::chrono::seconds(2),
                                                     std::chrono::seconds(10)};  ///< between tries
        std::chrono::milliseconds limit{10000};                                  ///< of a try
    };
    /// `link`: none for nullptr; it must outlive this.
    AlarmSender(Executor& executor, Settings settings, MqttLink* link);
    /// Ends the tries that go on; what waits is discarded.
    ~AlarmSender() { stop_ = true; }

    /// The receivers by their number: "hooks.example.org:443", "MQTT".
    [[nodiscard]] std::vector<std::string> receivers() const;
    struct Outcome {
        std::size_t receiver = 0;
        bool reached = false;
        std::string sentence;
        std::size_t waiting = 0;  ///< messages for the same receiver that were sent later
    };
    /// `told`: once for each receiver, from another thread or before this returns. A queue that is full keeps the
    /// oldest messages.
    void send(const std::string& json, const std::function<void(const Outcome&)>& told);
    /// Messages that wait for a receiver, beside the one that is on its way.
    [[nodiscard]] std::size_t waiting(std::size_t receiver) const { return queues_[receiver]->waiting; }

    static constexpr std::size_t most_waiting = 100;

  private:
    struct Queue {
        explicit Queue(Executor& executor) : lane(executor, "alarms") {}
        std::string name;
        std::function<Status(const std::string& json)> deliver;  ///< a try
        std::atomic<std::size_t> waiting = 0;
        Lane lane;  // ends first
    };

    [[nodiscard]] Status repeat(const std::function<Status()>& attempt) const;
    /// False: the program ends.
    [[nodiscard]] bool rest(std::chrono::milliseconds time) const;

    Settings settings_;
    std::atomic<bool> stop_ = false;
    const std::function<bool()> stopped_ = [this] { return stop_.load(); };
    std::vector<std::unique_ptr<Queue>> queues_;  // end first
};

}  // namespace talus::serve
