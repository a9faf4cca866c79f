#pragma once

#include <cstddef>
#include <string>

#include "core/result.hpp"
#include "geo/vector.hpp"

namespace talus::scene {

/// An attribute that must hold a length above 0 m.
struct LengthAttribute {
    const std::string& name;
    const char* what;  ///< "thickness"
    double most;       ///< m
};

/// The attribute of a feature, also from a text column that holds a number, m. Errors: no such attribute (lists the
/// existing ones), not a number, not greater than 0 and at most `most`.
[[nodiscard]] Result<double> read_length(const std::string& file, const geo::PolygonLayer& layer, std::size_t feature,
                                         const LengthAttribute& attribute);

}  // namespace talus::scene
