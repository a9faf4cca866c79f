#pragma once

#include "core/geometry.hpp"
#include "sim/model.hpp"

namespace talus {

/// Ground and walls as a particle sees them: distances, normals, and their share of its density.
template <class Real>
struct BoundarySample {
    Real ground_distance{};  ///< m along the normal; NaN where the ground is unknown
    Vec3<Real> ground_normal{};
    int building = -1;
    Real building_distance{};
    Vec3<Real> building_normal{};
};

template <class Real>
BoundarySample<Real> sample_boundary(const Model& model, const Vec3<Real>& p) {
    const GroundSample<Real> ground = model.terrain.sample(p.x, p.y);
    BoundarySample<Real> result;
    result.ground_distance = (p.z - ground.height) * ground.normal.z;  // exact for a plane
    result.ground_normal = ground.normal;
    if (!model.solids.empty()) {
        const SolidSample<Real> solid = model.solids.nearest(p);
        result.building = solid.building;
        result.building_distance = solid.distance;
        result.building_normal = solid.normal;
    }
    return result;
}

/// How hard a boundary pushes back, relative to the particle's own multiplier: it mirrors the particle's pressure, as a
/// neighbour of the same pressure would (Akinci et al. 2012).
inline constexpr int boundary_pressure_share = 2;

/// The boundary's share of density and its gradient, split by what exerts it.
template <class Real>
struct BoundaryDensity {
    Real density{};
    Vec3<Real> ground_gradient{}, building_gradient{};  ///< 1/m, into ground and walls

    /// The correction that a multiplier brings about, m.
    [[nodiscard]] Vec3<Real> correction(Real multiplier) const {
        return (ground_gradient + building_gradient) * (Real(boundary_pressure_share) * multiplier);
    }
};

/// The normal correction of a face, m, that `multiplier` (<= 0) stands for.
template <class Real>
Real boundary_push(Real multiplier, const Vec3<Real>& face_gradient) {
    return -Real(boundary_pressure_share) * multiplier * length(face_gradient);
}

/// Ground and a wall at the same time overlap below the wall's foot. For a kernel close to a Gaussian and faces at
/// right angles the shared part is the product of the shares.
template <class Real>
BoundaryDensity<Real> boundary_density(const Model& model, const BoundarySample<Real>& boundary) {
    const auto ground = model.boundary.at(boundary.ground_distance);
    BoundaryDensity<Real> result;
    result.density = ground.density;
    result.ground_gradient = boundary.ground_normal * ground.slope;
    if (boundary.building >= 0) {
        const auto wall = model.boundary.at(boundary.building_distance);
        result.density = 1 - (1 - ground.density) * (1 - wall.density);
        result.ground_gradient = result.ground_gradient * (1 - wall.density);
        result.building_gradient = boundary.building_normal * (wall.slope * (1 - ground.density));
    }
    return result;
}

}  // namespace talus
