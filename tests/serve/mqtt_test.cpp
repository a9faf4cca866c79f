#include <algorithm>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <mutex>
#include <optional>
#include <set>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>

#include "core/temporary_folder.hpp"
#include "serve/alerts_fixture.hpp"
#include "serve/certificate.hpp"
#include "serve/mqtt_link.hpp"

extern char** environ;

namespace talus::test {
namespace {

using ::testing::HasSubstr;

/// Debian's broker on a port of its own, and its clients. With a certificate connections use TLS.
class Broker {
  public:
    explicit Broker(std::optional<Pair> pair = {}) : tls_(pair) {
        close(listen_anywhere(port_));
        std::ofstream conf(file("mosquitto.conf"));
        conf << "listener " << port_ << " 127.0.0.1\nallow_anonymous false\npassword_file " << file("passwords")
             << "\nuser root\npersistence false\n";
        if (pair) {
            std::ofstream(file("certificate")) << pair->certificate;
            std::ofstream(file("key")) << pair->key;
            conf << "certfile " << file("certificate") << "\nkeyfile " << file("key") << "\n";
        }
        conf.close();
        std::ofstream(file("passwords")) << "";
        wait_for(begin({"/usr/bin/mosquitto_passwd", "-b", file("passwords"), user, password}));
        start();
    }
    ~Broker() { stop(); }
    void start() { broker_ = begin({"/usr/sbin/mosquitto", "-c", file("mosquitto.conf")}); }
    void stop() {
        if (broker_ > 0) kill(broker_, SIGTERM);
        wait_for(std::exchange(broker_, 0));
    }
    [[nodiscard]] static bool installed() {
        return access("/usr/sbin/mosquitto", X_OK) == 0 && access("/usr/bin/mosquitto_pub", X_OK) == 0;
    }
    [[nodiscard]] serve::MqttSettings settings() const {
        auto settings = *serve::read_mqtt_address(fmt::format("localhost:{}", port_), "valley", tls_);
        if (tls_) settings.authority = file("certificate");
        settings.user = user;
        settings.password = password;
        return settings;
    }
    /// False: the broker did not take it.
    [[nodiscard]] bool publish(const std::string& message, bool retained = false) const {
        std::vector<std::string> words = client("/usr/bin/mosquitto_pub", "valley/trigger");
        words.insert(words.end(), {"-m", message});
        if (retained) words.emplace_back("-r");
        return wait_for(begin(words)) == 0;
    }
    /// Writes the first alarm that comes within two minutes to a file.
    [[nodiscard]] pid_t listen_for_alarm() const {
        std::vector<std::string> words = client("/usr/bin/mosquitto_sub", "valley/alarm");
        words.insert(words.end(), {"-C", "1", "-W", "120"});
        return begin(words, file("alarm"));
    }
    [[nodiscard]] std::string alarm(pid_t listener) const {
        wait_for(listener);
        std::ifstream in(file("alarm"));
        return {std::istreambuf_iterator<char>(in), {}};
    }

    static constexpr const char *user = "talus", *password = "secret-of-broker";

