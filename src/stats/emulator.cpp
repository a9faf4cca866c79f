#include "stats/emulator.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "stats/cholesky.hpp"
#include "stats/optimise.hpp"

namespace talus::stats {
namespace {

// Variances of the trend's coefficients, of scaled values: a change of four standard deviations across the cube is not
// unusual.
constexpr double level_variance = 1, slope_variance = 4;

/// Prior of a logarithm: middle and standard deviation, and the limits of the search.
struct LogPrior {
    double middle, deviation, low, high;
};
const LogPrior length_prior = {std::log(0.5), 0.8, std::log(0.05), std::log(5.0)};
const LogPrior strength_prior = {std::log(1.0), 1.0, std::log(0.05), std::log(10.0)};
const LogPrior noise_prior = {std::log(0.05), 1.5, std::log(1e-3), std::log(1.0)};

/// Lengths, strength and noise from which the fit begins; the likelihood can have several peaks.
constexpr std::array<std::array<double, 3>, 3> starts = {{{0.3, 1, 0.05}, {1, 1, 0.2}, {0.15, 1, 0.01}}};

double penalty(const LogPrior& prior, double logarithm) {
    const double z = (logarithm - prior.middle) / prior.deviation;
    return z * z / 2;
}

}  // namespace

Emulator::Shape Emulator::shape_of(const std::vector<double>& logarithms) {
    Shape shape;
    const std::size_t factors = logarithms.size() - 2;
    for (std::size_t k = 0; k < factors; ++k) shape.lengths.push_back(std::exp(logarithms[k]));
    shape.strength = std::exp(logarithms[factors]);
    shape.noise = std::exp(logarithms[factors + 1]);
    return shape;
}

double Emulator::covariance(const std::vector<double>& a, const std::vector<double>& b) const {
    double trend = level_variance, square = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        trend += slope_variance * (a[k] - 0.5) * (b[k] - 0.5);
        const double distance = (a[k] - b[k]) / shape_.lengths[k];
        square += distance * distance;
    }
    const double r = std::sqrt(5 * square);  // Matern 5/2: Rasmussen & Williams 2006, equation 4.17
    return trend + shape_.strength * shape_.strength * (1 + r + r * r / 3) * std::exp(-r);
}

bool Emulator::factorise() {
    const std::size_t n = points_.size();
    factor_.assign(n * n, 0);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j <= i; ++j) factor_[i * n + j] = covariance(points_[i], points_[j]);
        factor_[i * n + i] += shape_.noise * shape_.noise + 1e-9;
    }
    if (!cholesky(factor_, n)) return false;
    weights_ = scaled_;
    solve_lower(factor_, weights_);
    solve_upper(factor_, weights_);
    return true;
}

double Emulator::evidence() const {  // Rasmussen & Williams 2006, equation 5.8
    const std::size_t n = points_.size();
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum -= scaled_[i] * weights_[i] / 2 + std::log(factor_[i * n + i]);
    return sum;
}

Emulator Emulator::fit(Points points, const std::vector<double>& values) {
    assert(!points.empty() && points.size() == values.size());
    Emulator emulator;
    emulator.points_ = std::move(points);
    const auto n = static_cast<double>(values.size());
    double square = 0;
    for (const double v : values) emulator.mean_ += v / n;
    for (const double v : values) square += (v - emulator.mean_) * (v - emulator.mean_) / n;
    emulator.scale_ = square > 0 ? std::sqrt(square) : 1;
    for (const double v : values) emulator.scaled_.push_back((v - emulator.mean_) / emulator.scale_);

    const std::size_t factors = emulator.points_.front().size();
    std::vector<double> low, high;
    const auto limit = [&](const LogPrior& prior) {
        low.push_back(prior.low);
        high.push_back(prior.high);
    };
    for (std::size_t k = 0; k < factors; ++k) limit(length_prior);
    limit(strength_prior);
    limit(noise_prior);
    const Objective objective = [&](const std::vector<double>& logarithms) {
        emulator.shape_ = shape_of(logarithms);
        if (!emulator.factorise()) return 1e9;
        double sum = penalty(strength_prior, logarithms[factors]) + penalty(noise_prior, logarithms[factors + 1]);
        for (std::size_t k = 0; k < factors; ++k) sum += penalty(length_prior, logarithms[k]);
        return sum - emulator.evidence();
    };
    Optimum best;
    for (const auto& [length, strength, noise] : starts) {
        std::vector<double> start(factors, std::log(length));
        start.insert(start.end(), {std::log(strength), std::log(noise)});
        Optimum found = minimise(objective, low, high, start, 60 * (factors + 2));
        if (best.at.empty() || found.value < best.value) best = std::move(found);
    }
    emulator.shape_ = shape_of(best.at);
    emulator.factorise();
    return emulator;
}

double Emulator::mean_at(const std::vector<double>& point) const {
    double sum = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) sum += weights_[i] * covariance(points_[i], point);
    return mean_ + scale_ * sum;
}

Emulator::Estimate Emulator::at(const std::vector<double>& point) const {
    std::vector<double> to_runs(points_.size());
    double mean = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
        to_runs[i] = covariance(points_[i], point);
        mean += weights_[i] * to_runs[i];
    }
    solve_lower(factor_, to_runs);
    double known = 0;
    for (const double v : to_runs) known += v * v;
    const double variance = std::max(0.0, covariance(point, point) - known);
    const double noise = noise_deviation();
    return {mean_ + scale_ * mean, scale_ * scale_ * variance, noise * noise};
}

Emulator Emulator::with(const std::vector<double>& point, double value) const {
    Emulator more = *this;
    more.points_.push_back(point);
    more.scaled_.push_back((value - mean_) / scale_);
    return more.factorise() ? more : *this;
}

std::vector<Emulator::LeftOut> Emulator::leave_one_out() const {
    const std::size_t n = points_.size();
    std::vector<LeftOut> all;
    all.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
        std::vector<double> unit(n, 0.0);
        unit[i] = 1;
        solve_lower(factor_, unit);
        double inverse = 0;  // diagonal of the inverse covariance
        for (const double v : unit) inverse += v * v;
        const double computed = mean_ + scale_ * scaled_[i];
        all.push_back({computed, computed - scale_ * weights_[i] / inverse, scale_ / std::sqrt(inverse)});
    }
    return all;
}

}  // namespace talus::stats
