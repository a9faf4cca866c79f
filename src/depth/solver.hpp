#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "depth/cell_row.hpp"
#include "depth/stages.hpp"
#include "simd/parallel.hpp"

/// Debris as a depth and a velocity per cell of a grid: the depth-averaged model beside the particles. Its equations
/// and their sources are in docs/depth-averaged.md.
namespace talus::depth {

/// Resistance of the ground and of the debris inside, everywhere the same.
struct Material {
    double rest_density = 2000;       ///< kg/m3
    double friction_coefficient = 0;  ///< Coulomb's
    double cohesion = 0;              ///< Pa
    sim::GroundLaws laws;
    double pore_pressure_ratio = 0;       ///< r_u, when debris starts to move or comes in
    double pore_pressure_decay_time = 0;  ///< s; 0: constant
    sim::EvolvingPressure soil;           ///< with which pore pressure evolves; then a ratio of 0 is hydrostatic
    double gravity = 9.80665;             ///< m/s2
};

/// Where the ground differs: a value per cell, NaN as elsewhere; no cells: nowhere.
struct GroundValues {
    std::vector<float> friction_coefficient, inverse_turbulent_friction, cohesion;  ///< 1, s2/m, Pa
    std::vector<float> stem_drag, laminar_viscosity;                                ///< 1/m, m2/s
    std::vector<float> structure;  ///< 1: a structure, whose top is the bed; debris passes only over that. 0: none
};

/// What is north and south of the grid.
enum class Edges {
    open,       ///< as at its other edges: unknown ground, over which debris leaves
    continued,  ///< the same as in the outermost row: for flow that differs along rows only
};

/// A face of the grid: east of a cell, or north of it.
struct Face {
    int column = 0, row = 0;
    bool north = false;
};

/// Steps debris over fixed ground with Heun's method; a step costs what moves. Single precision, two copies of depth
/// and velocity. Results have the same bits on any number of threads and any instruction set. Allocates nothing after
/// construction.
///
/// Where r_u decays, or differs between releases, debris carries it: each face moves it with its mass, from upstream,
/// so that depth times r_u is conserved and r_u stays between the values around it. Where pore pressure evolves, debris
/// carries its solid fraction in the same way, and both are updated at the end of a step.
///
/// Elevations are rounded to the float spacing of the largest one above the lowest (0.03 mm at 500 m), so that the sum
/// of bed and depth is exact where the level of a lake is such a number.
class Solver {
  public:
    /// `bed`: elevations at cell centres, m; NaN: unknown ground, over which debris leaves, as over the grid's edge.
    Solver(const Grid<double>& bed, const Material& material, const GroundValues& ground = {},
           Edges edges = Edges::open);

