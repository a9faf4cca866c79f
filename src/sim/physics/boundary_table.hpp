#pragma once

#include <vector>

#include "sim/physics/kernel.hpp"

namespace talus {

/// Share of density that a half-space of rest-density ground adds to a particle, as a function of its signed distance
/// to the plane: an analytic integral tabulated once (Koschier & Bender 2017, density maps, for a plane bed).
class BoundaryTable {
  public:
    BoundaryTable() = default;
    BoundaryTable(const Kernel& kernel, double particle_spacing);

    template <class Real>
    struct Share {
        Real density;  ///< 0 far away, 1/2 on the plane, to 1 deep inside
        Real slope;    ///< d density / d distance, 1/m, <= 0
    };

    template <class Real>
    [[nodiscard]] Share<Real> at(Real distance) const {
        const Real r = Real(support_radius_);
        // The negated form also takes the NaN distance of ground without data as "far away".
        if (!(distance < r)) return {Real(0), Real(0)};
        const Real u = (distance > -r ? distance + r : Real(0)) * Real(inverse_step_);
        const int i = static_cast<int>(u);
        const Real t = u - Real(i);
        const auto& a = nodes_[static_cast<std::size_t>(i)];
        const auto& b = nodes_[static_cast<std::size_t>(i) + 1];
        return {Real(a.density) + t * Real(b.density - a.density), Real(a.slope) + t * Real(b.slope - a.slope)};
    }

    /// The share of a half-space whose gradient has this size, 1/m: how much density a particle lacks whose neighbours
    /// pull it this strongly to one side.
    template <class Real>
    [[nodiscard]] Real density_at_slope(Real slope) const {
        const Real last = Real(by_slope_.size() - 2);
        const Real u = slope * Real(inverse_slope_step_);
        const Real bounded = u < last ? u : last;
        const int i = static_cast<int>(bounded);
        const Real low = Real(by_slope_[static_cast<std::size_t>(i)]);
        return low + (bounded - Real(i)) * (Real(by_slope_[static_cast<std::size_t>(i) + 1]) - low);
    }

  private:
    void tabulate_by_slope();

    struct Node {
        double density, slope;
    };
    double support_radius_ = 0, inverse_step_ = 0;
    std::vector<Node> nodes_;
    double inverse_slope_step_ = 0;
    std::vector<double> by_slope_;  // density at evenly spaced slopes from 0 to that on the plane
};

}  // namespace talus
