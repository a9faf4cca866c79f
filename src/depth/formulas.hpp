#pragma once

#include "core/number.hpp"
#include "sim/physics/ground_laws.hpp"

/// The formulas of the depth-averaged model, on one number or on many lanes; docs/depth-averaged.md has the equations.
namespace talus::depth {

/// Debris thinner than this lets nothing out and has no velocity, m. Its volume stays where it is.
inline constexpr float dry_depth = 1e-4F;

template <class Real>
TALUS_INLINE Real magnitude(const Real& a) {
    return larger(a, Real(0) - a);
}

/// The generalised minmod limiter (van Leer 1979; Kurganov & Tadmor 2000), theta = 1.3, for the change over a cell.
template <class Real>
TALUS_INLINE Real limited(const Real& before, const Real& after) {
    const Real a = before * Real(1.3F), b = (before + after) * Real(0.5F), c = after * Real(1.3F);
    return larger(Real(0), smaller(smaller(a, b), c)) + smaller(Real(0), larger(larger(a, b), c));
}

/// A cell and its two neighbours along an axis. Beds are relative to the cell's own.
template <class Real>
struct Line {
    Real depth, before, after;                                                      ///< m
    Real bed_before, bed_after;                                                     ///< m
    Real normal, normal_before, normal_after, across, across_before, across_after;  ///< velocities
};

/// What the faces before and after a cell see of it.
template <class Real>
struct Sides {
    Real depth_before, depth_after;
    Real rise;  ///< of the surface from one face to the other
    Real normal_before, normal_after, across_before, across_after;
};

/// 1 beside dry ground that stands above the cell's surface, else 0.
template <class Real>
TALUS_INLINE Real wall_beside(const Real& depth, const Real& beside, const Real& bed_beside) {
    return opaque(select(beside <= Real(dry_depth), Real(1), Real(0))) *
           opaque(select(bed_beside + beside > depth, Real(1), Real(0)));
}

/// The surface of a neighbour for slopes: that of the cell itself, where the neighbour is dry and stands above it. So
/// a lake ends at its shore.
template <class Real>
TALUS_INLINE Real surface_beside(const Real& depth, const Real& beside, const Real& bed_beside) {
    const Real surface = bed_beside + beside;
    return select(beside <= Real(dry_depth), opaque(smaller(surface, depth)), surface);
}

/// 1 beside a structure whose top debris does not reach with the depth and the kinetic energy that it has, else 0.
template <class Real>
TALUS_INLINE Real structure_beside(const Real& depth, const Real& normal, const Real& gravity, const Real& beside,
                                   const Real& bed_beside, const Real& structure, const Real& structure_beside) {
    const Real reach = depth + normal * normal / (Real(2) * gravity);
    return opaque(select(structure < structure_beside, Real(1), Real(0))) *
           opaque(select(reach < bed_beside + beside, Real(1), Real(0)));
}

/// Gives neighbours the debris of the cell itself, on their own ground.
template <class Real>
TALUS_INLINE void continue_stream(Line<Real>& l, const Real& before, const Real& after) {
    const auto take = [](const Real& stream, const Real& own, Real& beside) __attribute__((always_inline)) {
        beside = select(stream > Real(0), own, beside);
    };
    take(before, l.depth, l.before);
    take(before, l.normal, l.normal_before);
    take(before, l.across, l.across_before);
    take(after, l.depth, l.after);
    take(after, l.normal, l.normal_after);
    take(after, l.across, l.across_after);
}

/// Such a neighbour is replaced by ground that goes on as before, under the same debris.
template <class Real>
TALUS_INLINE void replace_structures(Line<Real>& l, const Real& before, const Real& after) {
    const Real one_sided_after = select(after > Real(0), Real(0) - l.bed_before, l.bed_after);
    const Real one_sided_before = select(before > Real(0), Real(0) - l.bed_after, l.bed_before);
    l.bed_before = select(before * after > Real(0), Real(0), one_sided_before);
    l.bed_after = select(before * after > Real(0), Real(0), one_sided_after);
    continue_stream(l, before, after);
}

/// 1 beside shallower debris on the side that an inflow comes from, else 0. `from`: 1 there. The stream goes on behind
/// its line, and holds against the debris that it brought.
template <class Real>
TALUS_INLINE Real inflow_beside(const Real& from, const Real& depth, const Real& beside) {
    return opaque(select(from > Real(0), Real(1), Real(0))) * opaque(select(beside < depth, Real(1), Real(0)));
}

/// Second-order values at the faces: slopes of depth or of surface elevation, whichever changes less over the cell.
template <class Real>
TALUS_INLINE Sides<Real> sides_of(const Line<Real>& l) {
    const Real half(0.5F);
    const Real below = l.depth - surface_beside(l.depth, l.before, l.bed_before);
    const Real above = surface_beside(l.depth, l.after, l.bed_after) - l.depth;
    const Real by_surface = limited(below, above) * half;
    const Real by_depth = limited(l.depth - l.before, l.after - l.depth) * half;
    const auto take_surface =
        magnitude(below) + magnitude(above) <= magnitude(l.depth - l.before) + magnitude(l.after - l.depth);
    const Real half_bed_before = l.bed_before * half, half_bed_after = l.bed_after * half;
    // Elevations above the cell's own bed.
    const Real surface_before = select(take_surface, l.depth - by_surface, l.depth - by_depth + half_bed_before);
    const Real surface_after = select(take_surface, l.depth + by_surface, l.depth + by_depth + half_bed_after);
    const Real wet = opaque(select(l.depth <= Real(dry_depth), Real(0), Real(1)));
    Sides<Real> s;
    s.depth_before = wet * larger(Real(0), surface_before - half_bed_before);
    s.depth_after = wet * larger(Real(0), surface_after - half_bed_after);
    s.rise = surface_after - surface_before;
    const auto flat = opaque(smaller(l.depth, smaller(l.before, l.after))) <= Real(dry_depth);
    const auto sloped = [&](const Real& at, const Real& before, const Real& after) __attribute__((always_inline)) {
        return select(flat, Real(0), limited(at - before, after - at) * half);
    };
    const Real by_normal = sloped(l.normal, l.normal_before, l.normal_after);
    const Real by_across = sloped(l.across, l.across_before, l.across_after);
    s.normal_before = l.normal - by_normal;
    s.normal_after = l.normal + by_normal;
    s.across_before = l.across - by_across;
    s.across_after = l.across + by_across;
    return s;
}

/// One side of a face. The axis points from `before` to `after`.
template <class Real>
struct FaceSide {
    Real depth, normal, across;
    Real wave;    ///< square of the wave speed over the depth, m/s2
    Real limit;   ///< the largest mass flux that the cell can feed without running dry, m2/s
    Real square;  ///< of the speed along the ground, m2/s2
    Real lift;    ///< pressure on the ground over density and depth, m/s2
};

template <class Real>
struct Flux {
    Real mass;                             ///< m2/s
    Real normal, across;                   ///< advected momentum, m3/s2
    Real pressure_before, pressure_after;  ///< at the face, above depth^2 / 2 of that side, m2
    Real carried_normal, carried_across;   ///< velocity of the debris that passes
    Real energy;                           ///< of motion and pressure, with the work of pressure, m4/s3
};

/// HLL (Harten, Lax & van Leer 1983) with the wave speeds of Davis (1988), beside dry ground those of a dam break
/// (Ritter 1892; Toro 2001). Tangential momentum goes with the mass. At a face with the same depth on both sides and no
/// velocity every number is exactly zero.
template <class Real>
TALUS_INLINE Flux<Real> face_flux(const FaceSide<Real>& before, const FaceSide<Real>& after) {
    using std::sqrt;
    const Real zero(0), tiny(1e-12F);
    const Real c_before = sqrt(before.wave * before.depth), c_after = sqrt(after.wave * after.depth);
    const auto dry_before = before.depth <= tiny, dry_after = after.depth <= tiny;
    const Real slow = select(
        dry_before, after.normal - Real(2) * c_after,
        select(dry_after, before.normal - c_before, opaque(smaller(before.normal - c_before, after.normal - c_after))));
    const Real fast = select(
        dry_after, before.normal + Real(2) * c_before,
        select(dry_before, after.normal + c_after, opaque(larger(before.normal + c_before, after.normal + c_after))));
    const Real left = smaller(opaque(slow), zero), right = larger(opaque(fast), zero);
    const Real scale = Real(1) / (right - left + tiny);
    const Real wave_before = right * scale, wave_after = (zero - left) * scale, both = left * right * scale;
    const Real m_before = before.depth * before.normal, m_after = after.depth * after.normal;
    const Real mass = wave_before * m_before + wave_after * m_after + both * (after.depth - before.depth);
    const Real advected =
        wave_before * (m_before * before.normal) + wave_after * (m_after * after.normal) + both * (m_after - m_before);
    const Real half(0.5F), head_before = before.lift * before.depth, head_after = after.lift * after.depth;
    const Real energy =
        wave_before * (m_before * (half * before.square + head_before)) +
        wave_after * (m_after * (half * after.square + head_after)) +
        both * half * (after.depth * (after.square + head_after) - before.depth * (before.square + head_before));
    const auto forward = mass > zero;
    const Real limit = select(forward, before.limit, after.limit), size = magnitude(mass);
    const Real share = select(size > limit, limit / (size + tiny), Real(1));
    const Real jump = (after.depth - before.depth) * (after.depth + before.depth) * Real(0.5F);
    Flux<Real> f;
    f.mass = mass * share;
    f.normal = advected * share;
    f.energy = energy * share;
    f.carried_normal = select(forward, before.normal, after.normal);
    f.carried_across = select(forward, before.across, after.across);
    f.across = f.mass * f.carried_across;
    f.pressure_before = wave_after * jump;
    f.pressure_after = zero - wave_before * jump;
    return f;
}

/// Resistance of the ground in a cell, per density.
template <class Real>
struct Resistance {
    Real friction;            ///< Coulomb's coefficient times the share of the normal stress that the grains bear
    Real strength;            ///< cohesion over density, m2/s2
    Real inverse_turbulence;  ///< 1 / xi at the depth of the flow, s2/m
    Real stem_drag;           ///< deceleration over v^2, 1/m
    Real viscosity;           ///< kinematic, on the ground, m2/s
    sim::MovingFriction<Real> moving_friction{};
};

/// What a plug adds to the stress on the ground, over the yield stress. A sheet that shears below a plug (Bingham 1922)
/// moves with U = tau h (1 - a)^2 (2 + a) / (6 rho nu), where a = yield stress / tau. With w = laminar drag of a
/// parabolic profile over yield stress, that is 2 s^3 - (3 + 2 w) s^2 + 1 = 0 for s = 1 / a, and s - 1 - w rises from
/// 0 to 1/2: 1/2 - 1/2 / (1 + 2 r + 7/3 r^2 + 11/4 r^3) with r = sqrt(2 w / 3) is within 0.15 % of s.
///
/// Implicit, by Newton's method, whose function is convex and begins above its root: m (1 + laminar) + yield (1 +
/// excess) = momentum, where both are what they take in the step: `laminar` of the momentum m that is left, `yield` in
/// m2/s.
template <class Real>
TALUS_INLINE Real plug_excess(const Real& momentum, const Real& yield, const Real& laminar) {
    using std::sqrt;
    const Real a = laminar * momentum / larger(yield, Real(1e-12F)), square = Real(1.5F) + Real(1.5F) * laminar;
    Real r = sqrt(larger(Real(0), a - laminar) / square), inverse = Real(1);
    for (int k = 0; k < 4; ++k) {
        inverse = Real(1) / (Real(1) + r * (Real(2) + r * (Real(7.0F / 3) + r * Real(2.75F))));
        const Real rise = (Real(1) + r * (Real(7.0F / 3) + r * Real(4.125F))) * inverse * inverse;
        const Real excess = Real(0.5F) - Real(0.5F) * inverse;
        const Real above = square * r * r + laminar * (Real(1) + excess) - a;
        r = larger(Real(0), r - above / larger(Real(2) * square * r + laminar * rise, Real(1e-12F)));
    }
    return Real(0.5F) - Real(0.5F) * inverse;
}

/// The momentum that drag leaves of what friction left: the positive root of laminar m + square m^2 = left.
template <class Real>
TALUS_INLINE Real left_by(const Real& friction_left, const Real& laminar, const Real& square) {
    using std::sqrt;
    const Real left = larger(Real(0), friction_left);
    return Real(2) * left / (laminar + sqrt(laminar * laminar + Real(4) * square * left));
}

/// Momentum along the ground (depth times speed, m2/s) after a step of resistance, implicitly: Coulomb and cohesion,
/// which stop, with the plug of cohesive viscous debris; laminar drag 3 nu U / h on the ground below a parabolic
/// profile; Voellmy's (1955) rho g U^2 / xi and stems (see sim/physics/resistance.hpp), and what stands in for them
/// (see sim/physics/ground_laws.hpp). `stretch`: area of the ground over its plan area; `normal_force`: normal stress
/// over density, m2/s2.
template <class Real>
TALUS_INLINE Real resisted(const Resistance<Real>& r, const Real& gravity, const Real& momentum, const Real& depth,
                           const Real& normal_force, const Real& stretch, const Real& time_step) {
    const Real inverse_depth = Real(1) / larger(depth, Real(dry_depth));
    const Real laminar =
        Real(1) + Real(3) * r.viscosity * time_step * (stretch * inverse_depth) * (stretch * inverse_depth);
    Real strength = r.strength;
    if (any(r.viscosity > Real(0))) {
        const Real stopping = time_step * stretch;
        strength = strength + strength * plug_excess(momentum - stopping * r.friction * normal_force,
                                                     stopping * strength, laminar - Real(1));
    }
    const Real square =
        time_step * inverse_depth * (gravity * stretch * r.inverse_turbulence * inverse_depth + r.stem_drag);
    const Real area = time_step * stretch;
    if (!any(r.moving_friction.on())) {
        return left_by(momentum - area * (r.friction * normal_force + strength), laminar, square);
    }
    // Friction that falls with the speed, from rest upwards, so that debris stops where it can.
    Real friction = r.moving_friction.at_rest(r.friction), left = Real(0);
    for (int k = 0; k < 5; ++k) {
        left = left_by(momentum - area * (friction * normal_force + strength), laminar, square);
        const Real speed = left * inverse_depth;
        friction = r.moving_friction.at(r.friction, normal_force, speed * speed);
    }
    return left;
}

/// Whether debris at rest stays: friction and cohesion carry the slope of its surface. Slopes of the surface are
/// central where both neighbours are wet and it rises or falls steadily, else the steeper one; on a crest or in a
/// hollow, axis by axis. `below`, `above`: changes of the surface to the cell and from it.
template <class Real>
struct RestSlope {
    Real slope;
    Real extreme;  ///< 1 on a crest or in a hollow, else 0
};
template <class Real>
TALUS_INLINE RestSlope<Real> rest_slope(const Line<Real>& l, const Real& inverse_cell) {
    const Real below = l.depth - surface_beside(l.depth, l.before, l.bed_before);
    const Real above = surface_beside(l.depth, l.after, l.bed_after) - l.depth;
    const Real extreme = opaque(select(below * above < Real(0), Real(1), Real(0)));
    const Real central =
        (Real(1) - extreme) * select(opaque(smaller(l.before, l.after)) > Real(dry_depth), Real(1), Real(0));
    const Real steeper = select(magnitude(below) > magnitude(above), below, above);
    return {select(central > Real(0), (below + above) * Real(0.5F), steeper) * inverse_cell, extreme};
}

/// Driving force and resistance at rest, squared.
template <class Real>
struct RestBalance {
    Real driving, resisting;
};
template <class Real>
TALUS_INLINE RestBalance<Real> rest_balance(const RestSlope<Real>& x, const RestSlope<Real>& y, const Real& bed_x,
                                            const Real& bed_y, const Real& square_stretch, const Real& gravity,
                                            const Real& depth, const Resistance<Real>& r) {
    const Real by_x = x.slope * bed_x, by_y = y.slope * bed_y, along = by_x + by_y;
    const Real in_x = x.slope * x.slope + by_x * by_x, in_y = y.slope * y.slope + by_y * by_y;
    const Real square = select(x.extreme + y.extreme > Real(0), larger(in_x, in_y),
                               x.slope * x.slope + y.slope * y.slope + along * along);
    const Real normal = gravity * depth;
    const Real strength =
        r.moving_friction.at_rest(r.friction) * normal + r.strength * (Real(1) + larger(Real(0), along));
    return {square * normal * normal, strength * strength * square_stretch};
}

}  // namespace talus::depth
