#pragma once

#include <limits>
#include <vector>

#include "core/result.hpp"
#include "depth/solver.hpp"
#include "terrain/inflow.hpp"

namespace talus::depth {

/// The debris of inflows, brought to a solver step by step: over the cells that a line crosses, by the length of line
/// in each, or evenly over an area. Volume is that of the hydrograph to the rounding of depths.
///
/// Across a line debris comes within the step, with the stream behind it (Solver::CellInflow): it keeps its depth and
/// velocity as far as nothing else changes them. Over an area it comes between steps.
class Inflows {
  public:
    Inflows(const Solver& solver, const std::vector<terrain::Inflow>& inflows);

    /// The first that no cell of known ground takes; none: their number.
    [[nodiscard]] std::size_t first_unplaced() const;
    /// Whether anything is still to come.
    [[nodiscard]] bool to_come() const;
    /// Takes a step of the solver, of at most `longest` s. Returns the volume that came in, m3, whose depth by cell is
    /// added to `added`, m. `left`: s, until the run ends: it cuts the last step and has no effect on others.
    [[nodiscard]] Result<double> advance(Solver& solver, double longest, Grid<float>& added,
                                         double left = std::numeric_limits<double>::infinity());
    /// What steps have changed, of the same inflows.
    template <class Archive>
    void keep(Archive& archive) {
        archive(time_);
        for (Source& source : sources_) {
            for (Cell& cell : source.cells) archive(cell.owed);
        }
    }

  private:
    struct Cell {
        int column = 0, row = 0;
        double share = 0;            ///< of the inflow
        double east = 0, north = 0;  ///< velocity in plan per velocity along the ground
        int from_x = 0, from_y = 0;  ///< see Solver::CellInflow
        double owed = 0;             ///< m, what rounding has kept back
    };
    struct Source {
        terrain::Inflow inflow;
        std::vector<Cell> cells;  ///< by row, then column

        void place_on_line(const Solver& solver);
        void place_on_area(const Solver& solver);
        void add_place(const Solver& solver, const PlanPoint& p, double size);
        [[nodiscard]] bool takes(int column, int row) const;
        void find_velocities(const Solver& solver);
        [[nodiscard]] bool comes_in(double from, double to) const;
        [[nodiscard]] double longest_step(const Solver& solver, double longest) const;
        void begin_step(Solver& solver, double step) const;
        double end_step(Solver& solver, double from, Grid<float>& added);
    };
    std::vector<Source> sources_;
    double time_ = 0;
};

}  // namespace talus::depth
