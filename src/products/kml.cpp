#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/try.hpp"
#include "core/visible_text.hpp"
#include "geo/longitude_latitude.hpp"
#include "geo/raster_outline.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"
#include "report/hazard_map.hpp"
#include "report/intensity.hpp"
#include "report/number_text.hpp"

namespace talus::products {
namespace {

/// Names may hold what XML must not.
std::string escape(const std::string& text) {
    return report::escape(visible(text));
}

/// KML writes alpha, blue, green, red.
std::string kml_colour(const report::Colour& colour, int alpha) {
    return fmt::format("{:02x}{:02x}{:02x}{:02x}", alpha, colour.blue, colour.green, colour.red);
}

std::string style_text(const std::string& id, const report::Colour& line, double width, const report::Colour& fill,
                       int fill_alpha) {
    return fmt::format(
        "<Style id=\"{}\"><LineStyle><color>{}</color><width>{}</width></LineStyle>"
        "<PolyStyle><color>{}</color><fill>{}</fill></PolyStyle></Style>\n",
        id, kml_colour(line, 255), width, kml_colour(fill, fill_alpha), fill_alpha > 0 ? 1 : 0);
}

class Geometry {
  public:
    explicit Geometry(const geo::ToLongitudeLatitude& to_degrees) : to_degrees_(to_degrees) {}

    /// On the ground; with a height, m, as bodies that stand on it.
    [[nodiscard]] std::string text(const std::vector<Polygon>& polygons, double height = 0) const {
        std::string all;
        for (const Polygon& polygon : polygons) {
            all +=
                height > 0 ? "<Polygon><extrude>1</extrude><altitudeMode>relativeToGround</altitudeMode>" : "<Polygon>";
            all += ring_text(polygon.outer, "outerBoundaryIs", height);
            for (const Ring& hole : polygon.holes) all += ring_text(hole, "innerBoundaryIs", height);
            all += "</Polygon>\n";
        }
        return "<MultiGeometry>" + all + "</MultiGeometry>";
    }

  private:
    [[nodiscard]] std::string ring_text(const Ring& ring, const char* element, double height) const {
        std::string places;
        for (std::size_t k = 0; k <= ring.size() && !ring.empty(); ++k) {  // the first place again at the end
            const PlanPoint p = to_degrees_(ring[k % ring.size()]);
            if (std::isfinite(p.x) && std::isfinite(p.y))
                places += fmt::format("{:.7f},{:.7f},{:g} ", p.x, p.y, height);
        }
        return fmt::format("<{0}><LinearRing><coordinates>{1}</coordinates></LinearRing></{0}>", element, places);
    }

