#include "serve/mqtt_link.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "serve/access.hpp"
#include "serve/trigger_message.hpp"

#if TALUS_MQTT
#include <mosquitto.h>
#include <mqtt_protocol.h>
#endif

namespace talus::serve {

Result<MqttSettings> read_mqtt_address(const std::string& address, const std::string& topic, bool tls) {
    MqttSettings settings;
    const std::size_t colon = address.rfind(':');
    settings.host = address.substr(0, colon);
    settings.port = tls ? 8883 : 1883;
    if (colon != std::string::npos) {
        const char* end = address.data() + address.size();
        const auto read = std::from_chars(address.data() + colon + 1, end, settings.port);
        if (read.ec != std::errc() || read.ptr != end || settings.port < 1 || settings.port > 65535) settings.host = "";
    }
    if (settings.host.empty()) return Error{fmt::format("{}: must be HOST or HOST:PORT", address)};
    const bool plain = std::all_of(topic.begin(), topic.end(),
                                   [](unsigned char c) { return c >= 0x20 && c < 0x7f && c != '+' && c != '#'; });
    if (topic.empty() || topic.size() > 200 || !plain) {
        return Error{"the topic must have 1 to 200 printable characters of ASCII without + and #"};
    }
    settings.topic = topic;
    return settings;
}

#if TALUS_MQTT

constexpr int keep_alive = 30;  // s

struct MqttLink::Parts {
    MqttSettings settings;
    Listener listener;
    mosquitto* client = nullptr;
    std::mutex mutex;  // guards the next four
    std::condition_variable changed;
    bool connected = false, ending = false;
    std::map<int, int> acknowledged;  // messages, with the broker's reason: 0x80 and above refuse
    std::string failure;              // of the connection, as the library puts it; of the thread
    std::thread thread;

