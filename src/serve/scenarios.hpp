#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "serve/message.hpp"
#include "serve/pace.hpp"
#include "twin/scenario.hpp"

namespace talus::serve {

/// Requests of the viewers of a scenario.
struct Audience {
    double rate_hz = 0;          ///< the highest wanted
    std::vector<unsigned> caps;  ///< maximum particles in a frame; a frame is made for each; empty: no viewer
    friend bool operator==(const Audience&, const Audience&) = default;
};

/// The newest frame of a scenario for each cap of its audience. Caps that lead to the same stride share one.
struct FrameSet {
    int scenario = 0;
    std::vector<std::pair<unsigned, twin::FramePtr>> frames;
};

/// Notified of changes of the scenarios, on the thread that owns them.
class Watcher {
  public:
    virtual ~Watcher() = default;
    virtual void frames(FrameSet set) = 0;
    virtual void state(int scenario, nlohmann::json state) = 0;
    virtual void setup(int scenario, nlohmann::json setup) = 0;
    virtual void done(int scenario, const std::string& by, const std::string& sentence) = 0;
    virtual void scenarios(std::vector<std::string> names) = 0;
};

/// The scenarios of a session, at most two, and the clock that they share: run, pause, step and speed are for both, and
/// the one that is behind in simulated time steps first. Independent of threads: `work` must be called when it is due,
/// and after any other call.
class Scenarios {
  public:
    static constexpr int max_count = 2;
    /// The highest rate of frames, Hz, and the fewest particles that a viewer can limit frames to.
    static constexpr double highest_rate = 60;
    static constexpr unsigned lowest_cap = 1000;

    Scenarios(std::unique_ptr<twin::Scenario> first, Watcher& watcher);

    /// 0 for "A", 1 for "B"; empty if there is none of that name.
    [[nodiscard]] std::optional<int> find(const std::string& name) const;
    [[nodiscard]] std::vector<std::string> names() const;
    [[nodiscard]] twin::Scenario& at(int index) { return *slots_[static_cast<std::size_t>(index)].scenario; }

    /// Any action of docs/protocol.md. Errors name key, value and allowed range; then nothing is changed.
    [[nodiscard]] Result<twin::Done> act(int index, const nlohmann::json& action, const std::string& by);
    /// A second scenario with the setup that `from` has now, at time 0, paused. Error: there are two.
    [[nodiscard]] Result<std::string> copy(int from);
    /// Error: the first one cannot be removed.
    [[nodiscard]] Status remove(int index);

    [[nodiscard]] nlohmann::json state(int index) const;
    [[nodiscard]] nlohmann::json setup(int index) const;
    /// The current frame with every `stride`-th particle.
    [[nodiscard]] twin::FramePtr frame(int index, unsigned stride) const;

    /// An entry per scenario; those without one have no audience.
    void set_audience(const std::vector<Audience>& audience);

    /// Takes a step if one is due, and notifies the watcher. Returns when to call it again; empty: not before another
    /// call.
    std::optional<Clock::time_point> work(Clock::time_point now);

    static constexpr const char* name_of(int index) { return index == 0 ? "A" : "B"; }

  private:
    /// State of a scenario between two messages to its viewers.
    struct Slot {
        std::unique_ptr<twin::Scenario> scenario;  // none: this slot is free
        RateMeter rate;
        Audience audience;
        bool frame_wanted = false, state_wanted = false;
        Clock::time_point next_frame{}, next_state{};
        nlohmann::json told_setup;
        std::uint32_t ids = 0;  // particle ids in the newest frame

        [[nodiscard]] bool ready() const { return scenario && scenario->phase() == run::RunPhase::ready; }
    };
    static void advance(Slot& slot);
    [[nodiscard]] Slot* furthest_behind();
    void step_all();
    void set_running(bool running);
    void want_all();
    void tell_state(int index, Clock::time_point now);
    void tell_frames(int index, Clock::time_point now);
    void tell_names();
    void tell_setup(int index);
    [[nodiscard]] Result<twin::Done> steer(const std::string& name, const nlohmann::json& action);

    Watcher& watcher_;
    std::array<Slot, max_count> slots_;
    Pace pace_;
    bool running_ = false;
};

}  // namespace talus::serve