    const geo::ToLongitudeLatitude& to_degrees_;
};

std::string placemark(const std::string& name, const std::string& description, const std::string& style,
                      const std::string& geometry) {
    return fmt::format(
        "<Placemark><name>{}</name><description>{}</description><styleUrl>#{}</styleUrl>{}</Placemark>\n", escape(name),
        escape(description), style, geometry);
}

std::string folder_text(const char* name, const std::string& content) {
    return fmt::format("<Folder><name>{}</name>\n{}</Folder>\n", name, content);
}

struct Part {
    std::string styles, folder;
};

Result<Part> inundation(const HazardMaps& maps, double least, const Geometry& geometry) {
    Grid<float> inside = maps.peak_depth;
    for (float& value : inside.values) value = value >= static_cast<float>(least) ? 1 : 0;
    TALUS_ASSIGN(const auto outlines, geo::class_outlines(inside, 1));
    std::string content;
    for (const geo::ClassOutline& outline : outlines) {
        content += placemark("Inundation", fmt::format("deeper than {:g} m: {:.0f} m2", least, outline.area),
                             "inundation", geometry.text(outline.polygons));
    }
    return Part{style_text("inundation", {20, 80, 140}, 3, {}, 0), folder_text("Inundation", content)};
}

/// Bands of equal arrival time in the colours of the map.
Result<Part> arrival(const HazardMaps& maps, const Geometry& geometry) {
    const auto& all = report::hazard_maps();
    const auto map = std::find_if(all.begin(), all.end(), [](const report::HazardMap& candidate) {
        return candidate.grid == &HazardMaps::arrival_time;
    });
    const report::Classes bands = report::even_classes(report::greatest(maps.arrival_time), map->ramp);
    Grid<float> classes = maps.arrival_time;
    for (float& value : classes.values) value = static_cast<float>(bands.of(value) + 1);
    TALUS_ASSIGN(const auto outlines, geo::class_outlines(classes, bands.breaks.size()));
    Part part;
    std::string content;
    for (const geo::ClassOutline& outline : outlines) {
        const std::size_t k = outline.number - 1;
        const std::string id = fmt::format("arrival_{}", k);
        const std::string name = k + 1 < bands.breaks.size()
                                     ? fmt::format("{} to {} s", bands.breaks[k], bands.breaks[k + 1])
                                     : fmt::format("after {} s", bands.breaks[k]);
        part.styles += style_text(id, bands.colours[k], 0.5, bands.colours[k], 150);
        content += placemark(name, "first arrival of debris since the release", id, geometry.text(outline.polygons));
    }
    part.folder = folder_text("Arrival", content);
    return part;
}

Part buildings_hit(const scene::Scene& scene, const observe::Observation& observation, const Geometry& geometry) {
    const report::IntensityGuideline& guideline = report::intensity_guideline(scene.spec.outputs.intensity_guideline);
    const report::Colour dark{60, 60, 60};
    Part part;
    part.styles = style_text("hit", dark, 1, {217, 217, 217}, 220);
    for (std::size_t k = 0; k < guideline.classes.size(); ++k) {
        part.styles += style_text(fmt::format("hit_{}", k), dark, 1, guideline.classes[k].colour, 220);
    }
    std::string content;
    for (std::size_t i = 0; i < scene.buildings.size() && i < observation.buildings.size(); ++i) {
        const observe::BuildingImpact& b = observation.buildings[i];
        if (!b.hit) continue;
        std::string text =
            fmt::format("hit after {:.0f} s, up to {:.1f} m deep at its walls, impact pressure {:.0f} kPa",
                        b.first_hit_time, b.peak_depth, b.peak_impact_pressure / 1e3);
        std::string style = "hit";
        if (const report::IntensityClass* intensity = guideline.class_of(b)) {
            text += ", intensity " + intensity->name;
            style = fmt::format("hit_{}", intensity - guideline.classes.data());
        }
        content +=
            placemark(b.name, text, style, geometry.text(scene.buildings[i].footprint, scene.buildings[i].height));
    }
    part.folder = folder_text("Buildings hit", content);
    return part;
}

}  // namespace

Status write_kml(const scene::Scene& scene, const run::RunResult& result, const std::filesystem::path& folder) {
    const auto to_degrees = geo::to_wgs84(scene.crs);
    if (!to_degrees) return {};  // a local system: nobody could place it on a globe
    const Geometry geometry(*to_degrees);
    const observe::Observation& observation = result.observation;
    TALUS_ASSIGN(const Part outline, inundation(observation.maps, scene.spec.outputs.arrival_depth, geometry));
    TALUS_ASSIGN(const Part bands, arrival(observation.maps, geometry));
    const Part hit = buildings_hit(scene, observation, geometry);
    return write_text_file(
        folder / "results.kml",
        fmt::format(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document>\n"
            "<name>{}</name>\n<description>{}</description>\n{}{}{}{}{}{}</Document></kml>\n",
            escape(title_of(scene, result)), escape(scene.spec.scene.description), outline.styles, bands.styles,
            hit.styles, hit.folder, outline.folder, bands.folder));
}

}  // namespace talus::products
