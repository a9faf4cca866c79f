#include "scene/new_release.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/lower_case.hpp"
#include "core/try.hpp"
#include "scene/attributes.hpp"

namespace talus::scene {
namespace {

constexpr std::size_t most_named = 20;

std::optional<std::int64_t> whole_number(const std::string& text) {
    std::int64_t number = 0;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (failed != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return number;
}

std::string as_text(const geo::Attribute& value) {
    if (const auto* text = std::get_if<std::string>(&value)) return *text;
    return std::holds_alternative<double>(value) ? attribute_text(value) : "";
}

/// The values there are, in the order of the features.
std::string values_text(std::vector<std::string> values) {
    const bool more = values.size() > most_named;
    values.resize(std::min(values.size(), most_named));
    return fmt::format("{}{}", fmt::join(values, ", "), more ? ", ..." : "");
}

}  // namespace

Status choose_features(const std::string& file, const std::string& which, geo::PolygonLayer& layer) {
    const std::size_t equals = which.find('=');
    if (equals == std::string::npos) {
        std::vector<std::string> numbers;
        numbers.reserve(layer.features.size());
        for (const geo::PolygonFeature& feature : layer.features) numbers.push_back(std::to_string(feature.fid));
        const std::optional<std::int64_t> fid = whole_number(which);
        std::erase_if(layer.features, [&](const geo::PolygonFeature& feature) { return feature.fid != fid; });
        if (!layer.features.empty()) return {};
        return Error{
            fmt::format("{}: has no feature {}; it must be the number that GIS programs show (fid: {}) or "
                        "ATTRIBUTE=VALUE",
                        file, which, values_text(numbers))};
    }
    const std::string name = lower_case(which.substr(0, equals)), wanted = which.substr(equals + 1);
    std::set<std::string> attributes;
    std::vector<std::string> values;
    bool exists = false;
    const auto is_other = [&](const geo::PolygonFeature& feature) {
        bool is_it = false;
        for (const auto& [own, value] : feature.attributes) {
            attributes.insert(own);
            if (lower_case(own) != name) continue;
            exists = true;
            values.push_back(as_text(value));
            is_it = is_it || values.back() == wanted;
        }
        return !is_it;
    };
    std::erase_if(layer.features, is_other);
    if (!layer.features.empty()) return {};
    if (!exists) {
        return Error{fmt::format("{}: has no attribute \"{}\"; its attributes: {}", file, which.substr(0, equals),
                                 attributes.empty() ? "none" : fmt::format("{}", fmt::join(attributes, ", ")))};
    }
    return Error{fmt::format("{}: has no feature with {}; the values there are: {}", file, which, values_text(values))};
}

Status write_features(const geo::PolygonLayer& layer, const geo::Crs& crs, const std::filesystem::path& folder,
                      params::ReleaseSpec& release) {
    std::map<std::string, bool> is_text;
    for (const geo::PolygonFeature& feature : layer.features) {
        for (const auto& [name, value] : feature.attributes) {
            if (lower_case(name) == "fid" || lower_case(name) == "geom") continue;  // columns of a GeoPackage's own
            is_text[name] = is_text[name] || std::holds_alternative<std::string>(value);
        }
    }
    std::vector<geo::Field> fields;
    fields.reserve(is_text.size());
    for (const auto& [name, text] : is_text) fields.push_back({name, text});
    std::vector<geo::OutputFeature> features;
    features.reserve(layer.features.size());
    for (const geo::PolygonFeature& feature : layer.features) {
        geo::OutputFeature& out = features.emplace_back();
        out.polygon = feature.parts;
        out.values.reserve(fields.size());
        for (const geo::Field& field : fields) {
            const auto found = feature.attributes.find(field.name);
            const geo::Attribute value = found == feature.attributes.end() ? geo::Attribute() : found->second;
            const bool number = std::holds_alternative<double>(value);
            out.values.push_back(field.is_text && number ? geo::Attribute(attribute_text(value)) : value);
        }
    }
    const std::filesystem::path file = std::filesystem::absolute(folder) / "release.gpkg";
    TALUS_TRY(geo::write_geopackage_layer(file.string(), "release", fields, features, crs));
    release.file = file.lexically_normal().string();
    release.layer.clear();
    return {};
}

}  // namespace talus::scene
