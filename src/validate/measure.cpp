#include "validate/measure.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "validate/case.hpp"

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

double time_mean(const std::vector<double>& times, const std::vector<double>& readings, double from, double to) {
    assert(times.size() == readings.size() && to > from);
    constexpr double rounding = 1e-9;
    if (times.empty() || times.front() > from + rounding || times.back() < to - rounding) return not_computed;
    double sum = 0;
    for (std::size_t k = 1; k < times.size(); ++k) {
        const double begin = std::max(from, times[k - 1]), end = std::min(to, times[k]);
        if (end <= begin) continue;
        const double slope = (readings[k] - readings[k - 1]) / (times[k] - times[k - 1]);
        sum += (end - begin) * (readings[k - 1] + slope * ((begin + end) / 2 - times[k - 1]));
    }
    return sum / (to - from);
}

double first_time_of(const std::vector<double>& times, const std::vector<double>& readings, double least) {
    assert(times.size() == readings.size());
    for (std::size_t k = 0; k < times.size(); ++k) {
        if (readings[k] < least) continue;
        if (k == 0) return times[0];
        return times[k] - (times[k] - times[k - 1]) * (readings[k] - least) / (readings[k] - readings[k - 1]);
    }
    return not_computed;
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
