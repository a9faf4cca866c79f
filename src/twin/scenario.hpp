#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "observe/observer.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"
#include "sim/model.hpp"
#include "sim/relax.hpp"
#include "sim/state.hpp"
#include "twin/alarms.hpp"
#include "twin/depth_averaged.hpp"
#include "twin/frame.hpp"

namespace talus::twin {

struct Journal;
struct JournalEntry;
class RecordedFlow;
struct SceneCopy;

/// "ready", "at_rest", "ended", "fault".
[[nodiscard]] std::string_view phase_name(run::RunPhase phase);

struct ScenarioOptions {
    std::vector<std::string> overrides;         ///< that the scene was loaded with, for the journal
    double frame_interval = 0.1;                ///< s of simulated time between recorded frames
    std::size_t recording_bytes = 512'000'000;  ///< when full, every second frame of the older half is removed
    std::filesystem::path fault_folder{};       ///< a fault is kept in a new folder there; empty: nowhere
};

/// More are refused in a change of a live run: a scenario file decides for itself.
inline constexpr int max_live_particles = 1'000'000;

/// The effect of an action.
struct Done {
    std::string sentence;  ///< for people: "friction coefficient 0.4 -> 0.3"
    std::string created;   ///< id of a new release, barrier or building; empty: none
};

/// A file of a run, made when it is asked for.
struct RunFile {
    std::string name, type, what;
    std::function<std::string()> bytes;
};

/// Bits of a frame's `flags`.
inline constexpr unsigned frame_running = 1, frame_too_compressed = 2, frame_recorded = 4;

/// A run that can be changed while it runs. No thread, no socket: one caller at a time. docs/twin.md has the plan,
/// docs/protocol.md the JSON of actions and answers.
class Scenario {
  public:
    /// Errors: as of Run::start().
    [[nodiscard]] static Result<std::unique_ptr<Scenario>> open(std::shared_ptr<const scene::Scene> scene,
                                                                ScenarioOptions options = {},
                                                                const sim::Progress& progress = {});
    /// At the start of the session of a journal.
    [[nodiscard]] static Result<std::unique_ptr<Scenario>> open_at(const Journal& journal,
                                                                   std::shared_ptr<const scene::Scene> scene,
                                                                   ScenarioOptions options);
    /// This one as it is now, to go on by itself: to the same bits, with the same journal, until they are changed. In
    /// the time that copying its memory takes.
    [[nodiscard]] std::unique_ptr<Scenario> fork() const;
    /// The same scene and the setup of this one as it is now, at time 0, with what can be undone and redone.
    [[nodiscard]] Result<std::unique_ptr<Scenario>> copy() const { return copying()({}); }
    /// The work of that, for any thread, while this scenario continues.
    [[nodiscard]] std::function<Result<std::unique_ptr<Scenario>>(const sim::Progress&)> copying() const;
    /// The work of opening the scene as its file has it, without anybody's changes but to observations, triggers and
    /// alarms, for any thread.
    [[nodiscard]] std::function<Result<std::unique_ptr<Scenario>>(const sim::Progress&)> opening() const;
    ~Scenario();
    Scenario(const Scenario&) = delete;
    Scenario& operator=(const Scenario&) = delete;

    /// Takes one step, observers and recording included. Nothing happens unless phase() is ready.
    void advance();
    /// Any action of docs/protocol.md that changes results: not run, pause, step, set_speed. Also those of triggers and
    /// gauges (trigger.hpp). Errors name key, value and
    /// allowed range; then nothing is changed.
    [[nodiscard]] Result<Done> apply(const nlohmann::json& action, const std::string& by);
    /// The part of it that can fail or takes long, for any thread. Until commit() the scenario must neither advance nor
    /// change; reading it is safe.
    struct Prepared;
    [[nodiscard]] Result<std::shared_ptr<Prepared>> prepare(const nlohmann::json& action, const std::string& by,
                                                            const sim::Progress& progress = {}) const;
    Done commit(Prepared& prepared);

    /// Repeats an entry of a journal. Errors: as apply().
    [[nodiscard]] Status follow(const JournalEntry& entry);

    [[nodiscard]] run::RunPhase phase() const;
    [[nodiscard]] std::string message() const;  ///< why it is at rest, ended or at fault; empty while ready
    [[nodiscard]] double time() const;          ///< s
    [[nodiscard]] std::uint64_t step() const;
    [[nodiscard]] std::uint64_t hash() const;
    [[nodiscard]] std::uint64_t revision() const;  ///< grows with every change of the setup
    [[nodiscard]] const scene::Scene& scene() const;
    [[nodiscard]] const sim::Model& model() const;
    [[nodiscard]] const sim::Ground& ground() const;  ///< as entrainment has left it
    [[nodiscard]] const sim::State& state() const;
    [[nodiscard]] const observe::Observer& observer() const;

