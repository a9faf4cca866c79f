// Zones with their own resistance, and beds, over the hillshade of the other maps.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "report/image.hpp"
#include "report/map.hpp"
#include "report/number_text.hpp"

namespace talus::report {
namespace {

/// Distinguishable with colour blindness (Okabe & Ito 2008); repeated if there are more zones.
constexpr std::array<Colour, 7> zone_colours = {
    {{0, 158, 115}, {230, 159, 0}, {0, 114, 178}, {204, 121, 167}, {240, 228, 66}, {86, 180, 233}, {213, 94, 0}}};
constexpr std::array<Colour, 3> bed_colours = {{{92, 51, 23}, {40, 40, 40}, {120, 0, 60}}};
constexpr int stripe = 9, stripe_width = 3;  ///< pixels

std::uint8_t zone_class(std::size_t zone) {
    return static_cast<std::uint8_t>(1 + zone % zone_colours.size());
}

std::uint8_t bed_class(std::size_t material) {
    return static_cast<std::uint8_t>(1 + zone_colours.size() + material % bed_colours.size());
}

/// Zones as areas, beds as stripes.
ClassImage picture_of(const scene::Scene& scene, const MapFrame& frame) {
    const GridGeometry& g = scene.terrain.elevation().geometry;
    const double pixels_per_metre = 900 / std::max(frame.area.width(), frame.area.height());
    ClassImage image;
    image.width = std::max(1, static_cast<int>(std::lround(frame.area.width() * pixels_per_metre)));
    image.height = std::max(1, static_cast<int>(std::lround(frame.area.height() * pixels_per_metre)));
    image.colours.assign(zone_colours.begin(), zone_colours.end());
    image.colours.insert(image.colours.end(), bed_colours.begin(), bed_colours.end());
    image.pixels.assign(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height), 0);
    std::size_t pixel = 0;
    for (int row = 0; row < image.height; ++row) {
        const double y = frame.area.y_max - (row + 0.5) / pixels_per_metre;
        const auto cell_row = static_cast<int>(std::floor((y - g.y_min) / g.cell));
        for (int column = 0; column < image.width; ++column, ++pixel) {
            const double x = frame.area.x_min + (column + 0.5) / pixels_per_metre;
            const auto cell_column = static_cast<int>(std::floor((x - g.x_min) / g.cell));
            if (cell_row < 0 || cell_column < 0 || cell_row >= g.rows || cell_column >= g.columns) continue;
            const std::size_t cell = g.index(cell_column, cell_row);
            const std::size_t zone = scene.zone_at.empty() ? 0 : scene.zone_at[cell];
            const std::size_t material = scene.bed.empty() ? 0 : scene.bed.material_at[cell];
            const bool striped = material > 0 && (column + row) % stripe < stripe_width;
            if (striped) {
                image.pixels[pixel] = bed_class(material - 1);
            } else if (zone > 0) {
                image.pixels[pixel] = zone_class(zone - 1);
            }
        }
    }
    return image;
}

/// The values of a zone, one per line.
std::vector<std::string> values_of(const params::ZoneSpec& zone) {
    std::vector<std::string> lines;
    if (zone.raster_holds == params::ZoneRaster::friction_coefficient)
        lines.emplace_back("friction as its raster says");
    if (zone.raster_holds == params::ZoneRaster::turbulent_friction) lines.emplace_back("ξ as its raster says");
    if (zone.friction_coefficient) lines.push_back(fmt::format("friction {}", plain(*zone.friction_coefficient)));
    if (zone.turbulent_friction) lines.push_back(fmt::format("ξ {} m/s²", plain(*zone.turbulent_friction)));
    if (zone.laminar_viscosity) lines.push_back(fmt::format("ν {} m²/s", plain(*zone.laminar_viscosity)));
    if (zone.cohesion) lines.push_back(fmt::format("cohesion {} Pa", plain(*zone.cohesion)));
    if (zone.stem_density > 0) {
        lines.push_back(fmt::format("{} stems/m²", plain(zone.stem_density)));
        lines.push_back(fmt::format("{} m thick", plain(zone.stem_diameter)));
        lines.push_back(fmt::format("drag coefficient {}", plain(zone.stem_drag_coefficient)));
    }
    return lines;
}

std::vector<std::string> values_of(const params::BedSpec& bed) {
    std::vector<std::string> lines;
    lines.push_back(bed.depth                  ? fmt::format("{} m deep", plain(*bed.depth))
                    : bed.depth_raster.empty() ? "as deep as its polygons say"
                                               : "as deep as its raster says");
    if (bed.law == params::EntrainmentLaw::growth) {
        lines.push_back(fmt::format("growth {} per m", plain(bed.growth_rate.value_or(0))));
    } else {
        lines.push_back(fmt::format("above {} Pa", plain(bed.critical_shear_stress)));
        lines.push_back(fmt::format("at {} m/s", plain(bed.erosion_rate)));
    }
    return lines;
}

/// Draws a line of the key with its text below; returns its height.
double draw_entry(Svg& svg, double x, double y, const Colour& colour, bool striped, const std::string& name,
                  const std::vector<std::string>& values) {
    if (striped) {
        svg.rect("swatch-base", x, y, 30, 18);
        for (int k = 0; k < 3; ++k) {
            svg.add("path", {{"class", "swatch layer"},
                             {"fill", colour.hex()},
                             {"transform", translation(x, y)},
                             {"d", fmt::format("M{} 18l10 -18h4l-10 18Z", 2 + 8 * k)}});
        }
    } else {
        draw_swatch(svg, x, y, colour);
    }
    svg.text("legend", x + 39, y + 13.5, shortened(name, 24));
    double below = y + 14;
    for (const std::string& value : values) {
        svg.text("legend-unit", x + 39, below + 14, value);
        below += 14;
    }
    return below + 10 - y;
}

}  // namespace

