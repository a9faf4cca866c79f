#pragma once

#include <string>
#include <string_view>

namespace talus::publish {

/// A grid message of docs/protocol.md as it is kept in a file, with two thirds of its bytes: values of maps rounded to
/// 16 significant bits (one part in 65,000) and in byte planes; terrain, in differences, as it is but deflated harder.
/// Anything else is returned unchanged.
[[nodiscard]] std::string compact_grid(std::string_view message);

}  // namespace talus::publish
