#include "stats/emulator.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "stats/cholesky.hpp"
#include "stats/optimise.hpp"

namespace talus::stats {
namespace {

// Of the trend's coefficients, of scaled values: a change of four standard deviations across the cube is not
// unusual.
constexpr double level_variance = 1, slope_deviation = 2;

/// Prior of a logarithm: middle and standard deviation, and the limits of the search.
struct LogPrior {
    double middle, deviation, low, high;
};
const LogPrior length_prior = {std::log(0.5), 0.8, std::log(0.05), std::log(5.0)};
const LogPrior strength_prior = {std::log(1.0), 1.0, std::log(0.05), std::log(10.0)};
const LogPrior noise_prior = {std::log(0.05), 1.5, std::log(1e-3), std::log(1.0)};
// Of the difference between two models of one quantity, in the scale of the quantity.
const LogPrior difference_prior = {std::log(0.3), 1.0, std::log(0.01), std::log(10.0)};
// Of the factor on the fast model.
constexpr double rho_middle = 1, rho_variance = 1;

/// Lengths, strength and noise from which the fit begins; the likelihood can have several peaks.
constexpr std::array<std::array<double, 3>, 3> starts = {{{0.3, 1, 0.05}, {1, 1, 0.2}, {0.15, 1, 0.01}}};

double penalty(const LogPrior& prior, double logarithm) {
    const double z = (logarithm - prior.middle) / prior.deviation;
    return z * z / 2;
}

double product(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

}  // namespace

/// From logarithms of lengths, strength and noise.
Emulator::Shape Emulator::shape_of(const std::vector<double>& parameters) const {
    Shape shape;
    const std::size_t factors = parameters.size() - 2;
    for (std::size_t k = 0; k < factors; ++k) shape.lengths.push_back(std::exp(parameters[k]));
    shape.strength = std::exp(parameters[factors]);
    shape.noise = std::exp(parameters[factors + 1]);
    shape.slope = fast_ ? slope_deviation * shape.strength : slope_deviation;
    return shape;
}

double Emulator::own_covariance(const std::vector<double>& a, const std::vector<double>& b) const {
    const double strength = shape_.strength * shape_.strength, slope = shape_.slope * shape_.slope;
    double trend = level_variance, square = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        trend += slope * (a[k] - 0.5) * (b[k] - 0.5);
        const double distance = (a[k] - b[k]) / shape_.lengths[k];
        square += distance * distance;
    }
    const double r = std::sqrt(5 * square);  // Matern 5/2: Rasmussen & Williams 2006, equation 4.17
    return trend + strength * (1 + r + r * r / 3) * std::exp(-r);
}

double Emulator::fast_share() const {
    const double ratio = fast_->scale_ / scale_;
    return rho_square_ * ratio * ratio;
}

Emulator::FastPart Emulator::fast_part(const std::vector<double>& point) const {
    FastPart part;
    for (const auto& run : fast_->points_) part.covariances.push_back(fast_->own_covariance(run, point));
    part.mean = (fast_->mean_ + fast_->scale_ * product(fast_->weights_, part.covariances) - fast_middle_) / scale_;
    return part;
}

std::vector<double> Emulator::covariances(const std::vector<double>& point, const FastPart& part) const {
    std::vector<double> all(points_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = own_covariance(points_[i], point);
    if (!fast_) return all;
    const double share = fast_share();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const double left = fast_->own_covariance(points_[i], point) - product(solved_[i], part.covariances);
        all[i] += share * left + rho_variance * fast_parts_[i].mean * part.mean;
    }
    return all;
}

double Emulator::variance(const std::vector<double>& point, FastPart part) const {
    const double own = own_covariance(point, point);
    if (!fast_) return own;
    solve_lower(fast_->factor_, part.covariances);
    const double left = fast_->own_covariance(point, point) - product(part.covariances, part.covariances);
    return own + fast_share() * left + rho_variance * part.mean * part.mean;
}

void Emulator::add_fast_part() {
    const std::vector<double>& point = points_[fast_parts_.size()];
    fast_parts_.push_back(fast_part(point));
    const std::vector<double>& to_fast = fast_parts_.back().covariances;
    solved_.push_back(to_fast);
    solve_lower(fast_->factor_, solved_.back());
    solve_upper(fast_->factor_, solved_.back());
    std::vector<double>& row = left_.emplace_back();
    for (std::size_t j = 0; j < fast_parts_.size(); ++j) {
        row.push_back(fast_->own_covariance(points_[j], point) - product(solved_[j], to_fast));
    }
}

double Emulator::above_fast(std::size_t run) const {
    return fast_ ? scaled_[run] - rho_middle * fast_parts_[run].mean : scaled_[run];
}

bool Emulator::factorise() {
    const std::size_t n = points_.size();
    const double share = fast_ ? fast_share() : 0;
    factor_.assign(n * n, 0);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            factor_[i * n + j] = own_covariance(points_[i], points_[j]);
            if (!fast_) continue;
            factor_[i * n + j] += share * left_[i][j] + rho_variance * fast_parts_[i].mean * fast_parts_[j].mean;
        }
        factor_[i * n + i] += shape_.noise * shape_.noise + 1e-9;
    }
    if (!cholesky(factor_, n)) return false;
    weights_.resize(n);
    for (std::size_t i = 0; i < n; ++i) weights_[i] = above_fast(i);
    solve_lower(factor_, weights_);
    solve_upper(factor_, weights_);
    return true;
}

