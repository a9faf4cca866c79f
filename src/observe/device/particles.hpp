#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "observe/debris.hpp"
#include "observe/device/maps.hpp"
#include "sim/device/backend.hpp"

/// Observers' kernels: functors that the executor of a backend runs over the particles that it has (docs/gpu.md).
namespace talus::observe::device {

/// What Debris asks of the particles of a backend. Every function may throw a sim::device::DeviceFailure.
class Particles {
  public:
    Particles() = default;
    Particles(const Particles&) = delete;
    Particles& operator=(const Particles&) = delete;
    virtual ~Particles() = default;

    /// Call after walls were changed.
    virtual void forget_walls() = 0;

    [[nodiscard]] virtual ParticleSums sums(const sim::StateSummary& state, double deposited_speed) = 0;
    /// `path` must stay what it is.
    virtual void find_on_path(const sim::StateSummary& state, const terrain::FlowPath& path, const PlanPoint& origin,
                              double from, Debris::OnPath& result) = 0;
    virtual void find_beside_walls(const sim::StateSummary& state, const WallPatches& patches,
                                   std::vector<WallParticle>& found) = 0;
    virtual void find_inside(const sim::StateSummary& state, const PlanRectangle& rectangle, bool released,
                             std::vector<PlacedParticle>& found) = 0;
    [[nodiscard]] virtual Maps& maps() = 0;
};

/// For the particles of a backend, which must live as long.
[[nodiscard]] std::unique_ptr<Particles> make_particles(sim::device::Backend& backend);
/// The same for a backend on a graphics card; nullptr for others.
[[nodiscard]] std::unique_ptr<Particles> make_cuda_particles(sim::device::Backend& backend);

}  // namespace talus::observe::device
