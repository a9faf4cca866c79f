#pragma once

#include <cstddef>
#include <vector>

namespace talus::stats {

/// Distribution of a number that is the sum of independent counts.
class CountDistribution {
  public:
    /// Adds how many of `count` happen, each with this probability.
    void add_binomial(std::size_t count, double probability);
    /// Adds a Poisson count, cut where its rest is below 1e-12.
    void add_poisson(double mean);

    /// Entry N: the probability that it is N or more; entry 0 is 1.
    [[nodiscard]] std::vector<double> at_least() const;

  private:
    void add(const std::vector<double>& other);
    std::vector<double> probability_ = {1};  // of 0, 1, ...
};

}  // namespace talus::stats
