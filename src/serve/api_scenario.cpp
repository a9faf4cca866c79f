#include <utility>

#include "serve/api.hpp"

namespace talus::serve {
namespace {

/// Asks the scenario that a request is about, on the loop's thread; does slow work on the worker's.
void ask(Session& session, const session::Question& question, const Request& request, const Respond& respond) {
    Arguments arguments = request.query;
    arguments.insert(request.parameters.begin(), request.parameters.end());
    session.loop().post([&session, &question, respond, arguments = std::move(arguments)](Scenarios& all) {
        session::Rest rest = session::ask(all, arguments.at("s"), question, arguments);
        if (!question.slow) return respond(to_response(rest()));
        session.worker().post([respond, rest = std::move(rest)] { respond(to_response(rest())); });
    });
}

void action(Session& session, const Request& request, const Respond& respond) {
    change(session, request, respond, [&](const std::string& by) {
        auto wanted = parse_json(request.body);
        if (!wanted) {
            respond(error_response(400, wanted.error().message));
            return;
        }
        session.loop().post(
            [respond, name = request.parameters.at("s"), wanted = std::move(*wanted), by](Scenarios& all) {
                session::act(all, name, wanted, by,
                             [respond](const session::Reply& reply) { respond(to_response(reply)); });
            });
    });
}

}  // namespace

void add_scenario_routes(Router& router, Session& session, Exports& exports) {
    const auto add = [&](const session::Question& question) {
        router.add({"GET", "/api/scenarios/{s}/" + question.name, Role::viewer,
                    [&session, &question](const Request& request, const Respond& respond) {
                        ask(session, question, request, respond);
                    },
                    question.keys});
    };
    for (const session::Question& question : session::questions()) add(question);
    router.add({"POST", "/api/scenarios/{s}/actions", Role::controller,
                [&session](const Request& request, const Respond& respond) { action(session, request, respond); }});
    router.add(
        {"GET", "/api/scenarios/{s}/exports", Role::viewer, [&exports](const Request& request, const Respond& respond) {
             exports.list(request.parameters.at("s"), respond);
         }});
    router.add({"GET", "/api/scenarios/{s}/exports/{name}", Role::viewer,
                [&exports](const Request& request, const Respond& respond) {
                    exports.file(request.parameters.at("s"), request.parameters.at("name"), respond);
                }});
}

}  // namespace talus::serve
