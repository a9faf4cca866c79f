#pragma once

#include "serve/calibrations.hpp"
#include "serve/depth_averaged.hpp"
#include "serve/ensembles.hpp"
#include "serve/exports.hpp"
#include "serve/router.hpp"
#include "serve/session.hpp"

namespace talus::serve {

class Alerts;
class Overlays;
/// The routes of docs/protocol.md. The arguments must outlive them.
[[nodiscard]] Router make_api(Session& session, Exports& exports, const Ensembles& ensembles,
                              Calibrations& calibrations, Alerts& alerts, Overlays& overlays);

class Start;
/// The routes that need no open session. nullptr: a server of one scene, without a start page.
[[nodiscard]] Router make_start_api(Start* start);

class Sharing;
class Access;
/// Reaching the server from other computers. For the server's thread, as its arguments.
void add_share_routes(Router& router, Sharing& sharing, Access& access);

// The parts of it.
void add_session_file_route(Router& router, Session& session, const Overlays& overlays);
void add_session_routes(Router& router, Session& session);
void add_scenario_routes(Router& router, Session& session, Exports& exports);
void add_ensemble_routes(Router& router, const Ensembles& ensembles);
void add_calibration_routes(Router& router, Session& session, Calibrations& calibrations);
void add_alert_routes(Router& router, Alerts& alerts);
/// Layers that people lay over the terrain.
void add_overlay_routes(Router& router, Overlays& overlays);
class FlowExports;
/// The moving flow as files.
void add_flow_routes(Router& router, FlowExports& flows);
/// Of the depth-averaged model beside the live runs.
void add_depth_averaged_routes(Router& router, Session& session, DepthAveraged& model);

/// Calls `act` with the name of the requester if it may make changes now, otherwise answers why not.
void change(Session& session, const Request& request, const Respond& respond,
            const std::function<void(const std::string& by)>& act);

/// To a request with a secret that nobody in the session has: the page has left, or it is made up.
inline constexpr const char* nobody_in_session = "the sender is not in this session; reload the page";

[[nodiscard]] Response no_scenario(const std::string& name);
[[nodiscard]] Response binary_response(std::string bytes);

/// The number of the query for `key`; empty: absent. Error: not a number from `low` to `high`.
[[nodiscard]] Result<std::optional<double>> number_of(const Request& request, const char* key, double low, double high);

}  // namespace talus::serve
