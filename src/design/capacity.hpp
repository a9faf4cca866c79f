#pragma once

#include <vector>

#include "core/geometry.hpp"
#include "terrain/terrain.hpp"

/// What a barrier can hold on the ground as it is.
namespace talus::design {

/// 1: the ground left of the line is higher, so that debris comes from there; -1: right of it.
[[nodiscard]] int upstream_side(const terrain::Terrain& terrain, const std::vector<PlanPoint>& line);

/// The mean fall of the ground towards the line over `distance` upstream of it, as a tangent.
[[nodiscard]] double ground_slope(const terrain::Terrain& terrain, const std::vector<PlanPoint>& line, int side,
                                  double distance);

struct Storage {
    double volume = 0;        ///< m3
    double area = 0;          ///< m2
    double reach = 0;         ///< m upstream of the line
    bool open_sides = false;  ///< it would flow out beside the barrier's ends, where nothing holds it
};

/// The space behind a barrier up to its crest where that is lowest, between the perpendiculars at its ends: below a
/// surface that rises upstream with `slope`, a tangent (0: level), connected with the face. `height` above the ground
/// under the line; `thickness` of the wall, half of which stands upstream of the line.
[[nodiscard]] Storage storage_behind(const terrain::Terrain& terrain, const std::vector<PlanPoint>& line, int side,
                                     double height, double thickness, double slope);

}  // namespace talus::design
