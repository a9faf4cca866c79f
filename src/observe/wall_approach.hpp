#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "observe/debris.hpp"
#include "observe/wall_patches.hpp"
#include "sim/model.hpp"

namespace talus::observe {

/// The flow in front of walls: for every column of the patches, the debris between the wall and one edge of the
/// reference area away from it. A particle is one spacing wide in plan and counts with the part of it inside.
class WallApproach {
  public:
    /// `edge` of the reference area, m.
    explicit WallApproach(double edge) : edge_(edge) {}

    /// Updates with the current debris.
    void update(const sim::Model& model, const Debris& debris, const WallPatches& patches);

    struct Flow {
        std::int32_t building = -1;
        double depth = 0;    ///< m, volume over area
        double density = 0;  ///< kg/m3, mean
        double speed = 0;    ///< m/s, depth-averaged
        double to_wall = 0;  ///< m/s, its part towards the wall, normal to it; negative: away from it
    };
    /// For the columns with debris in front of them.
    [[nodiscard]] const std::vector<Flow>& flows() const { return flows_; }

  private:
    struct Sum {
        double volume = 0, mass = 0;  // m3, kg
        double x = 0, y = 0, z = 0;   // volume times velocity
    };
    double edge_;
    Debris::BesideWalls beside_;
    std::vector<Sum> sums_;              // by column
    std::vector<std::uint32_t> wetted_;  // columns
    std::vector<Flow> flows_;
};

}  // namespace talus::observe
