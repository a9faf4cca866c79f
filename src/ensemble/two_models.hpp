#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"
#include "ensemble/ensemble_folder.hpp"
#include "ensemble/run_record.hpp"
#include "stats/control_variate.hpp"

namespace talus::ensemble {

/// A mean over the distributions of the factors, by particles alone and with the depth-averaged model's runs.
struct TwoModelMean {
    std::string key, name, unit;  ///< as Measure; of a building "hit", its name, ""
    stats::ControlledMean mean;   ///< of a building: of 1 where it is hit and 0 elsewhere
    double fast_mean = 0;         ///< of the depth-averaged model by itself
};

struct TwoModels {
    std::size_t pairs = 0;  ///< places where both models have a complete run
    std::size_t fast_complete = 0, fast_failed = 0;
    std::vector<TwoModelMean> results;    ///< those that every run of both has
    std::vector<TwoModelMean> buildings;  ///< those that some run of either hits
};

/// Reads runs 0 to count - 1 of the depth-averaged model, the first of which are at the places of `runs` (all of the
/// ensemble, by index). Errors: a record cannot be read.
[[nodiscard]] Result<TwoModels> compare_models(const std::vector<RunRecord>& runs, const std::vector<Measure>& measures,
                                               const EnsembleFolder& fast, std::size_t count);

}  // namespace talus::ensemble
