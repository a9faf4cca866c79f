#pragma once

#include <vector>

#include "core/number.hpp"
#include "sim/physics/kernel.hpp"

namespace talus::sim {

/// The tables of a BoundaryTable by pointers: see there. It owns nothing.
struct BoundaryNodes {
    double support_radius = 0, inverse_step = 0, inverse_slope_step = 0;
    const Quad *nodes = nullptr, *by_slope = nullptr, *sticking = nullptr;
    int node_count = 0, by_slope_count = 0, sticking_count = 0;

    template <class Real>
    struct Share {
        Real density;  ///< 0 far away, 1/2 on the plane, to 1 deep inside
        Real slope;    ///< d density / d distance, 1/m, <= 0
    };

    template <class Real>
    [[nodiscard]] TALUS_INLINE Share<Real> at(Real distance) const {
        const Real r = Real(support_radius);
        const auto near = distance < r;
        const Real u = select(near, larger(Real(0), distance + r), Real(0)) * Real(inverse_step);
        const auto i = truncated(u);
        const Real t = u - from_index<Real>(i);
        const auto node = quads_at(nodes, i);
        return {select(near, Real(node.x) + t * Real(node.y), Real(0)),
                select(near, Real(node.z) + t * Real(node.w), Real(0))};
    }

    /// The share of a half-space whose gradient has this size, 1/m: the density that a particle lacks when its
    /// neighbours are this unbalanced.
    template <class Real>
    [[nodiscard]] TALUS_INLINE Real density_at_slope(Real slope) const {
        const Real last = Real(by_slope_count - 1);
        const Real u = larger(Real(0), smaller(last, slope * Real(inverse_slope_step)));
        const auto i = truncated(u);
        const auto node = quads_at(by_slope, i);
        return Real(node.x) + (u - from_index<Real>(i)) * Real(node.y);
    }

    /// Sum of V W (1 + z / d) over ground at depths z, for a particle at the distance d: how much it loses of its
    /// velocity to ground where the flow goes on with its velocity turned around. At most what it is at a quarter of a
    /// spacing. Scaled so that a rest lattice loses as much to ground as viscosity inside passes on.
    template <class Real>
    [[nodiscard]] TALUS_INLINE Real sticking_at(Real distance) const {
        const Real last = Real(sticking_count - 1);
        const Real u = larger(Real(0), smaller(last, distance * Real(2 * inverse_step)));
        const auto i = truncated(u);
        const auto node = quads_at(sticking, i);
        return Real(node.x) + (u - from_index<Real>(i)) * Real(node.y);
    }
};

/// Share of density that a half-space of rest-density ground adds to a particle, as a function of its signed distance
/// to the plane: an analytic integral tabulated once (Koschier & Bender 2017, density maps, for a plane bed).
class BoundaryTable {
  public:
    BoundaryTable() = default;
    BoundaryTable(const Kernel& kernel, double particle_spacing);

    /// See BoundaryNodes, as for the two below.
    template <class Real>
    [[nodiscard]] TALUS_INLINE BoundaryNodes::Share<Real> at(Real distance) const {
        return nodes().at(distance);
    }
    template <class Real>
    [[nodiscard]] TALUS_INLINE Real density_at_slope(Real slope) const {
        return nodes().density_at_slope(slope);
    }
    template <class Real>
    [[nodiscard]] TALUS_INLINE Real sticking_at(Real distance) const {
        return nodes().sticking_at(distance);
    }
    /// For whoever computes elsewhere: valid as long as the table.
    [[nodiscard]] TALUS_INLINE BoundaryNodes nodes() const {
        return {support_radius_,
                inverse_step_,
                inverse_slope_step_,
                nodes_.data(),
                by_slope_.data(),
                sticking_.data(),
                static_cast<int>(nodes_.size()),
                static_cast<int>(by_slope_.size()),
                static_cast<int>(sticking_.size())};
    }

  private:
    void tabulate_by_slope();
    void tabulate_sticking(const Kernel& kernel, double particle_spacing);

    double support_radius_ = 0, inverse_step_ = 0;
    std::vector<Quad> nodes_;  // density, its rise to the next node, slope, its rise
    double inverse_slope_step_ = 0;
    std::vector<Quad> by_slope_;  // density at evenly spaced slopes from 0 to that on the plane; its rise
    std::vector<Quad> sticking_;  // at distances from 0 to r, twice as many nodes as in that range; its rise
};

}  // namespace talus::sim
