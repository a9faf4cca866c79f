#pragma once

#include <arpa/inet.h>
#include <fstream>
#include <mutex>
#include <netinet/in.h>
#include <stdexcept>
#include <string>
#include <sys/socket.h>
#include <thread>

#include <nlohmann/json.hpp>

#include "serve/serve_fixture.hpp"

namespace talus::test {

using nlohmann::json;

/// A socket that listens on a free port of this machine.
inline int listen_anywhere(std::uint16_t& port) {
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

/// Asks until it is so; false: not within a minute, which only a failing test waits for.
template <class Question>
bool eventually(const Question& question) {
    for (int i = 0; i < 1200; ++i) {
        if (question()) return true;
        std::this_thread::sleep_for(Milliseconds(50));
    }
    return false;
}

/// A server of a scene with two triggers, one of them with a gauge, and an alarm.
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

}  // namespace talus::test
