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

/// A scenario that was made from another.
struct Copied {
    std::string name;
    twin::Done done;
};

/// The scenarios of a session, and the clock that they share: of those that run, the one that is behind in simulated
/// time steps first. Independent of threads: `work` must be called when it is due, and after any other call.
class Scenarios {
  public:
    static constexpr int max_count = 6;
    /// The highest rate of frames, Hz, and the fewest particles that a viewer can limit frames to.
    static constexpr double highest_rate = 60;
    static constexpr unsigned lowest_cap = 1000;

    Scenarios(std::unique_ptr<twin::Scenario> first, Watcher& watcher);

    /// 0 for "A", 1 for "B", ...; empty if there is none of that name.
    [[nodiscard]] std::optional<int> find(const std::string& name) const;
    [[nodiscard]] std::vector<std::string> names() const;
    [[nodiscard]] twin::Scenario& at(int index) { return *slots_[static_cast<std::size_t>(index)].scenario; }

    /// Any action of docs/protocol.md. Errors name key, value and allowed range; then nothing is changed.
    [[nodiscard]] Result<twin::Done> act(int index, const nlohmann::json& action, const std::string& by);
    /// Another scenario with the setup that `from` has now, at time 0. `action`: applied to it first, unless null; the
    /// scenario then runs if `from` does, otherwise it is paused. Errors: there are max_count; as of `act`, and then
    /// there is no new scenario.
    [[nodiscard]] Result<Copied> copy(int from, const nlohmann::json& action, const std::string& by);
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

    static constexpr const char* name_of(int index) {
        constexpr std::array<const char*, max_count> letters{"A", "B", "C", "D", "E", "F"};
        return letters[static_cast<std::size_t>(index)];
    }

  private:
    /// State of a scenario between two messages to its viewers.
    struct Slot {
        std::unique_ptr<twin::Scenario> scenario;  // none: this slot is free
        std::string title;                         // given by people
        bool running = false;
        RateMeter rate;
        Audience audience;
        bool frame_wanted = false, state_wanted = false;
        Clock::time_point next_frame{}, next_state{};
        nlohmann::json told_setup;
        std::uint32_t ids = 0;  // particle ids in the newest frame

        [[nodiscard]] bool ready() const { return scenario && scenario->phase() == run::RunPhase::ready; }
        [[nodiscard]] bool steps() const { return running && ready(); }
    };
    using Slots = std::vector<Slot*>;
    static void advance(Slot& slot);
    [[nodiscard]] Slots all();
    /// Those that an action lists under "scenarios".
    [[nodiscard]] Result<Slots> listed(const nlohmann::json& action, Slots otherwise);
    [[nodiscard]] static Slot* furthest_behind(const Slots& slots);
    static void step_all(const Slots& slots);
    void start_clock();
    void want_all();
    void tell_state(int index, Clock::time_point now);
    void tell_frames(int index, Clock::time_point now);
    void tell_names();
    void tell_setup(int index);
    [[nodiscard]] Result<twin::Done> set_speed(const nlohmann::json& action);
    [[nodiscard]] Result<twin::Done> steer(const std::string& name, const Slots& slots);
    [[nodiscard]] Result<twin::Done> change(Slot& slot, const nlohmann::json& action, const std::string& by);
    [[nodiscard]] Result<twin::Done> give_name(Slot& slot, const nlohmann::json& action);
    [[nodiscard]] int index_of(const Slot& slot) const { return static_cast<int>(&slot - slots_.data()); }

    Watcher& watcher_;
    std::array<Slot, max_count> slots_;
    Pace pace_;
};

}  // namespace talus::serve
