#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "run/comparison.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"

namespace talus::products {

/// A result folder being written: under a temporary name next to the final one, and renamed when complete, so that an
/// incomplete folder never has the final name.
class OutputFolder {
  public:
    /// Makes the folders above it that are missing. Deletes what earlier runs of this output left behind when they were
    /// killed. Errors: not writable, already there without `force`.
    [[nodiscard]] static Result<OutputFolder> create(const std::filesystem::path& final_path, bool force);

    OutputFolder(OutputFolder&& other) noexcept;
    OutputFolder& operator=(OutputFolder&&) = delete;
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;
    /// Deletes the temporary folder unless committed, and of the folders made above it those that are empty.
    ~OutputFolder();

    [[nodiscard]] const std::filesystem::path& path() const { return temporary_; }
    [[nodiscard]] const std::filesystem::path& final_path() const { return final_; }
    /// Renames to the final name, replacing an earlier result if `force` was given.
    [[nodiscard]] Status commit();

  private:
    OutputFolder() = default;
    std::filesystem::path temporary_, final_;
    std::vector<std::filesystem::path> made_above_;  ///< the lowest first; empty once committed
    bool force_ = false;
    int lock_ = -1;  ///< held on the temporary folder while it is written; -1: the file system has no locks
};

/// Writes maps (.tif + .qml), front.csv, buildings.csv, results.gpkg, results.qlr, timeseries.csv, manifest.json,
/// results.json, report.html; where there are comparisons with variants of the scene, convergence.csv and variants.csv
/// too; PARTIAL.txt where the run did not end by itself, and the folder fault where a step could not be trusted. Errors
/// name the file and the cause (disk full, ...). `changed`: what was changed during the run, which the tables then say
/// in a last column; empty: nothing. `frame_times`: of the maps over time that are in the folder's series, s. Contours
/// are written only where the scene asks for them; why some are missing is added to `missing`, and is an error without
/// that.
[[nodiscard]] Status write_products(const scene::Scene& scene, const run::RunResult& result,
                                    const std::filesystem::path& folder,
                                    const std::vector<run::Comparison>& comparisons = {}, std::string_view changed = {},
                                    const std::vector<double>& frame_times = {},
                                    std::vector<std::string>* missing = nullptr);

}  // namespace talus::products
