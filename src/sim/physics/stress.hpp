#pragma once

#include <cmath>

#include "core/geometry.hpp"

namespace talus {

/// A symmetric tensor without trace; zz = -xx - yy.
template <class Real>
struct Deviator {
    Real xx{}, yy{}, xy{}, xz{}, yz{};

    friend Deviator operator+(const Deviator& a, const Deviator& b) {
        return {a.xx + b.xx, a.yy + b.yy, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
    }
    friend Deviator operator-(const Deviator& a, const Deviator& b) {
        return {a.xx - b.xx, a.yy - b.yy, a.xy - b.xy, a.xz - b.xz, a.yz - b.yz};
    }
    friend Deviator operator*(const Deviator& a, Real s) { return {a.xx * s, a.yy * s, a.xy * s, a.xz * s, a.yz * s}; }
    friend Vec3<Real> operator*(const Deviator& a, const Vec3<Real>& v) {
        return {a.xx * v.x + a.xy * v.y + a.xz * v.z, a.xy * v.x + a.yy * v.y + a.yz * v.z,
                a.xz * v.x + a.yz * v.y - (a.xx + a.yy) * v.z};
    }
};

/// Square of the Frobenius norm, 2 J2.
template <class Real>
Real square_norm(const Deviator<Real>& a) {
    const Real zz = -(a.xx + a.yy);
    return a.xx * a.xx + a.yy * a.yy + zz * zz + 2 * (a.xy * a.xy + a.xz * a.xz + a.yz * a.yz);
}

/// The gradient of a displacement field, summed up over neighbours.
template <class Real>
struct DisplacementGradient {
    Vec3<Real> x{}, y{}, z{};  ///< gradient of each component

    void add(const Vec3<Real>& difference, const Vec3<Real>& weight_gradient) {
        x += weight_gradient * difference.x;
        y += weight_gradient * difference.y;
        z += weight_gradient * difference.z;
    }
    /// Symmetric part without trace: the strain that changes shape.
    [[nodiscard]] Deviator<Real> shear() const {
        const Real third = (x.x + y.y + z.z) / 3;
        return {x.x - third, y.y - third, (x.y + y.x) / 2, (x.z + z.x) / 2, (y.z + z.y) / 2};
    }
    /// Change of a stress that turns with the material (Jaumann): w s - s w with w the antisymmetric part.
    [[nodiscard]] Deviator<Real> rotation_of(const Deviator<Real>& s) const {
        const Real wxy = (x.y - y.x) / 2, wxz = (x.z - z.x) / 2, wyz = (y.z - z.y) / 2;
        const Real zz = -(s.xx + s.yy);
        return {2 * (wxy * s.xy + wxz * s.xz), 2 * (wyz * s.yz - wxy * s.xy),
                wxy * (s.yy - s.xx) + wxz * s.yz + wyz * s.xz, wxz * (zz - s.xx) + wxy * s.yz - wyz * s.xy,
                wyz * (zz - s.yy) - wxy * s.xz - wxz * s.xy};
    }
};

/// Drucker & Prager (1952) without cohesion: sqrt(J2) <= internal friction coefficient * pressure, by radial return.
template <class Real>
Deviator<Real> limit_to_friction(const Deviator<Real>& trial, Real internal_friction_coefficient, Real pressure) {
    const Real limit_square = 2 * internal_friction_coefficient * internal_friction_coefficient * pressure * pressure;
    const Real square = square_norm(trial);
    return square > limit_square ? trial * std::sqrt(limit_square / square) : trial;
}

/// Constants of the stress iteration; docs/equations.md says what each does.
struct StressConstants {
    static constexpr double warm_start = 0.5;           ///< share of the last step's pressure multiplier to begin with
    static constexpr double stiffness = 0.2;            ///< k = stiffness / sum |V grad W|^2
    static constexpr double pressure_smoothing = 0.05;  ///< weight of the newest step in the pressure that limits shear
};

}  // namespace talus
