#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "messages/messages.hpp"
#include "session/scenarios.hpp"
#include "twin/depth_averaged.hpp"

/// The depth-averaged model of the present setup of every scenario, beside the live runs. Off until it is switched on.
namespace talus::session {

/// What is known of it, and what is to be computed next: one run at a time, that of the scenario that was changed last.
/// A changed setup discards its result. For one thread at a time. Functions that return scenario indices return
/// those whose status has changed.
class DepthAveragedResults {
  public:
    using Run = std::shared_ptr<const twin::DepthAveragedRun>;
    /// A run to be computed.
    struct Task {
        int scenario = -1;
        std::uint64_t asked = 0;
        std::function<Result<scene::Scene>()> scene{};
    };
    /// How one ended: with a run, refused by the scene that it asked for, or failed.
    struct Outcome {
        Run made{};
        std::string refused{}, failed{};
    };

    explicit DepthAveragedResults(const twin::DepthAveragedLimits& limits = {}) : limits_(limits) {}

    /// For all scenarios, also those to come. Off: results are discarded.
    std::vector<int> turn(bool on);
    [[nodiscard]] bool on() const { return on_; }
    /// Looks at what has changed, between two steps.
    std::vector<int> look(Scenarios& all);

    /// The next one, which is running from now on; empty: nothing is to be computed.
    [[nodiscard]] std::optional<Task> begin();
    /// Whether the task is still about the present setup.
    [[nodiscard]] bool wants(const Task& task) const { return slot(task.scenario).asked == task.asked; }
    /// Both do nothing for a task that is wanted no more.
    void take_share(const Task& task, double share);
    void finish(const Task& task, Outcome outcome);

    /// As `GET /api/scenarios/{s}/depth_averaged`.
    [[nodiscard]] messages::DepthAveragedStatus describe(int scenario) const;
    /// The result for the present setup; nullptr: there is none yet.
    [[nodiscard]] Run result(int scenario) const { return slot(scenario).made; }
    /// Why there is no result, as a sentence.
    [[nodiscard]] std::string why_none(int scenario) const;

  private:
    enum class State { off, waiting, running, done, refused, failed };
    struct Slot {
        State state = State::off;
        std::string key;          ///< the setup that this is about
        std::uint64_t asked = 0;  ///< counts questions; the newest is answered first. 0: there is none
        std::function<Result<scene::Scene>()> scene;
        std::string message;  ///< why it was refused or failed
        double share = 0;     ///< of the simulated time
        Run made;
    };
    static const char* name_of(State state);
    Slot& slot(int scenario) { return slots_[static_cast<std::size_t>(scenario)]; }
    [[nodiscard]] const Slot& slot(int scenario) const { return slots_[static_cast<std::size_t>(scenario)]; }

    twin::DepthAveragedLimits limits_;
    std::array<Slot, Scenarios::max_count> slots_;
    std::uint64_t asked_ = 0;
    bool on_ = false;
};

/// Computes it in turns with the live runs, on the caller's thread.
class DepthAveragedInTurns {
  public:
    /// `tell`: called with what everybody is to be told of a scenario.
    explicit DepthAveragedInTurns(std::function<void(int scenario, nlohmann::json status)> tell)
        : tell_(std::move(tell)) {}

    void turn(bool on, Scenarios& all);
    /// After a change of a setup, or of which scenarios there are.
    void look(Scenarios& all);
    /// A step. False: there is nothing to do.
    bool step(Clock::time_point now);
    [[nodiscard]] const DepthAveragedResults& results() const { return results_; }

  private:
    /// The run under way.
    struct Running {
        DepthAveragedResults::Task task;
        std::unique_ptr<const scene::Scene> scene;
        std::optional<twin::DepthAveragedSteps> steps;
    };
    [[nodiscard]] bool begin();
    void end(DepthAveragedResults::Outcome outcome);
    void tell(int scenario) { tell_(scenario, results_.describe(scenario)); }

    /// A page has 2 GB for this, up to six results and the live runs.
    static constexpr twin::DepthAveragedLimits limits{.most_cells = 1e6, .depth_bytes = 16'000'000};

    std::function<void(int, nlohmann::json)> tell_;
    DepthAveragedResults results_{limits};
    std::optional<Running> running_;
    Clock::time_point told_{};
};

/// What `{"on": true}` asks for.
[[nodiscard]] Result<bool> read_switch(const nlohmann::json& wanted);
/// As it is answered.
[[nodiscard]] messages::Done switched(bool on);

}  // namespace talus::session