    [[nodiscard]] std::string listened() const { return settings.topic + "/trigger"; }
    [[nodiscard]] std::string published() const { return settings.topic + "/alarm"; }
    void set_connected(bool now, const std::string& why) {
        {
            const std::lock_guard lock(mutex);
            connected = now;
        }
        changed.notify_all();
        listener.state(now, why);
    }
    Status start();
    Status limit_packets();
    void set_callbacks();
    void run();
    /// Connects, and serves the connection until it breaks.
    int serve_once(bool first);
};

Status MqttLink::Parts::start() {
    static const int initialised = mosquitto_lib_init();
    TALUS_ASSIGN(const std::string token, random_token());
    client =
        initialised == MOSQ_ERR_SUCCESS ? mosquitto_new(("talus-" + token.substr(0, 12)).c_str(), true, this) : nullptr;
    if (client == nullptr) return Error{"libmosquitto cannot be used"};
    const auto refused = [&](const char* what, int code) {
        return Error{fmt::format("MQTT broker {}: {}: {}", settings.shown(), what, mosquitto_strerror(code))};
    };
    if (!settings.user.empty()) {
        const int code = mosquitto_username_pw_set(client, settings.user.c_str(), settings.password.c_str());
        if (code != MOSQ_ERR_SUCCESS) return refused("login", code);
    }
    if (!settings.authority.empty()) {
        const int code = mosquitto_tls_set(client, settings.authority.c_str(), nullptr, nullptr, nullptr, nullptr);
        if (code != MOSQ_ERR_SUCCESS) return refused("certificate authority", code);
    }
    TALUS_TRY(limit_packets());
    set_callbacks();
    mosquitto_threaded_set(client, true);  // publish() is called on another thread than the loop
    thread = std::thread([this] { run(); });
    return {};
}

/// The broker keeps larger messages back: the library would buffer them whole before it shows them. Needs MQTT 5.
Status MqttLink::Parts::limit_packets() {
    constexpr std::uint32_t largest_packet = largest_trigger_message + 1024;  // topic and header beside the message
    mosquitto_property* properties = nullptr;
    int code = mosquitto_int_option(client, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);
    if (code == MOSQ_ERR_SUCCESS) {
        code = mosquitto_property_add_int32(&properties, MQTT_PROP_MAXIMUM_PACKET_SIZE, largest_packet);
    }
    // A port that there is not: it keeps the properties for the connections to come, and makes none that would block.
    if (code == MOSQ_ERR_SUCCESS) {
        code = mosquitto_connect_bind_v5(client, settings.host.c_str(), -1, keep_alive, nullptr, properties);
        if (code == MOSQ_ERR_INVAL) code = MOSQ_ERR_SUCCESS;
    }
    mosquitto_property_free_all(&properties);
    if (code != MOSQ_ERR_SUCCESS) {
        return Error{fmt::format("MQTT broker {}: the size of messages cannot be limited: {}", settings.shown(),
                                 mosquitto_strerror(code))};
    }
    return {};
}

void MqttLink::Parts::set_callbacks() {
    mosquitto_connect_callback_set(client, [](mosquitto* c, void* self, int code) {
        auto& parts = *static_cast<Parts*>(self);
        if (code != 0) {
            // Brokers before MQTT 5 answer with 1.
            parts.failure = code == 1 || code == MQTT_RC_UNSUPPORTED_PROTOCOL_VERSION ? "it does not speak MQTT 5"
                                                                                      : mosquitto_reason_string(code);
            return;
        }
        mosquitto_subscribe(c, nullptr, parts.listened().c_str(), 1);
        parts.set_connected(true, "");
    });
    // The reason of a connection that fails on the way, such as a certificate that is not trusted, is only logged.
    mosquitto_log_callback_set(client, [](mosquitto*, void* self, int level, const char* text) {
        if (level == MOSQ_LOG_ERR) static_cast<Parts*>(self)->failure = text;
    });
    mosquitto_publish_v5_callback_set(client,
                                      [](mosquitto*, void* self, int id, int reason, const mosquitto_property*) {
                                          auto& parts = *static_cast<Parts*>(self);
                                          {
                                              const std::lock_guard lock(parts.mutex);
                                              parts.acknowledged[id] = reason;
                                          }
                                          parts.changed.notify_all();
                                      });
    mosquitto_message_callback_set(client, [](mosquitto*, void* self, const mosquitto_message* message) {
        // A retained message is of unknown age: it would start a run again each time this program connects.
        if (message->retain) return;
        const auto size =
            std::min<std::size_t>(static_cast<std::size_t>(message->payloadlen), largest_trigger_message + 1);
        static_cast<Parts*>(self)->listener.message({static_cast<const char*>(message->payload), size});
    });
}

int MqttLink::Parts::serve_once(bool first) {
    using std::chrono::steady_clock;
    constexpr int wait = 200;  // ms
    // Over TLS the library's loop does not notice that a connection was refused.
    const auto latest_answer = steady_clock::now() + settings.answer_limit;
    int code = first ? mosquitto_connect_async(client, settings.host.c_str(), settings.port, keep_alive)
                     : mosquitto_reconnect_async(client);
    while (code == MOSQ_ERR_SUCCESS) {
        {
            const std::lock_guard lock(mutex);
            if (ending) return code;
            if (!connected && steady_clock::now() > latest_answer) {
                if (failure.empty()) failure = "no answer";
                return MOSQ_ERR_CONN_LOST;
            }
        }
        code = mosquitto_loop(client, wait, 1);
    }
    return code;
}

/// The library's own thread gives up for good after some failures: a name that is not found for a moment, a certificate
/// that has expired and is renewed.
void MqttLink::Parts::run() {
    using std::chrono::seconds;
    constexpr seconds shortest_wait(1), longest_wait(30);
    seconds wait = shortest_wait;
    for (bool first = true;; first = false) {
        failure.clear();
        errno = 0;
        const int code = serve_once(first);
        const int system_code = errno;
        std::unique_lock lock(mutex);
        if (ending) return;
        wait = connected ? shortest_wait : std::min(2 * wait, longest_wait);
        lock.unlock();
        if (failure.empty()) {
            failure = code == MOSQ_ERR_ERRNO ? std::system_category().message(system_code) : mosquitto_strerror(code);
        }
        set_connected(false, failure);
        lock.lock();
        if (changed.wait_for(lock, wait, [this] { return ending; })) return;
    }
}

Result<std::unique_ptr<MqttLink>> MqttLink::open(const MqttSettings& settings, Listener listener) {
    auto parts = std::make_unique<Parts>();
    parts->settings = settings;
    parts->listener = std::move(listener);
    Parts& made = *parts;
    auto link = std::unique_ptr<MqttLink>(new MqttLink(std::move(parts)));
    TALUS_TRY(made.start());
    return link;
}

MqttLink::~MqttLink() {
    if (parts_->thread.joinable()) {
        {
            const std::lock_guard lock(parts_->mutex);
            parts_->ending = true;
        }
        parts_->changed.notify_all();
        mosquitto_disconnect(parts_->client);  // wakes the loop
        parts_->thread.join();
    }
    if (parts_->client != nullptr) mosquitto_destroy(parts_->client);
}

Status MqttLink::publish(const std::string& payload, std::chrono::milliseconds limit,
                         const std::function<bool()>& stop) {
    Parts& p = *parts_;
    const auto end = std::chrono::steady_clock::now() + limit;
    const auto wait_for = [&](std::unique_lock<std::mutex>& lock, const auto& reached) {
        while (!reached() && !stop() && std::chrono::steady_clock::now() < end) {
            p.changed.wait_for(lock, std::chrono::milliseconds(100));
        }
        return reached();
    };
    std::unique_lock lock(p.mutex);
    const std::string who = "MQTT broker " + p.settings.shown();
    if (!wait_for(lock, [&] { return p.connected; })) return Error{who + ": not connected"};
    lock.unlock();
    int id = 0;
    const int code = mosquitto_publish(p.client, &id, p.published().c_str(), static_cast<int>(payload.size()),
                                       payload.data(), 1, false);
    if (code != MOSQ_ERR_SUCCESS) return Error{who + ": " + mosquitto_strerror(code)};
    lock.lock();
    const bool there = wait_for(lock, [&] { return p.acknowledged.contains(id); });
    const int reason = there ? p.acknowledged[id] : 0;
    p.acknowledged.erase(id);
    if (reason >= MQTT_RC_UNSPECIFIED) return Error{fmt::format("{}: {}", who, mosquitto_reason_string(reason))};
    return there ? Status() : Error{who + ": has not acknowledged the message"};
}

#else

struct MqttLink::Parts {};

Result<std::unique_ptr<MqttLink>> MqttLink::open(const MqttSettings&, Listener) {
    return Error{"this program was built without libmosquitto, so it has no MQTT"};
}

MqttLink::~MqttLink() = default;

Status MqttLink::publish(const std::string&, std::chrono::milliseconds, const std::function<bool()>&) {
    return Error{"no MQTT"};
}

#endif

MqttLink::MqttLink(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

}  // namespace talus::serve
