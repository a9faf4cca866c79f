#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry.hpp"
#include "observe/particle_sums.hpp"
#include "observe/wall_patches.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"
#include "terrain/flow_path.hpp"

namespace talus::observe::device {
class Particles;
}

namespace talus::observe {

class MapAccumulator;

/// The particles after a step as the observers read them: from the arrays of a state, or where a device has them. It
/// brings only those over that an observer asks for, in their order.
class Debris {
  public:
    Debris(const sim::State& state) : summary_(&state), state_(&state) {}  // NOLINT(google-explicit-constructor)
    Debris(device::Particles& particles, const sim::StateSummary& summary) : summary_(&summary), device_(&particles) {}

    [[nodiscard]] const sim::StateSummary& summary() const { return *summary_; }

    [[nodiscard]] ParticleSums sums(const sim::Model& model, double deposited_speed) const;

    /// Particles that are not held, on the path at the chainage `from` or beyond; the first `count` of `found`, in any
    /// order. Sets `held` to the number of held ones.
    struct OnPath {
        std::vector<PathParticle> found;
        std::uint32_t count = 0, held = 0;
    };
    void find_on_path(const terrain::FlowPath& path, const PlanPoint& origin, double from, OnPath& result) const;

    /// Particles that are not held, near walls.
    struct BesideWalls {
        std::vector<WallParticle> found;
        std::vector<std::uint8_t> near;  ///< by particle; for its own use
    };
    void find_beside_walls(const sim::Model& model, const WallPatches& patches, BesideWalls& result) const;

    /// Particles in a local plan rectangle; `released`: without held ones.
    void find_inside(const Extent& extent, bool released, std::vector<PlacedParticle>& found) const;

    /// Adds the step to a map.
    void add_to(MapAccumulator& maps) const;

  private:
    const sim::StateSummary* summary_;
    const sim::State* state_ = nullptr;
    device::Particles* device_ = nullptr;
};

}  // namespace talus::observe