    /// Debris leaves the ground from now on where that would have to hold it, flies and lands (docs/depth-averaged.md).
    /// Else it follows the ground.
    void let_fly();
    /// Adds debris at rest: m of vertical depth per cell of the grid. Unknown ground takes none. `pore_pressure_ratio`:
    /// its r_u now; absent: that of the material. `solid_fraction`: the same, where pore pressure evolves.
    void add(const Grid<float>& depth, std::optional<double> pore_pressure_ratio = {},
             std::optional<double> solid_fraction = {});
    /// Adds debris with a velocity to a cell of known ground; momenta add up. The last two as of add().
    void inject(int column, int row, double depth, double u, double v, std::optional<double> solid_fraction = {},
                std::optional<double> pore_pressure_ratio = {});
    /// What comes in to a cell from the next step on, besides what comes already.
    struct CellInflow {
        double rate = 0;             ///< m of depth per s
        double u = 0, v = 0;         ///< its velocity
        int from_x = 0, from_y = 0;  ///< where its stream stands: -1 west or south, 1 east or north, 0 neither. What
                                     ///< lies shallower there is not in its way, nor that of the debris in the cell.
        std::optional<double> solid_fraction = {};  ///< absent: that of the material
    };
    void add_inflow(int column, int row, const CellInflow& comes);
    void end_inflow(int column, int row);
    /// Turns ground of a cell into debris at rest above it: as much of `depth`, m, as elevations are rounded to.
    /// Returns that.
    double erode(int column, int row, double depth);
    /// Counts from the next step on what passes faces between cells of the grid.
    void watch(std::vector<Face> faces);
    /// Volume that passed each of them in the last step, to the east or north, m3: what the cells gained by it.
    [[nodiscard]] const std::vector<double>& passed() const { return passed_; }
    /// Gives the debris of a cell a velocity.
    void set_velocity(int column, int row, double u, double v);
    /// A row of a tile: tile_edge cells from index `at` of cells() on.
    struct Strip {
        std::ptrdiff_t at = 0;
        bool active = false;  ///< its tile took part in the last step; else one beside it did
    };
    /// Those of tiles that took part in the last step, and of those beside them, in which debris is deeper than
    /// dry_depth. `near`: room for an entry per tile.
    void find_strips(std::vector<std::uint8_t>& near, std::vector<Strip>& strips) const;
    /// Pointers to the south-western cell of padded rasters of `size` cells before and after it.
    struct Cells {
        std::ptrdiff_t stride = 0;
        std::size_t before = 0, size = 0;
        const float *depth = nullptr, *bed = nullptr, *slope_x = nullptr, *slope_y = nullptr;
        float *u = nullptr, *v = nullptr, *next_u = nullptr, *next_v = nullptr;  ///< a cell has twice the same of both
        const float* pore_pressure = nullptr;  ///< times pore_pressure_left it is r_u; null: not carried
        float pore_pressure_left = 1;
    };
    /// For who gives velocities to many cells at once; then call expect_waves().
    [[nodiscard]] Cells cells();
    /// Velocities of an active strip were changed. `faster`: where that is not 0, perhaps to waves that are faster than
    /// signal(), or to debris whose energy line is higher than highest_line(); null: nowhere.
    void expect_waves(const Strip& strip, const float* faster);
    /// Of the debris so far: the fastest wave, m/s, and the highest energy line, m, as rounded.
    [[nodiscard]] double signal() const { return signal_; }
    [[nodiscard]] double highest_line() const { return highest_line_; }

    /// The longest stable step, s, with waves of a speed, m/s; and the next step of at most `longest`.
    [[nodiscard]] double stable_step(double wave) const;
    [[nodiscard]] double next_step(double longest) const;
    /// Takes a step of at most `longest` s, at most what is stable. Error: a speed that is not finite.
    [[nodiscard]] Status advance(double longest);

    [[nodiscard]] const GridGeometry& geometry() const { return geometry_; }
    [[nodiscard]] double time() const { return time_; }
    [[nodiscard]] double time_step() const { return time_step_; }  ///< s, of the last step
    [[nodiscard]] std::uint64_t steps() const { return steps_; }
    /// Cells that steps have updated so far.
    [[nodiscard]] std::uint64_t cell_updates() const { return cell_updates_; }
    /// Whether the last step changed anything, or debris was added since.
    [[nodiscard]] bool active() const { return !segments_.empty(); }
    [[nodiscard]] double volume() const;                        ///< m3, on the grid
    [[nodiscard]] double volume_left() const { return left_; }  ///< m3, over its edge
    [[nodiscard]] const Material& material() const { return material_; }
    [[nodiscard]] std::string_view instruction_set() const { return stages_.instruction_set; }
    /// Bytes of memory per cell of the grid.
    [[nodiscard]] double bytes_per_cell() const;

