#pragma once

/// Units of the whole numbers in which map cells are summed.
namespace talus::observe::map_units {

inline constexpr double particle = 1 << 24;  ///< of a particle's volume
inline constexpr float speed = 1 << 10;      ///< of 1 m/s

}  // namespace talus::observe::map_units
