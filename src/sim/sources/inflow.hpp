#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/sources/area_source.hpp"
#include "sim/state.hpp"
#include "terrain/inflow.hpp"

namespace talus::sim {

/// Injects debris during a run. Whenever the inflow has advanced by a particle spacing, a row of particles appears at
/// its line: as many as match the total volume so far to the nearest whole particle, stacked in columns on a lattice of
/// rest density, moving at the inflow velocity along the ground, and under the pressure of the particles above. Nothing
/// is injected denser than at rest, so nothing is thrown apart.
///
/// Over the first three spacings beyond the line rows are prescribed: between steps their distance and velocity along
/// the inflow are set to those of the hydrograph; across it they remain as the solver left them. Otherwise the newest
/// row, with nothing behind it, would be pushed back by those in front, and the next one would be too close.
///
/// Inflow over an area uses an AreaSource.
class InflowFeeder {
  public:
    /// Without any inflow.
    InflowFeeder() = default;
    InflowFeeder(const Model& model, const LocalFrame& frame, const std::vector<terrain::Inflow>& inflows);

    /// Particles that all inflows together still have to inject.
    [[nodiscard]] std::uint32_t remaining() const;
    /// Whether a gauge may still bring more at a time, s: an inflow whose hydrograph was replaced has not ended.
    [[nodiscard]] bool awaits(double time) const;
    /// Replaces a hydrograph within Simulation::follow_gauge(); `inflow`: its index in the constructor's list. Until
    /// now both must be the same.
    void set_hydrograph(std::size_t inflow, const std::vector<params::InflowSample>& hydrograph);
    /// Whether there is work at a time, s: a row is due, or rows are prescribed.
    [[nodiscard]] bool due(double time) const;
    /// Leads the latest rows and injects those due at the state's time, within Simulation::change(). Allocates nothing
    /// if the state's arrays have room.
    void inject(const Model& model, const Ground& ground, State& state);

    /// What was injected so far, of the same inflows.
    template <class Archive>
    void keep(Archive& archive) {
        for (Source& s : sources_) archive(s.injected, s.rows, s.last_time, s.prescribed);
        for (AreaSource& area : areas_) archive(area);
    }

  private:
    static constexpr std::uint64_t buffer_rows = 3;
    struct Row {
        std::uint32_t first = 0, last = 0;  ///< ids
    };
    struct Source {
        terrain::Inflow inflow;
        double spacing = 0, particle_volume = 0;
        std::uint32_t total = 0, injected = 0;
        bool gauged = false;                        ///< its hydrograph is that of a gauge
        std::uint64_t rows = 0;                     ///< injected so far
        double last_time = 0;                       ///< s, of the last row
        std::array<Row, buffer_rows> prescribed{};  ///< row k at k % buffer_rows; empty: none, or no longer prescribed

        [[nodiscard]] double way_of(std::uint64_t row, double time) const {
            return inflow.way_until(time) - static_cast<double>(row + 1) * spacing;
        }
        [[nodiscard]] bool leads() const;
        void prescribe_inflow(const Ground& ground, State& state);

        [[nodiscard]] double end() const { return inflow.hydrograph.back().time; }
        [[nodiscard]] bool due(double time) const;
        /// When the next row is due; `time` is known to be later.
        [[nodiscard]] double next_time(double time) const;
        void add_row(const Model& model, const Ground& ground, State& state, double since);
    };
    std::vector<Source> sources_;
    std::vector<AreaSource> areas_;
    std::vector<std::pair<bool, std::size_t>> places_;  ///< of each inflow: over an area, and its index there
};

}  // namespace talus::sim
