#include "stats/count_distribution.hpp"

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/poisson.hpp>
#include <cstddef>
#include <utility>
#include <vector>

namespace talus::stats {

void CountDistribution::add(const std::vector<double>& other) {
    std::vector<double> sum(probability_.size() + other.size() - 1, 0);
    for (std::size_t i = 0; i < probability_.size(); ++i) {
        for (std::size_t k = 0; k < other.size(); ++k) sum[i + k] += probability_[i] * other[k];
    }
    // A tail that no sum of frequencies can show; it would make long lists of many persons.
    double tail = sum.back();
    while (sum.size() > 1 && tail < 1e-18) {
        sum.pop_back();
        tail += sum.back();
    }
    probability_ = std::move(sum);
}

void CountDistribution::add_binomial(std::size_t count, double probability) {
    if (count == 0 || !(probability > 0)) return;
    const boost::math::binomial of(static_cast<double>(count), probability);
    std::vector<double> terms(count + 1);
    for (std::size_t k = 0; k <= count; ++k) terms[k] = boost::math::pdf(of, static_cast<double>(k));
    add(terms);
}

void CountDistribution::add_poisson(double mean) {
    if (!(mean > 0)) return;
    const boost::math::poisson of(mean);
    std::vector<double> terms;
    double rest = 1;
    while (rest > 1e-12 && terms.size() < 1000000) {
        terms.push_back(boost::math::pdf(of, static_cast<double>(terms.size())));
        rest = boost::math::cdf(boost::math::complement(of, static_cast<double>(terms.size() - 1)));
    }
    add(terms);
}

std::vector<double> CountDistribution::at_least() const {
    std::vector<double> sums(probability_.size());
    double sum = 0;
    for (std::size_t k = probability_.size(); k-- > 0;) sums[k] = sum += probability_[k];
    sums[0] = 1;
    return sums;
}

}  // namespace talus::stats
