#include <cmath>
#include <utility>

#include "core/number_or_null.hpp"
#include "ensemble/predict.hpp"
#include "serve/api.hpp"
#include "twin/table_entry.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;

/// Field observations beside what the run so far predicts for them; `entries`: of the setup.
json observed_json(const scene::Scene& scene, const run::RunResult& result, const json& entries) {
    std::vector<json> ids;
    for (const std::string& section : twin::sections_of(twin::TableKind::observation)) {
        for (const json& entry : entries) {
            if (entry["section"] == section) ids.push_back(entry["id"]);
        }
    }
    const std::vector<ensemble::ObservedValue> observed = ensemble::observed_values(scene);
    const std::vector<double> predicted = ensemble::predicted_values(scene, result.observation);
    json rows = json::array();
    for (std::size_t k = 0; k < observed.size(); ++k) {
        const ensemble::ObservedValue& o = observed[k];
        const bool is = o.kind == ensemble::ObservedValue::Kind::equal;
        const bool reached = std::isfinite(predicted[k]) && !(o.unreached < 0 && predicted[k] < 0);
        const double deviation = deviation_of(o, reached ? predicted[k] : o.unreached);
        rows.push_back({{"id", k < ids.size() ? ids[k] : json()},
                        {"name", o.name},
                        {"unit", o.unit},
                        {"observed", o.value},
                        {"uncertainty", o.uncertainty},
                        {"is", is                                                  ? "equal"
                               : o.kind == ensemble::ObservedValue::Kind::at_least ? "at_least"
                                                                                   : "below"},
                        {"computed", reached ? json(predicted[k]) : json()},
                        {"deviation", number_or_null<json>(deviation)}});
    }
    return {{"time_s", result.simulated_time}, {"rows", std::move(rows)}};
}

/// A question that needs ensembles, which a session knows nothing of.
const session::Question& observed_question() {
    static const session::Question question{
        "observed", {}, true, [](Scenarios& all, int index, const Arguments&) -> session::Rest {
            const twin::Scenario& scenario = all.at(index);
            return [outcome = scenario.outcome(), entries = scenario.setup_json()["observations"]] {
                const auto [scene, result] = outcome();
                return session::reply(observed_json(scene, result, entries));
            };
        }};
    return question;
}

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
    add(observed_question());
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
