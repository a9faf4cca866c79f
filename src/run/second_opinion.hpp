#pragma once

#include <string>

#include "core/grid.hpp"
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

struct SecondOpinion {
    /// Peak depths of both on the same cells, the larger of the two models', by the mean over each; NaN: not reached.
    Grid<float> particles, depth_averaged;
    Grid<float> difference;  ///< m, depth-averaged less particles, debris that is not there counting as 0; NaN: neither
    AreaAgreement area;      ///< first: particles; deeper than outputs.arrival_depth
    LargestDifference depth;    ///< m
    LargestDifference arrival;  ///< s, of the front along the flow path
};

/// Compares complete or partial runs of the same scene.
[[nodiscard]] SecondOpinion second_opinion(const scene::Scene& scene, const RunResult& particles,
                                           const RunResult& depth_averaged);

}  // namespace talus::run
