#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "ensemble/hazard_zones.hpp"
#include "ensemble/plan.hpp"
#include "ensemble/reduction.hpp"
#include "ensemble/two_models.hpp"
#include "report/hazard_map.hpp"
#include "scene/scene.hpp"
#include "stats/sensitivity.hpp"

namespace talus::ensemble {

/// The evaluated runs of an ensemble, from which its products are written.
struct EnsembleResult {
    const scene::Scene* scene = nullptr;  ///< as given, before factors
    const PlannedRuns* runs = nullptr;
    Reduction reduction;
    std::vector<Measure> measures;
    std::vector<stats::Sensitivity> sensitivity;  ///< per measure
    const report::IntensityGuideline* guideline = nullptr;
    const HazardMatrix* matrix = nullptr;  ///< where the plan has a return period and the guideline has such
    Grid<float> zones;                     ///< of the matrix
    std::optional<TwoModels> two_models;   ///< where the plan has fast runs; the caller sets it

    /// The values of one measure over the complete runs; without NaN.
    [[nodiscard]] std::vector<double> values_of(std::size_t measure) const;
};

/// Adds measures and sensitivity. `scene` and `runs` must outlive the result.
[[nodiscard]] EnsembleResult summarise(const scene::Scene& scene, const PlannedRuns& runs, Reduction reduction);

/// Name and colours of a map of an ensemble: "probability_depth_0.1m", "peak_depth_p95".
[[nodiscard]] report::HazardMap style_of(const EnsembleMap& map);

/// How the map of an intensity class's probability is called and coloured: "probability_intensity_high".
[[nodiscard]] report::HazardMap intensity_odds_style(const report::IntensityClass& intensity, bool most_severe);

/// Maps (.tif + .qml), hazard_zones.gpkg where there are zones, results.qlr, runs.csv, buildings.csv,
/// distributions.csv, sensitivity.csv, two_models.csv where both were run, statistics.json, results.json and
/// report.html into the folder, over those of an earlier call. Errors name the file and the cause.
[[nodiscard]] Status write_ensemble(const EnsembleResult& result, const std::filesystem::path& folder);

/// A factor's effect on a result as statistics.json and results.json have it.
[[nodiscard]] nlohmann::ordered_json effect_json(stats::SensitivityKind kind, const std::string& factor,
                                                 const stats::FactorEffect& effect);

/// Counts, percentiles of every measure, odds of every building, sensitivity. A value that does not exist is null.
[[nodiscard]] nlohmann::ordered_json statistics_json(const EnsembleResult& result);

/// What the report shows, as data: results.json.
[[nodiscard]] nlohmann::ordered_json ensemble_results(const EnsembleResult& result);

/// The self-contained page of `results`, from ensemble_results(), with maps. Errors: a picture could not be encoded.
[[nodiscard]] Result<std::string> ensemble_report(const EnsembleResult& result, const nlohmann::ordered_json& results);

}  // namespace talus::ensemble
