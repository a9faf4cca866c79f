#pragma once

#include <cstddef>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "products/series_frames.hpp"
#include "products/triangle_mesh.hpp"
#include "terrain/terrain.hpp"

namespace talus::products {

/// The surface of the debris at one moment, with what is on it at each point.
struct DebrisMesh : TriangleMesh {
    std::vector<float> depth, speed;  ///< m, m/s
};

/// The surface of debris over a lattice of points; around it, where debris is next to none, it meets the ground.
/// `ground`: local z in `frame`, NaN: not known. `depth`, `speed` on the same lattice; 0: none. `lift`: above all
/// debris, m, for pictures.
[[nodiscard]] DebrisMesh mesh_debris(const LocalFrame& frame, const Grid<float>& ground, const Grid<float>& depth,
                                     const Grid<float>& speed, float lift);

/// Ground and debris over time as surfaces with common points, so that ground never shows through debris: a lattice on
/// the ground around all that debris reached, whose cells are those of the maps or a multiple of them.
class DebrisSurface {
  public:
    /// Upper bounds of a file that holds ground and animated debris.
    static constexpr std::size_t max_frames = 100, max_ground_points = 200000, max_debris_points = 500000;

    /// `peak_depth`: NaN where debris never came. Errors: the frames cannot be read.
    [[nodiscard]] static Result<DebrisSurface> make(const terrain::Terrain& terrain, const Grid<float>& peak_depth,
                                                    const SeriesFrames& frames);

    /// The frames of an animation: all or, of more than max_frames, some at even distances with the first and last.
    [[nodiscard]] const std::vector<std::size_t>& animated() const { return animated_; }
    [[nodiscard]] const GridGeometry& lattice() const { return ground_.geometry; }
    [[nodiscard]] double lowest() const { return lowest_; }    ///< m, local z of the ground
    [[nodiscard]] double highest() const { return highest_; }  ///< the same
    [[nodiscard]] TriangleMesh ground() const;
    /// Of any frame. Where there is none, no triangle.
    [[nodiscard]] Result<DebrisMesh> debris(std::size_t frame) const;

  private:
    DebrisSurface(const terrain::Terrain& terrain, const SeriesFrames& frames) : terrain_(terrain), frames_(frames) {}
    [[nodiscard]] Result<std::size_t> count_animated(const GridGeometry& cells) const;
    void lay_lattice(const GridGeometry& cells, int factor);
    /// Mean depth over the cells of every point, and the speed of what is there.
    [[nodiscard]] Status read(std::size_t frame, Grid<float>& depth, Grid<float>& speed) const;

    const terrain::Terrain& terrain_;
    const SeriesFrames& frames_;
    std::vector<std::size_t> animated_;
    GridGeometry cells_;  // of the maps, as many per point as factor_ squared
    int factor_ = 1;
    Grid<float> ground_;  // local z; NaN: not known
    double lowest_ = 0, highest_ = 0;
};

}  // namespace talus::products