double Emulator::evidence() const {  // Rasmussen & Williams 2006, equation 5.8
    const std::size_t n = points_.size();
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum -= above_fast(i) * weights_[i] / 2 + std::log(factor_[i * n + i]);
    return sum;
}

/// Scales the values: to mean 0, and variance 1 or that of the fast model's if it is greater, so that a few runs near
/// each other do not make the scale small.
void Emulator::take(Points points, const std::vector<double>& values) {
    points_ = std::move(points);
    const auto n = static_cast<double>(values.size());
    double square = 0;
    for (const double v : values) mean_ += v / n;
    for (const double v : values) square += (v - mean_) * (v - mean_) / n;
    scale_ = square > 0 ? std::sqrt(square) : 1;
    if (fast_) {
        const bool varies = product(fast_->scaled_, fast_->scaled_) > 0;
        if (varies) scale_ = square > 0 ? std::max(scale_, fast_->scale_) : fast_->scale_;
        if (values.empty()) mean_ = fast_middle_ = fast_->mean_;
        for (const auto& point : points_) fast_middle_ += fast_->mean_at(point) / n;
        for (std::size_t i = 0; i < points_.size(); ++i) add_fast_part();
    }
    for (const double v : values) scaled_.push_back((v - mean_) / scale_);
}

double Emulator::find_shape() {
    const LogPrior& strengths = fast_ ? difference_prior : strength_prior;
    const std::size_t factors = fast_ ? fast_->points_.front().size() : points_.front().size();
    std::vector<double> low, high, middle;
    const auto limit = [&](const LogPrior& prior) {
        low.push_back(prior.low);
        high.push_back(prior.high);
        middle.push_back(prior.middle);
    };
    for (std::size_t k = 0; k < factors; ++k) limit(length_prior);
    limit(strengths);
    limit(noise_prior);
    const Objective objective = [&](const std::vector<double>& parameters) {
        shape_ = shape_of(parameters);
        if (!factorise()) return 1e9;
        double sum = penalty(strengths, parameters[factors]) + penalty(noise_prior, parameters[factors + 1]);
        for (std::size_t k = 0; k < factors; ++k) sum += penalty(length_prior, parameters[k]);
        return sum - evidence();
    };
    if (points_.empty()) {
        shape_ = shape_of(middle);
        return 0;
    }
    Optimum best;
    for (const auto& [length, strength, noise] : starts) {
        std::vector<double> start(factors, std::log(length));
        start.insert(start.end(), {std::log(strength), std::log(noise)});
        Optimum found = minimise(objective, low, high, start, 60 * (factors + 2));
        if (best.at.empty() || found.value < best.value) best = std::move(found);
    }
    shape_ = shape_of(best.at);
    factorise();
    return best.value + static_cast<double>(points_.size()) * std::log(scale_);
}

Emulator Emulator::fit(Points points, const std::vector<double>& values) {
    assert(!points.empty() && points.size() == values.size());
    Emulator emulator;
    emulator.take(std::move(points), values);
    emulator.find_shape();
    return emulator;
}

Emulator Emulator::fit_beside(std::shared_ptr<const Emulator> fast, Points points, const std::vector<double>& values) {
    assert(fast && !fast->fast_ && points.size() == values.size());
    Emulator beside;
    beside.fast_ = std::move(fast);
    beside.take(points, values);
    beside.find_shape();
    if (points.empty()) return beside;
    beside.rho_square_ = beside.expected_rho_square();
    const double least = beside.find_shape();
    // Fewer runs, or runs all alike, do not tell that the models have nothing in common.
    const std::size_t enough = 2 * (points.front().size() + 2);
    const bool varies = product(beside.scaled_, beside.scaled_) > 0;
    if (points.size() < enough || !varies) return beside;
    Emulator alone;
    alone.take(std::move(points), values);
    return alone.find_shape() < least ? alone : beside;
}

double Emulator::rho() const {
    double rho = rho_middle;
    for (std::size_t i = 0; i < fast_parts_.size(); ++i) rho += rho_variance * fast_parts_[i].mean * weights_[i];
    return fast_ ? rho : 0;
}

/// Expected square of rho after the runs, which the uncertainty of the fast model is multiplied by.
double Emulator::expected_rho_square() const {
    std::vector<double> means;
    for (const FastPart& part : fast_parts_) means.push_back(part.mean);
    solve_lower(factor_, means);
    const double left = rho_variance - rho_variance * rho_variance * product(means, means);
    return rho() * rho() + std::max(0.0, left);
}

double Emulator::mean_at(const std::vector<double>& point) const {
    const FastPart part = fast_ ? fast_part(point) : FastPart();
    return mean_ + scale_ * (rho_middle * part.mean + product(weights_, covariances(point, part)));
}

Emulator::Estimate Emulator::at(const std::vector<double>& point) const {
    FastPart part = fast_ ? fast_part(point) : FastPart();
    std::vector<double> to_runs = covariances(point, part);
    const double mean = rho_middle * part.mean + product(weights_, to_runs);
    solve_lower(factor_, to_runs);
    const double left = std::max(0.0, variance(point, std::move(part)) - product(to_runs, to_runs));
    const double noise = noise_deviation();
    return {mean_ + scale_ * mean, scale_ * scale_ * left, noise * noise};
}

Emulator Emulator::with(const std::vector<double>& point, double value) const {
    Emulator more = *this;
    more.points_.push_back(point);
    more.scaled_.push_back((value - mean_) / scale_);
    if (fast_) more.add_fast_part();
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
