#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "depth/solver.hpp"
#include "terrain/inflow.hpp"

namespace talus::run {

/// Records what crosses the boundary of an area during a run of the depth-averaged model.
class BoundaryFlow {
  public:
    static constexpr double interval = 0.1;  ///< s, over which flow is averaged

    BoundaryFlow(const depth::Solver& solver, const Polygon& area);

    /// Call after every step of the solver.
    void record(const depth::Solver& solver);

    /// Adds debris that came in at a place of the boundary from elsewhere: m3, and its velocity in plan, m/s.
    void bring(const PlanPoint& place, double time, double volume, double u, double v);

    /// Totals, m3, of the volumes that came in and left, such that the difference is what the area gained: flow is
    /// sampled along the boundary, and the error of that is spread over both.
    struct Volumes {
        double in = 0, out = 0;
        double sampled_in = 0, sampled_out = 0;
    };
    [[nodiscard]] Volumes volumes() const;
    /// Of what came in, per density, m4/s.
    [[nodiscard]] PlanPoint momentum() const;
    /// m3/s that came in, by interval.
    [[nodiscard]] std::vector<double> discharge() const;
    /// Greatest of what came in, normal to the slope, m.
    [[nodiscard]] double thickness() const { return thickness_; }

    /// As inflows across lines, one per piece that debris comes through, at right angles to the direction of the
    /// momentum that it brought. Each brings a whole number of particles, all together the volume that came in to the
    /// nearest; and the momentum of the flow, per density.
    [[nodiscard]] std::vector<terrain::Inflow> inflows(double particle_spacing) const;

  private:
    struct Interval {
        double volume = 0, momentum_x = 0, momentum_y = 0;  ///< m3, m4/s
        double pore_pressure = 0;                           ///< m3, volume times r_u

        Interval& operator+=(const Interval& more);
    };
    struct Piece {
        PlanPoint centre, along, inward;  ///< `along`, `inward`: unit vectors
        double length = 0;
        double slope_x = 0, slope_y = 0;  ///< of the ground
        std::size_t edge = 0;             ///< of the area's outline
        std::vector<Interval> intervals;
    };
    [[nodiscard]] double volume_inside(const depth::Solver& solver) const;
    [[nodiscard]] std::vector<Piece> merged(double least_length) const;
    [[nodiscard]] Piece joined(std::size_t from, std::size_t to) const;

    GridGeometry cells_;
    std::vector<Piece> pieces_;
    std::vector<std::pair<std::size_t, float>> inside_;  ///< cells, and how much of each
    double in_ = 0, out_ = 0, gained_ = 0, thickness_ = 0;
    bool carries_pore_pressure_ = false;
};

}  // namespace talus::run
