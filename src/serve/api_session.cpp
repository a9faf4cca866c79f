#include <map>
#include <memory>
#include <utility>

#include "geo/orthophoto.hpp"
#include "messages/messages.hpp"
#include "serve/api.hpp"
#include "session/json_text.hpp"
#include "session/thinned.hpp"
#include "twin/answers.hpp"

namespace talus::serve {
namespace {

constexpr int photo_pixels = 4096;  // along the longer edge: what graphics cards take

void add_terrain(Router& router, Session& session) {
    // By thinning factor, so there are only a few. Used by the worker's thread only.
    const auto encoded = std::make_shared<std::map<int, Bytes>>();
    router.add({"GET",
                "/api/terrain",
                Role::viewer,
                [&session, encoded](const Request& request, const Respond& respond) {
                    const auto wanted =
                        number_of(request, "max_cells", session::fewest_terrain_cells, session::most_terrain_cells);
                    if (!wanted) {
                        respond(error_response(400, wanted.error().message));
                        return;
                    }
                    const Grid<float>& whole = session.scene()->terrain.elevation();
                    const int factor =
                        session::thinning(whole.geometry, wanted->value_or(session::usual_terrain_cells));
                    session.worker().post([respond, encoded, factor, scene = session.scene()] {
                        Bytes& bytes = (*encoded)[factor];
                        if (!bytes) bytes = session::terrain_message(scene->terrain.elevation(), factor);
                        Response response;
                        response.type = "application/octet-stream";
                        response.body = bytes;
                        respond(response);
                    });
                },
                {"max_cells"}});
}

void add_orthophoto(Router& router, Session& session) {
    // Used by the worker's thread only.
    const auto kept = std::make_shared<Response>();
    router.add({"GET", "/api/orthophoto", Role::viewer, [&session, kept](const Request&, const Respond& respond) {
                    if (session.scene()->spec.terrain.orthophoto.empty()) {
                        respond(error_response(404, "the scene has no orthophoto (terrain.orthophoto)"));
                        return;
                    }
                    session.worker().post([respond, kept, scene = session.scene()] {
                        if (!kept->body) {
                            auto photo = read_orthophoto(scene->spec.terrain.orthophoto, scene->crs,
                                                         scene->terrain.elevation().geometry.extent(), photo_pixels);
                            if (!photo) {
                                respond(error_response(500, photo.error().message));
                                return;
                            }
                            kept->type = photo->type;
                            kept->body = std::make_shared<const std::string>(std::move(photo->bytes));
                        }
                        respond(*kept);
                    });
                }});
}

void add_scenario(Session& session, const Request& request, const Respond& respond) {
    change(session, request, respond, [&](const std::string& by) {
        auto wanted = parse_json(request.body);
        if (!wanted) {
            respond(error_response(400, wanted.error().message));
            return;
        }
        session.loop().post([respond, by, wanted = std::move(*wanted)](Scenarios& all) {
            session::copy(all, wanted, by, [respond](const session::Reply& reply) { respond(to_response(reply)); });
        });
    });
}

void end_scenario(Session& session, const Request& request, const Respond& respond) {
    change(session, request, respond, [&](const std::string&) {
        session.loop().post([respond, name = request.parameters.at("s")](Scenarios& all) {
            respond(to_response(session::end(all, name)));
        });
    });
}

void control(Session& session, const Request& request, const Respond& respond) {
    const auto wanted = parse_json(request.body);
    const auto what = wanted ? session::read_control(*wanted) : Result<std::string>(wanted.error());
    if (!what) {
        respond(error_response(400, what.error().message));
        return;
    }
    const std::string secret = text_at(*wanted, "secret");
    const Person* who = session.people().whose(secret.empty() ? request.secret : secret);
    if (who == nullptr) {
        respond(error_response(409, nobody_in_session));
        return;
    }
    const Status changed = session.people().control(*what, who->id, Clock::now());
    if (!changed) {
        respond(error_response(409, changed.error().message));
        return;
    }
    session.people_changed();
    respond(json_response(200, messages::Done{.done = *what, .created = {}}));
}

}  // namespace

void add_session_routes(Router& router, Session& session) {
    router.add({"GET", "/api/session", Role::viewer, [&session](const Request& request, const Respond& respond) {
                    respond(json_response(200, session.describe(request.role)));
                }});
    router.add({"GET", "/api/scene", Role::viewer, [&session](const Request&, const Respond& respond) {
                    session.loop().post(
                        [respond](Scenarios& all) { respond(json_response(200, twin::scene_json(all.at(0)))); });
                }});
    add_terrain(router, session);
    add_orthophoto(router, session);
    const auto with_session = [&session](void (*handler)(Session&, const Request&, const Respond&)) -> Handler {
        return
            [&session, handler](const Request& request, const Respond& respond) { handler(session, request, respond); };
    };
    router.add({"POST", "/api/scenarios", Role::controller, with_session(add_scenario)});
    router.add({"DELETE", "/api/scenarios/{s}", Role::controller, with_session(end_scenario)});
    router.add({"POST", "/api/control", Role::controller, with_session(control)});
}

}  // namespace talus::serve
