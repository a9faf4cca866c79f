#include "products/layer_definition.hpp"

#include <fmt/format.h>

#include "products/text_file.hpp"
#include "report/number_text.hpp"

namespace talus::products {

using report::escape;

void LayerDefinition::add_raster(const std::string& name, const std::string& file, const std::string& style,
                                 bool shown) {
    add(rasters_, name, "./" + file, "raster", "gdal", style, shown);
}

void LayerDefinition::add_vector(const std::string& name, const std::string& file, const std::string& layer,
                                 const std::string& style, bool shown) {
    add(vectors_, name, fmt::format("./{}|layername={}", file, layer), "vector", "ogr", style, shown);
}

void LayerDefinition::add(Parts& parts, const std::string& name, const std::string& source, const char* type,
                          const char* provider, const std::string& style, bool shown) {
    const std::string id = fmt::format("talus_{}", ++count_);  // QGIS makes it unique when it opens the file
    parts.tree += fmt::format(
        R"(    <layer-tree-layer id="{}" name="{}" source="{}" providerKey="{}" checked="{}" expanded="{}"/>)"
        "\n",
        id, escape(name), escape(source), provider, shown ? "Qt::Checked" : "Qt::Unchecked", shown ? 1 : 0);
    // A style is <qgis attributes>elements</qgis>; a layer has the same attributes and elements among its own.
    const std::string_view root = "<qgis";
    const std::size_t from = style.find(root) + root.size(), to = style.rfind("</qgis>");
    parts.layers += fmt::format(
        "  <maplayer type=\"{}\"{}"
        "   <id>{}</id>\n   <layername>{}</layername>\n   <datasource>{}</datasource>\n   <provider>{}</provider>\n"
        "   <srs><spatialrefsys><wkt>{}</wkt></spatialrefsys></srs>\n  </maplayer>\n",
        type, style.substr(from, to - from), id, escape(name), escape(source), provider, escape(wkt_));
}

Status LayerDefinition::write(const std::filesystem::path& folder) const {
    return write_text_file(folder / "results.qlr",
                           fmt::format(R"(<!DOCTYPE qgis-layer-definition>
<qlr>
 <layer-tree-group name="" checked="Qt::Checked" expanded="1">
   <layer-tree-group name="{}" checked="Qt::Checked" expanded="1">
{}{}   </layer-tree-group>
 </layer-tree-group>
 <maplayers>
{}{} </maplayers>
</qlr>
)",
                                       escape(group_), vectors_.tree, rasters_.tree, vectors_.layers, rasters_.layers));
}

}  // namespace talus::products
