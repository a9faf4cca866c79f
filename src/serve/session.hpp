#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "serve/access.hpp"
#include "serve/executor.hpp"
#include "serve/loop.hpp"
#include "session/room.hpp"

namespace talus::serve {

using session::People;
using session::Person;
using session::Viewer;

/// Access of the session to the server's thread.
struct Thread {
    std::function<void(std::function<void()>)> post;            ///< runs something on it, soon
    std::function<void(std::chrono::milliseconds)> tick_after;  ///< calls Session::tick once, after a while
};

/// A session across threads: its room on the server's thread, its scenarios on the loop's, frames packed on a lane.
/// Everything but the functions of Watcher is for the server's thread.
class Session final : public Watcher {
  public:
    Session(Thread thread, Executor& executor, std::shared_ptr<const scene::Scene> scene, Tokens tokens);
    ~Session() override;

    /// Opens the scene; once, before anything else. Errors: as Loop::start.
    [[nodiscard]] Status open(twin::ScenarioOptions options, std::function<void(std::string)> failed);
    /// Ends thread and lanes; pending requests are not answered.
    void close();

    // As session::Room has it.
    void join(Viewer& viewer, Role role, const std::string& name, const std::string& former);
    void leave(Viewer& viewer);
    void dismiss_all() { room_->dismiss_all(); }
    [[nodiscard]] bool receive(Viewer& viewer, std::string_view text);
    void tick();
    [[nodiscard]] People& people() { return room_->people(); }
    void people_changed();
    [[nodiscard]] messages::Session describe(Role role) const { return room_->describe(role); }

    [[nodiscard]] Loop& loop() { return *loop_; }
    /// For work of fractions of a second that should not delay either thread.
    [[nodiscard]] Lane& worker() { return worker_; }
    [[nodiscard]] Executor& executor() { return executor_; }
    [[nodiscard]] const std::shared_ptr<const scene::Scene>& scene() const { return scene_; }

    /// Sends the state of a calibration to everybody, also to those who join later; from any thread.
    void calibration(nlohmann::json status);
    /// The same for the depth-averaged model of a scenario.
    void depth_averaged(int scenario, nlohmann::json status);
    /// `changed` is called from the loop's thread after every change of a setup, or of which scenarios there are. Once,
    /// before open().
    void watch_setups(std::function<void()> changed) { setups_changed_ = std::move(changed); }

    /// Sends the state of triggers and alarms in the same way.
    void alerts(nlohmann::json status);
    /// Sends the list of layers over the terrain in the same way.
    void overlays(nlohmann::json list);
    /// Who is told, on the server's thread, of the alerts of runs.
    void on_alerts(std::function<void(int scenario, const RunAlerts&)> listener) { on_alerts_ = std::move(listener); }
    /// Who is told, on the server's thread, of every setup of the first scenario: what is not of one run is as it has
    /// it.
    void on_first_setup(std::function<void(const twin::Setup&)> listener) { on_first_setup_ = std::move(listener); }
    /// For the server's thread, from any other.
    void post(std::function<void()> task) { thread_.post(std::move(task)); }

    // Watcher, from the loop's thread.
    void frames(FrameSet set) override;
    void state(int scenario, nlohmann::json state) override;
    void setup(int scenario, nlohmann::json told, const twin::Setup& setup) override;
    void done(int scenario, const std::string& by, const std::string& sentence) override;
    void scenarios(std::vector<std::string> names) override;
    void alerts(int scenario, RunAlerts alerts) override;

  private:
    void keep(session::Kept what, int scenario, nlohmann::json message);
    void pack_frames();
    void deliver_frames();
    void arm_tick();

    Thread thread_;
    Executor& executor_;
    std::shared_ptr<const scene::Scene> scene_;
    Tokens tokens_;
    std::unique_ptr<session::Room> room_;
    std::function<void(int, const RunAlerts&)> on_alerts_;
    std::function<void(const twin::Setup&)> on_first_setup_;
    std::function<void()> setups_changed_ = [] {};
    bool ticking_ = false;

    // In transit from the loop to the viewers; at either stage a newer one replaces an older one.
    std::mutex frames_mutex_;
    std::array<std::optional<FrameSet>, Scenarios::max_count> arrived_;  // guarded by the mutex, as the next three
    std::array<std::optional<session::PackedFrames>, Scenarios::max_count> packed_;
    bool packing_posted_ = false, delivery_posted_ = false;

    Lane worker_{executor_, "worker"}, packer_{executor_, "packer"};  // the latter compresses frames
    std::unique_ptr<Loop> loop_;
};

}  // namespace talus::serve
