#include "validate/measure.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

namespace talus::validate {

double percentile(std::vector<double> values, double share) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::sort(values.begin(), values.end());
    const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

double top_of(const sim::Model& model, const sim::State& state) {
    constexpr std::size_t highest = 5;
    if (state.count == 0) return std::numeric_limits<double>::quiet_NaN();
    std::vector<float> elevations(state.position.z.begin(), state.position.z.begin() + state.count);
    const std::size_t n = std::min(highest, elevations.size());
    std::partial_sort(elevations.begin(), elevations.begin() + static_cast<std::ptrdiff_t>(n), elevations.end(),
                      std::greater<>());
    return std::accumulate(elevations.begin(), elevations.begin() + static_cast<std::ptrdiff_t>(n), 0.0) /
               static_cast<double>(n) +
           model.particle_spacing / 2;
}

double edge_of(const std::vector<double>& profile, double cell, double least) {
    for (std::size_t k = profile.size(); k-- > 1;) {
        const double inner = profile[k - 1], outer = profile[k];
        if (inner < least || outer >= least) continue;
        return (static_cast<double>(k) - 0.5 + (inner - least) / (inner - outer)) * cell;
    }
    return 0;
}

ErrorNorms error_norms(const std::vector<double>& computed, const std::vector<double>& exact) {
    assert(computed.size() == exact.size());
    double squares = 0, exact_squares = 0, largest = 0, exact_largest = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const double difference = computed[i] - exact[i];
        squares += difference * difference;
        exact_squares += exact[i] * exact[i];
        largest = std::max(largest, std::abs(difference));
        exact_largest = std::max(exact_largest, std::abs(exact[i]));
    }
    return {std::sqrt(squares / exact_squares), largest / exact_largest};
}

}  // namespace talus::validate
