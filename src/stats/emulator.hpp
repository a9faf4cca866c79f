#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "stats/design.hpp"

namespace talus::stats {

/// Interpolates a predicted number between runs by a Gaussian process over the unit cube of the factors (Rasmussen &
/// Williams 2006, "Gaussian Processes for Machine Learning", chapters 2, 4 and 5).
///
/// Values are scaled to mean 0 and variance 1. Their covariance is that of a linear trend with broad coefficients, and
/// a Matern 5/2 function with a length per factor; each run adds independent noise, because particle positions differ.
/// Lengths, strength and noise are the most probable ones given the runs and broad log-normal priors.
///
/// Where a faster model of the same quantity has been run too, the process is that of Kennedy & O'Hagan (2000,
/// "Predicting the output from a complex computer code when fast approximations are available", Biometrika 87, equation
/// 1): rho times the process of the fast model plus an independent one of the kind above, the difference, whose slopes
/// are as strong as the rest of it. rho is normal around 1, so both models must have the same unit; it is not fixed at
/// its most probable value, since a few runs leave it uncertain (Le Gratiet & Garnier 2014, "Recursive co-kriging
/// model", International Journal for Uncertainty Quantification 4). The process of the fast model is that given its
/// own runs, with what they leave uncertain, so the runs of both need not be at the same places. Where the runs are
/// more probable by themselves, as of models with nothing in common, the emulator does without the fast model.
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
    /// The same, with the emulator of a faster model (itself one without). No rows: the fast model's, with the
    /// difference that is usual before any run.
    [[nodiscard]] static Emulator fit_beside(std::shared_ptr<const Emulator> fast, Points points,
                                             const std::vector<double>& values);

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
    /// The expected factor on the fast model; 0 without one.
    [[nodiscard]] double rho() const;

  private:
    struct Shape {
        std::vector<double> lengths;        // of the unit cube
        double strength = 1, noise = 0.05;  // standard deviations, of scaled values
        double slope = 0;                   // standard deviation of the trend's slopes, likewise
    };

    Emulator() = default;
    void take(Points points, const std::vector<double>& values);
    /// Minus the logarithm of the probability of the values with the shape found, up to a constant.
    double find_shape();
    [[nodiscard]] Shape shape_of(const std::vector<double>& parameters) const;
    /// Of scaled values, without the fast model's part.
    [[nodiscard]] double own_covariance(const std::vector<double>& a, const std::vector<double>& b) const;
    /// Of the fast model at a place, given its own runs.
    struct FastPart {
        double mean = 0;                  // in the scale of these values, less its mean over these runs
        std::vector<double> covariances;  // with its runs, of its scaled values
    };
    [[nodiscard]] FastPart fast_part(const std::vector<double>& point) const;
    /// Of a place with every run, and of itself. `part`: of the fast model there.
    [[nodiscard]] std::vector<double> covariances(const std::vector<double>& point, const FastPart& part) const;
    [[nodiscard]] double variance(const std::vector<double>& point, FastPart part) const;
    [[nodiscard]] double fast_share() const;
    [[nodiscard]] double expected_rho_square() const;
    /// What factorise() needs of the fast model for one more run.
    void add_fast_part();
    /// The scaled value of a run, less what is expected of it by the fast model before any run.
    [[nodiscard]] double above_fast(std::size_t run) const;
    /// Fills factor_ and weights_; false where the matrix is not positive definite.
    bool factorise();
    /// Logarithm of the probability of the values, up to a constant.
    [[nodiscard]] double evidence() const;

    Points points_;
    std::vector<double> scaled_;  // values
    double mean_ = 0, scale_ = 1;
    Shape shape_;
    std::vector<double> factor_;   // Cholesky factor of the covariance with noise, by rows
    std::vector<double> weights_;  // inverse covariance times values, less the fast model's part

    std::shared_ptr<const Emulator> fast_;
    double fast_middle_ = 0, rho_square_ = 1;
    // Of the fast model at each run: see FastPart; the inverse covariance of its runs times the covariances with them;
    // the covariances, given its runs, with the runs up to this one.
    std::vector<FastPart> fast_parts_;
    Points solved_, left_;
};

}  // namespace talus::stats
