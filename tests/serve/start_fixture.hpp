#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "cli/small_scene.hpp"
#include "serve/client.hpp"
#include "serve/library.hpp"
#include "serve/server.hpp"
#include "support/foreign.hpp"

namespace talus::test {

/// A server with a start page whose list of recent scenes has a small scene.
class StartPage : public ::testing::Test {
  protected:
    static constexpr const char* controller = "controller-token-of-tests";
    static constexpr const char* viewer = "viewer-token-of-the-tests";
    static constexpr const char* trigger = "trigger-token-of-the-tests";

    void SetUp() override {
        ASSERT_TRUE(serve::Library(folder()).remember(scene_.scene_file(), "Plane"));
        start();
    }
    void start(const std::filesystem::path& file = {}) {
        server_.reset();
        std::filesystem::create_directories(scene_.folder() / "exports");
        serve::ServerOptions options;
        options.port = 0;
        options.tokens = {controller, viewer, alerts_.http ? trigger : ""};
        options.alerts = alerts_;
        options.export_folder = scene_.folder() / "exports";
        auto server = serve::Server::listen(std::move(options));
        ASSERT_TRUE(server) << server.error().message;
        (*server)->start({folder(), file, on_quit_, limits_, program_, foreign_reader()});
        server_ = std::move(*server);
    }
    [[nodiscard]] std::filesystem::path folder() const { return scene_.folder() / "data"; }
    [[nodiscard]] HttpClient hand() const { return HttpClient(server_->port(), controller); }
    [[nodiscard]] nlohmann::json page() const { return hand().get("/api/start").json(); }
    [[nodiscard]] std::string id() const { return page()["scenes"][0]["id"]; }
    /// The page once nothing is being opened.
    nlohmann::json opened() {
        nlohmann::json now = page();
        for (int i = 0; i < 400 && !now["opening"].is_null(); ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(25));
            now = page();
        }
        return now;
    }
    nlohmann::json open(const nlohmann::json& what) {
        const Answer answer = hand().post("/api/open", what);
        EXPECT_EQ(answer.status, 202) << answer.body;
        return opened();
    }
    Answer act(const nlohmann::json& action) { return hand().post("/api/scenarios/A/actions", action); }

    SmallScene scene_;
    std::atomic<bool> quit_ = false;
    std::function<void()> on_quit_ = [this] { quit_ = true; };
    serve::UploadLimits limits_;
    serve::AlertSettings alerts_;    ///< triggers and alarms
    std::filesystem::path program_;  ///< for jobs
    std::unique_ptr<serve::Server> server_;
};

}  // namespace talus::test
