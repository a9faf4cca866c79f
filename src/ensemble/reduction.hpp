#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "ensemble/plan.hpp"
#include "ensemble/run_record.hpp"
#include "report/intensity.hpp"

/// Combined evaluation of the runs of an ensemble.
namespace talus::ensemble {

/// A map that counts runs or orders them.
struct EnsembleMap {
    enum class Kind { probability, percentile };
    Kind kind = Kind::probability;
    std::size_t map = 0;  ///< index into recorded_maps
    double level = 0;     ///< the threshold in the map's unit, or the percentile in %
    Grid<float> grid;     ///< share of runs, 0 to 1, or SI; NaN: in no run, or not by so many runs
};

/// A building over all complete runs.
struct BuildingOdds {
    std::string name;
    double hit = 0;                     ///< share of runs
    std::vector<double> over_pressure;  ///< share of runs with an impact pressure above each pressure threshold
    double median_pressure = 0, high_pressure = 0;  ///< Pa, 50th and 95th percentile; runs that miss it count as 0
    double median_depth = 0, high_depth = 0;        ///< m, likewise
    double early_hit = observe::never,
           median_hit = observe::never;  ///< s, 5th and 50th percentile; NaN: hit by fewer runs
};

struct Reduction {
    std::vector<RunRecord> runs;  ///< all existing ones, by index, without maps
    std::size_t complete = 0, failed = 0;
    std::vector<std::size_t> missing;  ///< runs of the plan that do not exist
    std::vector<EnsembleMap> maps;
    std::vector<Grid<float>>
        intensity;  ///< per class of the guideline, share of runs with it or a higher one; NaN: none
    std::vector<BuildingOdds> buildings;
};

/// Percentiles that are mapped, in %.
inline constexpr std::array<double, 3> mapped_percentiles = {5, 50, 95};

/// The smallest value that at least `percent` of the values do not exceed (nearest rank). Orders the values.
[[nodiscard]] double percentile(std::vector<double>& values, double percent);

/// Reads the records of runs 0 to count - 1 of `plan` (plan_identity) wherever one of the folders has them. Maps are
/// worked through in bands of rows that fit into `memory` bytes whatever the number of runs, so results are exact and
/// hang neither on the order of the runs nor on the machine that made them; those of intensity run by run. In
/// percentiles of depth, speed and pressure a run that never came to a place counts as 0, in those of arrival as never.
/// Errors: a record cannot be read or is damaged, maps of different cells.
[[nodiscard]] Result<Reduction> reduce(const std::vector<std::filesystem::path>& folders, std::size_t count,
                                       const std::string& plan, const Thresholds& thresholds,
                                       const report::IntensityGuideline& guideline = report::intensity_guideline({}),
                                       std::size_t memory = std::size_t{256} << 20);

}  // namespace talus::ensemble
