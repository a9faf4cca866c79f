#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "session/people.hpp"
#include "session/role.hpp"
#include "session/scenarios.hpp"

namespace talus::session {

/// A connected viewer. Sending to it must not block.
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

/// Messages of which those who join later get the newest. The last two are about the session, the others about a
/// scenario.
enum class Kept { setup, state, depth_averaged, calibration, alerts, overlays };

[[nodiscard]] Bytes message_text(Kept what, nlohmann::json message);

/// Encoded frames of a scenario, by cap.
using PackedFrames = std::vector<std::pair<unsigned, Bytes>>;
/// Compresses, which takes milliseconds; for any thread.
[[nodiscard]] PackedFrames pack(const FrameSet& set);

/// The people of a session, what each of them looks at, and what they are told. Does not depend on connections nor on
/// who owns the scenarios; time is an argument.
class Room {
  public:
    struct Settings {
        std::string id;       ///< of the session: pages that reconnect see whether it is still the same
        std::string program;  ///< its name and version
        std::string title;    ///< of the scene
        std::function<messages::Session::Links(Role)> links;  ///< that somebody with this role may pass on
        std::function<void(std::vector<Audience>)> watching;  ///< told what people look at, whenever that changes
    };
    /// The time in which a list of people is sent once at most; with many of them less often.
    static constexpr std::chrono::milliseconds tick_time{100};
    static constexpr int whole_session = Scenarios::max_count;  ///< in place of a scenario

    explicit Room(Settings settings) : settings_(std::move(settings)) {}

    /// Sends the current state to a new viewer. Until `leave`, `viewer` receives every change.
    const Person& join(Viewer& viewer, Role role, const std::string& name, const std::string& former,
                       Clock::time_point now);
    void leave(Viewer& viewer, Clock::time_point now);
    /// Tells all viewers that the session has ended, and lets them go.
    void dismiss_all();
    /// Handles a message from a viewer. False: it violates the protocol, and the connection must be closed.
    [[nodiscard]] bool receive(Viewer& viewer, std::string_view text, Clock::time_point now);

    [[nodiscard]] People& people() { return people_; }
    /// Notifies everybody, soon.
    void people_changed(Clock::time_point now);
    /// Whether tick() is to be called after another tick_time.
    [[nodiscard]] bool waiting() const { return people_untold_ || people_.waiting(); }
    void tick(Clock::time_point now);

    /// As `GET /api/session`.
    [[nodiscard]] messages::Session describe(Role role) const;

    /// A message for everybody who is here.
    void tell(const Bytes& text);
    void tell(const nlohmann::json& message);
    /// A message that replaces the former one of its kind and scenario.
    void keep(Kept what, int scenario, const Bytes& text);
    /// Which scenarios there are; what is known of others is forgotten.
    void scenarios(const std::vector<std::string>& names);
    void done(int scenario, const std::string& by, const std::string& sentence);
    void deliver(int scenario, PackedFrames frames);

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
    void offer_newest(Viewer& viewer, const View& view, int scenario);
    void tell_people(Clock::time_point now);
    [[nodiscard]] Clock::duration people_interval() const;

    Settings settings_;
    People people_;
    std::map<Viewer*, View> viewers_;
    std::vector<std::string> names_{"A"};
    std::array<std::map<Kept, Bytes>, Scenarios::max_count + 1> kept_;  // the last: about the session
    std::vector<Audience> audience_;
    std::array<PackedFrames, Scenarios::max_count> newest_;
    bool people_untold_ = false;
    Clock::time_point people_told_{};
};

}  // namespace talus::session
