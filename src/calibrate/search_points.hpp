#pragma once

#include <vector>

#include "calibrate/search.hpp"

/// Places of the unit cube at which runs were made.
namespace talus::calibrate {

inline stats::Points points_of(const std::vector<SearchRun>& runs, bool complete_only) {
    stats::Points points;
    for (const SearchRun& run : runs) {
        if (!complete_only || !run.predicted.empty()) points.push_back(run.point);
    }
    return points;
}

/// Of one observation, in the order of the complete runs.
inline std::vector<double> predictions_of(const std::vector<SearchRun>& runs, std::size_t observation) {
    std::vector<double> values;
    for (const SearchRun& run : runs) {
        if (!run.predicted.empty()) values.push_back(run.predicted[observation]);
    }
    return values;
}

inline double square_distance(const std::vector<double>& a, const std::vector<double>& b) {
    double square = 0;
    for (std::size_t k = 0; k < a.size(); ++k) square += (a[k] - b[k]) * (a[k] - b[k]);
    return square;
}

}  // namespace talus::calibrate
