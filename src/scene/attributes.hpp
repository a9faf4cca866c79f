#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "core/quantity.hpp"
#include "core/result.hpp"
#include "geo/vector.hpp"

namespace talus::scene {

/// The number in an attribute, in m or Pa; none: it is empty. Errors, the end of a sentence: text that is no such
/// number.
[[nodiscard]] Result<std::optional<double>> number_of(const geo::Attribute& attribute, Dimension dimension);

/// For messages: "2.5", "\"2 storeys\"", "empty".
[[nodiscard]] std::string attribute_text(const geo::Attribute& attribute);

/// An attribute that must hold a length above 0 m.
struct LengthAttribute {
    const std::string& name;
    const char* what;  ///< "thickness"
    double most;       ///< m
};

/// The attribute of a feature, m. Errors: no such attribute (lists the existing ones), empty, not a length, not greater
/// than 0 and at most `most`.
[[nodiscard]] Result<double> read_length(const std::string& file, const geo::PolygonLayer& layer, std::size_t feature,
                                         const LengthAttribute& attribute);

}  // namespace talus::scene
