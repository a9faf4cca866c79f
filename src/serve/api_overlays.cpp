#include "serve/api.hpp"
#include "serve/overlays.hpp"

namespace talus::serve {

void add_overlay_routes(Router& router, Overlays& overlays) {
    router.add({"GET", "/api/overlays", Role::viewer, [&overlays](const Request&, const Respond& respond) {
                    respond(json_response(200, overlays.describe()));
                }});
    router.add({"GET", "/api/overlays/{id}", Role::viewer, [&overlays](const Request& request, const Respond& respond) {
                    overlays.data(request, false, respond);
                }});
    router.add(
        {"GET", "/api/overlays/{id}/picture", Role::viewer,
         [&overlays](const Request& request, const Respond& respond) { overlays.data(request, true, respond); }});
    router.add({"GET", "/api/tiles", Role::viewer,
                [&overlays](const Request&, const Respond& respond) { overlays.tiles(respond); }});
    router.add({"POST", "/api/tiles", Role::controller,
                [&overlays](const Request& request, const Respond& respond) { overlays.add_tiles(request, respond); }});
    router.add(
        {"DELETE", "/api/tiles/{id}", Role::controller,
         [&overlays](const Request& request, const Respond& respond) { overlays.remove_tiles(request, respond); }});
    Route upload{"PUT", "/api/overlays", Role::controller,
                 [](const Request&, const Respond& respond) { respond(error_response(400, "the file is empty")); }};
    upload.query = {"name"};
    upload.intake = [&overlays](const Request& request) { return overlays.intake(request); };
    upload.largest_body = overlays.quota().upload;
    router.add(std::move(upload));
    router.add({"POST", "/api/overlays", Role::controller,
                [&overlays](const Request& request, const Respond& respond) { overlays.restore(request, respond); }});
    router.add({"POST", "/api/overlays/{id}", Role::controller,
                [&overlays](const Request& request, const Respond& respond) { overlays.change(request, respond); }});
    router.add({"DELETE", "/api/overlays/{id}", Role::controller,
                [&overlays](const Request& request, const Respond& respond) { overlays.remove(request, respond); }});
}

}  // namespace talus::serve