  private:
    [[nodiscard]] std::string file(const char* name) const { return (folder_.path() / name).string(); }
    [[nodiscard]] std::vector<std::string> client(const char* program, const char* topic) const {
        std::vector<std::string> words = {program, "-h", "localhost", "-p",     std::to_string(port_),
                                          "-u",    user, "-P",        password, "-q",
                                          "1",     "-t", topic};
        if (tls_) words.insert(words.end(), {"--cafile", file("certificate")});
        return words;
    }
    static pid_t begin(std::vector<std::string> words, const std::string& output = "/dev/null") {
        std::vector<char*> arguments;
        for (std::string& word : words) arguments.push_back(word.data());
        arguments.push_back(nullptr);
        posix_spawn_file_actions_t actions{};
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addopen(&actions, 1, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
        pid_t pid = 0;
        const int code = posix_spawn(&pid, words[0].c_str(), &actions, nullptr, arguments.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        return code == 0 ? pid : 0;
    }
    static int wait_for(pid_t pid) {
        int status = -1;
        if (pid > 0) waitpid(pid, &status, 0);
        return status;
    }

    TemporaryFolder folder_;
    bool tls_;
    std::uint16_t port_ = 0;
    pid_t broker_ = 0;
};

TEST_F(AlertsTest, messages_come_from_a_broker_and_alarms_go_to_it) {
    if (!Broker::installed()) GTEST_SKIP() << "mosquitto and mosquitto-clients are not installed";
    Broker broker;
    ASSERT_TRUE(eventually([&] { return broker.publish(R"({"trigger": "slope"})", true); }));  // retained: of any age
    serve::AlertSettings settings;
    settings.mqtt = broker.settings();
    serve_with(std::move(settings), false);
    ASSERT_TRUE(eventually([&] { return alerts()["listening"]["mqtt"] == "connected"; })) << alerts().dump();
    const pid_t listener = broker.listen_for_alarm();
    act({{"action", "set_speed"}, {"factor", nullptr}});
    ASSERT_TRUE(broker.publish("no JSON"));
    ASSERT_TRUE(eventually([&] { return alerts()["notes"].dump().find("not valid JSON") != std::string::npos; }));
    EXPECT_TRUE(alerts()["runs"].empty());  // the retained one would have come before
    ASSERT_TRUE(broker.publish(R"({"trigger": "slope", "values": {"volume_m3": 300}})"));
    ASSERT_TRUE(eventually([&] { return !alerts()["runs"].empty(); })) << alerts().dump();
    EXPECT_EQ(alerts()["runs"][0]["source"], "MQTT");
    EXPECT_EQ(alerts()["runs"][0]["values"]["volume_m3"], 300);
    const std::string alarm = broker.alarm(listener);
    ASSERT_FALSE(alarm.empty());
    EXPECT_EQ(json::parse(alarm)["trigger"], "slope");
    EXPECT_EQ(json::parse(alarm)["alarm"], "moving");
    ASSERT_TRUE(eventually([&] { return alerts()["alarms"][0]["delivery"] == "sent to MQTT"; })) << alerts().dump();
    broker.stop();
    ASSERT_TRUE(eventually([&] { return alerts()["listening"]["mqtt"] == "not connected: Connection refused"; }))
        << alerts().dump();
    broker.start();
    ASSERT_TRUE(eventually([&] { return alerts()["listening"]["mqtt"] == "connected"; })) << alerts().dump();
    EXPECT_EQ(as_viewer().get("/api/session").status, 200);
    EXPECT_EQ(log().find("secret"), std::string::npos);
}

TEST_F(AlertsTest, a_broker_keeps_messages_over_the_limit_back) {
    if (!Broker::installed()) GTEST_SKIP() << "mosquitto and mosquitto-clients are not installed";
    Broker broker;
    std::mutex mutex;
    std::vector<std::size_t> sizes;
    bool connected = false;
    const auto link = serve::MqttLink::open(broker.settings(), {[&](const std::string& payload) {
                                                                    const std::lock_guard lock(mutex);
                                                                    sizes.push_back(payload.size());
                                                                },
                                                                [&](bool now, const std::string&) {
                                                                    const std::lock_guard lock(mutex);
                                                                    connected = now;
                                                                }});
    ASSERT_TRUE(link) << link.error().message;
    ASSERT_TRUE(eventually([&] {
        const std::lock_guard lock(mutex);
        return connected;
    }));
    // The first may be lost: it subscribes while this is told.
    ASSERT_TRUE(eventually([&] {
        EXPECT_TRUE(broker.publish("first"));
        const std::lock_guard lock(mutex);
        return !sizes.empty();
    }));
    for (const std::size_t size : {std::size_t{100'000}, std::size_t{4096}, std::size_t{20'000}, std::size_t{3}}) {
        ASSERT_TRUE(broker.publish(std::string(size, 'x'))) << size;
    }
    ASSERT_TRUE(eventually([&] {
        const std::lock_guard lock(mutex);
        return sizes.back() == 3;
    }));
    std::erase(sizes, 5);
    EXPECT_EQ(sizes, (std::vector<std::size_t>{4096, 3}));
}

TEST_F(AlertsTest, a_broker_that_refuses_the_login_is_told_of) {
    if (!Broker::installed()) GTEST_SKIP() << "mosquitto and mosquitto-clients are not installed";
    Broker broker;
    serve::AlertSettings settings;
    settings.mqtt = broker.settings();
    settings.mqtt->password = "wrong";
    serve_with(std::move(settings), false);
    ASSERT_TRUE(eventually([&] { return log().find("not connected: Not authorized") != std::string::npos; })) << log();
}

TEST_F(AlertsTest, a_broker_is_reached_over_tls_if_its_certificate_is_that_of_the_authority) {
    if (!Broker::installed()) GTEST_SKIP() << "mosquitto and mosquitto-clients are not installed";
    Broker broker(self_signed("DNS:localhost"));
    serve::AlertSettings settings;
    settings.mqtt = broker.settings();
    serve_with(std::move(settings), false);
    ASSERT_TRUE(eventually([&] { return alerts()["listening"]["mqtt"] == "connected"; })) << alerts().dump();
    ASSERT_TRUE(broker.publish(R"({"trigger": "slope", "values": {"volume_m3": 300}})"));
    ASSERT_TRUE(eventually([&] { return !alerts()["runs"].empty(); })) << alerts().dump();
    EXPECT_EQ(alerts()["runs"][0]["source"], "MQTT");
}

TEST_F(AlertsTest, a_broker_with_the_certificate_of_somebody_else_is_refused) {
    if (!Broker::installed()) GTEST_SKIP() << "mosquitto and mosquitto-clients are not installed";
    Broker broker(self_signed("DNS:localhost")), elsewhere(self_signed("DNS:elsewhere.example"));
    const TemporaryFolder folder;
    const std::string other = (folder.path() / "authority").string();
    std::ofstream(other) << self_signed("DNS:localhost").certificate;
    for (auto settings : {broker.settings(), elsewhere.settings()}) {
        settings.answer_limit = Milliseconds(500);
        if (settings.port == broker.settings().port) settings.authority = other;
        std::mutex mutex;
        std::set<std::string> told;
        const auto link = serve::MqttLink::open(settings, {[](const std::string&) {},
                                                           [&](bool connected, const std::string& why) {
                                                               const std::lock_guard lock(mutex);
                                                               told.insert(connected ? "connected" : why);
                                                           }});
        ASSERT_TRUE(link) << link.error().message;
        // The broker may not be there yet at the first try.
        EXPECT_TRUE(eventually([&] {
            const std::lock_guard lock(mutex);
            return std::any_of(told.begin(), told.end(), [](const std::string& why) {
                return why.find("certificate verify failed") != std::string::npos;
            });
        })) << ::testing::PrintToString(told);
        EXPECT_FALSE(told.contains("connected"));
    }
}

TEST_F(AlertsTest, a_broker_that_is_not_there_yet_is_tried_again_over_tls) {
    if (!Broker::installed()) GTEST_SKIP() << "mosquitto and mosquitto-clients are not installed";
    Broker broker(self_signed("DNS:localhost"));
    broker.stop();
    serve::AlertSettings settings;
    settings.mqtt = broker.settings();
    settings.mqtt->answer_limit = Milliseconds(500);
    serve_with(std::move(settings), false);
    ASSERT_TRUE(eventually([&] { return alerts()["listening"]["mqtt"] == "not connected: no answer"; }))
        << alerts().dump();
    broker.start();
    ASSERT_TRUE(eventually([&] { return alerts()["listening"]["mqtt"] == "connected"; })) << alerts().dump();
}

}  // namespace
}  // namespace talus::test
