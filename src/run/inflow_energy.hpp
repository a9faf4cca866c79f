#pragma once

#include <utility>
#include <vector>

#include "depth/solver.hpp"
#include "terrain/inflow.hpp"

namespace talus::run {

/// Finds how much energy inflows bring into cells of the depth-averaged model.
class InflowEnergy {
  public:
    /// `inflows` must live as long as this.
    InflowEnergy(const depth::Solver& solver, const std::vector<terrain::Inflow>& inflows);

    /// The highest energy line of what comes in now, m above the lowest known ground: ground, debris and velocity head.
    [[nodiscard]] double highest(const depth::Solver& solver) const;

  private:
    void add_line(const depth::Solver& solver, const terrain::Inflow& inflow);
    void add_area(const depth::Solver& solver, const terrain::Inflow& inflow);
    void add(const depth::Solver& solver, const PlanPoint& p);

    const std::vector<terrain::Inflow>& inflows_;
    std::vector<std::vector<std::pair<int, int>>> places_;  ///< columns and rows, by inflow
};

}  // namespace talus::run
