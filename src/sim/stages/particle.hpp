#pragma once

#include <type_traits>

#include "core/geometry.hpp"
#include "sim/step_constants.hpp"

/// For lambdas of the bodies. All of a body is inlined: GCC 12 fails over a function of its own with vectors that the
/// baseline lacks.
#if defined(__CUDACC__)
#define TALUS_INLINE_LAMBDA
#else
#define TALUS_INLINE_LAMBDA __attribute__((always_inline))
#endif

/// The bodies of a step's stages, each written once, for whatever holds the particles. A body is given one of these:
///
/// - `LaneParticles` (sim/cpu/lane_particles.hpp): particles next to each other, a register full of each of their
///   numbers; the processor.
/// - `OneParticle` (sim/device/one_particle.hpp): one particle; a graphics card, and the host that stands in for it.
///
/// Both load and store the arrays of state and step in their own layout, under the same names. `Real` is their number.
/// Lanes hold debris that moves beside debris that does not: `moves()` and `mobile()` say which. One particle always
/// moves there: the kernel ends before the body where it does not.
///
/// Operations and their order decide the bits of a result. The double-precision reference does not use any of this: it
/// is the check.
namespace talus::sim::stages {

/// Where a particle is within its step.
template <class Real>
struct Displaced {
    Vec3<Real> place;  ///< where gradients are taken
    Vec3<Real> moved;  ///< from where the step started
    Real change{};     ///< of lambda, to apply
};

/// Position and velocity, as viscosity reads them.
template <class Real>
struct MotionOf {
    Vec3<Real> position, velocity;
};

/// The ground below a particle, taken to be plane within the step; the distance is that of a particle that is not
/// displaced.
template <class Real>
struct GroundPlane {
    Real distance, slope;
    Vec3<Real> normal;
};

/// The share of ground and walls in a particle's density.
template <class Real>
struct BoundaryShare {
    Real density{};
    Vec3<Real> gradient;
};

/// How a particle is held, where that is not the same for all (see resists_by_particle).
template <class Real>
struct Resistance {
    Real friction{0};         ///< coefficient on the ground, lowered by pore pressure
    Real strength{0};         ///< m, where it touches (see Grip)
    Real effective_share{1};  ///< 1 - r_u
    Real ground_shear{0};     ///< see shear_beside_ground; with inertial friction only
};

/// The water that rises around a particle; see Water.
template <class Real>
struct RisingWater {
    Real ratio{-1};  ///< at the end of the step; negative: none rises, or the debris has failed
    Real rise{0};    ///< in the step
};

/// The change to apply of a particle's stress, pressure included.
template <class Real>
struct StressChange {
    Real xx{}, xy{}, xz{}, yy{}, yz{}, zz{}, pressure{};
};

/// Both conditions, without a branch.
template <class Mask>
TALUS_INLINE Mask both(const Mask& a, const Mask& b) {
    if constexpr (std::is_same_v<Mask, bool>) {
        return a && b;
    } else {
        return a & b;
    }
}

}  // namespace talus::sim::stages
