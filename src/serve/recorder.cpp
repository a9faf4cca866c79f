#include "serve/recorder.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "publish/compact_grid.hpp"
#include "serve/library.hpp"
#include "serve/site_archive.hpp"
#include "session/json_text.hpp"
#include "twin/past_maps.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;

constexpr std::chrono::milliseconds look_again{100};
constexpr int mesh_cells = 400'000;  // of the terrain: as the page asks for it
constexpr int past_tables = 120, past_maps = 12;
const Error stopped{"stopped; nothing was written"};

/// What a page would be sent.
class Witness final : public session::Viewer {
  public:
    void send(Bytes text) override {
        auto message = parse_json(*text);
        const std::lock_guard lock(mutex_);
        if (message) messages_.push_back(std::move(*message));
    }
    void offer(int, Bytes) override {}
    void set_rate(double) override {}
    void dismiss(Bytes) override {}
    [[nodiscard]] std::vector<json> take() {
        const std::lock_guard lock(mutex_);
        return std::exchange(messages_, {});
    }

  private:
    std::mutex mutex_;
    std::vector<json> messages_;
};

/// Asks a session as a page does, without sockets, from a thread that can wait.
class Asker {
  public:
    Asker(OpenSession& open, const SayShare& say) : open_(open), say_(say) {}

    bool say(const std::string& what, double share) {
        what_ = what;
        share_ = share;
        return say_(what, share);
    }
    [[nodiscard]] Result<Response> get(const std::string& path, Arguments query = {}) {
        const auto promise = std::make_shared<std::promise<Response>>();
        auto answer = promise->get_future();
        open_.session.post([this, path, query = std::move(query), promise] {
            const Router::Match match = open_.router.find("GET", "/api/" + path);
            if (match.route == nullptr) return promise->set_value(error_response(404, "no such route"));
            Request request;
            request.method = "GET";
            request.path = "/api/" + path;
            request.query = query;
            request.parameters = match.parameters;
            request.role = Role::viewer;
            match.route->handler(request, [promise](Response response) { promise->set_value(std::move(response)); });
        });
        return wait(answer);
    }
    [[nodiscard]] Result<json> get_json(const std::string& path) {
        TALUS_ASSIGN(const Response response, get(path));
        if (response.status != 200) return Error{fmt::format("{}: {}", path, *response.body)};
        return parse_json(*response.body);
    }
    /// Calls `work` on the server's thread.
    [[nodiscard]] Status there(const std::function<void()>& work) {
        const auto promise = std::make_shared<std::promise<bool>>();
        auto done = promise->get_future();
        open_.session.post([work, promise] {
            work();
            promise->set_value(true);
        });
        TALUS_TRY(wait(done));
        return {};
    }
    OpenSession& open() { return open_; }

  private:
    template <class T>
    [[nodiscard]] Result<T> wait(std::future<T>& answer) {
        while (answer.wait_for(look_again) != std::future_status::ready) {
            if (!say_(what_, share_)) return stopped;
        }
        return answer.get();
    }

    OpenSession& open_;
    const SayShare& say_;
    std::string what_ = "opening";
    double share_ = 0;
};

/// An answer for the tape; one that is refused is left out, and the page says that the file has none.
Status keep(Asker& asker, publish::Tape& tape, const std::string& path, Arguments query = {}) {
    TALUS_ASSIGN(const Response response, asker.get(path, std::move(query)));
    if (response.status == 200 && response.body) tape.add(path, response.type, publish::compact_grid(*response.body));
    return {};
}

Status keep_at(Asker& asker, publish::Tape& tape, const std::string& path, double time) {
    TALUS_ASSIGN(const Response response, asker.get(path, {{"time_s", fmt::format("{:.6f}", time)}}));
    if (response.status == 200 && response.body)
        tape.add_at(path, time, response.type, publish::compact_grid(*response.body));
    return {};
}

/// Evenly chosen, with the first and the last.
std::vector<double> some_of(const std::vector<double>& times, std::size_t most) {
    if (times.size() <= most) return times;
    std::vector<double> chosen;
    for (std::size_t k = 0; k < most; ++k) chosen.push_back(times[k * (times.size() - 1) / (most - 1)]);
    return chosen;
}

/// Those at least `interval` apart, and the last.
std::vector<double> apart(const std::vector<double>& times, double interval) {
    std::vector<double> chosen;
    for (const double time : times) {
        if (chosen.empty() || time >= chosen.back() + interval - 1e-6) chosen.push_back(time);
    }
    if (!chosen.empty() && chosen.back() != times.back()) chosen.push_back(times.back());
    return chosen;
}

