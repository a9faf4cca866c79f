// Where the ground resists in its own way or can be picked up, over the hillshade of the other maps.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "products/report_image.hpp"
#include "products/report_sections.hpp"
#include "products/report_text.hpp"

namespace talus::report {
namespace {

/// Apart from each other to colour-blind eyes (Okabe & Ito 2008); beyond them they come again.
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

/// Zones as areas, what can be picked up as stripes.
ClassImage picture_of(const Scene& scene, const MapFrame& frame) {
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

/// What a zone says, a line each.
std::vector<std::string> values_of(const ZoneSpec& zone) {
    std::vector<std::string> lines;
    if (zone.raster_holds == ZoneRaster::friction_coefficient) lines.emplace_back("friction as its raster says");
    if (zone.raster_holds == ZoneRaster::turbulent_friction) lines.emplace_back("ξ as its raster says");
    if (zone.friction_coefficient) lines.push_back(fmt::format("friction {}", plain(*zone.friction_coefficient)));
    if (zone.turbulent_friction) lines.push_back(fmt::format("ξ {} m/s²", plain(*zone.turbulent_friction)));
    if (zone.cohesion) lines.push_back(fmt::format("cohesion {} Pa", plain(*zone.cohesion)));
    if (zone.stem_density > 0) {
        lines.push_back(fmt::format("{} stems/m²", plain(zone.stem_density)));
        lines.push_back(fmt::format("{} m thick", plain(zone.stem_diameter)));
        lines.push_back(fmt::format("drag coefficient {}", plain(zone.stem_drag_coefficient)));
    }
    return lines;
}

std::vector<std::string> values_of(const BedSpec& bed) {
    std::vector<std::string> lines;
    lines.push_back(bed.depth                  ? fmt::format("{} m deep", plain(*bed.depth))
                    : bed.depth_raster.empty() ? "as deep as its polygons say"
                                               : "as deep as its raster says");
    if (bed.law == EntrainmentLaw::growth) {
        lines.push_back(fmt::format("growth {} per m", plain(bed.growth_rate.value_or(0))));
    } else {
        lines.push_back(fmt::format("above {} Pa", plain(bed.critical_shear_stress)));
        lines.push_back(fmt::format("at {} m/s", plain(bed.erosion_rate)));
    }
    return lines;
}

/// The key, from the top down; `y` is then below it.
class Key {
  public:
    Key(double x, double y) : x_(x), y_(y) {}

    void add(const Colour& colour, bool striped, const std::string& name, const std::vector<std::string>& values) {
        if (striped) {
            svg_ += fmt::format(R"svg(<g transform="translate({} {})">)svg", coordinate(x_), coordinate(y_));
            svg_ += R"(<rect class="swatch-base" width="30" height="18"/>)";
            for (int k = 0; k < 3; ++k) {
                svg_ += fmt::format(R"(<path class="swatch layer" fill="{}" d="M{} 18l10 -18h4l-10 18Z"/>)",
                                    colour.hex(), 2 + 8 * k);
            }
            svg_ += "</g>";
        } else {
            svg_ += fmt::format(
                R"(<rect class="swatch-base" x="{0}" y="{1}" width="30" height="18"/><rect class="swatch layer" x="{0}" y="{1}" width="30" height="18" fill="{2}"/>)",
                coordinate(x_), coordinate(y_), colour.hex());
        }
        text("legend", 13.5, escape(shortened(name, 24)));
        y_ += 14;
        for (const std::string& value : values) {
            text("legend-unit", 14, value);
            y_ += 14;
        }
        y_ += 10;
    }
    [[nodiscard]] const std::string& svg() const { return svg_; }
    [[nodiscard]] double y() const { return y_; }

  private:
    void text(const char* style, double below, const std::string& words) {
        svg_ += fmt::format(R"(<text class="{}" x="{}" y="{}">{}</text>)", style, coordinate(x_ + 39),
                            coordinate(y_ + below), words);
    }

    double x_, y_;
    std::string svg_;
};

std::string words_of(const Scene& scene) {
    const MaterialSpec& material = scene.spec.material;
    std::string html;
    if (!scene.spec.zones.empty()) {
        html += fmt::format(
            "<p><b>Zones.</b> What a zone says of its ground holds there in place of the material's values: Coulomb "
            "friction (elsewhere {}), turbulent friction ξ (elsewhere {}; Voellmy 1955), cohesion (elsewhere {} Pa), "
            "and "
            "stems that drag on debris by C<sub>D</sub> n D v² / 2 (Petryk &amp; Bosmajian 1975). Where zones lie over "
            "each other, what the later one says goes before; the map shows the later one. A cell of the terrain "
            "belongs to a zone when its centre does.</p>\n",
            plain(material.friction_coefficient),
            material.turbulent_friction ? plain(*material.turbulent_friction) + " m/s²" : "none",
            plain(material.cohesion));
    }
    if (!scene.spec.beds.empty()) {
        html +=
            "<p><b>Bed.</b> Loose ground that debris picks up as it moves over it, by growth per metre of way "
            "(McDougall "
            "&amp; Hungr 2005) or by shear stress (Frank et al. 2015), down to its depth; what was picked up is said "
            "below.</p>\n";
    }
    return html;
}

}  // namespace

Result<std::string> zone_section(const Scene& scene, const MapContent& content, const MapFigures& maps, int figure) {
    if (!has_zone_figure(scene)) return std::string();
    const MapFrame frame = map_frame(scene, content);
    auto picture = png_uri(picture_of(scene, frame));
    if (!picture) return picture.error();
    const double x = frame.right() + 20;
    Key key(x, frame.top + 26);
    for (std::size_t k = 0; k < scene.spec.zones.size(); ++k) {
        const ZoneSpec& zone = scene.spec.zones[k];
        key.add(zone_colours.at(k % zone_colours.size()), false, zone.name, values_of(zone));
    }
    for (std::size_t k = 0; k < scene.spec.beds.size(); ++k) {
        const BedSpec& bed = scene.spec.beds[k];
        key.add(bed_colours.at(k % bed_colours.size()), true, bed.name, values_of(bed));
    }
    const std::string title = scene.spec.beds.empty()    ? "Zones of the ground"
                              : scene.spec.zones.empty() ? "Bed that can be picked up"
                                                         : "Zones of the ground and bed";
    const double key_top = key.y() + 8, width = x + MapFrame::key_width;
    const double height = std::max(frame.bottom() + 30, key_top + key_height(scene));
    const std::string flag = scene.spec.scene.reconstruction ? R"(<span class="flag">reconstruction</span> )" : "";
    return fmt::format(
        R"svg(<section id="zones">
<h2>{0}</h2>
{1}<figure class="map"><svg class="figure" viewBox="0 0 {2} {3}" style="max-width:{4}px" role="img" aria-label="Map: {0}"><use href="#map-base"/><g clip-path="url(#map-clip)"><image class="layer" x="{5}" y="{6}" width="{7}" height="{8}" preserveAspectRatio="none" href="{9}"/></g><use href="#map-over"/><text class="legend-title" x="{10}" y="{11}">On the ground</text>{12}<g transform="translate(0 {13})">{14}</g></svg><figcaption>{15}<b>Figure {16}. {0}.</b> As the run began, on the cells of the terrain, {17} m wide.</figcaption></figure>
</section>
)svg",
        title, words_of(scene), coordinate(width), coordinate(height), coordinate(1.04 * width), coordinate(frame.left),
        coordinate(frame.top), coordinate(frame.width()), coordinate(frame.height()), *picture, coordinate(x),
        coordinate(frame.top + 14), key.svg(), coordinate(key_top),
        draw_key(scene, content.buildings, frame, maps.contour_interval), flag, figure, plain(scene.terrain.cell()));
}

bool has_zone_figure(const Scene& scene) {
    return !scene.spec.zones.empty() || !scene.bed.empty();
}

}  // namespace talus::report
