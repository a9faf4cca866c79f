#include "session/page_api.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "messages/messages.hpp"
#include "session/json_text.hpp"
#include "session/thinned.hpp"
#include "session/url.hpp"

namespace talus::session {
namespace {

using nlohmann::json;

PageAnswer to_answer(const Reply& reply) {
    return {status_of(reply.outcome), reply.binary ? "application/octet-stream" : "application/json", reply.body};
}

PageAnswer refused(Outcome outcome, const std::string& sentence) {
    return to_answer(refusal(outcome, sentence));
}

PageAnswer not_here(const std::string& method, std::string_view path) {
    return refused(Outcome::unknown, fmt::format("{} {} is not part of this page: it needs the program on a machine",
                                                 tidy_name(method, 10), tidy_name(path, 80)));
}

/// The parts of a path between its slashes.
std::vector<std::string> parts_of(std::string_view path) {
    std::vector<std::string> parts;
    while (!path.empty()) {
        path.remove_prefix(1);  // the slash
        const std::size_t end = std::min(path.find('/'), path.size());
        parts.emplace_back(path.substr(0, end));
        path.remove_prefix(end);
    }
    return parts;
}

/// The question of a path behind the scenario's name, with the arguments in its name.
const Question* question_of(const std::vector<std::string>& parts, Arguments& arguments) {
    for (const Question& question : questions()) {
        const std::vector<std::string> wanted = parts_of("/" + question.name);
        if (wanted.size() + 3 != parts.size() || wanted[0] != parts[3]) continue;
        for (std::size_t i = 1; i < wanted.size(); ++i) {
            arguments[wanted[i].substr(1, wanted[i].size() - 2)] = parts[i + 3];
        }
        return &question;
    }
    return nullptr;
}

std::optional<PageAnswer> unknown_key(const Arguments& query, const std::vector<std::string>& known) {
    for (const auto& [key, value] : query) {
        if (std::find(known.begin(), known.end(), key) != known.end()) continue;
        return refused(Outcome::wrong,
                       fmt::format("the query has no {}; it may have: {}", tidy_name(key, 30),
                                   known.empty() ? "nothing" : fmt::format("{}", fmt::join(known, ", "))));
    }
    return {};
}

}  // namespace

PageAnswer PageApi::answer(const std::string& method, std::string_view target, std::string_view body,
                           const std::string& person, const Now& now) {
    const auto asked = parse_target(target);
    if (!asked) return refused(Outcome::wrong, asked.error().message);
    if (method == "GET") return get(asked->path, asked->query, now);
    const auto wanted = body.empty() ? Result<json>(json()) : parse_json(body);
    if (!wanted) return refused(Outcome::wrong, wanted.error().message);
    return change(method, asked->path, *wanted, person, now);
}

PageAnswer PageApi::get(std::string_view path, const Arguments& query, const Now&) {
    if (path == "/api/session") {
        return to_answer(reply(session_.describe(Role::controller)));
    }
    if (path == "/api/scene") return to_answer(session_.scene());
    if (path == "/api/terrain") return terrain(query);
    if (path == "/api/orthophoto") {
        if (!orthophoto_) return refused(Outcome::unknown, "the scene has no orthophoto (terrain.orthophoto)");
        return {200, orthophoto_->type, orthophoto_->bytes};
    }
    const std::vector<std::string> parts = parts_of(path);
    if (parts.size() < 4 || parts[0] != "api" || parts[1] != "scenarios") return not_here("GET", path);
    if (parts[3] == "exports" && parts.size() <= 5) return files(parts[2], parts.size() == 5 ? parts[4] : "");
    if (parts[3] == "depth_averaged") {
        if (parts.size() == 6 && parts[4] == "layers") {
            if (auto wrong = unknown_key(query, {"time_s"})) return *wrong;
            return to_answer(session_.depth_averaged(parts[2], "layers/" + parts[5], query));
        }
        if (parts.size() > 5 || (parts.size() == 5 && parts[4] != "comparison")) return not_here("GET", path);
        if (auto wrong = unknown_key(query, {})) return *wrong;
        return to_answer(session_.depth_averaged(parts[2], parts.size() == 5 ? parts[4] : ""));
    }
    Arguments arguments = query;
    const Question* question = question_of(parts, arguments);
    if (question == nullptr) return not_here("GET", path);
    if (auto wrong = unknown_key(query, question->keys)) return *wrong;
    return to_answer(session_.ask(parts[2], question->name, arguments));
}

/// The list of a run's files, or one of them. Others, such as the report, are written by the program.
PageAnswer PageApi::files(const std::string& scenario, const std::string& name) {
    if (name.empty() || scenario != files_of_) {
        auto files = session_.files(scenario);
        if (!files) return to_answer(no_scenario(scenario));
        files_ = std::move(*files);
        files_of_ = name.empty() ? scenario : "";
    }
    std::vector<messages::ExportFile> listed;
    listed.reserve(files_.size());
    for (const twin::RunFile& file : files_) {
        if (file.name == name) return {200, file.type, std::make_shared<const std::string>(file.bytes())};
        listed.push_back({.name = file.name, .bytes = {}, .what = file.what});
    }
    if (name.empty()) return to_answer(reply(messages::ExportFiles{.files = std::move(listed)}));
    if (files_.empty()) return refused(Outcome::unknown, "there are no results yet: run the simulation first");
    return not_here("GET", fmt::format("/api/scenarios/{}/exports/{}", scenario, name));
}

PageAnswer PageApi::terrain(const Arguments& query) {
    if (auto wrong = unknown_key(query, {"max_cells"})) return *wrong;
    const auto wanted = number_of(query, "max_cells", fewest_terrain_cells, most_terrain_cells);
    if (!wanted) return refused(Outcome::wrong, wanted.error().message);
    const Grid<float>& whole = scene_.terrain.elevation();
    const int factor = thinning(whole.geometry, wanted->value_or(usual_terrain_cells));
    Bytes& bytes = terrain_[factor];
    if (!bytes) bytes = terrain_message(whole, factor);
    return {200, "application/octet-stream", bytes};
}

PageAnswer PageApi::change(const std::string& method, std::string_view path, const json& body,
                           const std::string& person, const Now& now) {
    const std::vector<std::string> parts = parts_of(path);
    const bool of_scenarios = parts.size() >= 2 && parts[0] == "api" && parts[1] == "scenarios";
    std::optional<Reply> answer;
    const Answered answered = [&](const Reply& reply) { answer = reply; };
    if (method == "POST" && path == "/api/control") return control(body, person, now);
    if (method == "POST" && path == "/api/depth_averaged") return to_answer(session_.turn_depth_averaged(person, body));
    if (method == "POST" && of_scenarios && parts.size() == 2) {
        session_.copy(person, body, answered);
    } else if (method == "DELETE" && of_scenarios && parts.size() == 3) {
        answered(session_.end(person, parts[2]));
    } else if (method == "POST" && of_scenarios && parts.size() == 4 && parts[3] == "actions") {
        session_.act(person, parts[2], body, answered);
    } else {
        return not_here(method, path);
    }
    // It is prepared between two steps.
    while (!answer) static_cast<void>(session_.advance(now, Clock::duration::zero()));
    return to_answer(*answer);
}

PageAnswer PageApi::control(const json& body, const std::string& person, const Now& now) {
    const auto what = read_control(body);
    if (!what) return refused(Outcome::wrong, what.error().message);
    if (const Status changed = session_.control(*what, person, now()); !changed) {
        return refused(Outcome::not_now, changed.error().message);
    }
    return to_answer(reply(messages::Done{.done = *what, .created = {}}));
}

}  // namespace talus::session
