#pragma once

#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "talus.h"

namespace talus::embed {

/// The cells that a caller asks for or gives values of. `least`: columns and rows.
[[nodiscard]] inline Result<GridGeometry> geometry_of(const talus_grid& grid, std::int32_t least) {
    constexpr std::int32_t most = 1 << 20;
    constexpr std::int64_t most_cells = 400'000'000;
    for (const auto& [name, value] : {std::pair{"x_min", grid.x_min}, std::pair{"y_min", grid.y_min}}) {
        if (!std::isfinite(value)) return Error{fmt::format("grid.{} = {}: must be a finite number", name, value)};
    }
    if (!(grid.cell > 0) || !std::isfinite(grid.cell)) {
        return Error{fmt::format("grid.cell = {}: must be a finite number above 0", grid.cell)};
    }
    for (const auto& [name, count] : {std::pair{"columns", grid.columns}, std::pair{"rows", grid.rows}}) {
        if (count < least || count > most) {
            return Error{fmt::format("grid.{} = {}: must be {} to {}", name, count, least, most)};
        }
    }
    if (std::int64_t{grid.columns} * grid.rows > most_cells) {
        return Error{
            fmt::format("grid: has {} x {} cells; it must have at most {}", grid.columns, grid.rows, most_cells)};
    }
    return GridGeometry{grid.x_min, grid.y_min, grid.cell, grid.columns, grid.rows};
}

}  // namespace talus::embed
