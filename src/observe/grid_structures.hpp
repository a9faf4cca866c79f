#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "core/grid.hpp"
#include "depth/solver.hpp"
#include "observe/barrier_line.hpp"
#include "observe/moving_sums.hpp"
#include "observe/observation.hpp"
#include "observe/retention.hpp"
#include "params/spec.hpp"
#include "terrain/buildings.hpp"
#include "terrain/terrain.hpp"

namespace talus::observe {

/// What of a structure stands on the cells of the grid.
struct StructureCells {
    std::string name;
    bool is_barrier = false;
    std::vector<std::size_t> cells{};  ///< of the grid
};

/// Impact of debris of the depth-averaged model on structures, by the definitions of ImpactRecorder: walls have the
/// same columns and patches, what stands before a column is the flow in the cells within a patch edge of it. Instead of
/// impulses a wall takes the momentum flux of the flow towards it and its weight. And what passes barriers and lies
/// behind them.
class GridStructures {
  public:
    /// `buildings` and their cells in the same order.
    GridStructures(const depth::Solver& solver, const terrain::Terrain& terrain,
                   const std::vector<terrain::Building>& buildings, const std::vector<StructureCells>& cells,
                   const params::OutputSpec& outputs);

    /// What the solver must count for it (Solver::watch).
    [[nodiscard]] const std::vector<depth::Face>& faces() const { return faces_; }
    /// `row`: adds a sample to the history of every structure that has been hit.
    void after_step(const depth::Solver& solver, bool row);
    /// Including the debris that barriers retain now.
    [[nodiscard]] std::vector<BuildingImpact> impacts(const depth::Solver& solver) const;

    /// The measurements of the same structures.
    template <class Archive>
    void keep(Archive& archive) {
        for (Barrier& barrier : barriers_) archive(barrier.over, barrier.through);
        const std::size_t structures = impacts_.size(), slots = sums_.size();
        archive(impacts_, now_, sums_);
        if constexpr (Archive::reading) {
            if (impacts_.size() != structures || now_.size() != structures || sums_.size() != slots) archive.fail();
        }
    }

  private:
    struct Cell {
        int column, row;
        double weight;  ///< in the area before the wall
    };
    /// A column of a wall, see WallPatches.
    struct Wall {
        std::size_t building;
        double towards_x, towards_y;  ///< unit
        double width, height;         ///< m
        double patch_height, patch_area;
        int side;                 ///< of the barrier's line that it faces; 0: none
        std::size_t first, last;  ///< of cells_
    };
    struct Crossing {
        std::size_t face;
        double sign;                 ///< 1: east or north is from the line's left to its right
        std::array<double, 2> room;  ///< m, from the ground before and after the face up to the crest of an opening
    };
    struct Barrier {
        std::size_t building;
        BarrierLine line;
        std::vector<Crossing> crossings;
        std::vector<std::size_t> cells;  ///< of its own, in order
        double over = 0, through = 0;    ///< m3, from left to right
    };
    struct Now {
        double force = 0, pressure = 0, depth = 0, dynamic_pressure = 0;  // unfiltered; of the flow in front
    };

    void add_walls(const depth::Solver& solver, const terrain::Terrain& terrain,
                   const std::vector<terrain::Building>& buildings);
    void add_cells(const depth::Solver& solver, PlanPoint at, PlanPoint out, PlanPoint along, double width);
    void add_barrier(const depth::Solver& solver, const terrain::Terrain& terrain, const terrain::Building& building,
                     std::size_t index, const std::vector<std::size_t>& cells);
    void measure_walls(const depth::Solver& solver);
    void count_crossings(const depth::Solver& solver);
    void add_rows(const depth::Solver& solver);
    struct Filling {
        double volume = 0, height = 0;
    };
    [[nodiscard]] Filling filling(const depth::Solver& solver, const Barrier& barrier) const;
    [[nodiscard]] std::vector<DebrisColumn> columns_of(const depth::Solver& solver, const Barrier& barrier,
                                                       int side) const;
    [[nodiscard]] PlanPoint local_centre(int column, int row) const;

    params::OutputSpec outputs_;
    GridGeometry grid_;
    PlanPoint origin_;  ///< world, of local positions
    double density_, gravity_;
    std::vector<Cell> cells_;
    std::vector<Wall> walls_;
    std::vector<Barrier> barriers_;
    std::vector<depth::Face> faces_;
    std::vector<BuildingImpact> impacts_;
    std::vector<Now> now_;  ///< by building
    MovingSums sums_;       ///< force by building, then pressure by wall
};

}  // namespace talus::observe
