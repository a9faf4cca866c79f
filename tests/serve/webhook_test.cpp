#include "serve/webhook.hpp"

#include <array>
#include <atomic>
#include <mutex>
#include <poll.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>

#include "serve/alerts_fixture.hpp"
#include "serve/mqtt_link.hpp"

namespace talus::test {
namespace {

using ::testing::HasSubstr;

/// Takes posts and answers each with a status: 200 after the first `failures` ones, which get 503.
class Receiver {
  public:
    explicit Receiver(int failures = 0)
        : file_(listen_anywhere(port_)), failures_(failures), thread_([this] { run(); }) {}
    ~Receiver() {
        stop_ = true;
        thread_.join();
        close(file_);
    }
    [[nodiscard]] std::uint16_t port() const { return port_; }
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
    void run() {
        while (!stop_) {
            pollfd waiting{file_, POLLIN, 0};
            if (poll(&waiting, 1, 50) <= 0) continue;
            const int client = accept(file_, nullptr, nullptr);
            std::string request;
            std::array<char, 4096> piece{};
            while (request.empty() || request.back() != '}') {
                const ssize_t got = recv(client, piece.data(), piece.size(), 0);
                if (got <= 0) break;
                request.append(piece.data(), static_cast<std::size_t>(got));
            }
            std::size_t count = 0;
            {
                const std::lock_guard lock(mutex_);
                requests_.push_back(request);
                count = requests_.size();
            }
            const std::string answer = std::string("HTTP/1.1 ") +
                                       (count > static_cast<std::size_t>(failures_) ? "200 OK" : "503 Busy") +
                                       "\r\nContent-Length: 0\r\nConnection: close\r\n\r\n";
            (void)!send(client, answer.data(), answer.size(), MSG_NOSIGNAL);
            close(client);
        }
    }

    std::uint16_t port_ = 0;
    int file_, failures_;
    std::atomic<bool> stop_ = false;
    mutable std::mutex mutex_;
    std::vector<std::string> requests_;
    std::thread thread_;
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

TEST_F(AlertsTest, an_address_that_cannot_be_used_is_refused_without_repeating_it) {
    for (const char* text : {"", "ftp://secret/", "https://", "http://user:secret@host/", "http://host:port/secret",
                             "http://host/sec ret", "http://host:1234567/secret"}) {
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
