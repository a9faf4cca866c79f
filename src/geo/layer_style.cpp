#include "geo/layer_style.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>

#include <cpl_minixml.h>
#include <fmt/format.h>

#include "core/lower_case.hpp"
#include "geo/gdal.hpp"

namespace talus::geo {
namespace {

using nlohmann::json;

constexpr std::size_t longest_qml = 2'000'000, most_symbols = 200, longest_symbol_value = 200;
constexpr double pixels_per_mm = 96 / 25.4;

struct FreeXml {
    void operator()(CPLXMLNode* node) const { CPLDestroyXMLNode(node); }
};

double number_of_text(const std::string& text, double otherwise) {
    double value = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    return read.ec == std::errc() && std::isfinite(value) ? value : otherwise;
}

std::string value_of(const CPLXMLNode* node, const char* key) {
    const char* text = CPLGetXMLValue(node, key, "");
    return text != nullptr ? text : "";
}

/// A colour as QGIS writes it, "133,182,111,255" and possibly more; its opacity is multiplied to `opacity`.
std::string qgis_colour(const std::string& text, double& opacity) {
    std::array<int, 4> parts{0, 0, 0, 255};
    const char* at = text.data();
    const char* const end = at + text.size();
    for (std::size_t k = 0; k < parts.size() && at < end; ++k) {
        const auto read = std::from_chars(at, end, parts[k]);
        if (read.ec != std::errc() || parts[k] < 0 || parts[k] > 255) return {};
        at = read.ptr;
        if (at < end && *at == ',') ++at;
    }
    if (text.empty()) return {};
    opacity *= parts[3] / 255.0;
    return fmt::format("#{:02x}{:02x}{:02x}", parts[0], parts[1], parts[2]);
}

/// The properties of a layer of a symbol, as any version of QGIS writes them.
std::map<std::string, std::string> properties_of(const CPLXMLNode* layer) {
    std::map<std::string, std::string> found;
    for (const CPLXMLNode* child = layer->psChild; child != nullptr; child = child->psNext) {
        if (child->eType != CXT_Element) continue;
        if (std::strcmp(child->pszValue, "prop") == 0) found[value_of(child, "k")] = value_of(child, "v");
        if (std::strcmp(child->pszValue, "Option") != 0) continue;
        for (const CPLXMLNode* option = child->psChild; option != nullptr; option = option->psNext) {
            if (option->eType == CXT_Element) found[value_of(option, "name")] = value_of(option, "value");
        }
    }
    return found;
}

/// The first layer of a symbol; empty: it is none of the simple ones.
std::optional<FeatureStyle> style_of(const CPLXMLNode* symbol) {
    const CPLXMLNode* layer = CPLGetXMLNode(const_cast<CPLXMLNode*>(symbol), "layer");
    if (layer == nullptr) return {};
    const std::string kind = value_of(layer, "class");
    const double alpha = std::clamp(number_of_text(value_of(symbol, "alpha"), 1), 0.0, 1.0);
    auto properties = properties_of(layer);
    const auto width = [&](const char* key, double otherwise) {
        const std::string unit = properties[std::string(key) + "_unit"];
        const double given = number_of_text(properties[key], otherwise);
        return unit == "Pixel" ? given : given * pixels_per_mm;
    };
    FeatureStyle style;
    style.stroke_opacity = style.fill_opacity = alpha;
    if (kind == "SimpleFill") {
        if (properties["style"] != "no") style.fill = qgis_colour(properties["color"], style.fill_opacity);
        if (properties["outline_style"] != "no")
            style.stroke = qgis_colour(properties["outline_color"], style.stroke_opacity);
        style.width_px = width("outline_width", 0.26);
    } else if (kind == "SimpleLine") {
        const char* const key = properties.contains("line_color") ? "line_color" : "color";
        style.stroke = qgis_colour(properties[key], style.stroke_opacity);
        style.width_px = width(properties.contains("line_width") ? "line_width" : "width", 0.26);
    } else if (kind == "SimpleMarker") {
        style.fill = qgis_colour(properties["color"], style.fill_opacity);
        style.stroke = qgis_colour(properties["outline_color"], style.stroke_opacity);
        style.size_px = width("size", 2);
    } else {
        return {};
    }
    return feature_style_of(to_json(style));
}

}  // namespace

std::string colour_of(const std::string& text) {
    const auto is_hex = [](unsigned char c) { return std::isxdigit(c) != 0; };
    if (text.size() < 2 || text[0] != '#' || !std::all_of(text.begin() + 1, text.end(), is_hex)) return {};
    std::string lower = lower_case(text);
    if (text.size() == 7) return lower;
    if (text.size() != 4) return {};
    return {'#', lower[1], lower[1], lower[2], lower[2], lower[3], lower[3]};
}

json to_json(const FeatureStyle& style) {
    return {{"stroke", style.stroke},     {"stroke_opacity", style.stroke_opacity},
            {"fill", style.fill},         {"fill_opacity", style.fill_opacity},
            {"width_px", style.width_px}, {"size_px", style.size_px}};
}

FeatureStyle feature_style_of(const json& written) {
    FeatureStyle style;
    if (!written.is_object()) return style;
    const auto text = [&](const char* key) {
        const auto found = written.find(key);
        return found != written.end() && found->is_string() ? colour_of(found->get<std::string>()) : std::string();
    };
    const auto number = [&](const char* key, double low, double high, double otherwise) {
        const auto found = written.find(key);
        if (found == written.end() || !found->is_number()) return otherwise;
        return std::clamp(found->get<double>(), low, high);
    };
    style.stroke = text("stroke");
    style.fill = text("fill");
    style.stroke_opacity = number("stroke_opacity", 0, 1, 1);
    style.fill_opacity = number("fill_opacity", 0, 1, 1);
    style.width_px = number("width_px", 0.5, 20, 2);
    style.size_px = number("size_px", 3, 40, 10);
    return style;
}

json to_json(const LayerSymbols& symbols) {
    json values = json::array();
    for (const auto& [value, style] : symbols.values) values.push_back({{"value", value}, {"style", to_json(style)}});
    return {{"attribute", symbols.attribute}, {"values", std::move(values)}};
}

LayerSymbols symbols_of(const json& written) {
    LayerSymbols symbols;
    if (!written.is_object()) return symbols;
    const auto attribute = written.find("attribute"), values = written.find("values");
    if (attribute == written.end() || !attribute->is_string() || values == written.end() || !values->is_array()) {
        return symbols;
    }
    symbols.attribute = attribute->get<std::string>().substr(0, longest_symbol_value);
    for (const json& one : *values) {
        const auto value = one.is_object() ? one.find("value") : one.end();
        if (value == one.end() || !value->is_string() || symbols.values.size() >= most_symbols) continue;
        symbols.values[value->get<std::string>().substr(0, longest_symbol_value)] =
            feature_style_of(one.value("style", json()));
    }
    return symbols;
}

LayerSymbols read_qml(const std::string& qml) {
    LayerSymbols symbols;
    if (qml.size() > longest_qml) return symbols;
    const GdalMessages quiet;
    const std::unique_ptr<CPLXMLNode, FreeXml> document(CPLParseXMLString(qml.c_str()));
    if (!document) return symbols;
    const CPLXMLNode* renderer = CPLGetXMLNode(document.get(), "=qgis.renderer-v2");
    const CPLXMLNode* list = CPLGetXMLNode(document.get(), "=qgis.renderer-v2.symbols");
    if (renderer == nullptr || list == nullptr) return symbols;
    std::map<std::string, FeatureStyle> by_name;
    for (const CPLXMLNode* symbol = list->psChild; symbol != nullptr; symbol = symbol->psNext) {
        if (symbol->eType != CXT_Element || by_name.size() >= most_symbols) continue;
        if (const auto style = style_of(symbol)) by_name[value_of(symbol, "name")] = *style;
    }
    const std::string kind = value_of(renderer, "type");
    if (kind == "singleSymbol" && by_name.contains("0")) symbols.values[""] = by_name["0"];
    if (kind != "categorizedSymbol") return symbols;
    const CPLXMLNode* categories = CPLGetXMLNode(document.get(), "=qgis.renderer-v2.categories");
    symbols.attribute = value_of(renderer, "attr").substr(0, longest_symbol_value);
    if (std::string& name = symbols.attribute; name.size() > 2 && name.front() == '"' && name.back() == '"') {
        name = name.substr(1, name.size() - 2);  // as an expression has it
    }
    for (const CPLXMLNode* one = categories != nullptr ? categories->psChild : nullptr; one != nullptr;
         one = one->psNext) {
        const auto style = one->eType == CXT_Element ? by_name.find(value_of(one, "symbol")) : by_name.end();
        if (style != by_name.end())
            symbols.values[value_of(one, "value").substr(0, longest_symbol_value)] = style->second;
    }
    return symbols;
}

}  // namespace talus::geo
