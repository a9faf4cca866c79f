#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

/// How the features of a layer are drawn, as far as a map of points, lines and areas needs it.
namespace talus::geo {

struct FeatureStyle {
    std::string stroke = {}, fill = {};  ///< "#rrggbb"; empty: none
    double stroke_opacity = 1, fill_opacity = 1;
    double width_px = 2, size_px = 10;  ///< of lines; of the marks of points
    bool operator==(const FeatureStyle&) const = default;
};

/// One style for all, or one for each value of an attribute.
struct LayerSymbols {
    std::string attribute = {};                       ///< empty: one for all
    std::map<std::string, FeatureStyle> values = {};  ///< "": of all others
    [[nodiscard]] bool empty() const { return values.empty(); }
};

/// Reads simple fills, lines and marks of a QGIS style (QML), for all features or by the values of an attribute.
/// What is not so simple is left out; empty: nothing was understood. For the process that reads untrusted files.
[[nodiscard]] LayerSymbols read_qml(const std::string& qml);

/// "#rrggbb" in lower case, of that or of "#rgb"; empty: it is no such colour.
[[nodiscard]] std::string colour_of(const std::string& text);

[[nodiscard]] nlohmann::json to_json(const FeatureStyle& style);
[[nodiscard]] nlohmann::json to_json(const LayerSymbols& symbols);
/// Whatever is not a style, or out of range, becomes the usual.
[[nodiscard]] FeatureStyle feature_style_of(const nlohmann::json& written);
[[nodiscard]] LayerSymbols symbols_of(const nlohmann::json& written);

}  // namespace talus::geo
