#pragma once

#include <memory>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "terrain/height_field.hpp"

namespace talus::terrain {

/// A height field: elevations at the centres of square cells, between them bicubic Hermite patches (without twist), in
/// a local float frame. Height and normal belong to one smooth surface: on facets debris would lose speed at every
/// kink, and with normals that do not match the heights it would gain or lose energy. Slopes at the centres are central
/// differences, limited as van Leer (1977) does, so that the ground does not overshoot beside a cliff.
///
/// Debris can be on it where `covers` is true: inside the hull of the cell centres and away from nodata. Elsewhere the
/// ground continues as a plane, so that a particle on its way out, which is removed at the end of the step, still lies
/// on ground and does not disturb its neighbours. Copies share the heights, which never change: copying a terrain is
/// cheap, however large it is. A height's cell index and fraction come from the same floor(): taken from two roundings,
/// a particle exactly on a cell edge would see the ground jump.
class Terrain {
  public:
    Terrain() = default;

    /// `elevation`: world elevations in m, NaN where there is no data; at least 2 x 2 cells.
    /// The frame's origin is the middle of the grid, at the lowest elevation.
    explicit Terrain(Grid<float> elevation);

    [[nodiscard]] const LocalFrame& frame() const { return frame_; }
    /// World elevations as given (NaN: no data).
    [[nodiscard]] const Grid<float>& elevation() const { return *elevation_; }
    [[nodiscard]] double cell() const { return elevation_->geometry.cell; }

    /// Whether the ground is known at a local plan position.
    template <class Real>
    [[nodiscard]] TALUS_INLINE bool covers(Real x, Real y) const {
        return field_.covers(x, y);
    }
    /// Ground height and normal at a local plan position, finite everywhere. Outside the grid, the nearest edge cell's
    /// plane continues; where there is no data, that of the cells around.
    template <class Real>
    [[nodiscard]] TALUS_INLINE GroundSample<Real> sample(Real x, Real y) const {
        return field_.sample(x, y);
    }
    /// For whoever computes elsewhere: valid as long as the terrain, and until it changes.
    [[nodiscard]] const HeightField& field() const { return field_; }

    /// World elevation at a world plan position; NaN where not covered.
    [[nodiscard]] double elevation_at(const PlanPoint& p) const;

    /// Unit normal's z component (cosine of the slope) at a world plan position; NaN where not covered.
    [[nodiscard]] double slope_cosine_at(const PlanPoint& p) const;

    /// Index of the cell that a local plan position lies in, which must be covered.
    [[nodiscard]] std::size_t cell_at(float x, float y) const;
    /// Cosine of the slope at the centre of a cell that has data.
    [[nodiscard]] double slope_cosine_of(std::size_t cell) const;
    /// Changes the world elevation of a cell, which has data; the surface changes up to two cells around. Copies of
    /// this terrain are not affected: shared data is copied first.
    void set_elevation(std::size_t cell, float elevation);

  private:
    [[nodiscard]] Quad make_node(int column, int row) const;
    void continue_into_nodata();

    std::shared_ptr<Grid<float>> elevation_ = std::make_shared<Grid<float>>();
    LocalFrame frame_;
    std::shared_ptr<Quad[]> nodes_;
    HeightField field_;  // its nodes are the above
};

}  // namespace talus::terrain
