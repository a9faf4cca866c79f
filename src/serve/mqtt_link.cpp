#include "serve/mqtt_link.hpp"

#include <algorithm>
#include <charconv>
#include <condition_variable>
#include <mutex>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "serve/access.hpp"
#include "serve/trigger_message.hpp"

#if TALUS_MQTT
#include <mosquitto.h>
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

struct MqttLink::Parts {
    MqttSettings settings;
    Listener listener;
    mosquitto* client = nullptr;
    std::mutex mutex;  // guards the next three
    std::condition_variable changed;
    bool connected = false;
    std::set<int> acknowledged;

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
    mosquitto_reconnect_delay_set(client, 1, 30, true);
    mosquitto_connect_callback_set(client, [](mosquitto* c, void* self, int code) {
        auto& parts = *static_cast<Parts*>(self);
        if (code == 0) mosquitto_subscribe(c, nullptr, parts.listened().c_str(), 1);
        parts.set_connected(code == 0, code == 0 ? "" : mosquitto_connack_string(code));
    });
    mosquitto_disconnect_callback_set(client, [](mosquitto*, void* self, int code) {
        static_cast<Parts*>(self)->set_connected(false, code == 0 ? "closed" : mosquitto_strerror(code));
    });
    mosquitto_publish_callback_set(client, [](mosquitto*, void* self, int id) {
        auto& parts = *static_cast<Parts*>(self);
        {
            const std::lock_guard lock(parts.mutex);
            parts.acknowledged.insert(id);
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
    constexpr int keep_alive = 30;  // s
    const int code = mosquitto_connect_async(client, settings.host.c_str(), settings.port, keep_alive);
    // A broker that cannot be reached now is tried again by the thread.
    if (code == MOSQ_ERR_INVAL) return refused("connecting", code);
    const int begun = mosquitto_loop_start(client);
    return begun == MOSQ_ERR_SUCCESS ? Status() : refused("starting", begun);
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
    if (parts_->client == nullptr) return;
    mosquitto_disconnect(parts_->client);
    mosquitto_loop_stop(parts_->client, true);
    mosquitto_destroy(parts_->client);
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
    p.acknowledged.erase(id);
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
