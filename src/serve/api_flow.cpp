#include "serve/api.hpp"
#include "serve/flow_exports.hpp"

namespace talus::serve {

void add_flow_routes(Router& router, FlowExports& flows) {
    router.add({"GET",
                "/api/scenarios/{s}/flow",
                Role::viewer,
                [&flows](const Request& request, const Respond& respond) {
                    const auto interval = number_of(request, "interval_s", 0.001, 1e7);
                    if (!interval) return respond(error_response(400, interval.error().message));
                    flows.offer(request.parameters.at("s"), *interval, respond);
                },
                {"interval_s"}});
    router.add(
        {"POST", "/api/scenarios/{s}/flow", Role::controller, [&flows](const Request& request, const Respond& respond) {
             flows.start(request.parameters.at("s"), request.body, respond);
         }});
    router.add({"GET", "/api/flow", Role::viewer,
                [&flows](const Request&, const Respond& respond) { respond(json_response(200, flows.describe())); }});
    router.add({"DELETE", "/api/flow", Role::controller, [&flows](const Request&, const Respond& respond) {
                    flows.cancel();
                    respond(json_response(200, flows.describe()));
                }});
    router.add({"GET", "/api/flow/{name}", Role::viewer, [&flows](const Request& request, const Respond& respond) {
                    flows.file(request.parameters.at("name"), respond);
                }});
}

}  // namespace talus::serve
