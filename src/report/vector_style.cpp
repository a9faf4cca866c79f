#include "report/vector_style.hpp"

#include <fmt/format.h>

#include "report/number_text.hpp"

namespace talus::report {
namespace {

std::string colour_text(const Colour& colour, int alpha) {
    return fmt::format("{},{},{},{}", colour.red, colour.green, colour.blue, alpha);
}

std::string option(const char* name, const std::string& value) {
    return fmt::format(R"(        <Option type="QString" name="{}" value="{}"/>)"
                       "\n",
                       name, value);
}

std::string symbol_text(const VectorSymbol& symbol, std::size_t name) {
    std::string options;
    const char *type = "fill", *layer = "SimpleFill";
    if (symbol.kind == VectorSymbol::Kind::line) {
        type = "line";
        layer = "SimpleLine";
        options = option("line_color", colour_text(symbol.line, 255)) +
                  option("line_width", fmt::format("{}", symbol.line_width)) + option("line_width_unit", "MM");
    } else if (symbol.kind == VectorSymbol::Kind::point) {
        type = "marker";
        layer = "SimpleMarker";
        options = option("name", "circle") + option("color", colour_text(symbol.fill, symbol.fill_alpha)) +
                  option("outline_color", colour_text(symbol.line, 255)) +
                  option("outline_width", fmt::format("{}", symbol.line_width)) + option("outline_width_unit", "MM") +
                  option("size", "3") + option("size_unit", "MM");
    } else {
        options = option("color", colour_text(symbol.fill, symbol.fill_alpha)) +
                  option("outline_color", colour_text(symbol.line, 255)) + option("outline_style", "solid") +
                  option("outline_width", fmt::format("{}", symbol.line_width)) + option("outline_width_unit", "MM") +
                  option("style", symbol.fill_alpha == 0 ? "no" : "solid");
    }
    return fmt::format(R"(    <symbol type="{}" name="{}" alpha="1" clip_to_extent="1" force_rhr="0">
     <layer class="{}" enabled="1" locked="0" pass="0">
      <Option type="Map">
{}      </Option>
     </layer>
    </symbol>
)",
                       type, name, layer, options);
}

std::string style_text(const std::string& renderer, const std::string& label) {
    std::string labelling;
    if (!label.empty()) {
        labelling = fmt::format(R"( <labeling type="simple">
  <settings calloutType="simple">
   <text-style fieldName="{}" fontSize="8" textColor="34,34,34,255" isExpression="0">
    <text-buffer bufferDraw="1" bufferSize="0.8" bufferColor="255,255,255,255"/>
   </text-style>
   <placement placement="4"/>
  </settings>
 </labeling>
)",
                                escape(label));
    }
    return fmt::format(R"(<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis version="3.22.0" styleCategories="Symbology|Labeling" labelsEnabled="{}">
{}{}</qgis>
)",
                       label.empty() ? 0 : 1, renderer, labelling);
}

}  // namespace

std::string qgis_vector_style(const VectorSymbol& symbol, const std::string& label) {
    return style_text(
        fmt::format(R"( <renderer-v2 type="singleSymbol" forceraster="0" symbollevels="0" enableorderby="0">
  <symbols>
{}  </symbols>
 </renderer-v2>
)",
                    symbol_text(symbol, 0)),
        label);
}

std::string qgis_vector_style(const std::string& attribute, const std::vector<VectorClass>& classes,
                              const std::string& label) {
    std::string categories, symbols;
    for (std::size_t k = 0; k < classes.size(); ++k) {
        categories += fmt::format(R"(   <category render="true" symbol="{}" value="{}" label="{}" type="string"/>)"
                                  "\n",
                                  k, escape(classes[k].value), escape(classes[k].label));
        symbols += symbol_text(classes[k].symbol, k);
    }
    return style_text(
        fmt::format(
            R"( <renderer-v2 type="categorizedSymbol" attr="{}" forceraster="0" symbollevels="0" enableorderby="0">
  <categories>
{}  </categories>
  <symbols>
{}  </symbols>
 </renderer-v2>
)",
            escape(attribute), categories, symbols),
        label);
}

}  // namespace talus::report
