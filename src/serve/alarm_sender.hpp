#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "serve/mqtt_link.hpp"
#include "serve/webhook.hpp"
#include "serve/worker.hpp"

namespace talus::serve {

/// Delivers messages to a webhook and a broker on a thread of its own, each with a bounded number of tries, so that
/// nothing waits for a receiver.
class AlarmSender {
  public:
    struct Settings {
        std::optional<WebhookTarget> webhook;
        std::vector<std::chrono::milliseconds> waits{std::chrono::seconds(2),
                                                     std::chrono::seconds(10)};  ///< between tries
        std::chrono::milliseconds limit{10000};                                  ///< of a try
    };
    /// `link`: none for nullptr; it must outlive this.
    AlarmSender(Settings settings, MqttLink* link) : settings_(std::move(settings)), link_(link) {}
    /// Ends the try that goes on; what waits is discarded.
    ~AlarmSender() { stop_ = true; }

    /// Whether there is anybody to tell.
    [[nodiscard]] bool has_receiver() const { return settings_.webhook || link_ != nullptr; }
    /// `told`: an outcome in words, and whether it reached every receiver; from another thread.
    void send(std::string json, std::function<void(bool reached, const std::string& outcome)> told);

  private:
    [[nodiscard]] Status repeat(const std::function<Status()>& attempt);
    /// False: the program ends.
    [[nodiscard]] bool rest(std::chrono::milliseconds time) const;

    static constexpr std::size_t most_waiting = 100;
    Settings settings_;
    MqttLink* link_;
    std::atomic<bool> stop_ = false;
    std::atomic<std::size_t> waiting_ = 0;
    Worker worker_{"alarms"};  // ends first
};

}  // namespace talus::serve
