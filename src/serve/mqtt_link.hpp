#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "core/result.hpp"

namespace talus::serve {

/// Access to a broker.
struct MqttSettings {
    std::string host;
    int port = 1883;
    std::string topic = "talus";                    ///< listens to TOPIC/trigger, publishes to TOPIC/alarm
    std::string user, password;                     ///< empty: none
    std::string authority;                          ///< file of the certificate authority; empty: without TLS
    std::chrono::milliseconds answer_limit{10000};  ///< for a broker to accept the connection

    /// "broker.example.org:8883"
    [[nodiscard]] std::string shown() const { return host + ":" + std::to_string(port); }
};

/// A connection to a broker that is made again whenever it breaks. A build without libmosquitto has none.
class MqttLink {
  public:
    /// What it tells, from a thread of its own.
    struct Listener {
        std::function<void(const std::string& payload)> message;        ///< not one that the broker had retained
        std::function<void(bool connected, const std::string&)> state;  ///< and why not
    };
    /// Begins to connect. Errors: built without MQTT, a topic or an authority that cannot be used.
    [[nodiscard]] static Result<std::unique_ptr<MqttLink>> open(const MqttSettings& settings, Listener listener);
    /// Ends the thread.
    ~MqttLink();
    MqttLink(const MqttLink&) = delete;
    MqttLink& operator=(const MqttLink&) = delete;

    /// Publishes at quality of service 1 and waits until the broker has it. `stop` is asked ten times a second.
    [[nodiscard]] Status publish(const std::string& payload, std::chrono::milliseconds limit,
                                 const std::function<bool()>& stop);

  private:
    struct Parts;
    explicit MqttLink(std::unique_ptr<Parts> parts);
    std::unique_ptr<Parts> parts_;
};

/// Errors: not HOST or HOST:PORT, a topic with wildcards, longer than 200 bytes, or with control characters.
[[nodiscard]] Result<MqttSettings> read_mqtt_address(const std::string& address, const std::string& topic, bool tls);

}  // namespace talus::serve
