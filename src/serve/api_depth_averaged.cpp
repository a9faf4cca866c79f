#include <utility>

#include "serve/api.hpp"
#include "session/json_text.hpp"

namespace talus::serve {
namespace {

using Run = std::shared_ptr<const twin::DepthAveragedRun>;

/// Asks about the result of the scenario of a request between two steps, and does the work on the worker's thread. No
/// scenario, or no result, is a 404.
void take(Session& session, const DepthAveraged& model, const Request& request, const Respond& respond,
          std::function<std::function<Response()>(const twin::Scenario&, Run)> question) {
    session.loop().post(
        [&session, &model, respond, name = request.parameters.at("s"), question = std::move(question)](Scenarios& all) {
            const auto index = all.find(name);
            if (!index) return respond(no_scenario(name));
            Run run = model.result(*index);
            if (!run) return respond(error_response(404, model.why_none(*index)));
            session.worker().post([respond, work = question(all.at(*index), std::move(run))] { respond(work()); });
        });
}

void status(Session& session, const DepthAveraged& model, const Request& request, const Respond& respond) {
    session.loop().post([&model, respond, name = request.parameters.at("s")](Scenarios& all) {
        const auto index = all.find(name);
        respond(index ? json_response(200, model.describe(*index)) : no_scenario(name));
    });
}

void layer(Session& session, const DepthAveraged& model, const Request& request, const Respond& respond) {
    const auto time = number_of(request, "time_s", 0, 1e9);
    if (!time) return respond(error_response(400, time.error().message));
    take(session, model, request, respond,
         [time = *time, name = request.parameters.at("name")](const twin::Scenario&,
                                                              Run run) -> std::function<Response()> {
             return [time, name, run = std::move(run)] {
                 const auto grid = run->layer(name, time);
                 return grid ? binary_response(twin::encode_grid(*grid)) : error_response(404, grid.error().message);
             };
         });
}

void comparison(Session& session, const DepthAveraged& model, const Request& request, const Respond& respond) {
    take(session, model, request, respond, [](const twin::Scenario& scenario, Run run) -> std::function<Response()> {
        return [compared = twin::comparison_with(scenario, std::move(run))] { return json_response(200, compared()); };
    });
}

void turn(Session& session, DepthAveraged& model, const Request& request, const Respond& respond) {
    change(session, request, respond, [&](const std::string&) {
        const auto wanted = parse_json(request.body);
        const Result<bool> on = wanted ? session::read_switch(*wanted) : wanted.error();
        if (!on) return respond(error_response(400, on.error().message));
        model.turn(*on);
        respond(json_response(200, session::switched(*on)));
    });
}

}  // namespace

void add_depth_averaged_routes(Router& router, Session& session, DepthAveraged& model) {
    const std::string of_scenario = "/api/scenarios/{s}/depth_averaged";
    const auto reading =
        [&](void (*handler)(Session&, const DepthAveraged&, const Request&, const Respond&)) -> Handler {
        return [&session, &model, handler](const Request& request, const Respond& respond) {
            handler(session, model, request, respond);
        };
    };
    router.add({"GET", of_scenario, Role::viewer, reading(status)});
    router.add({"GET", of_scenario + "/layers/{name}", Role::viewer, reading(layer), {"time_s"}});
    router.add({"GET", of_scenario + "/comparison", Role::viewer, reading(comparison)});
    router.add({"POST", "/api/depth_averaged", Role::controller,
                [&session, &model](const Request& request, const Respond& respond) {
                    turn(session, model, request, respond);
                }});
}

}  // namespace talus::serve
