#pragma once

#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "depth/solver.hpp"
#include "run/run_scene.hpp"
#include "scene/scene.hpp"
#include "terrain/inflow.hpp"

/// A zoom: the depth-averaged model runs the event, and what crosses the boundary of an area becomes inflow of
/// particles that are finer than those of the whole event could be. What leaves the area is not fed back.
namespace talus::run {

/// Records what crosses the boundary of an area during a run of the depth-averaged model.
class BoundaryFlow {
  public:
    /// `piece`: m, length of boundary over which the flow is averaged.
    BoundaryFlow(const depth::Solver& solver, const Polygon& area, double piece);

    /// Call after every step of the solver.
    void record(const depth::Solver& solver);

    /// Totals, m3, of the volumes that came in and left, such that the difference is what the area gained: flow is
    /// sampled along the boundary, and the error of that is spread over both.
    struct Volumes {
        double in = 0, out = 0;
        double sampled_in = 0, sampled_out = 0;
    };
    [[nodiscard]] Volumes volumes() const;

    /// As inflows across lines, one per piece that debris comes through, at right angles to the direction of the
    /// momentum that it brought. Each brings a whole number of particles, all together the volume that came in to the
    /// nearest; and the momentum of the flow, per density.
    [[nodiscard]] std::vector<terrain::Inflow> inflows(double particle_spacing) const;

  private:
    struct Interval {
        double volume = 0, momentum_x = 0, momentum_y = 0;  ///< m3, m4/s
    };
    struct Piece {
        PlanPoint centre, along, inward;  ///< `along`, `inward`: unit vectors
        double length = 0;
        double slope_x = 0, slope_y = 0;  ///< of the ground
        std::vector<Interval> intervals;
    };
    [[nodiscard]] double volume_inside(const depth::Solver& solver) const;

    GridGeometry cells_;
    std::vector<Piece> pieces_;
    std::vector<std::pair<std::size_t, float>> inside_;  ///< cells, and how much of each
    double in_ = 0, out_ = 0, gained_ = 0;
};

/// What a zoom takes from the depth-averaged run.
struct Zoom {
    Polygon area;
    std::vector<terrain::Inflow> inflows;
    BoundaryFlow::Volumes volumes;
    double wall_time = 0, grid_cell = 0;  ///< s, m, of the depth-averaged run
    bool interrupted = false;
};

/// The rectangle around a structure. Errors: there is none of that name.
[[nodiscard]] Result<Polygon> zoom_around(const scene::Scene& scene, const std::string& structure, double margin);

/// Runs the depth-averaged model. Errors: as run_scene(); debris starts or comes in within the area, or a bed lies
/// there; no debris reaches it.
[[nodiscard]] Result<Zoom> record_zoom(const scene::Scene& grid_scene, const Polygon& area, double particle_spacing,
                                       const RunOptions& options);

/// Puts the inflows of a zoom in place of a scene's releases and inflows. Particles get `particle_spacing`.
void zoom_in(scene::Scene& scene, const Zoom& zoom, double particle_spacing);

}  // namespace talus::run