/// As many of the times as `room` takes, from the size of a few frames: close together while much moves, far apart
/// while debris rests. `series`: of the scenario.
Result<std::vector<double>> fitting_times(Asker& asker, const std::string& frame, const std::vector<double>& times,
                                          const json& series, std::size_t room) {
    const std::vector<double> sample = some_of(times, 8);
    double bytes = 0;
    for (const double time : sample) {
        TALUS_ASSIGN(const Response one, asker.get(frame, {{"time_s", fmt::format("{:.6f}", time)}}));
        bytes += static_cast<double>(one.body->size());
    }
    bytes /= static_cast<double>(sample.size());
    const auto most = static_cast<std::size_t>(std::max(2.0, static_cast<double>(room) / std::max(1.0, bytes)));
    if (times.size() <= most) return times;
    const auto at = series.at("time").at("time_s").get<std::vector<double>>();
    const auto moving = series.at("time").at("volume_moving_m3").get<std::vector<double>>();
    const double greatest = moving.empty() ? 0 : *std::max_element(moving.begin(), moving.end());
    constexpr double rest = 0.05;  // the share of the frames that debris at rest gets of those of a run in full motion
    std::vector<double> passed(times.size(), 0);
    std::size_t row = 0;
    for (std::size_t k = 1; k < times.size(); ++k) {
        while (row + 1 < at.size() && at[row] < times[k]) ++row;
        const double share = greatest > 0 ? moving[row] / greatest : 0;
        passed[k] = passed[k - 1] + (times[k] - times[k - 1]) * (rest + share);
    }
    std::vector<double> chosen{times.front()};
    for (std::size_t k = 1; k + 1 < times.size(); ++k) {
        const double due = passed.back() * static_cast<double>(chosen.size()) / static_cast<double>(most - 1);
        if (passed[k] >= due) chosen.push_back(times[k]);
    }
    chosen.push_back(times.back());
    return chosen;
}

Status record_scenario(Asker& asker, publish::Tape& tape, RecordedRun& run, const RecordOptions& options, double from,
                       double to) {
    const std::string& name = run.name;
    const std::string of = "scenarios/" + name + "/", what = "recording scenario " + name;
    const auto said = [&](double share) -> Status {
        if (!asker.say(what, from + share * (to - from))) return stopped;
        return {};
    };
    TALUS_TRY(said(0));
    for (const char* question : {"series", "impacts", "gauges", "observed", "figures", "recording", "journal"}) {
        TALUS_TRY(keep(asker, tape, of + question));
    }
    for (const std::string_view layer : twin::run_layers()) {
        TALUS_TRY(keep(asker, tape, fmt::format("{}layers/{}", of, layer)));
    }
    TALUS_ASSIGN(const json recording, asker.get_json(of + "recording"));
    const auto times = recording.at("times_s").get<std::vector<double>>();
    if (times.empty()) return {};
    std::vector<double> frames;
    if (options.frame_interval) {
        frames = apart(times, *options.frame_interval);
    } else {
        TALUS_ASSIGN(const json series, asker.get_json(of + "series"));
        TALUS_ASSIGN(frames, fitting_times(asker, of + "frame", times, series, options.frame_bytes));
    }
    run.frames = frames.size();
    for (std::size_t k = 0; k < frames.size(); ++k) {
        if (k % 10 == 0) TALUS_TRY(said(0.7 * static_cast<double>(k) / static_cast<double>(frames.size())));
        TALUS_TRY(keep_at(asker, tape, of + "frame", frames[k]));
    }
    for (const double time : some_of(frames, past_tables)) {
        TALUS_TRY(keep_at(asker, tape, of + "impacts", time));
        TALUS_TRY(keep_at(asker, tape, of + "gauges", time));
    }
    for (const double time : some_of(frames, past_maps)) {
        for (const std::string_view layer : twin::run_layers()) {
            TALUS_TRY(keep_at(asker, tape, fmt::format("{}layers/{}", of, layer), time));
        }
    }
    if (!options.files) return {};
    TALUS_TRY(said(0.8));
    TALUS_ASSIGN(json exports, asker.get_json(of + "exports"));
    json files = json::array();
    for (json& file : exports.at("files")) {
        if (file.at("name") == twin_html) continue;       // that is this page
        if (file.at("name") == "results.json") continue;  // what tables and report say, a tenth of the file
        TALUS_TRY(keep(asker, tape, of + "exports/" + file.at("name").get<std::string>()));
        files.push_back(std::move(file));
    }
    tape.add(of + "exports", "application/json", to_text({{"files", files}}));
    return {};
}

/// Secrets of this program, and who has used it, are not for a reader of the file.
json without_people(json session) {
    session["links"] = json::object();
    session["people"] = json::array();
    return session;
}

/// A page in one file loads nothing from anywhere, and addresses of map tiles may hold somebody's key.
json without_tiles(json about) {
    about["tiles"] = json::array();
    return about;
}