Result<Json> zone_figure(const scene::Scene& scene, const MapContent& content, double contour_interval) {
    if (scene.spec.zones.empty() && scene.bed.empty()) return Json();
    const MapFrame frame = map_frame(scene, content);
    TALUS_ASSIGN(auto picture, png_uri(picture_of(scene, frame)));
    const double x = frame.right() + 20, width = x + MapFrame::key_width;
    Svg svg;
    svg.add("use", {{"href", "#map-base"}});
    svg.open("g", {{"clip-path", "url(#map-clip)"}});
    draw_image(svg, "layer", frame.left, frame.top, frame.width(), frame.height(), picture);
    svg.close("g");
    svg.add("use", {{"href", "#map-over"}});
    svg.text("legend-title", x, frame.top + 14, "On the ground");
    double y = frame.top + 26;
    for (std::size_t k = 0; k < scene.spec.zones.size(); ++k) {
        const params::ZoneSpec& zone = scene.spec.zones[k];
        y += draw_entry(svg, x, y, zone_colours.at(k % zone_colours.size()), false, zone.name, values_of(zone));
    }
    for (std::size_t k = 0; k < scene.spec.beds.size(); ++k) {
        const params::BedSpec& bed = scene.spec.beds[k];
        y += draw_entry(svg, x, y, bed_colours.at(k % bed_colours.size()), true, bed.name, values_of(bed));
    }
    svg.open("g", {{"transform", translation(0, y + 8)}});
    draw_key(svg, scene, content, frame, contour_interval);
    svg.close("g");
    const char* title = scene.spec.beds.empty()    ? "Zones of the ground"
                        : scene.spec.zones.empty() ? "Bed that can be entrained"
                                                   : "Zones of the ground and bed";
    const double height = std::max(frame.bottom() + 30, y + 8 + key_height(scene, content));
    return Json{{"title", title},
                {"svg", figure_svg(width, height, std::string("Map: ") + title, svg, 1.04 * width, print_width(frame))},
                {"zones", scene.spec.zones.size()},
                {"beds", scene.spec.beds.size()},
                {"cell", scene.terrain.cell()}};
}

}  // namespace talus::report
