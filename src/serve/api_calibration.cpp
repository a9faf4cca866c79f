#include "messages/messages.hpp"
#include "serve/api.hpp"
#include "session/json_text.hpp"

namespace talus::serve {

void add_calibration_routes(Router& router, Session& session, Calibrations& calibrations) {
    router.add({"GET", "/api/calibration", Role::viewer, [&calibrations](const Request&, const Respond& respond) {
                    respond(json_response(200, calibrations.describe()));
                }});
    router.add({"POST", "/api/calibration", Role::controller,
                [&session, &calibrations](const Request& request, const Respond& respond) {
                    change(session, request, respond, [&](const std::string& by) {
                        const auto wanted = parse_json(request.body);
                        if (!wanted) {
                            respond(error_response(400, wanted.error().message));
                            return;
                        }
                        calibrations.start(*wanted, by, respond);
                    });
                }});
    router.add({"DELETE", "/api/calibration", Role::controller,
                [&session, &calibrations](const Request& request, const Respond& respond) {
                    change(session, request, respond, [&](const std::string&) {
                        const Status cancelled = calibrations.cancel();
                        respond(cancelled
                                    ? json_response(200, messages::Done{.done = "calibration cancelled", .created = {}})
                                    : error_response(409, cancelled.error().message));
                    });
                }});
}

}  // namespace talus::serve
