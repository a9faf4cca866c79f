#include "stats/weighted_means.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <cstddef>

namespace talus::stats {
namespace {

struct Moments {
    double mean = 0, variance = 0;  ///< of the values
    double count = 0;
};

Moments moments_of(const std::vector<double>& values) {
    Moments m;
    m.count = static_cast<double>(values.size());
    for (const double v : values) m.mean += v / m.count;
    for (const double v : values) m.variance += (v - m.mean) * (v - m.mean) / (m.count - 1);
    return m;
}

}  // namespace

Estimate sum_of_means(const std::vector<WeightedSample>& samples) {
    double sum = 0, variance = 0, fourth = 0;
    for (const WeightedSample& sample : samples) {
        const Moments m = moments_of(sample.values);
        const double part = sample.weight * sample.weight * m.variance / m.count;
        sum += sample.weight * m.mean;
        variance += part;
        fourth += part * part / (m.count - 1);
    }
    if (!(variance > 0)) return {sum, sum, sum};
    const boost::math::students_t student(variance * variance / fourth);
    const double reach = boost::math::quantile(student, 0.975) * std::sqrt(variance);
    return {sum, sum - reach, sum + reach};
}

Estimate sum_of_shares(const std::vector<WeightedSample>& samples) {
    constexpr double z = 1.959964;  // of 97.5 %
    double sum = 0, below = 0, above = 0;
    for (const WeightedSample& sample : samples) {
        const double n = static_cast<double>(sample.values.size());
        const double p = moments_of(sample.values).mean;
        const double middle = (p + z * z / (2 * n)) / (1 + z * z / n);
        const double reach = z * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n)) / (1 + z * z / n);
        sum += sample.weight * p;
        below += std::pow(sample.weight * (p - (middle - reach)), 2);
        above += std::pow(sample.weight * (middle + reach - p), 2);
    }
    return {sum, sum - std::sqrt(below), sum + std::sqrt(above)};
}

}  // namespace talus::stats
