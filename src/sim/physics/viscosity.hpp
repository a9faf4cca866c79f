#pragma once

#include <algorithm>
#include <limits>

#include "core/geometry.hpp"
#include "sim/model.hpp"
#include "terrain/terrain.hpp"

namespace talus::sim {

/// XSPH smoothing (Schechter & Bridson 2012): v_i += a sum_j V W_ij (v_j - v_i). The source of the method prints a
/// scalar product with grad W here, which is not a vector and has the sign that drives neighbours apart.
///
/// A coefficient per step would mean another material at every step length, so the scene's viscosity mu is the
/// smoothing per reference step of 1/60 s.
inline constexpr double viscosity_reference_step = 1.0 / 60;

/// The smoothing to apply in a step of `time_step` seconds. Proportional to it: variations that are slow over a support
/// radius lose a small part per step, which adds up to the same for any number of steps.
inline double step_smoothing(double viscosity, double time_step) {
    return std::min(1.0, viscosity * time_step / viscosity_reference_step);
}

/// The longest step in which the smoothing is at most the whole velocity difference. More would drive neighbours apart.
inline double longest_viscous_step(double viscosity) {
    return viscosity > 0 ? viscosity_reference_step / viscosity : std::numeric_limits<double>::infinity();
}

/// Viscosity shortens an adaptive step of at most `largest_time_step` to no less than this, s.
inline double shortest_viscous_step(double largest_time_step) {
    return std::min(largest_time_step, viscosity_reference_step) / 8;
}

/// The same smoothing against ground that viscous debris sticks to: the ground moves as if the flow continued below
/// with reversed velocity, so that the velocity is zero at the surface (Morris, Fox & Zhu 1997, "Modeling low Reynolds
/// number incompressible flows using SPH", section 3.4). Implicit: it never reverses the motion. Tangential only:
/// contact handles motion into the ground.
template <class Real, class AnyModel>
TALUS_DEVICE Vec3<Real> slowed_by_ground(const AnyModel& model, const terrain::GroundSample<Real>& below, Real distance,
                                         const Vec3<Real>& velocity, Real smoothing) {
    const Real loss = smoothing * model.boundary.sticking_at(distance);
    const Vec3<Real> along = velocity - below.normal * dot(velocity, below.normal);
    return velocity - along * (loss / (Real(1) + loss));
}

/// The kinematic viscosity, m2/s, equivalent to the smoothing for shear that varies slowly over a support radius: a
/// mode of wave number k decays at the rate (a / dt) k^2 / 2 * sum of x^2 V W.
inline double kinematic_viscosity(double viscosity, double kernel_second_moment) {
    return viscosity / viscosity_reference_step * kernel_second_moment / 2;
}

/// The inverse of `kinematic_viscosity`.
inline double smoothing_viscosity(double kinematic, double kernel_second_moment) {
    return 2 * kinematic * viscosity_reference_step / kernel_second_moment;
}

}  // namespace talus::sim
