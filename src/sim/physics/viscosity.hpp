#pragma once

#include <cmath>

namespace talus {

/// XSPH smoothing (Schechter & Bridson 2012): v_i += a sum_j V W_ij (v_j - v_i). The source of the method prints a
/// scalar product with grad W here, which is no vector and has the sign that drives neighbours apart.
///
/// A coefficient per step would mean another material at every step length, so the scene's viscosity mu is the
/// smoothing per reference step of 1/60 s.
inline constexpr double viscosity_reference_step = 1.0 / 60;

/// The smoothing to apply in a step of `time_step` seconds: what is left of a difference, (1 - mu), compounds.
inline double step_smoothing(double viscosity, double time_step) {
    return 1 - std::pow(1 - viscosity, time_step / viscosity_reference_step);
}

/// The kinematic viscosity, m2/s, that the smoothing amounts to for shear that varies slowly over a support radius:
/// a mode of wave number k decays at the rate (a / dt) k^2 / 2 * integral of x^2 W dV.
inline double kinematic_viscosity(double viscosity, double kernel_second_moment) {
    return -std::log1p(-viscosity) / viscosity_reference_step * kernel_second_moment / 2;
}

/// The inverse of `kinematic_viscosity`.
inline double smoothing_viscosity(double kinematic, double kernel_second_moment) {
    return -std::expm1(-2 * kinematic * viscosity_reference_step / kernel_second_moment);
}

}  // namespace talus
