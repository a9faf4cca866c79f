#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "messages/messages.hpp"
#include "serve/api.hpp"
#include "serve/library.hpp"
#include "serve/openapi.hpp"
#include "serve/overlays.hpp"
#include "serve/session_file.hpp"
#include "serve/start.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;
using Handle = void (*)(Start&, const Request&, const Respond&);

constexpr const char* one_scene = "this server shows one scene; talus start has a start page";

/// The routes exist on every server; one of a single scene refuses them.
Handler on_start(Start* start, Handle handle) {
    return [start, handle](const Request& request, const Respond& respond) {
        if (start == nullptr) {
            respond(error_response(409, one_scene));
        } else {
            handle(*start, request, respond);
        }
    };
}

void add_drafts(Router& router, Start* start) {
    const auto add = [&](const char* method, const char* pattern, Handle handle) {
        router.add({method, pattern, Role::controller, on_start(start, handle)});
    };
    add("POST", "/api/draft", [](Start& s, const Request&, const Respond& respond) { s.drafts().begin(respond); });
    add("GET", "/api/draft/{id}", [](Start& s, const Request& request, const Respond& respond) {
        s.drafts().describe(request.parameters.at("id"), respond);
    });
    add("DELETE", "/api/draft/{id}", [](Start& s, const Request& request, const Respond& respond) {
        s.drafts().discard(request.parameters.at("id"), respond);
    });
    add("DELETE", "/api/draft/{id}/files/{role}", [](Start& s, const Request& request, const Respond& respond) {
        s.drafts().remove(request.parameters.at("id"), request.parameters.at("role"), respond);
    });
    add("POST", "/api/draft/{id}/mend",
        [](Start& s, const Request& request, const Respond& respond) { s.drafts().mend(request, respond); });
    add("GET", "/api/draft/{id}/relief", [](Start& s, const Request& request, const Respond& respond) {
        s.drafts().relief(request.parameters.at("id"), respond);
    });
    add("POST", "/api/draft/{id}/scene",
        [](Start& s, const Request& request, const Respond& respond) { s.drafts().make(request, respond); });
    Route upload{"PUT", "/api/draft/{id}/files/{role}", Role::controller,
                 on_start(start, [](Start&, const Request&, const Respond& respond) {
                     respond(error_response(400, "the file is empty"));
                 })};
    upload.query = {"name"};
    if (start != nullptr) {
        upload.intake = [start](const Request& request) { return start->drafts().intake(request); };
        upload.largest_body = start->drafts().limits().bytes;
    }
    router.add(std::move(upload));
}

/// Those who are sent the same session at a time share one copy of it. For the loop's thread.
class SentSession {
  public:
    Bytes share(std::string text, const std::string& saved_at) {
        // It may differ in the time alone, which is as long in each; that of the first is as good.
        const std::size_t at = text.find(fmt::format("\"saved_at\":\"{}\"", saved_at));
        if (Bytes sent = sent_.lock(); sent && at != std::string::npos && saved_at.size() == saved_at_.size()) {
            const std::size_t begin = at + key_size;
            text.replace(begin, saved_at_.size(), saved_at_);
            if (text == *sent) return sent;
            text.replace(begin, saved_at.size(), saved_at);
        }
        auto bytes = std::make_shared<const std::string>(std::move(text));
        sent_ = bytes;
        saved_at_ = saved_at;
        return bytes;
    }

  private:
    static constexpr std::size_t key_size = std::string_view("\"saved_at\":\"").size();
    std::weak_ptr<const std::string> sent_;
    std::string saved_at_;
};

