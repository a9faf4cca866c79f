#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "serve/access.hpp"
#include "serve/loop.hpp"
#include "serve/worker.hpp"
#include "session/people.hpp"

namespace talus::serve {

using session::People;
using session::Person;

/// A connected viewer: a WebSocket. Sending to it must not block.
class Viewer {
  public:
    virtual ~Viewer() = default;
    virtual void send(Bytes text) = 0;
    /// Replaces a frame of the same scenario that has not been sent.
    virtual void offer(int scenario, Bytes frame) = 0;
    /// Frames per second and scenario, at most.
    virtual void set_rate(double rate_hz) = 0;
    /// Ends the connection once `last` is sent; it does not call the session any more.
    virtual void dismiss(Bytes last) = 0;
};

/// Access of the session to the server's thread.
struct Thread {
    std::function<void(std::function<void()>)> post;            ///< runs something on it, soon
    std::function<void(std::chrono::milliseconds)> tick_after;  ///< calls Session::tick once, after a while
};

/// State shared by all connections: the scenarios, the people, and what each viewer watches. Everything but the
/// functions of Watcher is for the server's thread.
class Session final : public Watcher {
  public:
    Session(Thread thread, std::shared_ptr<const scene::Scene> scene, Tokens tokens);
    ~Session() override;

    /// Opens the scene; once, before anything else. Errors: as Loop::start.
    [[nodiscard]] Status open(twin::ScenarioOptions options, std::function<void(std::string)> failed);
    /// Ends the threads; pending requests are not answered.
    void close();

    /// Sends the current state to a new viewer. Until `leave`, `viewer` receives every change.
    void join(Viewer& viewer, Role role, const std::string& name, const std::string& former);
    void leave(Viewer& viewer);
    /// Tells all viewers that the session has ended, and lets them go.
    void dismiss_all();
    /// Handles a message from a viewer. False: it violates the protocol, and the connection must be closed.
    [[nodiscard]] bool receive(Viewer& viewer, std::string_view text);
    void tick();

    [[nodiscard]] Loop& loop() { return *loop_; }
    [[nodiscard]] People& people() { return people_; }
    /// For work of fractions of a second that should not delay either thread.
    [[nodiscard]] Worker& worker() { return *worker_; }
    [[nodiscard]] const std::shared_ptr<const scene::Scene>& scene() const { return scene_; }
    /// Notifies everybody, soon.
    void people_changed();
    /// As `GET /api/session`.
    [[nodiscard]] nlohmann::json describe(Role role) const;

    /// Sends the state of a calibration to everybody, also to those who join later; from any thread.
    void calibration(nlohmann::json status);
    /// The same for the depth-averaged model of a scenario.
    void depth_averaged(int scenario, nlohmann::json status);
    /// `changed` is called from the loop's thread after every change of a setup, or of which scenarios there are. Once,
    /// before open().
    void watch_setups(std::function<void()> changed) { setups_changed_ = std::move(changed); }

    /// Sends the state of triggers and alarms in the same way.
    void alerts(nlohmann::json status);
    /// Who is told, on the server's thread, of the alerts of runs.
    void on_alerts(std::function<void(int scenario, const RunAlerts&)> listener) { on_alerts_ = std::move(listener); }
    /// For the server's thread, from any other.
    void post(std::function<void()> task) { thread_.post(std::move(task)); }

    // Watcher, from the loop's thread.
    void frames(FrameSet set) override;
    void state(int scenario, nlohmann::json state) override;
    void setup(int scenario, nlohmann::json setup) override;
    void done(int scenario, const std::string& by, const std::string& sentence) override;
    void scenarios(std::vector<std::string> names) override;
    void alerts(int scenario, RunAlerts alerts) override;

  private:
    /// What a viewer wants to see.
    struct View {
        std::string person;
        std::array<bool, Scenarios::max_count> looks{};
        double rate_hz = 0;
        unsigned cap = 0;
    };
    [[nodiscard]] bool set_view(Viewer& viewer, View& view, const nlohmann::json& message);
    void update_audience();
    void pack_frames();
    void deliver_frames();
    void offer_newest(Viewer& viewer, const View& view, int scenario);
    void broadcast(const nlohmann::json& message);
    void arm_tick();
    void tell_people(Clock::time_point now);
    [[nodiscard]] Clock::duration people_interval() const;

    Thread thread_;
    std::string id_;  // of this session: pages that reconnect see whether it is still the same
    std::shared_ptr<const scene::Scene> scene_;
    Tokens tokens_;
    People people_;
    std::map<Viewer*, View> viewers_;
    std::vector<std::string> names_{"A"};
    std::array<Bytes, Scenarios::max_count> states_, setups_;  // as messages; for those who join
    Bytes calibration_, alerts_;                               // likewise
    std::function<void(int, const RunAlerts&)> on_alerts_;
    std::array<Bytes, Scenarios::max_count> depth_averaged_;  // likewise
    std::function<void()> setups_changed_ = [] {};
    std::vector<Audience> audience_;
    /// Encoded frames, by cap.
    using Packed = std::vector<std::pair<unsigned, Bytes>>;
    std::array<Packed, Scenarios::max_count> newest_;
    bool people_untold_ = false, ticking_ = false;
    Clock::time_point people_told_{};

    // In transit from the loop to the viewers; at either stage a newer one replaces an older one.
    std::mutex frames_mutex_;
    std::array<std::optional<FrameSet>, Scenarios::max_count> arrived_;  // guarded by the mutex, as the next three
    std::array<std::optional<Packed>, Scenarios::max_count> packed_;
    bool packing_posted_ = false, delivery_posted_ = false;

    std::unique_ptr<Worker> worker_ = std::make_unique<Worker>("worker");
    std::unique_ptr<Worker> packer_ = std::make_unique<Worker>("packer");  // compresses frames
    std::unique_ptr<Loop> loop_;
};

}  // namespace talus::serve
