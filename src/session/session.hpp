#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/hash.hpp"
#include "core/result.hpp"
#include "session/depth_averaged.hpp"
#include "session/requests.hpp"
#include "session/room.hpp"
#include "session/scenarios.hpp"
#include "twin/answers.hpp"
#include "twin/results.hpp"

namespace talus::session {

/// A session in one piece, for one caller: what the server puts threads and sockets around, here without either, so
/// that a test or a page can hold it. Nothing blocks for longer than a step or a change takes, and that only in
/// advance(). Alarms are raised, and sent to nobody.
class Session final : private Watcher {
  public:
    struct Setup {
        std::shared_ptr<const scene::Scene> scene;
        twin::ScenarioOptions options{};
        std::string program{};  ///< its name and version, for those who join
    };
    /// The scene as scenario A, paused at time 0. Errors: as twin::Scenario::open.
    [[nodiscard]] static Result<std::unique_ptr<Session>> open(Setup setup);
    ~Session() override;

    /// The person's id.
    std::string join(Role role, const std::string& name, Clock::time_point now);
    void leave(const std::string& id, Clock::time_point now);
    /// A message of docs/protocol.md: view, mark or name. False: it violates the protocol.
    [[nodiscard]] bool receive(const std::string& id, std::string_view text, Clock::time_point now);
    /// As People::control.
    [[nodiscard]] Status control(const std::string& what, const std::string& id, Clock::time_point now);

    // As the requests of docs/protocol.md. Changes are refused to all but who has control, and prepared in advance().
    void act(const std::string& id, const std::string& scenario, const nlohmann::json& action,
             const Answered& answered);
    void copy(const std::string& id, const nlohmann::json& wanted, const Answered& answered);
    [[nodiscard]] Reply end(const std::string& id, const std::string& scenario);
    /// `question`: the name of one of questions().
    [[nodiscard]] Reply ask(const std::string& scenario, const std::string& question, const Arguments& arguments = {});
    /// As twin::page_files_of; nothing: there is no such scenario.
    [[nodiscard]] std::optional<std::vector<twin::RunFile>> files(const std::string& scenario) const;
    /// `{"on": true}`: the depth-averaged model beside the runs.
    [[nodiscard]] Reply turn_depth_averaged(const std::string& id, const nlohmann::json& wanted);
    /// `question`: empty for its status, "comparison", or "layers/" and a name; a layer may have a time.
    [[nodiscard]] Reply depth_averaged(const std::string& scenario, const std::string& question,
                                       const Arguments& arguments = {});
    [[nodiscard]] Reply scene() const { return reply(twin::scene_json(scenarios_->at(0))); }
    /// Of the first scenario's state now, as in its journal.
    [[nodiscard]] std::string hash() const { return to_hex(twin::version_of(scenarios_->at(0)).hash); }
    /// As `GET /api/session`.
    [[nodiscard]] messages::Session describe(Role role) const { return room_->describe(role); }

    /// Does what is due, for about as long as `budget`, by the clock `now`. Returns when to call it again; empty: not
    /// before another call.
    std::optional<Clock::time_point> advance(const Now& now, Clock::duration budget);

    /// What a person has been sent since the last call: messages, and the newest frames of what the person looks at.
    [[nodiscard]] std::vector<Bytes> events(const std::string& id);
    [[nodiscard]] std::vector<Bytes> frames(const std::string& id);

  private:
    struct Guest;
    Session() = default;
    /// The name of who may act now.
    [[nodiscard]] Result<std::string> actor(const std::string& id);

    // Watcher.
    void frames(FrameSet set) override { room_->deliver(set.scenario, pack(set)); }
    void state(int scenario, nlohmann::json state) override;
    void setup(int scenario, nlohmann::json told, const twin::Setup& setup) override;
    void done(int scenario, const std::string& by, const std::string& sentence) override;
    void scenarios(std::vector<std::string> names) override;
    void alerts(int, RunAlerts) override {}

    std::unique_ptr<Room> room_;
    std::map<std::string, std::unique_ptr<Guest>> guests_;  // by id
    std::deque<std::pair<Work, std::function<void()>>> work_;
    std::unique_ptr<Scenarios> scenarios_;
    DepthAveragedInTurns depth_averaged_{[this](int scenario, nlohmann::json status) {
        room_->keep(Kept::depth_averaged, scenario, message_text(Kept::depth_averaged, std::move(status)));
    }};
    bool setups_changed_ = false;
};

}  // namespace talus::session
