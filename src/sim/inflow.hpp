#pragma once

#include <cstdint>
#include <vector>

#include "sim/model.hpp"
#include "sim/state.hpp"
#include "terrain/inflow.hpp"

namespace talus {

/// Lets debris in while a run goes on. Whenever the inflow has moved on by a particle spacing, a row of particles
/// appears at its line: as many as make the volume that came in meanwhile, to the nearest whole one of all so far,
/// stacked in columns on a lattice of rest density, moving at the inflow velocity along the ground, and under the
/// pressure of what lies above them. Nothing is let in denser than at rest, so nothing pops apart.
///
/// The line is no wall: where debris is slower than its waves, and on level ground, it can spread upstream of it.
class InflowFeeder {
  public:
    InflowFeeder(const Model& model, const std::vector<Inflow>& inflows);

    /// Particles that all inflows together have yet to bring.
    [[nodiscard]] std::uint32_t to_come() const;
    /// Whether any row is due at a time, s.
    [[nodiscard]] bool due(double time) const;
    /// Lets in what is due at the state's time, within Simulation::change(). Allocates nothing if the state's arrays
    /// have room.
    void feed(const Model& model, State& state);

  private:
    struct Source {
        Inflow inflow;
        double spacing = 0, particle_volume = 0;
        std::uint32_t total = 0, fed = 0;
        std::uint64_t rows = 0;  ///< that have been let in
        double last_time = 0;    ///< s, of the last row

        [[nodiscard]] double end() const { return inflow.hydrograph.back().time; }
        [[nodiscard]] bool due(double time) const;
        /// When the next row is due; `time` is known to be later.
        [[nodiscard]] double next_time(double time) const;
        void add_row(const Model& model, State& state, double since);
    };
    std::vector<Source> sources_;
};

}  // namespace talus
