#include "serve/webhook.hpp"

#include <array>
#include <atomic>
#include <csignal>
#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
#include <openssl/ssl.h>
#include <optional>
#include <poll.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>

#include "core/temporary_folder.hpp"
#include "serve/alarm_sender.hpp"
#include "serve/alerts_fixture.hpp"
#include "serve/certificate.hpp"
#include "serve/mqtt_link.hpp"

namespace talus::test {
namespace {

using ::testing::HasSubstr;

/// Takes connections one after the other, on a thread of its own.
class Listener {
  public:
    /// `serve`: is given each of them.
    explicit Listener(std::function<void(int client)> serve)
        : file_(listen_anywhere(port_)), serve_(std::move(serve)), thread_([this] { run(); }) {}
    ~Listener() {
        stop_ = true;
        thread_.join();
        close(file_);
    }
    [[nodiscard]] std::uint16_t port() const { return port_; }

  private:
    void run() {
        while (!stop_) {
            pollfd waiting{file_, POLLIN, 0};
            if (poll(&waiting, 1, 50) <= 0) continue;
            const int client = accept(file_, nullptr, nullptr);
            serve_(client);
            close(client);
        }
    }

    std::uint16_t port_ = 0;
    int file_;
    std::function<void(int client)> serve_;
    std::atomic<bool> stop_ = false;
    std::thread thread_;
};

/// A request, up to the end of its JSON. `receive(room, size)`: the bytes that came, 0 or less at the end.
template <class Receive>
std::string read_request(const Receive& receive) {
    std::string request;
    std::array<char, 4096> piece{};
    while (request.empty() || request.back() != '}') {
        const auto got = receive(piece.data(), piece.size());
        if (got <= 0) break;
        request.append(piece.data(), static_cast<std::size_t>(got));
    }
    return request;
}

std::string answer_with(const char* status) {
    return fmt::format("HTTP/1.1 {}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n", status);
}

/// Takes posts and answers each with a status: 200 after the first `failures` ones, which get 503.
class Receiver {
  public:
    explicit Receiver(int failures = 0) : failures_(failures) {}
    [[nodiscard]] std::uint16_t port() const { return listener_.port(); }
    [[nodiscard]] std::vector<std::string> requests() const {
        const std::lock_guard lock(mutex_);
        return requests_;
    }
    /// The bodies that were answered with 200.
    [[nodiscard]] std::vector<json> taken() const {
        const std::lock_guard lock(mutex_);
        std::vector<json> bodies;
        for (std::size_t k = static_cast<std::size_t>(failures_); k < requests_.size(); ++k) {
            bodies.push_back(json::parse(requests_[k].substr(requests_[k].find("\r\n\r\n") + 4)));
        }
        return bodies;
    }

  private:
    void serve(int client) {
        const std::string request =
            read_request([&](char* room, std::size_t size) { return recv(client, room, size, 0); });
        std::size_t count = 0;
        {
            const std::lock_guard lock(mutex_);
            requests_.push_back(request);
            count = requests_.size();
        }
        const std::string answer = answer_with(count > static_cast<std::size_t>(failures_) ? "200 OK" : "503 Busy");
        (void)!send(client, answer.data(), answer.size(), MSG_NOSIGNAL);
    }

