#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid.hpp"

/// Rasters in an order of bytes that zlib compresses better than the values as they lie in memory.
namespace talus {

/// The lowest bytes of all numbers, then the second ones, the third, the highest.
[[nodiscard]] std::string to_byte_planes(std::span<const std::uint32_t> numbers);

/// For smooth rasters such as terrain, without loss. Each value's 32 bits, as a number, less those of the plane through
/// its western, southern and south-western neighbours (the Lorenzo predictor; Ibarria and others 2003), folded so that
/// small differences of either sign are small numbers, as byte planes.
[[nodiscard]] std::string to_difference_planes(const Grid<float>& grid);

/// The values again. `bytes`: four for each value. `columns`: at least 1.
[[nodiscard]] std::vector<float> from_difference_planes(std::string_view bytes, int columns);

}  // namespace talus
