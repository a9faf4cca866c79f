#pragma once

#include <array>
#include <cmath>

#include "core/grid.hpp"
#include "observe/peaks.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"

/// Both models on one scene: the particles, and the depth-averaged model as a second opinion.
namespace talus::run {

/// Plan areas reached by two runs, m2.
struct AreaAgreement {
    double both = 0, only_first = 0, only_second = 0;

    /// The area that both reached over that which either reached (Jaccard 1912); NaN: neither reached any.
    [[nodiscard]] double intersection_over_union() const;
};

/// Of two maps on the same cells: a cell is reached where its value is above `least`. NaN: not reached.
[[nodiscard]] AreaAgreement area_agreement(const Grid<float>& first, const Grid<float>& second, double least);

/// A difference between the models, at the place where it is largest.
struct LargestDifference {
    double particles = observe::never, depth_averaged = observe::never;  ///< NaN: there is none
    PlanPoint at{observe::never, observe::never};
    double chainage = observe::never;  ///< m, of differences along the flow path

    [[nodiscard]] bool known() const { return !std::isnan(particles); }
    [[nodiscard]] double size() const { return depth_averaged - particles; }
};

/// A map of both models, SI. NaN: not reached.
struct MapPair {
    observe::Peak peak_particles, peak_depth_averaged;  ///< on the cells of each
    Grid<float> particles, depth_averaged;              ///< means over the same cells, the larger of the two models'
    Grid<float> difference;     ///< depth-averaged less particles, debris that is not there counting as 0; NaN: neither
    LargestDifference largest;  ///< on these cells
    double median_particles = observe::never,
           median_depth_averaged = observe::never;  ///< of the ground that both cover
};

struct SecondOpinion {
    MapPair depth, speed, pressure;  ///< peaks: m, m/s, and the dynamic pressure, Pa
    AreaAgreement area;              ///< first: particles; deeper than outputs.arrival_depth
    LargestDifference arrival;       ///< s, of the front along the flow path
};
/// In the order of observe::peak_numbers.
inline constexpr std::array peak_pairs = {&SecondOpinion::depth, &SecondOpinion::speed, &SecondOpinion::pressure};

/// Where runs follow their debris, takes one path for both, so that chainages are the same places: that of the run
/// that went farther, which cuts the front of neither. Call it before second_opinion().
void take_one_path(scene::Scene& scene, RunResult& particles, scene::Scene& grid_scene, RunResult& depth_averaged);

/// Compares complete or partial runs of the same scene.
[[nodiscard]] SecondOpinion second_opinion(const scene::Scene& scene, const RunResult& particles,
                                           const RunResult& depth_averaged);

}  // namespace talus::run