    [[nodiscard]] std::vector<params::TriggerSpec> triggers() const;
    /// Raised by the run so far.
    [[nodiscard]] const std::vector<RaisedAlarm>& alarms() const;
    /// The action of the trigger that started this run; nullptr: people did.
    [[nodiscard]] const nlohmann::json* trigger() const;

    // Answers, as docs/protocol.md has them. They lack `scenario`, which only the loop knows; state_json() also lacks
    // speed_factor, real_time_factor, steps_per_second, and its "status" is phase_name(phase()).
    [[nodiscard]] nlohmann::json scene_json() const;
    /// `with_hash`: it takes milliseconds with many particles.
    [[nodiscard]] nlohmann::json state_json(bool with_hash = true) const;
    /// Of the run as it is now; that of state_json() may be of a moment ago.
    [[nodiscard]] nlohmann::json verdict_json() const;
    [[nodiscard]] nlohmann::json setup_json() const;
    [[nodiscard]] nlohmann::json series_json() const;
    /// Without a time, s: now; otherwise at the recorded frame at or before it.
    [[nodiscard]] nlohmann::json impacts_json(std::optional<double> time = {}) const;
    /// As impacts_json(): between two rows of the time series a gauge reads the former.
    [[nodiscard]] nlohmann::json gauges_json(std::optional<double> time = {}) const;
    [[nodiscard]] nlohmann::json journal_json() const;
    [[nodiscard]] nlohmann::json recording_json() const;

    /// The current frame. `stride` >= 1: every stride-th particle. `flags`: frame_running; the frame adds
    /// frame_too_compressed itself.
    [[nodiscard]] FramePtr frame(unsigned stride, unsigned flags) const;
    /// The recorded frame at or before a time, s; nullptr: none.
    [[nodiscard]] FramePtr recorded_frame(double time) const;

    // Long operations. Each copies what it needs of the current run, and returns the work itself, which any thread can
    // do while the run continues.

    /// What passed at a point, over the recording.
    [[nodiscard]] std::function<nlohmann::json()> probe(const PlanPoint& p) const;
    /// One of run_layers(); NaN: no value. SI units. The last has cells of the terrain, the others those of the maps.
    /// Now, or at the recorded frame at or before a time (see past_layer; erosion is exact). Errors: no such layer,
    /// nothing recorded by that time.
    [[nodiscard]] Result<std::function<Grid<float>()>> layer(const std::string& name,
                                                             std::optional<double> time = {}) const;
    /// Whether debris has eroded any of its bed.
    [[nodiscard]] bool has_erosion() const;
    /// `{"figures": [...]}`: the key figures of the run so far, as in results.json.
    [[nodiscard]] std::function<nlohmann::json()> figures() const;
    /// What results.json has of the run so far.
    [[nodiscard]] nlohmann::json results_json() const;
    /// `{"run_out": ..., "gauges": [...], "crs_wkt": ...}` of the run so far, as talus.h says.
    [[nodiscard]] nlohmann::json measures_json() const;
    /// The files of the run so far that need no disk: tables and maps, as products() writes them. None before the
    /// first step.
    [[nodiscard]] std::vector<RunFile> page_files() const;
    /// Writes the run so far as `talus run` would, into an existing empty folder.
    [[nodiscard]] std::function<Status(const std::filesystem::path& folder)> products() const;
    /// The moving flow of the run so far (recorded_flow.hpp). It copies the results.
    [[nodiscard]] std::shared_ptr<const RecordedFlow> flow() const;

    /// The scene with the present setup, and the result of the run so far.
    [[nodiscard]] std::function<std::pair<scene::Scene, run::RunResult>()> outcome() const;
    /// As scene_copy(), of the present setup. `file`, `overrides`: of the scene.
    [[nodiscard]] std::function<Result<SceneCopy>(const std::filesystem::path& file,
                                                  const std::vector<std::string>& overrides)>
    copy_of_scene() const;

    // The depth-averaged model of the present setup, beside this run (depth_averaged.hpp).

    /// The present setup as a text: setups of one scene are the same if their texts are.
    [[nodiscard]] std::string setup_key() const;
    /// Makes the scene of the present setup, from time 0, for that model. Errors: as twin::for_depth_averaged().
    [[nodiscard]] std::function<Result<scene::Scene>()> for_depth_averaged(
        const DepthAveragedLimits& limits = {}) const;
    /// `{"time_s", "over", "rows", ...}` of docs/protocol.md: this run so far beside that one.
    [[nodiscard]] std::function<nlohmann::json()> compared_with(std::shared_ptr<const DepthAveragedRun> other) const;

  private:
    struct Parts;
    explicit Scenario(std::unique_ptr<Parts> parts);
    std::unique_ptr<Parts> parts_;
};

/// How a grid message holds its values: as they are, or as differences (core/byte_planes.hpp), which takes half the
/// bytes where a raster is smooth as terrain is.
enum class GridCoding : std::uint8_t { values, differences };

/// Encodes a grid message.
[[nodiscard]] std::string encode_grid(const Grid<float>& grid, GridCoding coding = GridCoding::values);

}  // namespace talus::twin
