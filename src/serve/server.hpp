#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "scene/scene.hpp"
#include "serve/access.hpp"
#include "serve/alerts.hpp"
#include "serve/calibrations.hpp"
#include "serve/draft.hpp"
#include "serve/router.hpp"
#include "twin/scenario.hpp"

namespace talus::serve {

struct ServerOptions {
    std::string host = "127.0.0.1";          ///< address to listen on, IPv4 or IPv6
    std::uint16_t port = 8123;               ///< 0: any that is free
    std::vector<std::string> allowed_hosts;  ///< further host names under which browsers may reach this server
    Tokens tokens;
    std::filesystem::path export_folder;  ///< an existing folder for result files
    twin::ScenarioOptions scenario;
    std::chrono::milliseconds patience{30000};     ///< timeout of a silent connection, for a header, for a body
    bool run = false;                              ///< start immediately
    CalibrationSettings calibration;               ///< without a scene file there are none
    std::vector<std::filesystem::path> ensembles;  ///< folders of finished ensembles whose maps are shown
    AlertSettings alerts;                          ///< triggers and alarms; neither unless set
    std::function<void(std::string)> on_failure;   ///< the simulation cannot continue: out of memory; from any thread
    geo::ForeignReader reader{};                   ///< of files that people lay over the terrain
    std::vector<std::string> tiles;           ///< addresses of map tiles that browsers may load; check_tile_address
    std::size_t connections_per_address = 0;  ///< at once; 0: a third of what the system allows in all
};

/// Of a server with a start page.
struct StartSettings {
    std::filesystem::path folder;   ///< keeps the list of recent scenes, own scenes and saved sessions
    std::filesystem::path file;     ///< a scene or a saved session to open at once; empty: none
    std::function<void()> on_quit;  ///< the user ends the program in the page
    UploadLimits uploads{};         ///< of a new scene
    std::filesystem::path program;  ///< talus itself, for jobs; empty: there are none
    geo::ForeignReader reader{};    ///< of files that are uploaded
};

/// A session that users and programs access over HTTP and WebSocket, as described in docs/protocol.md. Runs on its own
/// threads until it is destroyed.
class Server {
  public:
    /// Binds the port. Errors: bad address, port in use, bad tokens.
    [[nodiscard]] static Result<std::unique_ptr<Server>> listen(ServerOptions options);
    /// Opens the scene and starts answering; once. Errors: the scene cannot be run, an ensemble cannot be shown on it.
    [[nodiscard]] Status serve(const std::shared_ptr<const scene::Scene>& scene);
    /// Starts answering with the start page, on which a scene is chosen; once, in place of serve().
    void start(StartSettings settings);
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    [[nodiscard]] std::uint16_t port() const;
    /// The address with a token, for a browser.
    [[nodiscard]] std::string link(Role role) const;
    /// Of the server and of the open session.
    [[nodiscard]] std::vector<Route> routes() const;

  private:
    struct Parts;
    explicit Server(std::unique_ptr<Parts> parts);
    std::unique_ptr<Parts> parts_;
};

}  // namespace talus::serve
