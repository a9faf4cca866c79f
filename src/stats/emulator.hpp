#pragma once

#include <cstddef>
#include <vector>

#include "stats/design.hpp"

namespace talus::stats {

/// Interpolates a predicted number between runs by a Gaussian process over the unit cube of the factors (Rasmussen &
/// Williams 2006, "Gaussian Processes for Machine Learning", chapters 2, 4 and 5).
///
/// Values are scaled to mean 0 and variance 1. Their covariance is that of a linear trend with broad coefficients, and
/// a Matern 5/2 function with a length per factor; each run adds independent noise, because particle positions differ.
/// Lengths, strength and noise are the most probable ones given the runs and broad log-normal priors.
class Emulator {
  public:
    /// Estimate at a place: the mean, its variance, and the variance of runs around it.
    struct Estimate {
        double mean = 0, variance = 0, noise = 0;
    };
    /// Prediction of one run from all others.
    struct LeftOut {
        double computed = 0, mean = 0, deviation = 0;
    };

    /// `points`: at least one row, all of as many numbers from 0 to 1; `values`: one finite number per row.
    [[nodiscard]] static Emulator fit(Points points, const std::vector<double>& values);

    [[nodiscard]] Estimate at(const std::vector<double>& point) const;
    /// Only the mean, much cheaper.
    [[nodiscard]] double mean_at(const std::vector<double>& point) const;
    /// The same process with one more run; without fitting again.
    [[nodiscard]] Emulator with(const std::vector<double>& point, double value) const;
    /// Every run from the others with the same lengths (Dubrule 1983, "Cross validation of kriging in a unique
    /// neighborhood").
    [[nodiscard]] std::vector<LeftOut> leave_one_out() const;

    /// Standard deviation of a run around the mean, in the unit of the values.
    [[nodiscard]] double noise_deviation() const { return shape_.noise * scale_; }
    [[nodiscard]] const std::vector<double>& lengths() const { return shape_.lengths; }

  private:
    struct Shape {
        std::vector<double> lengths;        // of the unit cube
        double strength = 1, noise = 0.05;  // standard deviations, of scaled values
    };

    Emulator() = default;
    [[nodiscard]] static Shape shape_of(const std::vector<double>& logarithms);
    [[nodiscard]] double covariance(const std::vector<double>& a, const std::vector<double>& b) const;
    /// Fills factor_ and weights_; false where the matrix is not positive definite.
    bool factorise();
    /// Logarithm of the probability of the values, up to a constant.
    [[nodiscard]] double evidence() const;

    Points points_;
    std::vector<double> scaled_;  // values
    double mean_ = 0, scale_ = 1;
    Shape shape_;
    std::vector<double> factor_;   // Cholesky factor of the covariance with noise, by rows
    std::vector<double> weights_;  // inverse covariance times values
};

}  // namespace talus::stats
