#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "observe/observation.hpp"
#include "run/boundary_flow.hpp"

namespace talus::run {

/// What a zoom was, and what crossed its boundary.
struct ZoomRecord {
    std::string around;  ///< the structure; empty: a polygon
    Polygon area;
    double surroundings = 0;                           ///< m beyond the boundary, after which particles are removed
    double event_volume = 0;                           ///< m3, of the event's releases and inflows
    double particle_spacing = 0;                       ///< m
    double thickness = 0;                              ///< m, greatest normal to the slope, of what came in
    double grid_cell = 0;                              ///< m, of the depth-averaged model
    double simulated_time = 0, wall_time = 0;          ///< s, of its run
    observe::Energy energy;                            ///< of that run
    BoundaryFlow::Volumes volumes;                     ///< in the depth-averaged model
    std::size_t pieces = 0;                            ///< of the boundary that debris came through
    double brought_volume = 0;                         ///< m3, of the particles
    PlanPoint momentum{0, 0}, brought_momentum{0, 0};  ///< N s in plan: of what came in, and of the particles
    std::vector<double> discharge;                     ///< m3/s that came in, every BoundaryFlow::interval

    [[nodiscard]] double layers() const { return thickness / particle_spacing; }
    /// s, when debris first crosses the boundary.
    [[nodiscard]] double first_time() const;
};

}  // namespace talus::run
