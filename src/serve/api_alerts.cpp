#include "serve/alerts.hpp"
#include "serve/api.hpp"

namespace talus::serve {

void add_alert_routes(Router& router, Alerts& alerts) {
    router.add({"GET", "/api/alerts", Role::viewer,
                [&alerts](const Request&, const Respond& respond) { respond(json_response(200, alerts.describe())); }});
    Route trigger{"POST", "/api/trigger", Role::trigger, [&alerts](const Request& request, const Respond& respond) {
                      alerts.take(request.body, "HTTP", respond);
                  }};
    trigger.largest_body = largest_trigger_message;
    router.add(std::move(trigger));
}

}  // namespace talus::serve
