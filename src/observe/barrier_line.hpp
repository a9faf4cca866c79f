#pragma once

#include <vector>

#include "core/geometry.hpp"
#include "params/spec.hpp"
#include "terrain/terrain.hpp"

namespace talus::observe {

/// The line of a barrier in plan, local: what crosses it, and what lies beside it.
class BarrierLine {
  public:
    BarrierLine(const terrain::Terrain& terrain, const params::BarrierSpec& shape);

    struct Crossing {
        int net = 0;          ///< 1 from the line's left to its right, -1 back
        double chainage = 0;  ///< m
    };
    /// Of a way from `a` to `b`.
    [[nodiscard]] Crossing crossing(const PlanPoint& a, const PlanPoint& b) const;

    struct Place {
        double chainage = 0, distance = 0;
        int side = 0;  ///< 1 left, -1 right, 0: not beside the line, beyond the perpendiculars at its ends
    };
    [[nodiscard]] Place place_of(const PlanPoint& p) const;

    /// Below this elevation, local, debris passes through the barrier there, not over it; minus infinity: no opening.
    [[nodiscard]] double opening_crest(double chainage) const;

    [[nodiscard]] double length() const { return length_; }
    [[nodiscard]] const Extent& extent() const { return extent_; }
    [[nodiscard]] double half_thickness() const { return half_thickness_; }

  private:
    struct Opening {
        double from, to, crest;  ///< m along the line; local z
    };
    std::vector<PlanPoint> points_;  // rounded as positions of particles are
    std::vector<Opening> openings_;
    Extent extent_;
    double length_ = 0, half_thickness_ = 0;
};

/// World position at a chainage of a line.
[[nodiscard]] PlanPoint point_at(const std::vector<PlanPoint>& line, double chainage);

}  // namespace talus::observe
