#pragma once

#include <numbers>

#include "core/geometry.hpp"

namespace talus::sim {

/// Coulomb friction on ground and walls as a position correction (Mueller et al. 2007; the accumulated form follows the
/// sequential impulses of Catto 2005). The correction that would undo the tangential displacement of this step is
/// limited to `limit` = friction coefficient * accumulated normal correction of this step, which makes the result
/// independent of the number of iterations.
/// Returns the change to apply now; `accumulated` is what the step has applied so far.
template <class Real>
TALUS_DEVICE Vec3<Real> friction_change(const Vec3<Real>& tangential_displacement, Real limit,
                                        Vec3<Real>& accumulated) {
    Vec3<Real> wanted = accumulated - tangential_displacement;
    const Real size = length(wanted);
    wanted = wanted * select(size > limit, limit / size, Real(1));
    const Vec3<Real> change = wanted - accumulated;
    accumulated = wanted;
    return change;
}

/// Ratio of a pair's tangential to its normal correction that gives an internal friction coefficient tan(phi):
/// in isotropic simple shear a cap c yields shear stress / pressure = (4 / pi) c.
inline double pair_friction_cap(double internal_friction_coefficient) {
    return std::numbers::pi / 4 * internal_friction_coefficient;
}

/// Friction between two particles: a correction against their relative tangential displacement, at most `cap` times
/// their normal correction, at most `weight` / 2 of the displacement itself. The weights V W of all neighbours add up
/// to about one, so that simultaneous corrections do not overshoot. Returns the correction of the first particle; the
/// second gets its opposite.
template <class Real>
TALUS_DEVICE Vec3<Real> pair_friction(const Vec3<Real>& separation, Real square_distance,
                                      const Vec3<Real>& relative_displacement, Real limit, Real weight) {
    const Real along = dot(relative_displacement, separation) / (square_distance + Real(1e-12));
    const Vec3<Real> tangential = relative_displacement - separation * along;
    const Real size = length(tangential);
    const Real wanted = Real(0.5) * weight * size;
    return tangential * select(wanted <= limit, Real(-0.5) * weight, -limit / size);
}

}  // namespace talus::sim
