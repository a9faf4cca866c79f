#pragma once

#include <cmath>

#include "sim/physics/kernel.hpp"

namespace talus::sim::stages {

/// The kernel of a pair of particles, with its constants. `Smoothing`: one of sim::kernels, or what chooses one.
template <class Smoothing>
struct PairKernel {  // NOLINT(cppcoreguidelines-pro-type-member-init): the scale has a constructor
    Smoothing kernel;
    PairScale scale;

    /// W r^3 at the quotient q of distance and support radius; V W is that times the scale.
    template <class Real>
    [[nodiscard]] TALUS_INLINE Real unscaled(const Real& q) const {
        return kernel.value(q);
    }
    /// V W.
    template <class Real>
    [[nodiscard]] TALUS_INLINE Real value(const Real& q) const {
        return kernel.value(q) * Real(scale.value_scale);
    }
    /// V grad W is this times the separation and the scale.
    template <class Real>
    [[nodiscard]] TALUS_INLINE Real unscaled_slope(const Real& q) const {
        return kernel.slope_over_q(q);
    }
    /// V grad W is this times the separation.
    template <class Real>
    [[nodiscard]] TALUS_INLINE Real slope(const Real& q) const {
        return kernel.slope_over_q(q) * Real(-scale.gradient_scale);
    }
    template <class Real>
    [[nodiscard]] TALUS_INLINE Vec3<Real> gradient(const Vec3<Real>& separation) const {
        return separation * slope(scale.quotient(length(separation)));
    }
};

/// What the density constraint takes from the neighbours.
template <class Real>
struct PairSums {
    Real density{}, square{}, divergence{};
    Vec3<Real> gradient;

    /// Adds a neighbour; returns the pair's gradient. The density is not scaled before finish().
    template <class Smoothing, class Neighbour>
    TALUS_INLINE Vec3<Real> add(const PairKernel<Smoothing>& kernel, const Vec3<Real>& separation,
                                const Neighbour& neighbour) {
        using std::sqrt;
        const Real distance_square = dot(separation, separation);
        const Real q = kernel.scale.quotient(Real(sqrt(distance_square)));
        const Real slope = kernel.slope(q);
        const Vec3<Real> own = separation * slope;
        density += neighbour.if_present(kernel.unscaled(q));
        square += slope * slope * distance_square;
        gradient += own;
        return own;
    }
    /// With the particle's own share.
    template <class Smoothing>
    TALUS_INLINE void finish(const PairKernel<Smoothing>& kernel) {
        density = Real(kernel.scale.value_scale) * (density + kernel.unscaled(Real(0)));
    }
};

}  // namespace talus::sim::stages
