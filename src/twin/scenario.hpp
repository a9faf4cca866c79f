#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"
#include "sim/relax.hpp"

namespace talus::twin {

struct Journal;
struct JournalEntry;
class LiveRun;
struct Replayed;

struct ScenarioOptions {
    std::vector<std::string> overrides;         ///< that the scene was loaded with, for the journal
    double frame_interval = 0.1;                ///< s of simulated time between recorded frames
    std::size_t recording_bytes = 512'000'000;  ///< when full, every second frame of the older half is removed
    std::filesystem::path fault_folder{};       ///< a fault is kept in a new folder there; empty: nowhere
};

/// The effect of an action.
struct Done {
    std::string sentence;  ///< for people: "friction coefficient 0.4 -> 0.3"
    std::string created;   ///< id of a new release, barrier or building; empty: none
};

/// A run that can be changed while it runs. No thread, no socket: one caller at a time. docs/twin.md has the plan,
/// docs/protocol.md the JSON of actions. What is read from it is in answers.hpp (JSON of docs/protocol.md),
/// results.hpp, recorded_flow.hpp, scene_copy.hpp, journal.hpp, and depth_averaged.hpp.
class Scenario {
  public:
    using Opened = Result<std::unique_ptr<Scenario>>;
    /// The work of opening one, for any thread, while the scenario that it came from continues.
    using Opening = std::function<Opened(const sim::Progress&)>;

    /// Errors: as of Run::start().
    [[nodiscard]] static Opened open(std::shared_ptr<const scene::Scene> scene, ScenarioOptions options = {},
                                     const sim::Progress& progress = {});
    /// This one as it is now, to go on by itself: to the same bits, with the same journal, until they are changed. In
    /// the time that copying its memory takes.
    [[nodiscard]] std::unique_ptr<Scenario> fork() const;
    /// The same scene and the setup of this one as it is now, at time 0, with what can be undone and redone.
    [[nodiscard]] Opening copying() const;
    /// The scene as its file has it, without anybody's changes but to observations, triggers and alarms.
    [[nodiscard]] Opening opening() const;
    ~Scenario();
    Scenario(const Scenario&) = delete;
    Scenario& operator=(const Scenario&) = delete;

    /// Takes one step, observers and recording included. Nothing happens unless phase() is ready.
    void advance();
    /// Any action of docs/protocol.md that changes results: not run, pause, step, set_speed. Also those of triggers and
    /// gauges (trigger.hpp). Errors name key, value and allowed range; then nothing is changed.
    [[nodiscard]] Result<Done> apply(const nlohmann::json& action, const std::string& by);
    /// The part of it that can fail or takes long, for any thread. Until commit() the scenario must neither advance nor
    /// change; reading it is safe.
    struct Prepared;
    [[nodiscard]] Result<std::shared_ptr<Prepared>> prepare(const nlohmann::json& action, const std::string& by,
                                                            const sim::Progress& progress = {}) const;
    Done commit(Prepared& prepared);

    [[nodiscard]] run::RunPhase phase() const;
    [[nodiscard]] std::string message() const;  ///< why it is at rest, ended or at fault; empty while ready
    [[nodiscard]] double time() const;          ///< s
    [[nodiscard]] std::uint64_t step() const;
    [[nodiscard]] const scene::Scene& scene() const;
    /// With its setup, state and recording (live_run.hpp).
    [[nodiscard]] const LiveRun& run() const;
    /// The rest, for the functions that read it (scenario_parts.hpp).
    struct Parts;
    [[nodiscard]] const Parts& parts() const { return *parts_; }

  private:
    friend Result<Replayed> replay(const Journal& journal, std::shared_ptr<const scene::Scene> scene,
                                   const std::function<bool(std::uint64_t step)>& on_step,
                                   std::optional<ScenarioOptions> options);
    explicit Scenario(std::unique_ptr<Parts> parts);
    /// At the start of the session of a journal.
    [[nodiscard]] static Opened open_at(const Journal& journal, std::shared_ptr<const scene::Scene> scene,
                                        ScenarioOptions options);
    /// Repeats an entry of a journal. Errors: as apply().
    [[nodiscard]] Status follow(const JournalEntry& entry);

    std::unique_ptr<Parts> parts_;
};

}  // namespace talus::twin
