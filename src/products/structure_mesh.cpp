#include "products/structure_mesh.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "core/triangulate.hpp"

namespace talus::products {
namespace {

constexpr double buried = 1;  // m, so that no gap shows below a wall on a slope

/// The lowest ground along an outline, world; NaN where none of it is known.
double lowest_ground(const terrain::Terrain& terrain, const Ring& ring) {
    double lowest = std::numeric_limits<double>::quiet_NaN();
    for (const PlanPoint& p : ring) lowest = std::fmin(lowest, terrain.elevation_at(p));
    return lowest;
}

class Faces {
  public:
    explicit Faces(const LocalFrame& frame) : frame_(frame) {}

    void add_roof(const Polygon& part, double roof) {
        for (const PlanTriangle& triangle : triangulate(part)) {
            for (const PlanPoint& p : triangle) add_corner({p.x, p.y, roof}, {0, 0, 1});
        }
    }
    /// Walls along a ring that has the solid to its left.
    void add_walls(const Ring& ring, double floor, double roof) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const PlanPoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
            const double length = std::hypot(b.x - a.x, b.y - a.y);
            if (length <= 0) continue;
            const LocalPoint out{static_cast<float>((b.y - a.y) / length), static_cast<float>((a.x - b.x) / length), 0};
            for (const auto& [p, z] : {std::pair{a, floor}, {b, floor}, {b, roof}, {a, floor}, {b, roof}, {a, roof}}) {
                add_corner({p.x, p.y, z}, out);
            }
        }
    }
    [[nodiscard]] TriangleMesh take() { return std::move(mesh_); }

  private:
    void add_corner(const WorldPoint& p, const LocalPoint& normal) {
        mesh_.corners.push_back(static_cast<std::uint32_t>(mesh_.points.size()));
        mesh_.points.push_back(frame_.to_local(p));
        mesh_.normals.push_back(normal);
    }

    LocalFrame frame_;
    TriangleMesh mesh_;
};

Ring with_solid_left(const Ring& ring, bool hole) {
    double twice = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const PlanPoint &o = ring.front(), &a = ring[i], &b = ring[(i + 1) % ring.size()];
        twice += (a.x - o.x) * (b.y - o.y) - (b.x - o.x) * (a.y - o.y);
    }
    return (twice > 0) != hole ? ring : Ring(ring.rbegin(), ring.rend());
}

}  // namespace

void TriangleMesh::add(const TriangleMesh& other) {
    const auto first = static_cast<std::uint32_t>(points.size());
    points.insert(points.end(), other.points.begin(), other.points.end());
    normals.insert(normals.end(), other.normals.begin(), other.normals.end());
    colours.insert(colours.end(), other.colours.begin(), other.colours.end());
    for (const std::uint32_t corner : other.corners) corners.push_back(first + corner);
}

TriangleMesh structure_mesh(const terrain::Terrain& terrain, const terrain::Building& building) {
    if (!stands(building)) return {};
    Faces faces(terrain.frame());
    for (std::size_t k = 0; k < building.footprint.size(); ++k) {
        const Polygon& part = building.footprint[k];
        const double roof =
            building.part_roof_elevations.empty() ? building.roof_elevation : building.part_roof_elevations[k];
        const double floor = lowest_ground(terrain, part.outer) - buried;
        if (!std::isfinite(roof) || !std::isfinite(floor) || floor >= roof) continue;
        faces.add_roof(part, roof);
        faces.add_walls(with_solid_left(part.outer, false), floor, roof);
        for (const Ring& hole : part.holes) {
            if (!hole.empty()) faces.add_walls(with_solid_left(hole, true), floor, roof);
        }
    }
    return faces.take();
}

report::Colour structure_colour(const report::IntensityGuideline& guideline, const observe::BuildingImpact& impact) {
    if (!impact.hit) return {190, 190, 186};
    const report::IntensityClass* intensity = guideline.class_of(impact);
    return intensity != nullptr ? intensity->colour : report::Colour{235, 225, 200};
}

}  // namespace talus::products
