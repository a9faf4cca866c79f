#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/geometry.hpp"
#include "sim/ground.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::sim {

/// Entrainment of the bed: ground becomes particles, one at a time, wherever the bed's law has loosened a particle's
/// volume. The terrain sinks by exactly that volume in the cell; the particle starts at rest, so that debris keeps its
/// momentum and loses speed. Room is made by moving the surrounding debris outwards like an incompressible body around
/// a growing half sphere on the ground: nothing is compressed, nothing gains speed.
///
/// The order of the state alone decides: results do not depend on the number of threads.
class Entrainment {
  public:
    /// Finds where particles come loose in the step of state.time_step just taken, three and a half spacings apart;
    /// those without room wait. Returns their number.
    std::size_t find(const Model& model, const Ground& ground, const State& state);

    /// Turns ground into particles at the sites of find(). The arrays of `state` must have room for them.
    void apply(const Model& model, Ground& ground, State& state);

    /// What has come loose so far.
    template <class Archive>
    void keep(Archive& archive) {
        archive(loose_);
        count_.resize(loose_.size());
        rate_.resize(loose_.size());
    }

  private:
    struct Site {
        std::uint32_t particle = 0;  ///< sorted index of the particle below which ground comes loose
        std::size_t cell = 0;
        LocalPoint foot;    ///< on the ground; from find(), directly below the particle
        LocalPoint normal;  ///< of the ground
    };
    struct Neighbour {
        std::uint32_t site = 0, particle = 0;
        friend bool operator<(const Neighbour& a, const Neighbour& b) {
            return a.site != b.site ? a.site < b.site : a.particle < b.particle;
        }
    };

    void find_shear_rates(const Model& model, const Ground& ground, const State& state);
    [[nodiscard]] bool is_clear(const Model& model, const Ground& ground, const LocalPoint& p) const;
    void find_neighbours(const Model& model, const State& state);
    [[nodiscard]] std::span<const Neighbour> neighbours_of(std::size_t site) const;
    void choose_foot(const Model& model, const Ground& ground, const State& state, std::size_t index);
    void make_room(const Model& model, const Ground& ground, State& state, std::size_t index) const;

    std::vector<double> loose_;         // m3 that have come loose, less those that became particles, by cell
    std::vector<std::uint32_t> count_;  // particles over a cell, of beds eroded by shear; 0 between steps
    std::vector<float> rate_;           // m3 per particle in this step, for the same beds
    std::vector<std::size_t> touched_;  // cells with a count
    std::vector<Site> sites_;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> by_bin_;  // sites
    std::vector<Neighbour> neighbours_;                            // by site
};

}  // namespace talus::sim
