#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry.hpp"
#include "report/colour.hpp"

namespace talus::products {

/// Triangles in the terrain's local frame: metres, x east, y north, z up; counterclockwise seen from outside.
struct TriangleMesh {
    std::vector<LocalPoint> points, normals;
    std::vector<report::Colour> colours;  ///< per point; empty: one for all
    std::vector<std::uint32_t> corners;   ///< three points per triangle

    void add(const TriangleMesh& other);
};

}  // namespace talus::products
