#pragma once

#include <numbers>

/// Angles are in radians inside the program and in degrees where people read or write them.
namespace talus {

inline constexpr double degrees_per_radian = 180 / std::numbers::pi;
inline constexpr double radians_per_degree = std::numbers::pi / 180;

}  // namespace talus
