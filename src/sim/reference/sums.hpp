#pragma once

#include <algorithm>
#include <cmath>

#include "sim/reference/reference.hpp"

/// Sums over particles, each of them over all: the reference takes no care of speed.
namespace talus::sim::reference {

/// V W and V grad_i W of a pair.
struct Pair {
    double value = 0;
    Vector gradient;
};

inline Pair pair_of(const Model& model, const Vector& separation) {
    const double r = model.support_radius, q = length(separation) / r;
    if (q >= 1) return {};
    return with_kernel(model.kernel.choice, [&](auto kernel) {
        const double scale = model.kernel.particle_volume / (r * r * r);
        return Pair{scale * kernel.value(q), separation * (-scale / (r * r) * kernel.slope_over_q(q))};
    });
}

/// Particles are in the order of their ids.
inline float rank_of(std::size_t i) {
    return grain_rank(static_cast<std::uint32_t>(i));
}

inline double own_value(const Model& model) {
    return pair_of(model, {}).value;
}

/// Calls f(j, pair) for every other particle within the support radius.
template <class Points, class F>
void for_each_neighbour(const Model& model, std::size_t count, std::size_t i, const Points& point, const F& f) {
    for (std::size_t j = 0; j < count; ++j) {
        const Vector separation = point(i) - point(j);
        if (j != i && length(separation) < model.support_radius) f(j, pair_of(model, separation));
    }
}

/// Particles in a column at a place: all are distributed over the centres of columns by bilinear interpolation, and
/// read back in the same way.
inline double particles_in_column(const Model& model, const State& state, const Vector& p) {
    const double width = column_width(model);
    const auto share = [&](double counted, double read) {
        const double from = counted / width - 0.5, to = read / width - 0.5;
        double sum = 0;
        for (const double middle : {std::floor(to), std::floor(to) + 1}) {
            sum += (1 - std::abs(to - middle)) * std::max(0.0, 1 - std::abs(from - middle));
        }
        return sum;
    };
    double sum = 0;
    for (const Particle& other : state.particles) {
        sum += share(other.position.x, p.x) * share(other.position.y, p.y);
    }
    return sum;
}

}  // namespace talus::sim::reference
