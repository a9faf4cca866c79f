#pragma once

#include <cstdint>
#include <vector>

namespace talus::observe {

/// The debris on a cell of a plan grid, on one side of a barrier's line and between the perpendiculars at its ends.
struct DebrisColumn {
    std::int32_t column = 0, row = 0;
    double volume = 0;           ///< m3
    double bottom = 0, top = 0;  ///< m, elevations of the debris
    bool at_rest = false;        ///< slower than outputs.deposited_speed
    bool at_face = false;        ///< it touches the barrier
};

/// Debris that a barrier retains, m3: what touches its face, and all that is connected with it, from cell to cell, as
/// long as it is dammed up (its bottom lies below the highest surface at the face) or has come to rest. The height of
/// the barrier has no part in it. `columns`: by row, then column.
[[nodiscard]] double retained_volume(const std::vector<DebrisColumn>& columns);

}  // namespace talus::observe
