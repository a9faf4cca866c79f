#pragma once

#include <array>
#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "session/pace.hpp"
#include "twin/alarms.hpp"
#include "twin/frame.hpp"
#include "twin/scenario.hpp"

namespace talus::session {

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

/// What started a run, and the alarms that it has raised.
// NOLINTNEXTLINE(bugprone-exception-escape): moving JSON does not throw
struct RunAlerts {
    nlohmann::json trigger;  ///< its action; null: people started the run
    std::vector<twin::RaisedAlarm> alarms;
    std::size_t news = 0;  ///< of the alarms, the last ones: raised since the last call
};

/// Notified of changes of the scenarios, on the thread that owns them.
class Watcher {
  public:
    virtual ~Watcher() = default;
    virtual void frames(FrameSet set) = 0;
    virtual void state(int scenario, nlohmann::json state) = 0;
    virtual void setup(int scenario, nlohmann::json told, const twin::Setup& setup) = 0;
    virtual void done(int scenario, const std::string& by, const std::string& sentence) = 0;
    virtual void scenarios(std::vector<std::string> names) = 0;
    virtual void alerts(int scenario, RunAlerts alerts) = 0;
};

/// A scenario that was made from another.
struct Copied {
    std::string name;
    twin::Done done;
};

/// Work that takes long, for another thread; it ends soon once `stop` is set. `then` is called by the owner of the
/// scenarios, between two steps.
using Work = std::function<void(const std::atomic<bool>& stop)>;
using Elsewhere = std::function<void(Work work, std::function<void()> then)>;

/// A clock, for what measures how long something took.
using Now = std::function<Clock::time_point()>;

template <class Value>
using Answer = std::function<void(Result<Value>)>;

/// The scenarios of a session, and the clock that they share: of those that run, the one that is behind in simulated
/// time steps first. Independent of threads: `work` must be called when it is due, and after any other call.
class Scenarios {
  public:
    static constexpr int max_count = 6;
    /// The highest rate of frames, Hz, and the fewest particles that a viewer can limit frames to.
    static constexpr double highest_rate = 60;
    static constexpr unsigned lowest_cap = 1000;
    /// Changes of a scenario that wait while another is prepared.
    static constexpr std::size_t max_waiting = 32;

    Scenarios(std::unique_ptr<twin::Scenario> first, Watcher& watcher, Elsewhere elsewhere);

    /// 0 for "A", 1 for "B", ...; empty if there is none of that name.
    [[nodiscard]] std::optional<int> find(const std::string& name) const;
    [[nodiscard]] std::vector<std::string> names() const;
    [[nodiscard]] twin::Scenario& at(int index) { return *slots_[static_cast<std::size_t>(index)].scenario; }

    /// Any action of docs/protocol.md. A change is prepared elsewhere, one at a time; meanwhile its scenario takes no
    /// step. Errors name key, value and allowed range, or say that max_waiting wait already; then nothing is changed.
    void act(int index, const nlohmann::json& action, const std::string& by, const Answer<twin::Done>& answer);
    /// Another scenario with the setup that `from` has now, at time 0. `action`: applied to it first, unless null; the
    /// scenario then runs if `from` does, otherwise it is paused. Errors: there are max_count; as of `act`, and then
    /// there is no new scenario.
    void copy(int from, const nlohmann::json& action, const std::string& by, const Answer<Copied>& answer);
    /// Keeps a place for the runs of triggers, which people cannot take.
    void reserve_for_triggers() { reserved_ = 1; }
    /// Starts the scene as its file has it with a trigger's action, in place of an earlier run of a trigger that is
    /// over or in a free one. Errors: there is no such place; as of twin::read_trigger.
    void start_by_trigger(const nlohmann::json& action, const std::string& by, const Answer<Copied>& answer);
    /// Whether there is such a place now.
    [[nodiscard]] bool has_place(const std::string& trigger) { return place_for(trigger) != nullptr; }
    /// Puts a value of a gauge in force: as `act`.
    void follow_gauge(int index, const nlohmann::json& action, const std::string& by, const Answer<twin::Done>& answer);
    /// The run of a trigger that goes on or is paused; empty: there is none.
    [[nodiscard]] std::optional<int> run_of(const std::string& trigger) const;
    /// Another scenario, paused, in the place of the one of that index, if there is one.
    void put(int index, std::unique_ptr<twin::Scenario> scenario, const std::string& title);
    /// Error: the first one cannot be removed.
    [[nodiscard]] Status remove(int index);

