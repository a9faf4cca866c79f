#include "serve/api.hpp"

#include <utility>

namespace talus::serve {

Router make_api(Session& session, Exports& exports, const Ensembles& ensembles, Calibrations& calibrations,
                Alerts& alerts, Overlays& overlays) {
    Router router;
    add_session_routes(router, session);
    add_session_file_route(router, session, overlays);
    add_overlay_routes(router, overlays);
    add_scenario_routes(router, session, exports);
    add_ensemble_routes(router, ensembles);
    add_calibration_routes(router, session, calibrations);
    add_alert_routes(router, alerts);
    return router;
}

void change(Session& session, const Request& request, const Respond& respond,
            const std::function<void(const std::string& by)>& act) {
    const Person* who = session.people().whose(request.secret);
    if (who == nullptr && !request.secret.empty()) {
        respond(error_response(409, nobody_in_session));
        return;
    }
    if (const Status allowed = session.people().may_act(who ? who->id : ""); !allowed) {
        respond(error_response(409, allowed.error().message));
        return;
    }
    act(who ? who->name : "a program");
}

Response no_scenario(const std::string& name) {
    return to_response(session::no_scenario(name));
}

Response binary_response(std::string bytes) {
    Response response;
    response.type = "application/octet-stream";
    response.body = std::make_shared<const std::string>(std::move(bytes));
    return response;
}

Result<std::optional<double>> number_of(const Request& request, const char* key, double low, double high) {
    return session::number_of(request.query, key, low, high);
}

}  // namespace talus::serve