    int failures_;
    mutable std::mutex mutex_;
    std::vector<std::string> requests_;
    Listener listener_{[this](int client) { serve(client); }};
};

TEST_F(AlertsTest, an_alarm_is_posted_once_with_the_hash_of_the_run_and_is_tried_again) {
    Receiver receiver(1);
    serve::AlertSettings settings;
    settings.sender.webhook = *serve::read_webhook(
        fmt::format("http://127.0.0.1:{}/hooks/secret-path\nBearer secret-of-hook\n", receiver.port()));
    serve_with(std::move(settings));
    act({{"action", "set_speed"}, {"factor", nullptr}});
    // A run of people raises the alarm, and nobody is told.
    act({{"action", "run"}});
    ASSERT_TRUE(eventually([&] { return !alerts()["alarms"].empty(); }));
    EXPECT_THAT(alerts()["alarms"][0]["delivery"].get<std::string>(), HasSubstr("no trigger started this run"));
    ASSERT_EQ(as_trigger().post("/api/trigger", {{"trigger", "slope"}}).status, 200);
    ASSERT_TRUE(eventually([&] { return !receiver.taken().empty(); }));
    const json body = receiver.taken()[0];
    EXPECT_EQ(body["alarm"], "moving");
    EXPECT_EQ(body["message"], "Clear the road.");
    EXPECT_EQ(body["scenario"], "B");
    EXPECT_EQ(body["trigger"], "slope");
    EXPECT_GT(body["time_s"], 0);
    EXPECT_EQ(body["hash"].get<std::string>().size(), 16U);
    EXPECT_TRUE(body.contains("expected_s") && body.contains("raised_at") && body.contains("step"));
    const std::string request = receiver.requests()[0];
    EXPECT_THAT(request, HasSubstr("POST /hooks/secret-path HTTP/1.1"));
    EXPECT_THAT(request, HasSubstr("Authorization: Bearer secret-of-hook"));
    ASSERT_TRUE(eventually([&] {
        const json rows = alerts()["alarms"];
        return rows.size() == 2 && rows[1]["delivery"].get<std::string>().find("sent to 127.0.0.1") == 0;
    }));
    // Once: it goes on, and no other message comes.
    const double reached = state("B")["time_s"];
    eventually([&] { return state("B")["time_s"] > reached + 2 || state("B")["status"] != "running"; });
    EXPECT_EQ(receiver.requests().size(), 2U);  // a failure and the delivery
    EXPECT_EQ(alerts().dump().find("secret"), std::string::npos);
    EXPECT_EQ(log().find("secret"), std::string::npos);
}

TEST_F(AlertsTest, a_receiver_that_does_not_answer_holds_nothing_up_and_is_told_of) {
    std::uint16_t closed = 0, silent = 0;
    close(listen_anywhere(closed));
    const int waits = listen_anywhere(silent);  // takes connections and says nothing
    const auto limit = Milliseconds(300);
    const auto target = [](std::uint16_t to) { return *serve::read_webhook(fmt::format("http://127.0.0.1:{}/", to)); };
    const auto never = [] { return false; };
    EXPECT_THAT(serve::post_webhook(target(closed), "{}", limit, never).error().message, HasSubstr("connecting"));
    EXPECT_THAT(serve::post_webhook(target(silent), "{}", limit, never).error().message, HasSubstr("took too long"));
    serve::AlertSettings settings;
    settings.sender.webhook = target(closed);
    settings.sender.limit = limit;
    serve_with(std::move(settings));
    act({{"action", "set_speed"}, {"factor", nullptr}});
    ASSERT_EQ(as_trigger().post("/api/trigger", {{"trigger", "slope"}}).status, 200);
    ASSERT_TRUE(eventually([&] {
        const json rows = alerts()["alarms"];
        return rows.size() == 1 && rows[0]["delivery"].get<std::string>().find("not delivered") == 0;
    })) << alerts().dump();
    EXPECT_THAT(log(), HasSubstr("tried 3 times"));
    EXPECT_NE(state("B")["status"], "fault");
    close(waits);
}

/// Alarms with a webhook that answers and a broker that is not there.
class QueuesTest : public AlertsTest {
  protected:
    static serve::MqttSettings dead_broker() {
        std::uint16_t closed = 0;
        close(listen_anywhere(closed));
        return *serve::read_mqtt_address(fmt::format("127.0.0.1:{}", closed), "valley", false);
    }
    static serve::AlarmSender::Settings sender_to(std::uint16_t port) {
        serve::AlarmSender::Settings settings;
        settings.webhook = *serve::read_webhook(fmt::format("http://127.0.0.1:{}/", port));
        settings.limit = std::chrono::minutes(10);
        return settings;
    }
};

TEST_F(QueuesTest, a_receiver_waits_for_no_other_and_its_queue_keeps_the_oldest) {
    auto link = serve::MqttLink::open(dead_broker(), {[](const std::string&) {}, [](bool, const std::string&) {}});
    if (!link) GTEST_SKIP() << link.error().message;
    Receiver receiver;
    std::mutex mutex;
    std::vector<serve::AlarmSender::Outcome> told;
    const auto outcomes = [&](std::size_t of) {
        const std::lock_guard lock(mutex);
        std::vector<std::string> sentences;
        for (const auto& outcome : told) {
            if (outcome.receiver == of) sentences.push_back(outcome.sentence);
        }
        return sentences;
    };
    serve::Executor executor;
    serve::AlarmSender sender(executor, sender_to(receiver.port()), link->get());
    ASSERT_EQ(sender.receivers().size(), 2U);
    const auto send = [&](int k) {
        sender.send(json{{"alarm", k}}.dump(), [&](const serve::AlarmSender::Outcome& outcome) {
            const std::lock_guard lock(mutex);
            told.push_back(outcome);
        });
    };
    send(0);
    ASSERT_TRUE(eventually([&] { return sender.waiting(1) == 0 && outcomes(0).size() == 1; }));
    const int most = static_cast<int>(serve::AlarmSender::most_waiting);
    for (int k = 1; k <= most + 1; ++k) {
        send(k);
        ASSERT_TRUE(eventually([&] { return static_cast<int>(outcomes(0).size()) == k + 1; })) << "all are posted";
    }
    EXPECT_EQ(receiver.taken().size(), static_cast<std::size_t>(most) + 2);
    EXPECT_EQ(sender.waiting(1), static_cast<std::size_t>(most));
    EXPECT_EQ(outcomes(1), std::vector<std::string>{"not sent to MQTT: 100 messages wait already"}) << "the newest";
}

TEST_F(QueuesTest, a_receiver_that_is_behind_is_told_of) {
    std::ofstream file(scene_.scene_file(), std::ios::app);
    for (int k = 1; k < 5; ++k) {
        file << "\n[[alarm]]\nname = \"moving " << k << "\"\nchainage_m = 30\ndistance_m = " << 20 - k << "\n";
    }
    file.close();
    Receiver receiver;
    serve::AlertSettings settings;
    settings.mqtt = dead_broker();
    settings.sender = sender_to(receiver.port());
    serve_with(std::move(settings));
    if (!server_) GTEST_SKIP() << "built without MQTT";
    act({{"action", "set_speed"}, {"factor", nullptr}});
    ASSERT_EQ(as_trigger().post("/api/trigger", {{"trigger", "slope"}}).status, 200);
    ASSERT_TRUE(eventually([&] { return receiver.taken().size() == 5; })) << alerts().dump();
    ASSERT_TRUE(eventually([&] {
        return alerts()["notes"].dump().find("MQTT is behind: 3 alarms wait for it") != std::string::npos;
    })) << alerts().dump();
    EXPECT_THAT(alerts()["alarms"][0]["delivery"].get<std::string>(),
                ::testing::MatchesRegex("sent to 127.0.0.1:[0-9]+; is being sent to MQTT"));
}

/// Takes posts over TLS and answers them with 200.
class TlsReceiver {
  public:
    explicit TlsReceiver(const Pair& pair) {
        BIO *certificate = BIO_new_mem_buf(pair.certificate.data(), static_cast<int>(pair.certificate.size())),
            *key = BIO_new_mem_buf(pair.key.data(), static_cast<int>(pair.key.size()));
        X509* read = PEM_read_bio_X509(certificate, nullptr, nullptr, nullptr);
        EVP_PKEY* secret = PEM_read_bio_PrivateKey(key, nullptr, nullptr, nullptr);
        SSL_CTX_use_certificate(context_.get(), read);
        SSL_CTX_use_PrivateKey(context_.get(), secret);
        X509_free(read);
        EVP_PKEY_free(secret);
        BIO_free(certificate);
        BIO_free(key);
        listener_.emplace([this](int client) { serve(client); });
    }
    [[nodiscard]] std::uint16_t port() const { return listener_->port(); }
    [[nodiscard]] std::string request() {
        const std::lock_guard lock(mutex_);
        return request_;
    }

