#include "products/layer_definition.hpp"

#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "products/text_file.hpp"
#include "report/number_text.hpp"

namespace talus::products {

using report::escape;

namespace {

/// QGIS shows dates only: time 0 is the beginning of the year 2000, as in the NetCDF series.
std::string date_text(double seconds) {
    const auto time = std::chrono::sys_days(std::chrono::year{2000} / 1 / 1) +
                      std::chrono::milliseconds(std::llround(seconds * 1000));
    const auto day = std::chrono::floor<std::chrono::days>(time);
    const std::chrono::year_month_day date(day);
    const std::chrono::hh_mm_ss clock(time - day);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", static_cast<int>(date.year()),
                       static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), clock.hours().count(),
                       clock.minutes().count(), clock.seconds().count(), clock.subseconds().count());
}

}  // namespace

void LayerDefinition::add_raster(const std::string& name, const std::string& file, const std::string& style,
                                 bool shown) {
    add(rasters_, name, "./" + file, "raster", "gdal", style, shown);
}

void LayerDefinition::add_vector(const std::string& name, const std::string& file, const std::string& layer,
                                 const std::string& style, bool shown) {
    add(vectors_, name, fmt::format("./{}|layername={}", file, layer), "vector", "ogr", style, shown);
}

void LayerDefinition::add(Parts& parts, const std::string& name, const std::string& source, const char* type,
                          const char* provider, const std::string& style, bool shown, const std::string& more) {
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
        "   <srs><spatialrefsys><wkt>{}</wkt></spatialrefsys></srs>\n{}  </maplayer>\n",
        type, style.substr(from, to - from), id, escape(name), escape(source), provider, escape(wkt_), more);
}

void LayerDefinition::add_over_time(const std::string& group, const std::vector<Frame>& frames) {
    over_time_.tree +=
        fmt::format("    <layer-tree-group name=\"{}\" checked=\"Qt::Unchecked\" expanded=\"0\">\n", escape(group));
    for (const Frame& frame : std::vector<Frame>(frames.rbegin(), frames.rend())) {  // the latest on top
        add(over_time_, frame.name, frame.source, "raster", "gdal", frame.style, true,
            fmt::format(
                "   <temporal mode=\"0\" enabled=\"1\" fetchMode=\"0\"><fixedRange><start>{}</start><end>{}</end>"
                "</fixedRange></temporal>\n",
                date_text(frame.begin), date_text(frame.end - 0.001)));  // ranges include their ends
    }
    over_time_.tree += "    </layer-tree-group>\n";
}

Status LayerDefinition::write(const std::filesystem::path& folder) const {
    return write_text_file(folder / "results.qlr",
                           fmt::format(R"(<!DOCTYPE qgis-layer-definition>
<qlr>
 <layer-tree-group name="" checked="Qt::Checked" expanded="1">
   <layer-tree-group name="{}" checked="Qt::Checked" expanded="1">
{}{}{}   </layer-tree-group>
 </layer-tree-group>
 <maplayers>
{}{}{} </maplayers>
</qlr>
)",
                                       escape(group_), vectors_.tree, over_time_.tree, rasters_.tree, vectors_.layers,
                                       over_time_.layers, rasters_.layers));
}

}  // namespace talus::products
