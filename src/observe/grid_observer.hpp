#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/grid.hpp"
#include "depth/solver.hpp"
#include "observe/cell_peaks.hpp"
#include "observe/discharge.hpp"
#include "observe/energy.hpp"
#include "observe/front_tracker.hpp"
#include "observe/gauges.hpp"
#include "observe/grid_structures.hpp"
#include "observe/map_accumulator.hpp"
#include "observe/map_shares.hpp"
#include "observe/observation.hpp"
#include "params/spec.hpp"
#include "sim/ground.hpp"
#include "terrain/flow_path.hpp"

namespace talus::observe {

inline constexpr int strip_cells = 16;

/// Of the debris in some cells, place by place of the strips of cells that they lie in: compilers turn such sums into
/// vectors.
struct StripSums {
    using Places = std::array<double, strip_cells>;
    Places deposited{}, moving{};                        ///< m3
    Places kinetic{}, momentum{}, potential{};           ///< volume times speed squared, speed, elevation
    Places fastest{};                                    ///< m/s
    float front = std::numeric_limits<float>::lowest();  ///< chainage of the farthest cell, m

    friend StripSums operator+(StripSums a, const StripSums& b) {
        for (std::size_t k = 0; k < strip_cells; ++k) {
            a.deposited[k] += b.deposited[k];
            a.moving[k] += b.moving[k];
            a.kinetic[k] += b.kinetic[k];
            a.momentum[k] += b.momentum[k];
            a.potential[k] += b.potential[k];
            a.fastest[k] = std::max(a.fastest[k], b.fastest[k]);
        }
        a.front = std::max(a.front, b.front);
        return a;
    }
};

/// Watches a run of the depth-averaged model, for the same results as those of the particles. Maps have the cells of
/// the grid. A front is where the map's arrivals are: the path's chainage beyond which no cell was reached earlier.
class GridObserver {
  public:
    GridObserver(const depth::Solver& solver, terrain::FlowPath flow_path, const params::OutputSpec& outputs,
                 GridStructures structures, double held);

    /// Call after debris was added to the solver: its depth by cell, m, its volume and what is still held, m3.
    void note_release(const depth::Solver& solver, const Grid<float>& depth, double volume, double held);
    /// What came in or was entrained in the last step, m3; call it before after_step().
    /// `highest`: the inflow's highest energy line, m above the lowest known ground.
    void note_inflow(double volume, double highest);
    void note_entrainment(double volume) { volume_entrained_ += volume; }
    /// Records the flow at these places from now on.
    void watch(const depth::Solver& solver, const std::vector<terrain::Gauge>& gauges);
    /// Records what passes these lines from now on.
    void watch(const depth::Solver& solver, const terrain::Terrain& terrain,
               const std::vector<terrain::CrossSection>& sections);
    /// What the solver must count for it (Solver::watch), once all that is watched is known.
    [[nodiscard]] std::vector<depth::Face> faces() const;
    /// `held`: volume in releases that are still to start, m3.
    void after_step(const depth::Solver& solver, double held, double steps_per_second);

    /// Depth of releases and inflows by cell, m, to which that of an inflow is to be added.
    [[nodiscard]] Grid<float>& released() { return released_; }
    [[nodiscard]] const TimeSample& latest() const { return timeseries_.back(); }
    /// The debris as it is now; `held`: as above.
    [[nodiscard]] TimeSample sample(const depth::Solver& solver, double held, double steps_per_second) const;
    [[nodiscard]] const std::vector<TimeSample>& timeseries() const { return timeseries_; }
    /// m3.
    [[nodiscard]] double volume_faster_than(const depth::Solver& solver, double limit) const;
    /// Debris now, over the part of the grid that contains any.
    [[nodiscard]] MapAccumulator::Present present(const depth::Solver& solver) const;
    /// Debris thinner than this does not count as having reached a cell, m.
    [[nodiscard]] double thinnest_depth() const;
    [[nodiscard]] double front_chainage() const { return front_; }
    /// m/s, the greatest speed that the fall of the debris explains (EnergyAccount).
    [[nodiscard]] double greatest_speed() const { return energy_.greatest_speed(); }
    /// m/s, along the ground, of the fastest cell that counts as reached.
    [[nodiscard]] double fastest(const depth::Solver& solver) const;
    /// The complete results, with the debris where it is as deposit.
    [[nodiscard]] Observation finish(const depth::Solver& solver, const sim::Ground& ground, double held) const;

    /// All that it has measured, of the same run.
    template <class Archive>
    void keep(Archive& archive) {
        const std::size_t cells = released_.values.size();
        const auto keep_map = [&](std::vector<float>& map) {
            archive(map);
            if constexpr (Archive::reading) {
                if (map.size() != (&map == &reached_.pressure ? 0 : cells)) archive.fail();
            }
        };
        for_each_map_array(keep_map, reached_);
        keep_map(arrival_fastest_);
        keep_map(released_.values);
        archive(structures_, gauges_, sections_, energy_, timeseries_, volume_released_, volume_entrained_, front_,
                farthest_arrival_);
        if constexpr (Archive::reading) {
            if (timeseries_.empty()) archive.fail();  // it has a row from the beginning on
        }
    }

  private:
    void measure_cells(const depth::Solver& solver);
    /// The debris around a cell that it just arrived in.
    [[nodiscard]] FrontRecord::Head head_at(const depth::Solver& solver, std::size_t cell) const;
    void read_gauges(const depth::Solver& solver, bool row);
    void add_row(const depth::Solver& solver, double held, double steps_per_second);
    void add_row_to(StripSums& sums, const depth::Solver& solver, int r) const;
    [[nodiscard]] Energy measure_energy(const depth::Solver& solver, const HazardMaps& hazard) const;
    [[nodiscard]] FrontRecord front_record() const;
    [[nodiscard]] HazardMaps maps(const depth::Solver& solver) const;

    params::OutputSpec outputs_;
    terrain::FlowPath flow_path_;
    double density_, gravity_;
    /// By cell. Speeds of arrival are the mean of the debris around it; peak pressures follow from peak speeds: empty.
    RaisePeaks raise_peaks_ = raise_peaks_function();
    MapArrays<std::vector<float>> reached_;
    std::vector<float> arrival_fastest_;  ///< m/s, the largest speed around a cell on arrival
    Grid<float> released_;                ///< m, by cell
    std::vector<float> chainage_;         ///< by cell; NaN: not on the path
    GridStructures structures_;
    GaugeRecorder gauges_;
    GridSections sections_;
    EnergyAccount energy_;
    std::vector<TimeSample> timeseries_;
    double volume_released_ = 0, volume_entrained_ = 0;
    float farthest_arrival_ = std::numeric_limits<float>::lowest();  ///< chainage of a cell, m
    double front_ = never;                                           ///< the same at the last row of the time series
};

}  // namespace talus::observe
