#pragma once

#include "observe/observation.hpp"
#include "products/triangle_mesh.hpp"
#include "report/intensity.hpp"
#include "terrain/buildings.hpp"
#include "terrain/terrain.hpp"

namespace talus::products {

/// Walls and roofs of a structure, from a metre below the lowest ground at its walls; every face has its own corners.
/// Empty where it has no solid.
[[nodiscard]] TriangleMesh structure_mesh(const terrain::Terrain& terrain, const terrain::Building& building);

/// What a structure looks like: grey, or as hard as it was hit.
[[nodiscard]] report::Colour structure_colour(const report::IntensityGuideline& guideline,
                                              const observe::BuildingImpact& impact);

}  // namespace talus::products
