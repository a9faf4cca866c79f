#pragma once

#include "sim/physics/density.hpp"
#include "sim/physics/friction.hpp"
#include "sim/stages/pairs.hpp"
#include "sim/stages/particle.hpp"

/// Pairwise position-based dynamics (docs/equations.md), eqs. (1) to (4): density and pair friction, both start from
/// zero in every step.
namespace talus::sim::stages {

/// Compression present at the step's start may be undone only slowly, since a correction becomes velocity: the density
/// constraint tolerates the rest.
template <class At, class Smoothing>
TALUS_INLINE void find_tolerated(const At& at, const PairKernel<Smoothing>& kernel) {
    using Real = typename At::Real;
    const Vec3<Real> p = at.position_at_start();
    PairSums<Real> sums;
    at.for_each_neighbour([&](const auto& neighbour) TALUS_INLINE_LAMBDA {
        const Real q = kernel.scale.quotient(length(p - neighbour.position_at_start()));
        sums.density += neighbour.if_present(kernel.unscaled(q));
    });
    sums.finish(kernel);
    const Real start = sums.density + at.sample_boundary(p, Vec3<Real>{}).density - Real(1);
    at.set_tolerated_compression(larger(Real(0), start - Real(at.step().undone_compression)));
    at.set_multiplier(Real(0));
    // The first contacts are resolved before the first iteration.
    const Displaced<Real> predicted = at.displaced();
    at.sample_boundary(predicted.place, predicted.moved);
}

/// Debris resists compression only.
template <class At, class Smoothing>
TALUS_INLINE void update_multipliers(const At& at, const PairKernel<Smoothing>& kernel) {
    using Real = typename At::Real;
    const Displaced<Real> own = at.displaced();
    PairSums<Real> sums;
    at.for_each_neighbour([&](const auto& neighbour)
                              TALUS_INLINE_LAMBDA { sums.add(kernel, own.place - neighbour.place(), neighbour); });
    sums.finish(kernel);
    const BoundaryShare<Real> boundary = at.sample_boundary(own.place, own.moved);
    const Real compression = sums.density + boundary.density - Real(1);
    const Real before = at.multiplier();
    const Real after =
        next_multiplier(before, compression - at.tolerated_compression(),
                        gradient_square(sums, boundary, Real(at.step().softness)), Real(at.step().jacobi_factor));
    at.set_multiplier(select(at.moves(), after, before));
    at.set_compression(larger(Real(0), compression) * at.mobile());
    at.set_change((after - before) * at.mobile());
}

/// Friction between particles pressed together; equal and opposite for the two of a pair.
template <class At, class Smoothing>
TALUS_INLINE void apply_pairs(const At& at, const PairKernel<Smoothing>& kernel) {
    using Real = typename At::Real;
    using std::sqrt;
    const Displaced<Real> own = at.displaced();
    const Real cap(at.step().pair_friction_cap);
    Vec3<Real> correction = boundary_correction(at.boundary_gradient(), own.change);
    at.for_each_neighbour([&](const auto& neighbour) TALUS_INLINE_LAMBDA {
        const Displaced<Real> other = neighbour.displaced();
        const Vec3<Real> separation = own.place - other.place;
        const Real square = dot(separation, separation), distance = sqrt(square);
        const Real q = kernel.scale.quotient(distance);
        const Real push = (own.change + other.change) * Real(-kernel.scale.gradient_scale) * kernel.unscaled_slope(q);
        const Real limit = larger(Real(0), push * distance) * cap;  // none between separating particles
        correction +=
            separation * push + pair_friction(separation, square, own.moved - other.moved, limit, kernel.value(q));
    });
    at.set_corrected(own.moved + correction * at.mobile());
}

}  // namespace talus::sim::stages
