#include <fmt/format.h>

#include "serve/api.hpp"
#include "session/json_text.hpp"

namespace talus::serve {

void add_ensemble_routes(Router& router, const Ensembles& ensembles) {
    router.add({"GET", "/api/ensembles", Role::viewer, [&ensembles](const Request&, const Respond& respond) {
                    respond(json_response(200, ensembles.describe()));
                }});
    router.add({"GET", "/api/ensembles/{e}/maps/{name}", Role::viewer,
                [&ensembles](const Request& request, const Respond& respond) {
                    const std::string &ensemble = request.parameters.at("e"), &name = request.parameters.at("name");
                    Response response;
                    response.type = "application/octet-stream";
                    response.body = ensembles.map(ensemble, name);
                    if (response.body) {
                        respond(response);
                        return;
                    }
                    respond(
                        error_response(404, fmt::format("there is no map {} of an ensemble {}; /api/ensembles lists "
                                                        "those that there are",
                                                        tidy_name(name, 60), tidy_name(ensemble, 20))));
                }});
}

}  // namespace talus::serve
