#include "scene/attributes.hpp"

#include <exception>
#include <optional>

#include <fmt/format.h>

namespace talus::scene {
namespace {

std::string attribute_names(const geo::PolygonLayer& layer) {
    std::string names;
    for (const auto& [name, value] : layer.features.front().attributes) names += (names.empty() ? "" : ", ") + name;
    return names.empty() ? "none" : names;
}

/// The attribute as a number, also from a text column that holds one.
std::optional<double> number_of(const geo::Attribute& attribute) {
    if (const auto* number = std::get_if<double>(&attribute)) return *number;
    const auto* text = std::get_if<std::string>(&attribute);
    if (!text || text->empty()) return std::nullopt;
    std::size_t used = 0;
    try {
        const double number = std::stod(*text, &used);
        return used == text->size() ? std::optional(number) : std::nullopt;
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

std::string attribute_text(const geo::Attribute& attribute) {
    if (const auto* number = std::get_if<double>(&attribute)) return fmt::format("{}", *number);
    if (const auto* text = std::get_if<std::string>(&attribute)) return "\"" + *text + "\"";
    return "empty";
}

}  // namespace

Result<double> read_length(const std::string& file, const geo::PolygonLayer& layer, std::size_t feature,
                           const LengthAttribute& attribute) {
    const auto& attributes = layer.features[feature].attributes;
    const auto found = attributes.find(attribute.name);
    if (found == attributes.end()) {
        return Error{fmt::format("{}: has no attribute \"{}\"; its attributes: {}", file, attribute.name,
                                 attribute_names(layer))};
    }
    const std::optional<double> length = number_of(found->second);
    if (!length || !(*length > 0) || *length > attribute.most) {
        return Error{fmt::format("{}: feature {} has {} = {}; it must be a {} greater than 0 and at most {:.0f} (m)",
                                 file, feature + 1, attribute.name, attribute_text(found->second), attribute.what,
                                 attribute.most)};
    }
    return *length;
}

}  // namespace talus::scene
