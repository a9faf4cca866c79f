#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "params/spec.hpp"
#include "terrain/plan_bins.hpp"
#include "terrain/solid_walls.hpp"
#include "terrain/terrain.hpp"

namespace talus::terrain {

/// Resistance of a structure to the filtered force of debris normal to its walls. Above it, the structure is removed.
struct Resistance {
    double force_per_metre = std::numeric_limits<double>::infinity();  ///< N/m of a barrier's line
    double pressure = std::numeric_limits<double>::infinity();         ///< Pa, impact pressure on a patch of its walls
    bool operator==(const Resistance&) const = default;
};

/// A solid with vertical walls and a flat roof, from below the ground up to `roof_elevation` (not finite: no solid).
/// Its parts may have separate roofs, such as those of a wall whose crest follows the ground.
struct Building : params::BuildingSpec {
    std::string name;
    std::vector<Polygon> footprint;              ///< world plan coordinates
    bool height_assumed = false;                 ///< from the default, not from the data
    double roof_elevation = 0;                   ///< m, world; set by place_buildings
    std::vector<double> part_roof_elevations{};  ///< m, world, per part of the footprint; empty: one roof for all
    Resistance resistance{};
    std::optional<params::BarrierSpec>
        barrier{};  ///< its specification without the name, if it is a barrier (make_barrier)
};

/// Whether there is a solid.
[[nodiscard]] bool stands(const Building& building);

/// The same building without its solid: its index remains valid.
[[nodiscard]] Building without_solid(Building building);

/// Of the whole footprint, world.
[[nodiscard]] Extent extent_of(const Building& building);

/// Sets every roof to the mean ground elevation of its footprint plus its height; NaN where the ground is not known.
void place_buildings(const Terrain& terrain, std::vector<Building>& buildings);

/// Distance of a local position from the buildings. Cost away from all buildings: one table look-up. Buildings that
/// touch or overlap act as one solid: a wall between two of them is not a surface. A barrier with a clearance has a
/// lower face: below it there is no solid. A net is not a solid for grains whose rank by size, 0 to 1, is below its
/// passing share.
class BuildingSolids {
  public:
    BuildingSolids() = default;
    /// `range`: the greatest distance, m, at which `nearest` must still report a building.
    BuildingSolids(const Terrain& terrain, const std::vector<Building>& buildings, double range);

    [[nodiscard]] bool empty() const { return edges_.empty(); }
    [[nodiscard]] double range() const { return range_; }

    /// False where no solid can be within range of a local plan position: most of the ground.
    [[nodiscard]] bool near(float x, float y) const { return !bins_.near(x, y).empty(); }

    /// The building whose surface is nearest to the local position, if within range or inside. On an edge of a solid
    /// the normal is that of one of the faces that meet there.
    template <class Real>
    [[nodiscard]] SolidSample<Real> nearest(const Vec3<Real>& p, float grain_rank = largest_grain) const;

    /// From outside, the nearest wall or roof that is directly opposite the local position, within range, and that is
    /// turned away from `first`, the sample of nearest(), by 60 degrees or more: the other wall of a corner or an
    /// alley.
    template <class Real>
    [[nodiscard]] SolidSample<Real> second_nearest(const Vec3<Real>& p, const SolidSample<Real>& first,
                                                   float grain_rank = largest_grain) const;

    /// Whether the local position lies strictly inside any building.
    template <class Real>
    [[nodiscard]] bool inside(const Vec3<Real>& p, float grain_rank = largest_grain) const;

    /// For whoever computes elsewhere: valid as long as this, and until it changes.
    [[nodiscard]] SolidWalls walls() const {
        return {edges_.data(), solids_.data(), static_cast<std::uint32_t>(edges_.size()), range_, bins_.view()};
    }
    [[nodiscard]] const std::vector<WallEdge>& edges() const { return edges_; }
    [[nodiscard]] const std::vector<WallSolid>& solids() const { return solids_; }
    [[nodiscard]] const PlanBins& bins() const { return bins_; }

    /// Turns nets into walls.
    void close_nets() {
        for (Solid& solid : solids_) solid.passing_share = 0;
    }

    template <class Archive>
    void keep(Archive& archive) {
        archive(edges_, solids_, range_, bins_);
    }

  private:
    using Edge = WallEdge;
    using Solid = WallSolid;

    void split_walls();
    void fill_bins();

    std::vector<Edge> edges_;
    std::vector<Solid> solids_;
    double range_ = 0;
    PlanBins bins_;  // of solids_, grown by range_
};

}  // namespace talus::terrain