    [[nodiscard]] float depth_at(int column, int row) const { return depth_[index(column, row)]; }
    [[nodiscard]] float u_at(int column, int row) const { return u_[index(column, row)]; }
    [[nodiscard]] float v_at(int column, int row) const { return v_[index(column, row)]; }
    /// m, as rounded, above the lowest known ground.
    [[nodiscard]] float bed_at(int column, int row) const { return bed_[index(column, row)]; }
    [[nodiscard]] float slope_x_at(int column, int row) const { return slope_x_[index(column, row)]; }
    [[nodiscard]] float slope_y_at(int column, int row) const { return slope_y_[index(column, row)]; }
    [[nodiscard]] bool flies() const { return !height_.empty(); }
    /// m, of flying debris above the ground; 0: on it.
    [[nodiscard]] float height_at(int column, int row) const { return flies() ? height_[index(column, row)] : 0; }
    /// Vertical velocity of flying debris less that of a point that follows the ground below, m/s.
    [[nodiscard]] float climb_at(int column, int row) const { return flies() ? climb_[index(column, row)] : 0; }
    [[nodiscard]] bool carries_pore_pressure() const { return !pore_pressure_.empty(); }
    [[nodiscard]] bool pore_pressure_evolves() const { return !solid_fraction_.empty(); }
    /// Of the debris there; 0 where pore pressure does not evolve.
    [[nodiscard]] float solid_fraction_at(int column, int row) const {
        return pore_pressure_evolves() ? solid_fraction_[index(column, row)] : 0;
    }
    /// r_u of the debris there, now.
    [[nodiscard]] float pore_pressure_ratio_at(int column, int row) const {
        return carries_pore_pressure() ? pore_pressure_[index(column, row)] * static_cast<float>(pore_pressure_left_)
                                       : static_cast<float>(material_.pore_pressure_ratio);
    }
    [[nodiscard]] bool known(int column, int row) const { return !unknown_[index(column, row)]; }
    [[nodiscard]] bool built(int column, int row) const {
        return !structure_.empty() && structure_[index(column, row)] > 0;
    }

