#include "session/requests.hpp"

#include <array>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "messages/messages.hpp"
#include "session/json_text.hpp"
#include "session/observed.hpp"
#include "twin/answers.hpp"
#include "twin/json_keys.hpp"
#include "twin/live_run.hpp"
#include "twin/results.hpp"

namespace talus::session {
namespace {

using nlohmann::json;

constexpr double latest = 1e9;    // s
constexpr double farthest = 1e9;  // m

Reply binary(std::string bytes) {
    return {Outcome::done, std::make_shared<const std::string>(std::move(bytes)), true};
}

Rest refused(Outcome outcome, const Error& why) {
    return [answer = refusal(outcome, why.message)] { return answer; };
}

Rest frame(Scenarios& all, int index, const Arguments& arguments) {
    const auto time = number_of(arguments, "time_s", 0, latest);
    if (!time) return refused(Outcome::wrong, time.error());
    const twin::FramePtr frame = *time ? all.at(index).run().recording().at(**time) : all.frame(index, 1);
    if (!frame) {
        return refused(Outcome::unknown, Error{fmt::format("nothing is recorded at or before time_s = {}", **time)});
    }
    return
        [frame, index, flags = *time ? twin::frame_recorded : 0] { return binary(twin::encode(*frame, index, flags)); };
}

Rest probe(Scenarios& all, int index, const Arguments& arguments) {
    const auto x = number_of(arguments, "x_m", -farthest, farthest),
               y = number_of(arguments, "y_m", -farthest, farthest);
    if (!x || !y) return refused(Outcome::wrong, x ? y.error() : x.error());
    if (!*x || !*y) return refused(Outcome::wrong, Error{"the query needs x_m and y_m"});
    return [probe = twin::probe_at(all.at(index), {**x, **y})] { return reply(probe()); };
}

Rest layer(Scenarios& all, int index, const Arguments& arguments) {
    const auto time = number_of(arguments, "time_s", 0, latest);
    if (!time) return refused(Outcome::wrong, time.error());
    auto grid = twin::layer_of(all.at(index), arguments.at("name"), *time);
    if (!grid) return refused(Outcome::unknown, grid.error());
    return [grid = std::move(*grid)] { return binary(twin::encode_grid(grid())); };
}

Rest figures(Scenarios& all, int index, const Arguments&) {
    return [figures = twin::figures_of(all.at(index))] { return reply(figures()); };
}

/// What a scenario answers at once.
Question plain(const char* name, std::function<json(Scenarios&, int index)> answer) {
    return {name, {}, false, [answer = std::move(answer)](Scenarios& all, int index, const Arguments&) -> Rest {
                return [made = reply(answer(all, index))] { return made; };
            }};
}
Question plain(const char* name, json (*answer)(const twin::Scenario&)) {
    return plain(name, [answer](Scenarios& all, int index) { return answer(all.at(index)); });
}

/// A table of a scenario, now or as of `time_s`.
Question table(const char* name, json (*answer)(const twin::Scenario&, std::optional<double> time)) {
    return {name, {"time_s"}, false, [answer](Scenarios& all, int index, const Arguments& arguments) -> Rest {
                const auto time = number_of(arguments, "time_s", 0, latest);
                if (!time) return refused(Outcome::wrong, time.error());
                return [made = reply(answer(all.at(index), *time))] { return made; };
            }};
}

}  // namespace

int status_of(Outcome outcome) {
    constexpr std::array statuses{200, 400, 404, 409};  // as Outcome has them
    return statuses[static_cast<std::size_t>(outcome)];
}

Reply reply(const json& content) {
    return {Outcome::done, std::make_shared<const std::string>(to_text(content))};
}

Reply refusal(Outcome outcome, const std::string& sentence) {
    return {outcome, std::make_shared<const std::string>(to_text(messages::Refusal{.error = sentence}))};
}

Reply no_scenario(const std::string& name) {
    return refusal(Outcome::unknown, fmt::format("there is no scenario {}", tidy_name(name, 20)));
}

Result<std::optional<double>> number_of(const Arguments& arguments, const std::string& key, double low, double high) {
    const auto found = arguments.find(key);
    if (found == arguments.end()) return std::optional<double>();
    const std::string& text = found->second;
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc() || end != text.data() + text.size() || !(value >= low && value <= high)) {
        return Error{fmt::format("{} = {}; it is a number from {} to {}", key, tidy_name(text, 30), low, high)};
    }
    return std::optional<double>(value);
}

const std::vector<Question>& questions() {
    static const std::vector<Question> known{
        plain("state", &Scenarios::state),  // with what the session knows
        plain("setup", &Scenarios::setup),
        // From the scenario itself.
        plain("series", twin::series_json),
        plain("journal", twin::journal_json),
        plain("recording", twin::recording_json),
        table("impacts", twin::impacts_json),
        table("gauges", twin::gauges_json),
        // With work for another thread.
        {"frame", {"time_s"}, true, frame},
        {"probe", {"x_m", "y_m"}, true, probe},
        {"figures", {}, true, figures},
        {"observed", {}, true, observed},
        {"layers/{name}", {"time_s"}, true, layer},
    };
    return known;
}

Rest ask(Scenarios& all, const std::string& scenario, const Question& question, const Arguments& arguments) {
    const auto index = all.find(scenario);
    if (!index) return [answer = no_scenario(scenario)] { return answer; };
    return question.ask(all, *index, arguments);
}

void act(Scenarios& all, const std::string& scenario, const json& action, const std::string& by,
         const Answered& answered) {
    const auto index = all.find(scenario);
    if (!index) return answered(no_scenario(scenario));
    all.act(*index, action, by, [answered](const Result<twin::Done>& done) {
        if (!done) return answered(refusal(Outcome::wrong, done.error().message));
        answered(reply(messages::Done{.done = done->sentence, .created = messages::if_any(done->created)}));
    });
}

void copy(Scenarios& all, const json& wanted, const std::string& by, const Answered& answered) {
    const auto name = wanted.is_object() ? wanted.find("copy_of") : wanted.end();
    if (name == wanted.end() || !name->is_string()) {
        return answered(refusal(Outcome::wrong, "the body is an object with copy_of, a scenario's name"));
    }
    if (const Status known = twin::check_keys(wanted, {"copy_of", "action"}); !known) {
        return answered(refusal(Outcome::wrong, known.error().message));
    }
    const auto index = all.find(name->get<std::string>());
    if (!index) return answered(no_scenario(name->get<std::string>()));
    all.copy(*index, wanted.value("action", json()), by, [answered](const Result<Copied>& made) {
        if (!made) return answered(refusal(Outcome::not_now, made.error().message));
        answered(reply(messages::NewScenario{
            .done = made->done.sentence, .created = made->name, .object = messages::if_any(made->done.created)}));
    });
}

Reply end(Scenarios& all, const std::string& scenario) {
    const auto index = all.find(scenario);
    if (!index) return no_scenario(scenario);
    const Status removed = all.remove(*index);
    if (!removed) return refusal(Outcome::not_now, removed.error().message);
    return reply(messages::Done{.done = "scenario " + scenario + " ended", .created = {}});
}

}  // namespace talus::session
