#pragma once

#include <string>
#include <vector>

#include "report/colour.hpp"

namespace talus::report {

/// How polygons, lines or points are drawn. Colours with an alpha of 0 to 255.
struct VectorSymbol {
    enum class Kind { polygon, line, point };
    Colour fill{}, line{};
    int fill_alpha = 255;
    double line_width = 0.3;  ///< mm
    Kind kind = Kind::polygon;
};

/// A class of a layer: features whose attribute has this value.
struct VectorClass {
    std::string value, label;
    VectorSymbol symbol;
};

/// A QGIS 3 layer style: the same symbol for all features, or one by the value of `attribute`. `label`: the attribute
/// that labels them; empty: none.
[[nodiscard]] std::string qgis_vector_style(const VectorSymbol& symbol, const std::string& label = "");
[[nodiscard]] std::string qgis_vector_style(const std::string& attribute, const std::vector<VectorClass>& classes,
                                            const std::string& label = "");

}  // namespace talus::report