    /// Calls f(const CellRow&) in parallel for the rows of what the last step may have changed.
    template <class F>
    void for_each_active_row(const F& f) const {
        simd::parallel_ranges(segments_.size(), 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t s = first; s < last; ++s) {
                for (int k = 0; k < tile_edge; ++k) {
                    const CellRow row = active_row(segments_[s], k);
                    if (row.first < row.last) f(row);
                }
            }
        });
    }

    /// The same, one row after the other.
    template <class F>
    void for_each_active_row_in_turn(const F& f) const {
        for (const Segment& segment : segments_) {
            for (int k = 0; k < tile_edge; ++k) {
                const CellRow row = active_row(segment, k);
                if (row.first < row.last) f(row);
            }
        }
    }

    /// The state of a whole row, -1 to the number of rows: unknown ground lies around the grid, dry unless its edges
    /// are continued.
    [[nodiscard]] CellRow row(int row) const { return cell_row(row, 0, geometry_.columns); }

    /// Hash of time, depths and velocities of all cells, and of the pore pressure that debris carries.
    [[nodiscard]] std::uint64_t hash() const;

    /// All that steps change, between two of them, for a solver of the same ground, material and faces.
    template <class Archive>
    void keep(Archive& archive) {
        const std::size_t cells = depth_.size();
        for (std::vector<float>* array : {&bed_, &slope_x_, &slope_y_, &depth_, &u_, &v_, &next_depth_, &next_u_,
                                          &next_v_, &spare_, &next_spare_}) {
            archive(*array);
            if (array->size() != cells) return fail(archive);
        }
        // Each there, or not at all.
        for (std::vector<float>* array :
             {&pore_pressure_, &next_pore_pressure_, &solid_fraction_, &next_solid_fraction_, &height_, &climb_,
              &next_height_, &next_climb_, &inflow_.depth, &inflow_.momentum_x, &inflow_.momentum_y, &inflow_.from_x,
              &inflow_.from_y, &inflow_.grains}) {
            archive(*array);
            if (!array->empty() && array->size() != cells) return fail(archive);
        }
        const std::size_t tiles = changed_.size();
        archive(changed_, segments_, drained_from_, pore_pressure_left_, highest_line_, signal_, time_, time_step_,
                left_, steps_, cell_updates_);
        if (changed_.size() != tiles || segments_.size() > tiles) fail(archive);
    }

  private:
    [[nodiscard]] std::size_t index(int column, int row) const {
        return origin_ + static_cast<std::size_t>(row + margin) * stride_ + static_cast<std::size_t>(column + margin);
    }
    [[nodiscard]] std::size_t tile_of(int column, int row) const {
        return static_cast<std::size_t>((row + margin) / tile_edge) * tile_columns_ + (column + margin) / tile_edge;
    }
    template <class Archive>
    static void fail(Archive& archive) {
        if constexpr (Archive::reading) archive.fail();
    }
    [[nodiscard]] CellRow active_row(const Segment& segment, int row_of_tile) const;
    [[nodiscard]] CellRow cell_row(int row, int first, int last) const;
    /// What debris of a cell or of an inflow starts with.
    struct Start {
        double pore_pressure_ratio = 0, solid_fraction = 0;
    };
    [[nodiscard]] Start start_of(std::optional<double> pore_pressure_ratio, std::optional<double> solid_fraction) const;
    void mix_in(int column, int row, double depth, double u, double v, const Start& start);
    void expect_waves_of(std::size_t cell, std::size_t tile);
    void raise_line(std::size_t cell, double depth, double u, double v);
    void carry_pore_pressure();
    void drain();
    [[nodiscard]] Motion motion();
    [[nodiscard]] Motion next_motion();
    void set_bed(const Grid<double>& bed);
    void find_slopes(std::size_t cell);
    void set_cover(const GroundValues& ground);
    void find_active_tiles();
    [[nodiscard]] double advance_stage(bool second);
    [[nodiscard]] double take_outflow(const Segment& segment, const Motion& motion);
    void continue_rows(const Motion& motion) const;
    void count_passing(bool second);
    template <class F>
    void for_each_continued_row(const F& f) const;

    static constexpr int margin = 2;  ///< cells of unknown ground around the grid

    GridGeometry geometry_;
    double elevation_spacing_ = 1;  ///< m, to which elevations are rounded
    Material material_;
    Edges edges_;
    Stages stages_;
    int tile_columns_ = 0, tile_rows_ = 0;
    std::size_t stride_ = 0, origin_ = 0;  ///< origin_: index of the padded grid's south-western cell
    std::vector<float> bed_, slope_x_, slope_y_;
    std::vector<float> depth_, u_, v_, next_depth_, next_u_, next_v_, spare_, next_spare_;
    /// r_u of the debris in a cell, as it was or would have been at drained_from_: all of it falls alike, so that cells
    /// at rest need no step. Empty: it is the same everywhere and constant.
    std::vector<float> pore_pressure_, next_pore_pressure_;
    std::vector<float> solid_fraction_, next_solid_fraction_;       ///< empty: pore pressure does not evolve
    std::vector<float> height_, climb_, next_height_, next_climb_;  ///< see Motion; empty: debris does not fly
    double drained_from_ = 0, pore_pressure_left_ = 1;              ///< s; what is left of the pressure of then
    std::vector<float> friction_, inverse_turbulence_, strength_, stem_drag_, viscosity_,
        structure_;  ///< empty: everywhere the same
    struct {
        std::vector<float> depth, momentum_x, momentum_y, from_x, from_y;
        std::vector<float> grains;  ///< only where pore pressure evolves
        [[nodiscard]] auto all() { return std::array{&depth, &momentum_x, &momentum_y, &from_x, &from_y}; }
    } inflow_;                                         ///< see Inflow; empty: none so far
    std::vector<Face> faces_;                          ///< that are watched
    std::vector<double> passed_;                       ///< m3, by face
    std::vector<float> passes_east_, passes_north_;    ///< by cell, see StageData; empty: none is watched
    std::vector<std::uint8_t> unknown_;                ///< by cell
    std::vector<std::uint8_t> has_unknown_, changed_;  ///< by tile
    std::vector<std::uint8_t> near_structure_;         ///< by tile, see StageData; empty: there is no structure
    std::vector<Segment> segments_;
    std::vector<float> fastest_;  ///< by segment
    std::vector<double> lost_;    ///< m, by segment
    std::vector<int> computed_;   ///< cells, by segment
    double highest_line_ = 0;     ///< m: energy line of the highest debris so far, see raise_line()
    double signal_ = 0;           ///< m/s, the fastest wave of the next step; 0: to be found
    double time_ = 0, time_step_ = 0, left_ = 0;
    std::uint64_t steps_ = 0, cell_updates_ = 0;
};

}  // namespace talus::depth
