#pragma once

#include <memory>
#include <string>
#include <vector>

#include "serve/alerts.hpp"
#include "serve/calibrations.hpp"
#include "serve/depth_averaged.hpp"
#include "serve/ensembles.hpp"
#include "serve/exports.hpp"
#include "serve/flow_exports.hpp"
#include "serve/overlays.hpp"
#include "serve/router.hpp"
#include "serve/session.hpp"
#include "serve/twin_page.hpp"

namespace talus::serve {

struct ServerOptions;

/// A scenario that is there when a session opens.
struct OpeningScenario {
    int index = 0;      ///< 0 for "A", ...
    std::string title;  ///< given by people; empty: none
    std::unique_ptr<twin::Scenario> scenario;
};

/// A session with all that belongs to it, and the routes to it.
struct OpenSession {
    OpenSession(Thread thread, Executor& executor, std::shared_ptr<const scene::Scene> scene,
                const ServerOptions& options);
    ~OpenSession() { close(); }
    OpenSession(const OpenSession&) = delete;
    OpenSession& operator=(const OpenSession&) = delete;

    /// From any thread. `scenarios`: in place of one at time 0. Errors: the scene cannot be run, an ensemble cannot be
    /// shown on it.
    [[nodiscard]] static Result<std::shared_ptr<OpenSession>> open(const Thread& thread, Executor& executor,
                                                                   const std::shared_ptr<const scene::Scene>& scene,
                                                                   const ServerOptions& options,
                                                                   std::vector<OpeningScenario> scenarios = {},
                                                                   std::vector<Overlay> overlays = {},
                                                                   const std::vector<TileAddress>& tiles = {});
    /// Ends thread and lanes; requests that wait are not answered. Nobody may use the session any more.
    void close();
    /// From any thread but the server's: closes a session that the server's thread may have tasks of, and lets it go
    /// there, once those and what they have posted in turn are done.
    static void retire(const Thread& thread, std::shared_ptr<OpenSession> session);

    Ensembles ensembles;
    Session session;
    Exports exports;
    Calibrations calibrations;
    Alerts alerts;
    DepthAveraged depth_averaged;
    Overlays overlays;
    Router router;
    FlowExports flows;
    TwinPage twin_page{*this};
};

using OpenSessionPtr = std::shared_ptr<OpenSession>;

}  // namespace talus::serve