  private:
    void serve(int client) {
        SSL* session = SSL_new(context_.get());
        SSL_set_fd(session, client);
        if (SSL_accept(session) == 1) {
            const std::string request = read_request(
                [&](char* room, std::size_t size) { return SSL_read(session, room, static_cast<int>(size)); });
            const std::string answer = answer_with("200 OK");
            SSL_write(session, answer.data(), static_cast<int>(answer.size()));
            const std::lock_guard lock(mutex_);
            request_ = request;
        }
        SSL_free(session);
    }

    std::unique_ptr<SSL_CTX, void (*)(SSL_CTX*)> context_{SSL_CTX_new(TLS_server_method()), SSL_CTX_free};
    std::mutex mutex_;
    std::string request_;
    std::optional<Listener> listener_;
};

TEST(Webhook, goes_over_tls_only_to_a_host_whose_certificate_is_valid) {
    std::signal(SIGPIPE, SIG_IGN);  // of the receiver, which is hung up on
    const Pair trusted = self_signed("DNS:localhost"), other = self_signed("DNS:elsewhere.example");
    const TemporaryFolder folder;
    const std::string authorities = (folder.path() / "authorities").string();
    std::ofstream(authorities) << trusted.certificate << other.certificate;
    TlsReceiver receiver(trusted), elsewhere(other), stranger(self_signed("DNS:localhost"));
    const auto post = [](const TlsReceiver& to) {
        const auto target = *serve::read_webhook(fmt::format("https://localhost:{}/hook\nBearer token\n", to.port()));
        return serve::post_webhook(target, "{\"alarm\": 1}", Milliseconds(20000), [] { return false; });
    };
    ASSERT_EQ(setenv("SSL_CERT_FILE", authorities.c_str(), 1), 0);  // where OpenSSL looks for authorities
    const Status sent = post(receiver), to_another_host = post(elsewhere), to_a_stranger = post(stranger);
    unsetenv("SSL_CERT_FILE");
    ASSERT_TRUE(sent) << sent.error().message;
    EXPECT_THAT(receiver.request(), HasSubstr("POST /hook HTTP/1.1"));
    EXPECT_THAT(receiver.request(), HasSubstr("{\"alarm\": 1}"));
    for (const Status& refused : {to_another_host, to_a_stranger}) {
        ASSERT_FALSE(refused);
        EXPECT_THAT(refused.error().message, HasSubstr("the certificate"));
    }
    EXPECT_EQ(elsewhere.request() + stranger.request(), "");
}

TEST_F(AlertsTest, an_address_that_cannot_be_used_is_refused_without_repeating_it) {
    for (const char* text : {"", "ftp://secret/", "https://", "http://user:secret@host/", "http://host:port/secret",
                             "http://host/sec ret", "http://host:1234567/secret", "http://host:0/secret",
                             "http://host:99999/secret", "http://host:65536/", "http://host:1.5/", "http://host:/"}) {
        const auto target = serve::read_webhook(text);
        ASSERT_FALSE(target) << text;
        EXPECT_EQ(target.error().message.find("secret"), std::string::npos) << target.error().message;
    }
    const auto target = serve::read_webhook("https://[::1]/a?b=c");
    ASSERT_TRUE(target);
    EXPECT_EQ(target->host, "::1");
    EXPECT_EQ(target->port, "443");
    EXPECT_EQ(target->path, "/a?b=c");
    EXPECT_FALSE(serve::read_mqtt_address("host:99999", "talus", false));
    EXPECT_FALSE(serve::read_mqtt_address(":1883", "talus", false));
    EXPECT_FALSE(serve::read_mqtt_address("host", "talus/#", false));
    EXPECT_EQ(serve::read_mqtt_address("host", "talus", true)->port, 8883);
}

}  // namespace
}  // namespace talus::test
