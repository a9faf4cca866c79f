#include "report/hazard_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/hazard_maps.hpp"
#include "report/number_text.hpp"

namespace talus::report {

namespace {

std::string item(const std::string& upper_limit, const report::Colour& colour, int alpha, const std::string& label) {
    return fmt::format("          <item value=\"{}\" color=\"{}\" alpha=\"{}\" label=\"{}\"/>\n", upper_limit,
                       colour.hex(), alpha, report::escape(label));
}

/// One of named_maps.
HazardMap map_of(const NamedMap& named) {
    HazardMap made{std::string(named.key),
                   named.title,
                   named.description,
                   named.unit,
                   named.factor,
                   named.grid,
                   {named.breaks.begin(), named.breaks.end()},
                   named.ramp};
    made.tab = named.tab != nullptr ? named.tab : named.title;
    made.caption = named.caption;
    made.digits = named.digits;
    return made;
}

/// A map that not every run has, in m.
HazardMap other_map(const char* file, const char* title, const char* description, std::vector<double> breaks,
                    const Ramp& ramp) {
    return {file, title, description, "m", 1, nullptr, std::move(breaks), ramp};
}

/// A QGIS 3 layer style around the element of a renderer.
std::string layer_style(const std::string& renderer, const std::string& resampling = "") {
    return R"qml(<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis version="3.22.0" styleCategories="AllStyleCategories" hasScaleBasedVisibilityFlag="0">
  <customproperties>
    <Option/>
  </customproperties>
  <pipe>
)qml" + renderer +
           R"qml(    <brightnesscontrast brightness="0" contrast="0" gamma="1"/>
    <huesaturation saturation="0" grayscaleMode="0" colorizeOn="0"/>
    <rasterresampler maxOversampling="2")qml" +
           resampling + R"qml(/>
    <resamplingStage>resamplingFilter</resamplingStage>
  </pipe>
  <blendMode>0</blendMode>
</qgis>
)qml";
}

/// A QGIS style with a colour per class.
std::string category_style(const HazardMap& map) {
    std::string entries;
    for (std::size_t k = 0; k < map.categories.size(); ++k) {
        const Category& category = map.categories[k];
        entries += fmt::format("        <paletteEntry value=\"{}\" color=\"{}\" alpha=\"255\" label=\"{}\"/>\n", k + 1,
                               category.colour.hex(), report::escape(category.name));
    }
    return layer_style(fmt::format(
        R"qml(    <rasterrenderer type="paletted" band="1" opacity="0.85" alphaBand="-1" nodataColor="">
      <rasterTransparency/>
      <colorPalette>
{}      </colorPalette>
    </rasterrenderer>
)qml",
        entries));
}

}  // namespace

const std::vector<HazardMap>& hazard_maps() {
    static const std::vector<HazardMap> maps = [] {
        std::vector<HazardMap> all;
        all.reserve(named_maps.size());
        for (const NamedMap& named : named_maps) all.push_back(map_of(named));
        return all;
    }();
    return maps;
}

const HazardMap& erosion_map() {
    static const HazardMap erosion =
        other_map("erosion_depth", "Erosion depth", "depth that debris entrained from the bed, vertical",
                  {0, 0.05, 0.1, 0.25, 0.5, 1, 2, 3, 5}, {25, 0.07, 52, 0.13, 0.92, 0.30});
    return erosion;
}

const HazardMap& thickness_map() {
    static const HazardMap thickness =
        other_map("peak_thickness", "Peak thickness", "peak flow thickness, normal to the slope",
                  {0, 0.1, 0.25, 0.5, 1, 2, 3, 5, 10, 20}, {205, 0.05, 268, 0.15, 0.90, 0.28});
    return thickness;
}

Grid<float> in_unit(const Grid<float>& si, double factor) {
    Grid<float> result = si;
    for (float& value : result.values) value = static_cast<float>(value * factor);
    return result;
}

double greatest(const Grid<float>& grid) {
    double most = 0;
    for (const float value : grid.values) {
        if (value > most) most = value;
    }
    return most;
}

std::string qgis_style(const HazardMap& map, double largest, std::size_t band) {
    if (!map.categories.empty()) return category_style(map);
    largest = std::max(largest, map.full_scale);
    const report::Classes classes = map.breaks.empty() ? report::even_classes(largest, map.ramp)
                                                       : report::fixed_classes(map.breaks, largest, map.ramp);
    const std::size_t count = classes.breaks.size();
    // QGIS gives a value the colour of the first item at or above it. A time of zero is an arrival, so no class of
    // times is transparent.
    std::string items;
    if (!map.breaks.empty()) {
        const double lowest = classes.breaks.front();
        items += item(fmt::format("{}", lowest), Colour{255, 255, 255}, 0,  // a legend shows it without its alpha
                      lowest > 0 ? fmt::format("up to {} {}", lowest, map.unit) : std::string("none"));
    }
    for (std::size_t k = 0; k < count; ++k) {
        const bool last = k + 1 == count;
        const std::string upper = last ? "inf" : fmt::format("{}", classes.breaks[k + 1]);
        const std::string label = last ? fmt::format("above {} {}", classes.breaks[k], map.unit)
                                       : fmt::format("{} – {} {}", classes.breaks[k], upper, map.unit);
        items += item(upper, classes.colours[k], 255, label);
    }
    return layer_style(fmt::format(
        R"qml(    <rasterrenderer type="singlebandpseudocolor" band="{3}" opacity="0.85" alphaBand="-1" nodataColor="" classificationMin="{0}" classificationMax="{1}">
      <rasterTransparency/>
      <minMaxOrigin>
        <limits>None</limits>
        <extent>WholeRaster</extent>
        <statAccuracy>Exact</statAccuracy>
      </minMaxOrigin>
      <rastershader>
        <colorrampshader colorRampType="DISCRETE" classificationMode="1" clip="0" minimumValue="{0}" maximumValue="{1}" labelPrecision="2">
{2}        </colorrampshader>
      </rastershader>
    </rasterrenderer>
)qml",
        classes.breaks.front(), std::max(largest, classes.breaks.back()), items, band));
}

std::string qgis_hillshade_style() {
    // Without, the shade of a map that is zoomed in is that of the steps between the cells.
    const char* const smooth = R"( zoomedInResampler="bilinear" zoomedOutResampler="bilinear")";
    return layer_style(
        R"qml(    <rasterrenderer type="hillshade" band="1" azimuth="315" angle="45" zfactor="1" multidirection="0" opacity="1" alphaBand="-1" nodataColor="">
      <rasterTransparency/>
    </rasterrenderer>
)qml",
        smooth);
}

}  // namespace talus::report
