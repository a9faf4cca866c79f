#pragma once

#include <filesystem>
#include <vector>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "sim/state.hpp"

namespace talus::products {

/// Particles over time for ParaView: a .vtp per frame and a .pvd that lists them. Positions are local; the origin is
/// stored as field data of every frame.
class ParticleSeries {
  public:
    explicit ParticleSeries(std::filesystem::path folder);
    [[nodiscard]] Status write_frame(const LocalFrame& frame, const sim::State& state);
    [[nodiscard]] Status finish();

  private:
    std::filesystem::path folder_;
    std::vector<double> times_;
};

}  // namespace talus::products
