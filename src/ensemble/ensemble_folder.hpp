#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "ensemble/plan.hpp"
#include "ensemble/run_record.hpp"

namespace talus::ensemble {

/// The definition that identifies an ensemble: inputs by checksum, overrides, design, seed, factors. Runs of two
/// folders belong together if `difference` finds none; thresholds are included, but ignored by it.
[[nodiscard]] nlohmann::ordered_json ensemble_definition(const PlannedRuns& runs, const run::SceneSource& source,
                                                         const scene::Scene& base, const std::string& scene_name);

/// The same for the records of its runs: a checksum of the definition without what `difference` ignores.
[[nodiscard]] std::string plan_identity(const nlohmann::ordered_json& definition);

/// The plan that a definition was made from. Errors: not as ensemble_definition writes it.
[[nodiscard]] Result<EnsemblePlan> plan_of(const nlohmann::ordered_json& definition);

/// A folder with ensemble.json and a file per completed run, locked by one process at a time.
class EnsembleFolder {
  public:
    /// Creates the folder, or opens that of an interrupted ensemble with the same definition. The lock ends with the
    /// process, however that ends. Errors: locked by another process, contains something else or another ensemble
    /// (names the first difference), cannot be created or written.
    [[nodiscard]] static Result<EnsembleFolder> open(const std::filesystem::path& path,
                                                     const nlohmann::ordered_json& definition);
    /// The same without a lock, for the other processes of the holder, whose folder exists.
    [[nodiscard]] static EnsembleFolder join(const std::filesystem::path& path,
                                             const nlohmann::ordered_json& definition);

    EnsembleFolder(EnsembleFolder&& other) noexcept;
    EnsembleFolder& operator=(EnsembleFolder&&) = delete;
    EnsembleFolder(const EnsembleFolder&) = delete;
    EnsembleFolder& operator=(const EnsembleFolder&) = delete;
    ~EnsembleFolder();

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    /// As plan_identity of the definition.
    [[nodiscard]] const std::string& plan() const { return plan_; }
    /// FOLDER/runs/000012.run
    [[nodiscard]] std::filesystem::path run_file(std::size_t run) const;

  private:
    EnsembleFolder() = default;
    std::filesystem::path path_;
    std::string plan_;
    int lock_ = -1;
};

/// Puts the runs of `from` into `to` as well (as links where the file system has them). Damaged ones of `to` are
/// replaced. Errors: a run that both have with different results, a damaged one, a file that cannot be created.
[[nodiscard]] Status take_runs(const std::filesystem::path& from, const EnsembleFolder& to, std::size_t count);

/// ensemble.json of a folder. Errors: missing, not of that kind.
[[nodiscard]] Result<nlohmann::ordered_json> read_definition(const std::filesystem::path& folder,
                                                             const std::string& kind = "ensemble");

/// Why the runs of two ensembles do not belong together: "seed: 2, not 1"; empty if they do.
[[nodiscard]] std::string difference(const nlohmann::ordered_json& there, const nlohmann::ordered_json& wanted);

}  // namespace talus::ensemble