/// What concerns the session as a whole.
Status record_session(Asker& asker, publish::Tape& tape) {
    for (const char* question : {"scene", "orthophoto", "ensembles", "alerts"}) {
        TALUS_TRY(keep(asker, tape, question));
    }
    TALUS_ASSIGN(json session, asker.get_json("session"));
    tape.add("session", "application/json", to_text(without_people(std::move(session))));
    TALUS_ASSIGN(const Response terrain, asker.get("terrain", {{"max_cells", fmt::format("{}", mesh_cells)}}));
    if (terrain.status == 200) tape.add("terrain", terrain.type, publish::compact_grid(*terrain.body));
    TALUS_ASSIGN(const json overlays, asker.get_json("overlays"));
    tape.add("overlays", "application/json", to_text(without_tiles(overlays)));
    if (overlays.at("tiles").empty()) {
        TALUS_TRY(keep(asker, tape, "session/file"));
    } else {
        TALUS_ASSIGN(const Response file, asker.get("session/file"));
        TALUS_ASSIGN(json saved, parse_json(*file.body, Library::most_session_values));
        tape.add("session/file", "application/json", to_text(without_tiles(std::move(saved))));
    }
    for (const json& overlay : overlays.at("overlays")) {
        const std::string path = "overlays/" + overlay.at("id").get<std::string>();
        TALUS_TRY(keep(asker, tape, path));
        TALUS_TRY(keep(asker, tape, path + "/picture"));
    }
    return {};
}

/// Whether a run of this status goes on.
bool goes_on(const json& state) {
    return state.at("status") == "running";
}

}  // namespace

Status run_to_end(OpenSession& open, const SayShare& say) {
    Asker asker(open, say);
    const auto refused = std::make_shared<std::promise<std::string>>();
    auto answer = refused->get_future();
    TALUS_TRY(asker.there([&open, refused] {
        open.session.loop().post([refused](Scenarios& all) {
            all.act(0, {{"action", "set_speed"}, {"factor", nullptr}}, "", [](const Result<twin::Done>&) {});
            all.act(0, {{"action", "run"}}, "", [refused](const Result<twin::Done>& done) {
                refused->set_value(done ? "" : done.error().message);
            });
        });
    }));
    if (const std::string why = answer.get(); !why.empty()) return Error{why};
    for (;;) {
        TALUS_ASSIGN(const json state, asker.get_json("scenarios/A/state"));
        const double time = state.at("time_s"), end = state.at("end_time_s");
        if (!asker.say(fmt::format("running, {:.1f} s of at most {:.0f} s", time, end), time / end)) return stopped;
        if (state.at("status") == "fault") return Error{state.at("message").get<std::string>()};
        if (!goes_on(state)) return {};
        std::this_thread::sleep_for(look_again);
    }
}

Result<Recorded> record(OpenSession& open, const RecordOptions& options, const SayShare& say) {
    Asker asker(open, say);
    Recorded recorded;
    publish::Tape& tape = recorded.tape;
    if (!asker.say("recording", 0)) return stopped;
    TALUS_TRY(record_session(asker, tape));

    Witness witness;
    TALUS_TRY(asker.there([&] { open.session.join(witness, Role::viewer, "", ""); }));
    std::vector<json> messages = witness.take();
    TALUS_TRY(asker.there([&] { open.session.leave(witness); }));
    std::vector<std::string> names;
    for (json& message : messages) {
        if (message.at("type") == "hello") {
            names = message.at("session").at("scenarios").get<std::vector<std::string>>();
            message["session"] = without_people(message["session"]);
            message["you"]["secret"] = "";
        }
        if (message.at("type") == "overlays") message = without_tiles(std::move(message));
        // As it is now: the last message may be of a moment before the end.
        if (message.at("type") == "state") {
            TALUS_ASSIGN(const json now,
                         asker.get_json("scenarios/" + message.at("scenario").get<std::string>() + "/state"));
            message.update(now);
            if (goes_on(message)) message["status"] = "paused";  // on the tape it does not go on
        }
        if (message.at("type") != "people") tape.say(std::move(message));
    }
    for (std::size_t k = 0; k < names.size(); ++k) {
        const auto share = [&](std::size_t part) {
            return static_cast<double>(part) / static_cast<double>(names.size());
        };
        TALUS_ASSIGN(const json state, asker.get_json("scenarios/" + names[k] + "/state"));
        RecordedRun& run = recorded.runs.emplace_back();
        run.name = names[k];
        run.end = state.at("time_s");
        run.hash = state.value("hash", "");
        TALUS_TRY(record_scenario(asker, tape, run, options, share(k), share(k + 1)));
    }
    return recorded;
}

Result<publish::PageFiles> published_page() {
    publish::PageFiles page;
    for (const ArchivedFile& file : site_archive()) {
        if (file.name == "published/page.js") page.script = file.content;
        if (file.name == "published/page.css") page.style = file.content;
        if (file.name == "published/worker.js") page.worker = file.content;
        if (file.name == "published/loader.js") page.loader = file.content;
    }
    if (page.script.empty() || page.style.empty() || page.loader.empty())
        return Error{"this program was built without the page (TALUS_WEB); it cannot publish a twin"};
    return page;
}

}  // namespace talus::serve
