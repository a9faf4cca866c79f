#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "session/role.hpp"
#include "session/scenarios.hpp"

/// What people ask of the scenarios of a session, and the answers, however both travel.
namespace talus::session {

/// How a request ends. Otherwise than done, the answer is `{"error": sentence}`.
enum class Outcome { done, wrong, unknown, not_now };
/// The status that HTTP has for it.
[[nodiscard]] int status_of(Outcome outcome);

struct Reply {
    Outcome outcome = Outcome::done;
    Bytes body;
    bool binary = false;  ///< a frame or a grid; otherwise JSON
};
using Answered = std::function<void(Reply)>;

[[nodiscard]] Reply reply(const nlohmann::json& content);
[[nodiscard]] Reply refusal(Outcome outcome, const std::string& sentence);
[[nodiscard]] Reply no_scenario(const std::string& name);

/// The number of the arguments for `key`; empty: absent. Error: not a number from `low` to `high`.
[[nodiscard]] Result<std::optional<double>> number_of(const Arguments& arguments, const std::string& key, double low,
                                                      double high);

/// The rest of the work on an answer once the scenario has provided the data; for any thread.
using Rest = std::function<Reply()>;

/// What can be asked about a scenario.
struct Question {
    std::string name;               ///< "state", "layers/{name}"
    std::vector<std::string> keys;  ///< arguments that it may have beside those in its name
    bool slow = false;              ///< its rest takes long enough to delay steps
    std::function<Rest(Scenarios&, int index, const Arguments&)> ask;
};
[[nodiscard]] const std::vector<Question>& questions();
/// Between two steps.
[[nodiscard]] Rest ask(Scenarios& all, const std::string& scenario, const Question& question,
                       const Arguments& arguments);

/// Any action of docs/protocol.md. The answer is `{"done", "created"}`.
void act(Scenarios& all, const std::string& scenario, const nlohmann::json& action, const std::string& by,
         const Answered& answered);
/// `{"copy_of": "A", "action": {...}}`. The answer is `{"done", "created", "object"}`.
void copy(Scenarios& all, const nlohmann::json& wanted, const std::string& by, const Answered& answered);
[[nodiscard]] Reply end(Scenarios& all, const std::string& scenario);

}  // namespace talus::session