/// Ensembles, calibrations and validations.
void add_jobs(Router& router, Start* start) {
    const auto add = [&](const char* method, const char* pattern, Handle handle) {
        router.add({method, pattern, Role::controller, on_start(start, handle)});
    };
    add("POST", "/api/jobs",
        [](Start& s, const Request& request, const Respond& respond) { s.add_job(request, respond); });
    add("GET", "/api/jobs/form/{id}", [](Start& s, const Request& request, const Respond& respond) {
        s.with_scene(request.parameters.at("id"), respond,
                     [&s, respond](const KnownScene& scene) { s.job_forms().describe(scene, respond); });
    });
    add("GET", "/api/jobs/estimate/{id}", [](Start& s, const Request& request, const Respond& respond) {
        s.with_scene(request.parameters.at("id"), respond,
                     [&s, respond](const KnownScene& scene) { s.job_forms().estimate(scene, respond); });
    });
    add("GET", "/api/jobs/cases",
        [](Start& s, const Request&, const Respond& respond) { s.job_forms().cases(respond); });
    const auto answer = [](const Status& status, const char* sentence) {
        return status ? json_response(200, messages::Done{.done = sentence, .created = {}})
                      : error_response(409, status.error().message);
    };
    const auto change = [&](const char* method, const char* pattern, Status (Jobs::*act)(const std::string&),
                            const char* sentence) {
        Route route{method, pattern, Role::controller,
                    [start, act, sentence, answer](const Request& request, const Respond& respond) {
                        if (start == nullptr) return respond(error_response(409, one_scene));
                        respond(answer((start->jobs().*act)(request.parameters.at("id")), sentence));
                    }};
        router.add(std::move(route));
    };
    change("POST", "/api/jobs/{id}/cancel", &Jobs::cancel, "it ends soon");
    change("POST", "/api/jobs/{id}/resume", &Jobs::resume, "the job is in the queue");
    change("DELETE", "/api/jobs/{id}", &Jobs::remove, "deleted");
    // A link that a browser follows carries no token; the ticket in it stands for one.
    router.add({"GET", "/api/reports/{ticket}", Role::nobody, [start](const Request& request, const Respond& respond) {
                    if (start == nullptr) return respond(error_response(404, one_scene));
                    auto page = start->jobs().report(request.parameters.at("ticket"));
                    if (!page) return respond(error_response(404, page.error().message));
                    Response response;
                    response.type = "text/html; charset=utf-8";
                    response.body = std::make_shared<const std::string>(std::move(*page));
                    response.document = true;
                    respond(response);
                }});
}

}  // namespace

Router make_start_api(Start* start) {
    Router router;
    router.add({"GET", "/api/openapi.json", Role::nobody, [](const Request&, const Respond& respond) {
                    Response response;
                    response.body = std::make_shared<const std::string>(openapi_document());
                    respond(response);
                }});
    router.add({"GET", "/api/start", Role::viewer, [start](const Request& request, const Respond& respond) {
                    if (start == nullptr) return respond(json_response(200, messages::NoStartPage{.available = false}));
                    start->describe(request.role, respond);
                }});
    const auto add = [&](const char* method, const char* pattern, Handle handle) {
        router.add({method, pattern, Role::controller, on_start(start, handle)});
    };
    add("POST", "/api/open",
        [](Start& s, const Request& request, const Respond& respond) { s.open(request, respond); });
    add("DELETE", "/api/open", [](Start& s, const Request&, const Respond& respond) { s.cancel(respond); });
    add("DELETE", "/api/recent/{id}", [](Start& s, const Request& request, const Respond& respond) {
        s.forget(request.parameters.at("id"), respond);
    });
    Route keep{
        "POST", "/api/sessions", Role::controller,
        on_start(start, [](Start& s, const Request& request, const Respond& respond) { s.save(request, respond); })};
    keep.largest_body = Library::longest_session;  // a file of one may come from a browser
    router.add(std::move(keep));
    add("DELETE", "/api/sessions/{id}", [](Start& s, const Request& request, const Respond& respond) {
        s.remove_saved(request.parameters.at("id"), respond);
    });
    add("DELETE", "/api/scenes/{id}", [](Start& s, const Request& request, const Respond& respond) {
        s.remove_scene(request.parameters.at("id"), respond);
    });
    add("GET", "/api/scenes/{id}/bundle", [](Start& s, const Request& request, const Respond& respond) {
        s.download(request.parameters.at("id"), respond);
    });
    add_drafts(router, start);
    add_jobs(router, start);
    add("POST", "/api/quit", [](Start& s, const Request&, const Respond& respond) { s.quit(respond); });
    return router;
}

void add_session_file_route(Router& router, Session& session, const Overlays& overlays) {
    router.add({"GET", "/api/session/file", Role::viewer,
                [&session, &overlays, last = std::make_shared<SentSession>()](const Request&, const Respond& respond) {
                    const std::string title = session.scene()->spec.scene.title;
                    session.loop().post([last, respond, title, laid = overlays.saved()](Scenarios& all) {
                        const json file = write_session(all, title, title, laid);
                        Response response;
                        response.body = last->share(to_text(file), file["saved_at"]);
                        response.file_name = "session.json";
                        respond(response);
                    });
                }});
}

}  // namespace talus::serve
