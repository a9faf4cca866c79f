#include "scene/attributes.hpp"

#include <fmt/format.h>

#include "scene/parse.hpp"

namespace talus::scene {
namespace {

std::string attribute_names(const geo::PolygonLayer& layer) {
    std::string names;
    for (const auto& [name, value] : layer.features.front().attributes) names += (names.empty() ? "" : ", ") + name;
    return names.empty() ? "none" : names;
}

}  // namespace

std::string attribute_text(const geo::Attribute& attribute) {
    if (const auto* number = std::get_if<double>(&attribute)) return fmt::format("{}", *number);
    if (const auto* text = std::get_if<std::string>(&attribute)) return "\"" + one_line(*text, 80) + "\"";
    return "empty";
}

Result<std::optional<double>> number_of(const geo::Attribute& attribute, Dimension dimension) {
    if (const auto* number = std::get_if<double>(&attribute)) return std::optional(*number);
    const auto* text = std::get_if<std::string>(&attribute);
    if (text == nullptr || text->find_first_not_of(' ') == std::string::npos) return std::optional<double>();
    const Result<double> read = read_quantity(*text, dimension);
    if (!read) return read.error();
    return std::optional(*read);
}

Result<double> read_length(const std::string& file, const geo::PolygonLayer& layer, std::size_t feature,
                           const LengthAttribute& attribute) {
    const auto& attributes = layer.features[feature].attributes;
    const auto found = attributes.find(attribute.name);
    if (found == attributes.end()) {
        return Error{fmt::format("{}: has no attribute \"{}\"; its attributes: {}", file, attribute.name,
                                 attribute_names(layer))};
    }
    const Result<std::optional<double>> read = number_of(found->second, Dimension::length);
    const double length = read && *read ? **read : 0;
    if (!(length > 0) || length > attribute.most) {
        return Error{fmt::format("{}: feature {} has {} = {}{}; it must be a {} greater than 0 and at most {:.0f} (m)",
                                 file, feature + 1, attribute.name, attribute_text(found->second),
                                 read ? "" : ", where " + read.error().message, attribute.what, attribute.most)};
    }
    return length;
}

}  // namespace talus::scene