    /// Given by people; may be empty.
    [[nodiscard]] const std::string& title(int index) const { return slots_[static_cast<std::size_t>(index)].title; }
    [[nodiscard]] nlohmann::json state(int index) const;
    [[nodiscard]] nlohmann::json setup(int index) const;
    /// The current frame with every `stride`-th particle.
    [[nodiscard]] twin::FramePtr frame(int index, unsigned stride) const;

    /// An entry per scenario; those without one have no audience.
    void set_audience(const std::vector<Audience>& audience);

    /// Takes a step if one is due, and notifies the watcher. Returns when to call it again; empty: not before another
    /// call.
    std::optional<Clock::time_point> work(const Now& clock);

    static constexpr const char* name_of(int index) {
        constexpr std::array<const char*, max_count> letters{"A", "B", "C", "D", "E", "F"};
        return letters[static_cast<std::size_t>(index)];
    }

  private:
    /// A change that is to be prepared after the present one.
    struct Waiting {
        std::function<void()> begin;
        std::function<void(const Error&)> refuse;  ///< in place of it
    };
    struct Job {
        std::string what;
        bool holds = true;  ///< the scenario takes no step meanwhile
        std::atomic<bool> cancelled = false;
        std::atomic<double> share = 0;
    };
    /// State of a scenario between two messages to its viewers.
    struct Slot {
        std::shared_ptr<twin::Scenario> scenario;  // none: this slot is free
        std::shared_ptr<Job> job;                  // what is being prepared for it
        std::deque<Waiting> waiting;               // what is to be prepared after that
        std::string title;                         // given by people
        bool running = false;
        RateMeter rate;
        Audience audience;
        bool frame_wanted = false, state_wanted = false;
        Clock::time_point next_frame{}, next_state{};
        nlohmann::json told_setup;
        std::uint32_t ids = 0;      // particle ids in the newest frame
        bool told_trigger = false;  // what the watcher knows of its alerts
        std::size_t told_alarms = 0;

        [[nodiscard]] bool ready() const { return scenario && scenario->phase() == run::RunPhase::ready; }
        [[nodiscard]] bool steps() const { return running && ready() && !(job && job->holds); }
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
    void tell_alerts(int index);
    [[nodiscard]] Slot* place_for(const std::string& trigger);
    void tell_setup(int index);
    [[nodiscard]] Result<twin::Done> set_speed(const nlohmann::json& action);
    [[nodiscard]] Result<twin::Done> run_control(const std::string& name, const Slots& slots);
    void change(Slot& slot, const nlohmann::json& action, const std::string& by, const Answer<twin::Done>& answer);
    void restart(const Slots& slots, const nlohmann::json& action, const std::string& by,
                 const Answer<twin::Done>& answer);
    [[nodiscard]] twin::Done cancel(Slot& slot);
    template <class Made>
    void prepare(Slot& slot, const std::string& what, bool holds,
                 std::function<Result<Made>(const sim::Progress&)> work, std::function<void(Result<Made>)> then);
    void prepare_next(const Job* ended);
    [[nodiscard]] Result<twin::Done> give_name(Slot& slot, const nlohmann::json& action);
    [[nodiscard]] int index_of(const Slot& slot) const { return static_cast<int>(&slot - slots_.data()); }

    Watcher& watcher_;
    Elsewhere elsewhere_;
    std::array<Slot, max_count> slots_;
    int reserved_ = 0;  // places for triggers
    Pace pace_;
};

}  // namespace talus::session
