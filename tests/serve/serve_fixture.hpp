#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "cli/small_scene.hpp"
#include "serve/client.hpp"
#include "serve/server.hpp"
#include "support/foreign.hpp"

namespace talus::test {

/// A server of a small scene in this process, paused at time 0.
class Serve : public ::testing::Test {
  protected:
    static constexpr const char* controller = "controller-token-of-tests";
    static constexpr const char* viewer = "viewer-token-of-the-tests";

    /// Does not end by itself; simulated time passes as wall time does.
    void SetUp() override { start(); }
    /// Before what derived fixtures lend it is gone.
    void TearDown() override { server_.reset(); }

    void start(const std::vector<std::string>& overrides = {}, Milliseconds patience = Milliseconds(60000)) {
        server_.reset();
        std::vector<std::string> all{"solver.end_time_s=1000"};
        all.insert(all.end(), overrides.begin(), overrides.end());
        auto scene = scene::load_scene(scene_.scene_file(), all);
        ASSERT_TRUE(scene) << scene.error().message;
        serve::ServerOptions options;
        options.port = 0;
        options.tokens = {controller, viewer};
        options.export_folder = scene_.folder();
        options.patience = patience;
        options.connections_per_address = connections_per_address_;
        options.allowed_hosts = {"twin.example.org"};
        options.ensembles = ensembles_;
        options.reader = foreign_reader();
        options.tiles = tiles_;
        options.calibration.source = {scene_.scene_file(), all};
        options.calibration.folder = scene_.folder();
        options.calibration.keep = keep_;
        auto server = serve::Server::listen(std::move(options));
        ASSERT_TRUE(server) << server.error().message;
        const Status serving = (*server)->serve(std::make_shared<const scene::Scene>(std::move(*scene)));
        ASSERT_TRUE(serving) << serving.error().message;
        server_ = std::move(*server);
    }

    [[nodiscard]] std::uint16_t port() const { return server_->port(); }
    [[nodiscard]] HttpClient as_controller() const { return HttpClient(port(), controller); }
    [[nodiscard]] HttpClient as_viewer() const { return HttpClient(port(), viewer); }
    [[nodiscard]] WebSocket join(const char* token, const std::string& name = "Ada", int receive_buffer = 0) const {
        return WebSocket(port(), fmt::format("token={}&name={}", token, name), receive_buffer);
    }
    /// Controls the session as a program, which is possible while nobody holds control.
    Answer act(const nlohmann::json& action, const std::string& person = "") {
        HttpClient client = as_controller();
        return client.post("/api/scenarios/A/actions", action, person);
    }

    SmallScene scene_;
    std::vector<std::filesystem::path> ensembles_;  ///< whose maps are shown
    std::vector<std::string> tiles_;                ///< addresses of map tiles
    std::size_t connections_per_address_ = 0;
    bool keep_ = false;  ///< what calibrations find
    std::unique_ptr<serve::Server> server_;
};

}  // namespace talus::test
