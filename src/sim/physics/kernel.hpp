#pragma once

#include <cmath>
#include <numbers>

#include "core/geometry.hpp"
#include "params/spec.hpp"

namespace talus::sim {

/// Radial smoothing kernels with support radius r, normalised in 3-D; q = distance / r.
/// value: W r^3; slope_over_q: -(dW/dq) r^3 / q >= 0, so that grad W = -slope_over_q x / r^5 needs no direction vector.
namespace kernels {

/// Wendland (1995) C2 in 3-D, as used for SPH by Dehnen & Aly (2012).
struct WendlandC2 {
    template <class Real>
    TALUS_DEVICE static Real value(Real q) {
        const Real t = 1 - q, t2 = t * t;
        return Real(21.0 / (2 * std::numbers::pi)) * t2 * t2 * (4 * q + 1);
    }
    template <class Real>
    TALUS_DEVICE static Real slope_over_q(Real q) {
        const Real t = 1 - q;
        return Real(210 / std::numbers::pi) * t * t * t;
    }
};

/// Cubic spline, Monaghan (1992), with its support at q = 1.
struct CubicSpline {
    template <class Real>
    TALUS_DEVICE static Real value(Real q) {
        const Real t = 1 - q, c = Real(8 / std::numbers::pi);
        return select(q <= Real(0.5), c * (6 * q * q * (q - 1) + 1), c * 2 * t * t * t);
    }
    template <class Real>
    TALUS_DEVICE static Real slope_over_q(Real q) {
        const Real t = 1 - q, c = Real(48 / std::numbers::pi);
        return select(q <= Real(0.5), c * (2 - 3 * q), c * t * t / q);
    }
};

/// Spiky, Desbrun & Gascuel (1996).
struct Spiky {
    template <class Real>
    TALUS_DEVICE static Real value(Real q) {
        const Real t = 1 - q;
        return Real(15 / std::numbers::pi) * t * t * t;
    }
    template <class Real>
    TALUS_DEVICE static Real slope_over_q(Real q) {
        const Real t = 1 - q;
        // The slope is finite at q = 0; two particles at one place have no direction in which to separate and stay.
        return Real(45 / std::numbers::pi) * t * t / larger(q, Real(1e-6));
    }
};

/// Poly6, Mueller et al. (2003).
struct Poly6 {
    template <class Real>
    TALUS_DEVICE static Real value(Real q) {
        const Real t = 1 - q * q;
        return Real(315 / (64 * std::numbers::pi)) * t * t * t;
    }
    template <class Real>
    TALUS_DEVICE static Real slope_over_q(Real q) {
        const Real t = 1 - q * q;
        return Real(315 / (64 * std::numbers::pi)) * 6 * t * t;
    }
};

/// The pair of Macklin & Mueller (2013): density from Poly6, gradient from Spiky. Not the gradient of any energy.
struct Poly6Spiky {
    template <class Real>
    TALUS_DEVICE static Real value(Real q) {
        return Poly6::value(q);
    }
    template <class Real>
    TALUS_DEVICE static Real slope_over_q(Real q) {
        return Spiky::slope_over_q(q);
    }
};

}  // namespace kernels

/// Calls `f` with the kernel type of the choice: one branch per stage instead of one per pair.
template <class F>
decltype(auto) with_kernel(params::KernelChoice choice, F&& f) {
    switch (choice) {
        case params::KernelChoice::cubic_spline:
            return f(kernels::CubicSpline{});
        case params::KernelChoice::spiky:
            return f(kernels::Spiky{});
        case params::KernelChoice::poly6_spiky:
            return f(kernels::Poly6Spiky{});
        case params::KernelChoice::wendland_c2:
            break;
    }
    return f(kernels::WendlandC2{});
}

/// A kernel at its support radius, with the particle volume calibrated so that the cubic rest lattice has G = 0.
struct Kernel {
    params::KernelChoice choice = params::KernelChoice::wendland_c2;
    double support_radius = 0;     ///< m
    double particle_volume = 0;    ///< m3, V with sum over the lattice of V W = 1
    double rest_gradient_sum = 0;  ///< sum |V grad W|^2 of a particle in the rest lattice, 1/m2
    /// Largest eigenvalue of the density constraints' Jacobi iteration in the rest lattice: the overshoot when all
    /// neighbours correct at once.
    double max_eigenvalue = 1;
    /// Sum of -x d(V W)/dx over the lattice: the share of a linearly varying stress that the sum over neighbours
    /// transmits.
    double gradient_moment = 1;
    double second_moment = 0;  ///< sum of x^2 V W over the lattice, m2: links XSPH smoothing to a kinematic viscosity
};

/// A kernel's constants as every pair needs them: V W = value_scale * W r^3, V grad W = -gradient_scale * slope_over_q
/// x.
struct PairScale {
    float inverse_radius, value_scale, gradient_scale;

    explicit PairScale(const Kernel& kernel) {
        const double r = kernel.support_radius;
        inverse_radius = static_cast<float>(1 / r);
        value_scale = static_cast<float>(kernel.particle_volume / (r * r * r));
        gradient_scale = static_cast<float>(kernel.particle_volume / (r * r * r * r * r));
    }
    /// distance / r, at most 1, where every kernel vanishes
    template <class Real>
    [[nodiscard]] TALUS_INLINE Real quotient(const Real& distance) const {
        return smaller(Real(1), distance * Real(inverse_radius));
    }
};

/// Calibrates on the cubic lattice of the spacing.
[[nodiscard]] Kernel make_kernel(params::KernelChoice choice, double particle_spacing, double support_radius);

}  // namespace talus::sim
