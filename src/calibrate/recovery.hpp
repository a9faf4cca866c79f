#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibrate/calibration.hpp"
#include "core/result.hpp"

/// Tests whether a calibration recovers known values: with synthetic observations from runs with them.
namespace talus::calibrate {

/// One attempt.
struct RecoverySeed {
    std::uint64_t seed = 0;
    std::vector<double> truth;      ///< per factor, in the unit of its key
    std::vector<double> low, high;  ///< the 95 % interval of the calibration
    std::vector<double> median;
    double widest_r_hat = 0;
    std::size_t runs = 0;

    [[nodiscard]] bool returned(std::size_t factor) const {
        return low[factor] <= truth[factor] && truth[factor] <= high[factor];
    }
    [[nodiscard]] bool returned() const;
};

struct Recovery {
    std::vector<ensemble::Factor> factors;
    std::vector<RecoverySeed> seeds;
    bool interrupted = false;
};

/// Draws values from the priors, runs the scene with them, uses its predictions, with a normal error of each
/// observation's uncertainty, as observations, and calibrates; `seeds` times, in folders seed_01, ... of `folder`, with
/// the runs with known values in `truths`. Values whose debris does not reach the place of every observation are drawn
/// again, since nothing would have been observed there. Resumes with the runs in the folders. `on_seed` is called with
/// every new seed. Errors: as calibrate; too few values bring debris to all observations.
[[nodiscard]] Result<Recovery> recover(const CalibrationPlan& plan, const ensemble::PlannedRuns& runs,
                                       const run::SceneSource& source, const scene::Scene& base,
                                       const std::string& scene_name, const std::filesystem::path& folder,
                                       std::size_t seeds, const CalibrationOptions& options,
                                       const std::function<void(std::size_t)>& on_seed);

/// recovery.csv: a row per seed and factor.
[[nodiscard]] std::string recovery_table(const Recovery& recovery);

}  // namespace talus::calibrate
