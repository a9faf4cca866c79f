#include "report/hazard_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "observe/map_names.hpp"
#include "report/number_text.hpp"

namespace talus::report {

namespace {

std::string item(const std::string& upper_limit, const report::Colour& colour, int alpha, const std::string& label) {
    return fmt::format("          <item value=\"{}\" color=\"{}\" alpha=\"{}\" label=\"{}\"/>\n", upper_limit,
                       colour.hex(), alpha, report::escape(label));
}

/// The look of one of observe::named_maps, which has its title, unit and grid.
HazardMap map(const char* key, const char* description, std::vector<double> breaks, const report::Ramp& ramp,
              const char* caption, int digits, const char* tab = nullptr) {
    const observe::NamedMap& named = *observe::find_map(key);
    HazardMap made{key, named.title, description, named.unit, named.factor, named.grid, std::move(breaks), ramp};
    made.tab = tab != nullptr ? tab : named.title;
    made.caption = caption;
    made.digits = digits;
    return made;
}

/// A map that not every run has, in m.
HazardMap other_map(const char* file, const char* title, const char* description, std::vector<double> breaks,
                    const report::Ramp& ramp) {
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
    // Breaks at 15 and 30 kPa separate slight, extensive and complete damage to buildings not of reinforced concrete
    // (Kang & Kim 2014); depths of 0.5 and 1 m are the limits of common intensity classes.
    static const std::vector<HazardMap> maps = {
        map("peak_depth", "peak flow depth, vertical", {0, 0.1, 0.25, 0.5, 1, 2, 3, 5, 10, 20},
            {205, 0.05, 268, 0.15, 0.90, 0.28}, "Greatest vertical flow depth at each place during the run.", 2),
        map("peak_speed", "peak depth-averaged speed", {0, 1, 2, 4, 6, 8, 10, 15, 20, 30},
            {104, 0.11, 8, 0.13, 0.93, 0.28}, "Greatest depth-averaged speed at each place during the run.", 1),
        map("peak_pressure", "peak dynamic pressure of the free flow, density x speed^2",
            {0, 5, 15, 30, 50, 100, 200, 400, 800}, {88, 0.08, -48, 0.14, 0.93, 0.26},
            "Greatest dynamic pressure of the free flow at each place: density times the square of the depth-averaged "
            "speed.",
            0),
        map("arrival_time", "time of first arrival since the start of the run", {}, {215, 0.06, 118, 0.10, 0.30, 0.92},
            "Time from the start of the run until debris first stands at each place.", 1),
        map("deposit_depth", "deposit depth at the end of the run, vertical",
            {0.05, 0.1, 0.25, 0.5, 1, 2, 3, 5, 10, 20}, {92, 0.07, 42, 0.09, 0.92, 0.28},
            "Vertical depth of debris at the end of the run. Below 0.05 m nothing is drawn.", 2, "Deposit"),
    };
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
