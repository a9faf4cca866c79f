#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.hpp"
#include "run/variants.hpp"
#include "scene/scene.hpp"
#include "stats/design.hpp"
#include "stats/distribution.hpp"

/// The plan of an ensemble: factors, number of runs, thresholds.
namespace talus::ensemble {

/// A key of the scene that varies from run to run.
struct Factor {
    std::string key;  ///< "material.friction_coefficient", "release[0].volume_m3"
    stats::Distribution distribution;
};

/// A run counts towards a probability where it exceeds the threshold. In the units of the maps.
struct Thresholds {
    std::vector<double> depth = {0.1, 0.5, 1};  ///< m
    std::vector<double> speed = {5, 10};        ///< m/s
    std::vector<double> pressure = {15, 30};    ///< kPa; of the free flow on maps, of the filtered force on buildings
};

struct EnsemblePlan {
    stats::DesignKind design = stats::DesignKind::latin_hypercube;
    std::size_t runs = 64;      ///< at most; designs that come in blocks take the largest number that fits
    std::size_t levels = 5;     ///< per factor of a grid; a list has as many as it has entries
    std::size_t fast_runs = 0;  ///< of the depth-averaged model beside those of particles; 0: none
    std::uint64_t seed = 1;
    std::vector<Factor> factors;
    Thresholds thresholds;
    std::optional<double> return_period;  ///< years between events of which the runs are samples; absent: not stated
};

/// Reads a plan file (docs/ensembles.md). Errors name file, line, key, value and what is allowed.
[[nodiscard]] Result<EnsemblePlan> read_plan(const std::filesystem::path& file);

/// Adds "section.key=distribution", or replaces the factor with that key. Errors as parse_distribution.
[[nodiscard]] Status add_factor(EnsemblePlan& plan, std::string_view text);

/// "0.5,1" as thresholds: ascending, at least 0. `what` names them in the error.
[[nodiscard]] Result<std::vector<double>> parse_thresholds(std::string_view text, std::string_view what);

/// The values of one run.
struct PlannedRun {
    std::vector<std::string> values;     ///< per factor, as text
    std::vector<std::string> overrides;  ///< for load_scene, after those of the scene's source
};

/// Every run of a plan on a scene. All runs have the particle spacing and the map cell of the scene as given, unless a
/// factor changes them, so that differences come from the factors and maps lie on one grid.
class PlannedRuns {
  public:
    /// Checks every factor against the scene and its allowed range. Errors: no factor, no such key, not a number where
    /// a range is given, an invalid value, more factors or runs than the design can have, too few runs.
    [[nodiscard]] static Result<PlannedRuns> make(const EnsemblePlan& plan, const run::SceneSource& source,
                                                  const scene::Scene& base);

    [[nodiscard]] std::size_t count() const { return points_.size(); }
    [[nodiscard]] const EnsemblePlan& plan() const { return plan_; }
    [[nodiscard]] const stats::Points& points() const { return points_; }
    [[nodiscard]] const std::vector<std::string>& fixed() const { return fixed_; }
    [[nodiscard]] PlannedRun at(std::size_t run) const;
    /// Replaces the points of the design by these of the unit cube, with a number per factor.
    void set_points(stats::Points points) { points_ = std::move(points); }

  private:
    PlannedRuns() = default;

    EnsemblePlan plan_;
    stats::Points points_;
    std::vector<std::string> fixed_;   // overrides that all runs share
    std::vector<bool> whole_;          // per factor: only whole numbers
    std::vector<std::size_t> levels_;  // per factor of a grid
};

}  // namespace talus::ensemble
