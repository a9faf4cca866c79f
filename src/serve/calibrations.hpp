#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "calibrate/calibration.hpp"
#include "core/result.hpp"
#include "messages/messages.hpp"
#include "run/variants.hpp"
#include "scene/scene.hpp"
#include "serve/executor.hpp"
#include "serve/long_task.hpp"
#include "serve/message.hpp"
#include "twin/table_entry.hpp"

namespace talus::serve {

/// What calibrations run, and where.
struct CalibrationSettings {
    run::SceneSource source;       ///< loads the session's scene again; no file: there are no calibrations
    std::string scene_name;        ///< for the record
    bool own_files = false;        ///< as in write_calibration
    std::filesystem::path folder;  ///< an existing one; each calibration records its runs in a folder there
    bool keep = false;             ///< the folders stay, with tables and report
};

/// One calibration at a time, at a lower priority than the live run. Its result is kept until the next one starts. It
/// is none of Jobs: it waits for none of those, needs no other program and no second copy of the terrain, and everybody
/// sees its runs and the map of its emulators as they come. Functions may be called from any thread.
class Calibrations {
  public:
    /// `tell` is called with describe() after every change, from any thread.
    Calibrations(Executor& executor, std::shared_ptr<const scene::Scene> scene, CalibrationSettings settings,
                 std::function<void(nlohmann::json)> tell);
    ~Calibrations();
    Calibrations(const Calibrations&) = delete;
    Calibrations& operator=(const Calibrations&) = delete;

    /// The observations of the first scenario, as its setup has them: the next calibration is against these.
    void follow(std::vector<twin::TableEntry> observations);
    /// Starts one according to the body of `POST /api/calibration`, and answers once it is known whether it can run.
    /// Errors (400, 409) name key, value and what is allowed.
    void start(const nlohmann::json& wanted, const std::string& by, const Respond& respond);
    /// The current run is discarded. Error: none is running.
    [[nodiscard]] Status cancel();
    /// Ends the current run; nothing is sent any more.
    void close();

    /// As `GET /api/calibration`.
    [[nodiscard]] nlohmann::json describe() const;

  private:
    using Clock = std::chrono::steady_clock;
    using State = LongTask::State;
    struct Ending {
        State state = State::failed;
        std::string message;
    };
    void work(calibrate::CalibrationPlan plan, const std::string& by, const Respond& respond);
    [[nodiscard]] Ending calibrate_in(const std::filesystem::path& folder, const calibrate::CalibrationPlan& plan,
                                      const ensemble::PlannedRuns& runs);
    void begin(const calibrate::CalibrationPlan& plan, const std::string& by);
    void take_run(const calibrate::CalibrationRun& run);
    void take_fit(const calibrate::Calibration& now);
    void take_progress(const calibrate::CalibrationProgress& now);
    void take_result(const calibrate::Calibration& made);
    void end(const Ending& ending);
    // Under the lock:
    [[nodiscard]] nlohmann::json describe_now() const;
    void tell_now();
    [[nodiscard]] std::filesystem::path new_folder() const;

    [[nodiscard]] static std::vector<messages::CalibratedObservation> listed(
        const std::vector<ensemble::ObservedValue>& observed);
    /// A sentence; empty: there can be one.
    [[nodiscard]] static std::optional<std::string> why_none(const std::vector<ensemble::ObservedValue>& observed,
                                                             const run::SceneSource& source);
    /// Under the lock, while none runs: takes the observations that are followed.
    void take_observations();
    /// Loads the scene with these observations. Errors: it cannot be read or written.
    [[nodiscard]] Result<run::SceneSource> source_of_runs() const;

    const CalibrationSettings settings_;
    const std::shared_ptr<const scene::Scene> opened_;
    std::shared_ptr<const scene::Scene> scene_;  // with the observations; changes only while none runs, as the next
    std::vector<ensemble::ObservedValue> observed_;
    run::SceneSource source_;  // of the present calibration
    std::function<void(nlohmann::json)> tell_;
    mutable std::mutex mutex_;                        // guards the following members
    LongTask calibration_;                            // the current or the last one
    messages::CalibrationStatus status_;              // what describe() gives beside that
    std::vector<twin::TableEntry> followed_, taken_;  // observations of the setup; at first those of the scene
    bool busy_ = false, closed_ = false;
    Clock::time_point told_{};
    Lane lane_;
};

}  // namespace talus::serve
