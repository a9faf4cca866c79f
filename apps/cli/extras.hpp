#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "products/series.hpp"
#include "products/tracks.hpp"
#include "run/run_scene.hpp"
#include "scene/scene.hpp"
#include "state_file.hpp"

/// What a run writes only where it is asked for: the run over time, tracks of particles, its state. One that cannot be
/// written is named at the end, and takes nothing else with it.
namespace talus::cli {

class Extras {
  public:
    /// `folder`: of the results while they are written; `final_folder`: where they will be. `say` tells the user
    /// something.
    Extras(const scene::Scene& scene, const std::optional<SavedState>& save, std::filesystem::path folder,
           const std::filesystem::path& final_folder, std::function<void(const std::string&)> say);
    Extras(const Extras&) = delete;
    Extras& operator=(const Extras&) = delete;

    /// Sets what it needs of a run.
    void take_part(run::RunOptions& options);
    /// The run has ended: writes what was asked for into the folder.
    void finish(const run::RunResult& result);
    /// Of the run over time, s; empty: none was written.
    [[nodiscard]] std::vector<double> frame_times() const { return series_ ? series_->times() : std::vector<double>(); }
    /// Why something is missing, a sentence each.
    [[nodiscard]] std::vector<std::string>& failures() { return failures_; }

  private:
    void add(const run::Frame& frame);
    void save(const std::string& state, double time);
    void note(const Status& status);

    std::optional<SavedState> save_;
    std::filesystem::path folder_;
    std::function<void(const std::string&)> say_;
    std::optional<products::Series> series_;
    std::optional<products::Tracks> tracks_;
    std::vector<std::string> failures_;
};

}  // namespace talus::cli
