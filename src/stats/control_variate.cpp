#include "stats/control_variate.hpp"

#include <cassert>
#include <cmath>
#include <cstddef>

namespace talus::stats {
namespace {

constexpr std::size_t fewest_pairs = 5;  // below, the factor is not worth estimating

double average(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v / static_cast<double>(values.size());
    return sum;
}

}  // namespace

ControlledMean controlled_mean(const std::vector<double>& slow, const std::vector<double>& fast,
                               const std::vector<double>& more) {
    assert(slow.size() == fast.size() && slow.size() >= 2);
    const auto n = static_cast<double>(slow.size()), extra = static_cast<double>(more.size());
    const double slow_mean = average(slow), fast_mean = average(fast);
    double slow_square = 0, fast_square = 0, product = 0;
    for (std::size_t i = 0; i < slow.size(); ++i) {
        slow_square += (slow[i] - slow_mean) * (slow[i] - slow_mean) / (n - 1);
        fast_square += (fast[i] - fast_mean) * (fast[i] - fast_mean) / (n - 1);
        product += (slow[i] - slow_mean) * (fast[i] - fast_mean) / (n - 1);
    }
    ControlledMean m;
    m.plain = m.mean = slow_mean;
    m.plain_error = m.error = std::sqrt(slow_square / n);
    if (slow.size() < fewest_pairs || more.empty() || !(slow_square > 0) || !(fast_square > 0)) return m;
    const double told = product * product / (slow_square * fast_square);  // share of the variance
    const double left = (1 - extra / (n + extra) * told) * (n - 2) / (n - 3);
    if (left >= 1) return m;
    m.factor = product / fast_square;
    const double all_mean = (n * fast_mean + extra * average(more)) / (n + extra);
    m.mean = slow_mean + m.factor * (all_mean - fast_mean);
    m.error = m.plain_error * std::sqrt(left);
    return m;
}

}  // namespace talus::stats
