#include <arpa/inet.h>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <mutex>
#include <netinet/in.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>

#include "core/temporary_folder.hpp"
#include "serve/mqtt_link.hpp"
#include "serve/schema.hpp"
#include "serve/serve_fixture.hpp"
#include "serve/webhook.hpp"
#include "twin/journal.hpp"

extern char** environ;

namespace talus::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// A socket that listens on a free port of this machine.
int listen_anywhere(std::uint16_t& port) {
    const int file = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (file < 0 || bind(file, reinterpret_cast<sockaddr*>(&address), size) != 0 || listen(file, 8) != 0 ||
        getsockname(file, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
        throw std::runtime_error("cannot listen");
    }
    port = ntohs(address.sin_port);
    return file;
}

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

/// Asks until it is so; false: not within a minute, which only a failing test waits for.
template <class Question>
bool eventually(const Question& question) {
    for (int i = 0; i < 1200; ++i) {
        if (question()) return true;
        std::this_thread::sleep_for(Milliseconds(50));
    }
    return false;
}

class AlertsTest : public Serve {
  protected:
    static constexpr const char* trigger = "trigger-token-of-the-tests";

    void SetUp() override {
        std::ofstream(scene_.input("stream.csv"))
            << "time_s,discharge_m3ps,velocity_mps\n0,0,0\n1,8,3\n10,8,3\n11,0,0\n";
        std::ofstream file(scene_.scene_file(), std::ios::app);
        file << "\n[[inflow]]\nname = \"stream\"\nline_m = [[824180, 825110], [824180, 825090]]\nhydrograph = "
                "\"stream.csv\"\n"
                "\n[[trigger]]\nname = \"slope\"\nrelease = \"" +
                    release_name() +
                    "\"\nvolume_limit_m3 = 2000\n"
                    "pore_pressure_ratio_limit = 0.5\n"
                    "\n[[trigger]]\nname = \"gauge\"\ninflow = \"stream\"\ndischarge_limit_m3ps = 50\n"
                    "start_discharge_m3ps = 2\nhold_time_s = 30\n"
                    "\n[[alarm]]\nname = \"moving\"\nchainage_m = 30\ndistance_m = 20\nmessage = \"Clear the road.\"\n";
    }
    [[nodiscard]] static std::string release_name() { return "scar"; }

    void serve_with(serve::AlertSettings alerts, bool token = true) {
        alerts.http = token;
        alerts.log = [this](const std::string& line) {
            const std::lock_guard lock(log_mutex_);
            log_ += line + "\n";
        };
        alerts.sender.waits = {Milliseconds(20), Milliseconds(20)};
        auto scene = scene::load_scene(scene_.scene_file(), {"solver.end_time_s=1000"});
        ASSERT_TRUE(scene) << scene.error().message;
        serve::ServerOptions options;
        options.port = 0;
        options.tokens = {controller, viewer, token ? trigger : ""};
        options.export_folder = scene_.folder();
        options.alerts = std::move(alerts);
        auto server = serve::Server::listen(std::move(options));
        ASSERT_TRUE(server) << server.error().message;
        const Status serving = (*server)->serve(std::make_shared<const scene::Scene>(std::move(*scene)));
        ASSERT_TRUE(serving) << serving.error().message;
        server_ = std::move(*server);
    }
    [[nodiscard]] HttpClient as_trigger() const { return HttpClient(port(), trigger); }
    [[nodiscard]] std::string log() const {
        const std::lock_guard lock(log_mutex_);
        return log_;
    }
    [[nodiscard]] json alerts() const { return as_viewer().get("/api/alerts").json(); }
    [[nodiscard]] json state(const std::string& scenario) const {
        return as_viewer().get("/api/scenarios/" + scenario + "/state").json();
    }
    void act_on(const std::string& scenario, const json& action) const {
        const Answer answer = as_controller().post("/api/scenarios/" + scenario + "/actions", action);
        EXPECT_EQ(answer.status, 200) << answer.body;
    }

  private:
    mutable std::mutex log_mutex_;
    std::string log_;
};

TEST_F(AlertsTest, its_token_starts_a_run_and_does_nothing_else_and_no_other_token_does) {
    serve_with({});
    const json message = {{"trigger", "slope"}, {"values", {{"volume_m3", 300}}}, {"reason", "tilt meter 2"}};
    EXPECT_EQ(HttpClient(port()).post("/api/trigger", message).status, 401);
    EXPECT_EQ(HttpClient(port(), "trigger-token-of-the-testx").post("/api/trigger", message).status, 401);
    EXPECT_EQ(as_viewer().post("/api/trigger", message).status, 403);
    EXPECT_EQ(as_controller().post("/api/trigger", message).status, 403);
    for (const char* target : {"/api/session", "/api/scenarios/A/state", "/api/alerts", "/api/terrain"}) {
        const Answer refused = as_trigger().get(target);
        EXPECT_EQ(refused.status, 403) << target;
        EXPECT_THAT(refused.body, HasSubstr("POST /api/trigger alone"));
    }
    EXPECT_EQ(as_trigger().post("/api/scenarios/A/actions", {{"action", "run"}}).status, 403);
    EXPECT_EQ(join(trigger).status(), 403);
    // A person cannot pretend to be a trigger.
    EXPECT_EQ(act({{"action", "trigger"}, {"trigger", "slope"}}).status, 400);
    EXPECT_EQ(act({{"action", "gauge"}, {"trigger", "gauge"}}).status, 400);

    WebSocket ada = join(controller, "Ada"), eve = join(viewer, "Eve");
    const Answer started = as_trigger().post("/api/trigger", message);
    ASSERT_EQ(started.status, 200) << started.body;
    EXPECT_EQ(started.json()["scenario"], "B");
    EXPECT_EQ(started.json()["started"], true);
    for (WebSocket* person : {&ada, &eve}) {
        json run;
        ASSERT_TRUE(eventually([&] {
            const json told = person->wait_for("alerts");
            if (told.is_object() && !told["runs"].empty()) run = told["runs"][0];
            return !run.is_null();
        }));
        EXPECT_EQ(run["trigger"], "slope");
        EXPECT_EQ(run["source"], "HTTP");
        EXPECT_EQ(run["reason"], "tilt meter 2");
        EXPECT_EQ(run["values"]["volume_m3"], 300);
    }
    ASSERT_TRUE(eventually([&] { return state("B")["time_s"] > 0.2; }));
    EXPECT_EQ(state("A")["status"], "paused");
    EXPECT_EQ(as_trigger().post("/api/trigger", message).status, 409);
    EXPECT_THAT(log(), HasSubstr("started by trigger \"slope\", volume 300 m3: tilt meter 2"));
    EXPECT_EQ(log().find(trigger), std::string::npos);
    EXPECT_EQ(as_viewer().get("/api/scenarios/B/journal").body.find(trigger), std::string::npos);
}

TEST_F(AlertsTest, a_bad_message_is_refused_with_one_sentence_and_noted) {
    serve_with({});
    const std::pair<std::string, const char*> bad[] = {
        {"", "not valid JSON"},
        {"[]", "must be a JSON object"},
        {"{\"trigger\": \"slope\", \"trigger\": \"gauge\"}", "twice"},
        {R"({"trigger": "slop"})", "there is no such trigger"},
        {R"({"trigger": 3})", "trigger = 3"},
        {R"({"values": {}})", "trigger: missing"},
        {R"({"trigger": "slope", "scenario": "A"})", "scenario"},
        {R"({"trigger": "slope", "values": {"volume_m3": 2001}})", "volume_m3 = 2001"},
        {R"({"trigger": "slope", "values": {"volume_m3": NaN}})", "not valid JSON"},
        {R"({"trigger": "slope", "values": {"volume_m3": 1e999}})", ""},
        {R"({"trigger": "slope", "values": {"discharge_m3ps": 3}})", "does not take it"},
        {R"({"trigger": "gauge", "values": {"discharge_m3ps": 51}})", "discharge_m3ps = 51"},
        {R"({"trigger": "gauge", "values": {"discharge_m3ps": -1}})", "discharge_m3ps = -1"},
        {R"({"trigger": "slope", "time": "yesterday"})", "UTC"},
        {R"({"trigger": "slope", "time": "2020-01-01T00:00:00Z"})", "300 s old"},
        {R"({"trigger": "slope", "time": "2120-01-01T00:00:00Z"})", "60 s ahead"},
    };
    for (const auto& [body, sentence] : bad) {
        const Answer answer = as_trigger().ask("POST", "/api/trigger", body);
        EXPECT_EQ(answer.status, 400) << body << answer.body;
        EXPECT_THAT(answer.body, HasSubstr(sentence)) << body;
    }
    EXPECT_EQ(as_viewer().get("/api/session").json()["scenarios"], json({"A"}));
    EXPECT_THAT(alerts()["notes"].dump(), HasSubstr("refused"));
    EXPECT_EQ(as_trigger().ask("POST", "/api/trigger", std::string(5000, ' ')).status, 413);
}

TEST_F(AlertsTest, floods_are_refused_and_nothing_starts_unless_it_is_configured) {
    serve_with({});
    int refused = 0;
    HttpClient client = as_trigger();
    for (int i = 0; i < 200 && refused == 0; ++i) {
        refused += client.post("/api/trigger", {{"trigger", "nothing"}}).status == 429 ? 1 : 0;
    }
    EXPECT_EQ(refused, 1);
    serve_with({}, false);
    EXPECT_EQ(HttpClient(port(), trigger).post("/api/trigger", {{"trigger", "slope"}}).status, 401);
    EXPECT_EQ(HttpClient(port(), "").post("/api/trigger", {{"trigger", "slope"}}).status, 401);
    EXPECT_EQ(alerts()["listening"]["http"], false);
}

TEST_F(AlertsTest, a_gauge_starts_a_run_and_feeds_it_and_the_journal_replays_to_the_same_hash) {
    serve_with({});
    const auto send = [&](double discharge) {
        return as_trigger().post("/api/trigger", {{"trigger", "gauge"}, {"values", {{"discharge_m3ps", discharge}}}});
    };
    EXPECT_EQ(send(1.5).json()["started"], false);  // below start_discharge_m3ps
    const Answer started = send(6);
    ASSERT_EQ(started.status, 200) << started.body;
    ASSERT_EQ(started.json()["scenario"], "B");
    ASSERT_TRUE(eventually([&] { return state("B")["time_s"] > 0.3; }));
    const Answer more = send(12);
    ASSERT_EQ(more.status, 200) << more.body;
    EXPECT_THAT(more.body, HasSubstr("12 m3/s"));
    EXPECT_EQ(more.json()["started"], false);
    const Answer volume = as_trigger().post("/api/trigger", {{"trigger", "gauge"}, {"values", json::object()}});
    EXPECT_EQ(volume.status, 409);
    EXPECT_EQ(alerts()["runs"][0]["reading"]["discharge_m3ps"], 12);
    const double reached = state("B")["time_s"];
    ASSERT_TRUE(eventually([&] { return state("B")["time_s"] > reached + 1; }));
    act_on("B", {{"action", "pause"}});
    const std::string journal = as_viewer().get("/api/scenarios/B/journal").body;
    const auto read = twin::read_journal(journal);
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->entries.size(), 2U);
    EXPECT_EQ(read->entries[0].action["action"], "trigger");
    EXPECT_EQ(read->entries[1].action["action"], "gauge");
    EXPECT_EQ(read->entries[1].by, "trigger \"gauge\"");
    auto scene = scene::load_scene(scene_.scene_file(), {"solver.end_time_s=1000"});
    ASSERT_TRUE(scene);
    const auto again = twin::replay(*read, std::make_shared<const scene::Scene>(std::move(*scene)));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->hash, read->hash);
    EXPECT_EQ(again->hash, state("B")["hash"]);
}

