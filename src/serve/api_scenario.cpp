#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "serve/api.hpp"
#include "session/json_text.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;

/// Asks the scenario that a request is about, on the loop's thread.
void ask(Session& session, const Request& request, const Respond& respond,
         std::function<Response(Scenarios&, int index)> question) {
    session.loop().post([respond, name = request.parameters.at("s"), question = std::move(question)](Scenarios& all) {
        const auto index = all.find(name);
        respond(index ? question(all, *index) : no_scenario(name));
    });
}

/// The rest of the work on an answer once the scenario has provided the data.
using Work = std::function<Response()>;

/// Asks the scenario between two steps, and does the work on the worker's thread. An error is a 404.
void take(Session& session, const Request& request, const Respond& respond,
          std::function<Result<Work>(Scenarios&, int index)> question) {
    session.loop().post(
        [&session, respond, name = request.parameters.at("s"), question = std::move(question)](Scenarios& all) {
            const auto index = all.find(name);
            if (!index) {
                respond(no_scenario(name));
                return;
            }
            Result<Work> work = question(all, *index);
            if (!work) {
                respond(error_response(404, work.error().message));
                return;
            }
            session.worker().post([respond, work = std::move(*work)] { respond(work()); });
        });
}

using Question = std::function<json(Scenarios&, int index)>;

void add_questions(Router& router, Session& session) {
    const std::pair<const char*, Question> questions[] = {
        {"state", [](Scenarios& all, int index) { return all.state(index); }},
        {"setup", [](Scenarios& all, int index) { return all.setup(index); }},
        {"series", [](Scenarios& all, int index) { return all.at(index).series_json(); }},
        {"journal", [](Scenarios& all, int index) { return all.at(index).journal_json(); }},
        {"recording", [](Scenarios& all, int index) { return all.at(index).recording_json(); }},
    };
    for (const auto& [name, question] : questions) {
        router.add({"GET", std::string("/api/scenarios/{s}/") + name, Role::viewer,
                    [&session, question = question](const Request& request, const Respond& respond) {
                        ask(session, request, respond,
                            [question](Scenarios& all, int index) { return json_response(200, question(all, index)); });
                    }});
    }
}

void frame(Session& session, const Request& request, const Respond& respond) {
    const auto time = number_of(request, "time_s", 0, 1e9);
    if (!time) {
        respond(error_response(400, time.error().message));
        return;
    }
    take(session, request, respond, [time = *time](Scenarios& all, int index) -> Result<Work> {
        const twin::FramePtr frame = time ? all.at(index).recorded_frame(*time) : all.frame(index, 1);
        if (!frame) return Error{fmt::format("nothing is recorded at or before time_s = {}", *time)};
        return Work([frame, index, flags = time ? twin::frame_recorded : 0] {
            return binary_response(twin::encode(*frame, index, flags));
        });
    });
}

void probe(Session& session, const Request& request, const Respond& respond) {
    const auto x = number_of(request, "x_m", -1e9, 1e9), y = number_of(request, "y_m", -1e9, 1e9);
    if (!x || !y) {
        respond(error_response(400, x ? y.error().message : x.error().message));
        return;
    }
    if (!*x || !*y) {
        respond(error_response(400, "the query needs x_m and y_m"));
        return;
    }
    take(session, request, respond, [point = PlanPoint{**x, **y}](Scenarios& all, int index) -> Result<Work> {
        return Work([probe = all.at(index).probe(point)] { return json_response(200, probe()); });
    });
}

void figures(Session& session, const Request& request, const Respond& respond) {
    take(session, request, respond, [](Scenarios& all, int index) -> Result<Work> {
        return Work([figures = all.at(index).figures()] { return json_response(200, figures()); });
    });
}

void layer(Session& session, const Request& request, const Respond& respond) {
    const auto time = number_of(request, "time_s", 0, 1e9);
    if (!time) {
        respond(error_response(400, time.error().message));
        return;
    }
    take(session, request, respond,
         [time = *time, name = request.parameters.at("name")](Scenarios& all, int index) -> Result<Work> {
             TALUS_ASSIGN(auto grid, all.at(index).layer(name, time));
             return Work([grid = std::move(grid)] { return binary_response(twin::encode_grid(grid())); });
         });
}

/// A table of a scenario, now or as of `time_s`.
using Table = json (twin::Scenario::*)(std::optional<double> time) const;

Handler table_handler(Session& session, Table table) {
    return [&session, table](const Request& request, const Respond& respond) {
        const auto time = number_of(request, "time_s", 0, 1e9);
        if (!time) {
            respond(error_response(400, time.error().message));
            return;
        }
        ask(session, request, respond, [table, time = *time](Scenarios& all, int index) {
            return json_response(200, (all.at(index).*table)(time));
        });
    };
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
                const auto index = all.find(name);
                if (!index) {
                    respond(no_scenario(name));
                    return;
                }
                all.act(*index, wanted, by, [respond](const Result<twin::Done>& done) {
                    if (!done) return respond(error_response(400, done.error().message));
                    const json created = done->created.empty() ? json() : json(done->created);
                    respond(json_response(200, {{"done", done->sentence}, {"created", created}}));
                });
            });
    });
}

}  // namespace

void add_scenario_routes(Router& router, Session& session, Exports& exports) {
    add_questions(router, session);
    const auto with_session = [&session](void (*handler)(Session&, const Request&, const Respond&)) -> Handler {
        return
            [&session, handler](const Request& request, const Respond& respond) { handler(session, request, respond); };
    };
    router.add({"GET", "/api/scenarios/{s}/frame", Role::viewer, with_session(frame), {"time_s"}});
    router.add({"GET",
                "/api/scenarios/{s}/impacts",
                Role::viewer,
                table_handler(session, &twin::Scenario::impacts_json),
                {"time_s"}});
    router.add({"GET",
                "/api/scenarios/{s}/gauges",
                Role::viewer,
                table_handler(session, &twin::Scenario::gauges_json),
                {"time_s"}});
    router.add({"GET", "/api/scenarios/{s}/probe", Role::viewer, with_session(probe), {"x_m", "y_m"}});
    router.add({"GET", "/api/scenarios/{s}/figures", Role::viewer, with_session(figures)});
    router.add({"GET", "/api/scenarios/{s}/layers/{name}", Role::viewer, with_session(layer), {"time_s"}});
    router.add({"POST", "/api/scenarios/{s}/actions", Role::controller, with_session(action)});
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
