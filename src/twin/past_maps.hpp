#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/grid.hpp"
#include "twin/frame.hpp"

namespace talus::twin {

inline constexpr std::string_view pore_pressure_layer = "pore_pressure_ratio";

/// The names of the layers of layer_of().
[[nodiscard]] std::vector<std::string_view> run_layers();

/// Properties of the current map that past ones share: the cells, and the least depth that counts as debris.
struct MapFrame {
    GridGeometry geometry;    ///< of the whole map
    double thinnest = 0;      ///< m, see MapAccumulator::thinnest_depth
    Grid<float> arrival_now;  ///< s, of the present; NaN: never
};

/// A layer of layer_of() as it was when the last of `frames` was recorded. Arrival times are exact. Peaks are the
/// greatest of the recorded frames: higher values between two frames are missed, so they are lower bounds.
[[nodiscard]] Grid<float> past_layer(const std::string& name, const std::vector<FramePtr>& frames, const MapFrame& map);

}  // namespace talus::twin