TEST_F(AlertsTest, people_cannot_take_the_place_of_a_run_of_a_trigger) {
    serve_with({});
    for (int i = 0; i < 4; ++i) EXPECT_EQ(as_controller().post("/api/scenarios", {{"copy_of", "A"}}).status, 200);
    const Answer full = as_controller().post("/api/scenarios", {{"copy_of", "A"}});
    EXPECT_EQ(full.status, 409);
    EXPECT_THAT(full.body, HasSubstr("beside one that a trigger starts"));
    const Answer started = as_trigger().post("/api/trigger", {{"trigger", "slope"}});
    EXPECT_EQ(started.json()["scenario"], "F") << started.body;
    const Answer none = as_trigger().post("/api/trigger", {{"trigger", "gauge"}, {"values", {{"discharge_m3ps", 5}}}});
    EXPECT_EQ(none.status, 409);
    EXPECT_THAT(none.body, HasSubstr("every place"));
}

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

/// Debian's broker on a port of its own, and its clients.
class Broker {
  public:
    Broker() {
        close(listen_anywhere(port_));
        std::ofstream(file("mosquitto.conf"))
            << "listener " << port_ << " 127.0.0.1\nallow_anonymous false\npassword_file " << file("passwords")
            << "\nuser root\npersistence false\n";
        std::ofstream(file("passwords")) << "";
        wait_for(begin({"/usr/bin/mosquitto_passwd", "-b", file("passwords"), user, password}));
        broker_ = begin({"/usr/sbin/mosquitto", "-c", file("mosquitto.conf")});
    }
    ~Broker() { stop(); }
    void stop() {
        if (broker_ > 0) kill(broker_, SIGTERM);
        wait_for(std::exchange(broker_, 0));
    }
    [[nodiscard]] static bool installed() {
        return access("/usr/sbin/mosquitto", X_OK) == 0 && access("/usr/bin/mosquitto_pub", X_OK) == 0;
    }
    [[nodiscard]] serve::MqttSettings settings() const {
        auto settings = *serve::read_mqtt_address(fmt::format("127.0.0.1:{}", port_), "valley", false);
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
        return {program, "-h", "127.0.0.1", "-p", std::to_string(port_), "-u", user, "-P", password,
                "-q",    "1",  "-t",        topic};
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
    ASSERT_TRUE(eventually([&] { return alerts()["listening"]["mqtt"] != "connected"; }));
    EXPECT_EQ(as_viewer().get("/api/session").status, 200);
    EXPECT_EQ(log().find("secret"), std::string::npos);
}

TEST_F(AlertsTest, a_broker_that_refuses_the_login_is_told_of) {
    if (!Broker::installed()) GTEST_SKIP() << "mosquitto and mosquitto-clients are not installed";
    Broker broker;
    serve::AlertSettings settings;
    settings.mqtt = broker.settings();
    settings.mqtt->password = "wrong";
    serve_with(std::move(settings), false);
    ASSERT_TRUE(eventually([&] { return log().find("authoris") != std::string::npos; })) << log();
}

}  // namespace
}  // namespace talus::test
