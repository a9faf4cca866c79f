#pragma once

#include <cmath>

#include "core/geometry.hpp"

namespace talus::sim {

/// A symmetric tensor without trace; zz = -xx - yy.
template <class Real>
struct Deviator {
    Real xx{}, yy{}, xy{}, xz{}, yz{};

    TALUS_DEVICE friend Deviator operator+(const Deviator& a, const Deviator& b) {
        return {a.xx + b.xx, a.yy + b.yy, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
    }
    TALUS_DEVICE friend Deviator operator-(const Deviator& a, const Deviator& b) {
        return {a.xx - b.xx, a.yy - b.yy, a.xy - b.xy, a.xz - b.xz, a.yz - b.yz};
    }
    TALUS_DEVICE friend Deviator operator*(const Deviator& a, Real s) {
        return {a.xx * s, a.yy * s, a.xy * s, a.xz * s, a.yz * s};
    }
    friend Vec3<Real> operator*(const Deviator& a, const Vec3<Real>& v) {
        return {a.xx * v.x + a.xy * v.y + a.xz * v.z, a.xy * v.x + a.yy * v.y + a.yz * v.z,
                a.xz * v.x + a.yz * v.y - (a.xx + a.yy) * v.z};
    }
};

/// Square of the Frobenius norm, 2 J2.
template <class Real>
TALUS_DEVICE Real square_norm(const Deviator<Real>& a) {
    const Real zz = -(a.xx + a.yy);
    return a.xx * a.xx + a.yy * a.yy + zz * zz + 2 * (a.xy * a.xy + a.xz * a.xz + a.yz * a.yz);
}

/// The gradient of a displacement field, summed up over neighbours.
template <class Real>
struct DisplacementGradient {
    Vec3<Real> x{}, y{}, z{};  ///< gradient of each component

    TALUS_DEVICE void add(const Vec3<Real>& difference, const Vec3<Real>& weight_gradient) {
        x += weight_gradient * difference.x;
        y += weight_gradient * difference.y;
        z += weight_gradient * difference.z;
    }
    [[nodiscard]] TALUS_DEVICE Real divergence() const { return x.x + y.y + z.z; }
    /// Symmetric part without trace: the strain that changes shape.
    [[nodiscard]] TALUS_DEVICE Deviator<Real> shear() const {
        const Real third = divergence() / 3;
        return {x.x - third, y.y - third, (x.y + y.x) / 2, (x.z + z.x) / 2, (y.z + z.y) / 2};
    }
};

/// Square of the norm that Drucker & Prager (1952) allow without cohesion: sqrt(J2) <= tan(phi) * pressure.
template <class Real>
TALUS_DEVICE Real friction_limit_square(Real internal_friction_coefficient, Real pressure) {
    return 2 * internal_friction_coefficient * internal_friction_coefficient * pressure * pressure;
}

/// The same with cohesion, in the units of lambda: sqrt(J2) <= cohesion + tan(phi) * pressure. Without friction it is
/// the yield limit of von Mises, with which viscous debris is a Bingham fluid.
template <class Real>
TALUS_DEVICE Real strength_limit_square(Real internal_friction_coefficient, Real pressure, Real cohesion) {
    const Real strength = internal_friction_coefficient * pressure + cohesion;
    return 2 * strength * strength;
}

/// Radial return.
template <class Real>
TALUS_DEVICE Deviator<Real> limited(const Deviator<Real>& trial, Real limit_square) {
    const Real square = square_norm(trial);
    using std::sqrt;
    return trial * select(square > limit_square, sqrt(limit_square / square), Real(1));
}

/// The mu(I) law: mu_s + (mu_2 - mu_s) / (I_0 / I + 1), I = shear rate * d / sqrt(p / grain density) (Jop, Forterre &
/// Pouliquen 2006, "A constitutive law for dense granular flows", eq. 2). `shear` is the strain of a step and
/// `pressure` in the units of lambda, from which the step's length cancels; `grain_size`: see InertialFriction; divided
/// by the kernel's gradient moment where the strain is a sum over neighbours, which is too small by that factor.
template <class Real>
TALUS_DEVICE Real inertial_friction(Real slow, Real rise, Real half, Real grain_size, const Deviator<Real>& shear,
                                    Real pressure) {
    using std::sqrt;
    const Real fast = sqrt(2 * square_norm(shear)) * grain_size;
    const Real number_times_root = half * sqrt(pressure);
    return slow + select(fast > Real(0), rise * fast / (fast + number_times_root), Real(0));
}

/// The stress that resists the shear of a step, in the units of lambda: it grows with every iteration until debris no
/// longer shears, or yields. `gain` relative to the density constraint's factor.
template <class Real>
TALUS_DEVICE Deviator<Real> next_stress(const Deviator<Real>& before, const Deviator<Real>& shear, Real limit_square,
                                        Real pair_square, Real jacobi_factor) {
    constexpr double gain = 0.5;  // shear has two components where compression has one
    const Real share = select(pair_square > Real(0), Real(gain) * jacobi_factor / pair_square, Real(0));
    return limited(before + shear * share, limit_square);
}

}  // namespace talus::sim
