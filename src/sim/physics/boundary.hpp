#pragma once

#include <array>

#include "core/geometry.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/physics/net.hpp"

namespace talus::sim {

/// A face of the boundary, taken to be plane near a particle.
template <class Real>
struct BoundaryFace {
    Real distance{};      ///< m along the normal
    Vec3<Real> normal{};  ///< unit, out of the ground or the solid
    Real slope{};         ///< d density / d distance, 1/m, <= 0
    int building = -1;    ///< the building it belongs to; -1: none
};

inline constexpr std::size_t face_count = 3;  ///< the ground, and the two nearest walls: debris collects in corners

/// Ground and walls around a particle: their share of its density, and how it changes with the particle's place.
template <class Real>
struct Boundary {
    std::array<BoundaryFace<Real>, face_count> faces;  ///< the ground first; an unused wall has no building
    Real density{};
    Vec3<Real> gradient{};  ///< of the density, 1/m, into ground and walls
};

/// The ground as a face.
template <class Real>
struct GroundFace {
    Real distance{};  ///< see BoundaryFace
    Vec3<Real> normal{};
    Real density{}, slope{};  ///< its share of a particle's density, and the derivative by the distance
};

template <class Real, class AnyModel, class AnyTerrain>
TALUS_DEVICE GroundFace<Real> sample_ground(const AnyModel& model, const AnyTerrain& terrain, const Vec3<Real>& p) {
    const terrain::GroundSample<Real> below = terrain.sample(p.x, p.y);
    const Real distance = (p.z - below.height) * below.normal.z;  // exact for a plane
    const auto share = model.boundary.at(distance);
    return {distance, below.normal, share.density, share.slope};
}

/// The ground and walls beside it. Where faces meet, their shares overlap. For a kernel close to a Gaussian and faces
/// at right angles the shared part is the product of the shares. `grain_rank` decides which nets are walls (see
/// net.hpp).
template <class Real, class AnyModel, class AnyGround>
TALUS_DEVICE Boundary<Real> boundary_with(const GroundFace<Real>& ground_share, const AnyModel& model,
                                          const AnyGround& ground, const Vec3<Real>& p, float grain_rank) {
    Boundary<Real> result;
    auto& [base, wall, second_wall] = result.faces;
    base = {ground_share.distance, ground_share.normal, ground_share.slope, -1};
    result.density = ground_share.density;
    result.gradient = base.normal * base.slope;
    if (ground.solids.empty()) return result;
    const terrain::SolidSample<Real> nearest = ground.solids.nearest(p, grain_rank);
    if (nearest.building < 0) return result;
    const terrain::SolidSample<Real> second = ground.solids.second_nearest(p, nearest, grain_rank);
    const auto share = model.boundary.at(nearest.distance);
    const auto second_share = second.building < 0 ? decltype(share){} : model.boundary.at(second.distance);
    const Real free = 1 - ground_share.density, wall_free = 1 - share.density, second_free = 1 - second_share.density;
    wall = {nearest.distance, nearest.normal, share.slope * free * second_free, nearest.building};
    second_wall = {second.distance, second.normal, second_share.slope * free * wall_free, second.building};
    base.slope *= wall_free * second_free;
    result.density = 1 - free * wall_free * second_free;
    result.gradient = base.normal * base.slope + wall.normal * wall.slope + second_wall.normal * second_wall.slope;
    return result;
}

template <class Real, class AnyModel, class AnyGround>
TALUS_DEVICE Boundary<Real> sample_boundary(const AnyModel& model, const AnyGround& ground, const Vec3<Real>& p,
                                            float grain_rank = terrain::largest_grain) {
    return boundary_with(sample_ground(model, ground.terrain, p), model, ground, p, grain_rank);
}

/// The response of a boundary to a particle, relative to passive ground: 2 would be a mirror image, which presses like
/// the particle (Akinci et al. 2012) and approaches as it does. With 1, hard contact has to carry most of the weight,
/// and creeps; with 2, debris beside a wall jitters; with 1.5 neither is observed (docs/equations.md).
inline constexpr double boundary_mirror_share = 1.5;

/// How a displacement changes the density that the constraint sees at a boundary of this gradient. The constraint and
/// the correction use the same share; otherwise the boundary would add energy.
template <class Real>
TALUS_DEVICE Real boundary_change(const Vec3<Real>& gradient, const Vec3<Real>& displacement) {
    return Real(boundary_mirror_share) * dot(gradient, displacement);
}

/// The correction, m, that a multiplier causes at a boundary whose density has this gradient.
template <class Real>
TALUS_DEVICE Vec3<Real> boundary_correction(const Vec3<Real>& gradient, Real multiplier) {
    return gradient * (Real(boundary_mirror_share) * multiplier);
}

/// The normal correction, m, that `multiplier` (<= 0) stands for at a face whose density has this slope.
template <class Real>
TALUS_DEVICE Real boundary_push(Real slope, Real multiplier) {
    return Real(boundary_mirror_share) * multiplier * slope;
}

}  // namespace talus::sim
