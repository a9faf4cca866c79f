#pragma once

#include <vector>

#include "stats/sensitivity.hpp"

/// Sums of means over classes of events, each known from a sample, with the interval that holds the sum with 95 %.
namespace talus::stats {

struct WeightedSample {
    double weight = 1;           ///< events of the class in a year
    std::vector<double> values;  ///< of independent draws of it; at least two
};

/// Student's t interval with the degrees of freedom of Welch (1947) and Satterthwaite (1946). Not for shares near 0.
[[nodiscard]] Estimate sum_of_means(const std::vector<WeightedSample>& samples);

/// Of values that are 0 or 1: each share has the score interval of Wilson (1927), and the sum that of Zou & Donner
/// (2008, "Construction of confidence limits about effect measures", Statistics in Medicine 27), which is not empty
/// where no draw was 1.
[[nodiscard]] Estimate sum_of_shares(const std::vector<WeightedSample>& samples);

}  // namespace talus::stats
