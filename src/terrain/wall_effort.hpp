#pragma once

#include <vector>

#include "core/geometry.hpp"
#include "terrain/buildings.hpp"

namespace talus::terrain {

/// What BuildingSolids of these will cost, without making them: solids that overlap cut each other's walls, and the
/// pieces are looked through near each particle. Upper bounds.
class WallEffort {
  public:
    /// `range`: as of BuildingSolids.
    WallEffort(const std::vector<Building>& buildings, double range);

    /// Comparisons of walls that the constructor of BuildingSolids makes.
    [[nodiscard]] double comparisons() const { return comparisons_; }
    /// Pieces into which it cuts them.
    [[nodiscard]] double pieces() const;
    /// Pieces of walls that a look-up goes through, as a mean over an extent, world.
    [[nodiscard]] double pieces_near(const Extent& extent) const;

  private:
    struct Part {
        Extent extent;
        double walls = 0;   ///< edges of the outline
        double others = 0;  ///< edges of the parts that it may overlap

        /// A convex outline meets a wall twice, at most.
        [[nodiscard]] double cuts() const { return others / 2; }
    };
    std::vector<Part> parts_;
    double range_, comparisons_ = 0;
};

}  // namespace talus::terrain
