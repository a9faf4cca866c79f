#pragma once

#include "scene/load.hpp"

namespace talus::scene {

/// A flow path shorter than this is that of a laboratory, m.
inline constexpr double shortest_field_path = 20;

/// Lengths of the defaults of [outputs] over those in the field: 1, and for a shorter flow path its length over
/// shortest_field_path, rounded to 1, 2 or 5 times a power of ten.
[[nodiscard]] double output_scale(double path_length);

/// Shortens the lengths of [outputs] that the scene does not give, with a note, where the flow path is short: 1 m of
/// chainage and 0.1 m of depth are much in a flume of 4 m.
void shorten_outputs(Scene& scene);

/// Sets outputs.geoid_height of a scene that needs it and does not give it, by a geoid grid of PROJ, with a note;
/// without one the note says so.
void settle_geoid_height(Scene& scene);

}  // namespace talus::scene
