#include "report/map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/try.hpp"
#include "report/colour.hpp"
#include "report/hazard_map.hpp"
#include "report/image.hpp"
#include "report/intensity.hpp"
#include "report/number_text.hpp"
#include "report/relief.hpp"
#include "report/rows.hpp"

namespace talus::report {
namespace {

double largest(const Grid<float>& grid) {
    double most = std::numeric_limits<double>::quiet_NaN();
    for (const float v : grid.values) {
        if (!std::isnan(v) && !(v <= most)) most = v;
    }
    return most;
}

double smallest(const Grid<float>& grid) {
    double least = std::numeric_limits<double>::quiet_NaN();
    for (const float v : grid.values) {
        if (!std::isnan(v) && !(v >= least)) least = v;
    }
    return least;
}

/// Under a map's name: what its classes are of.
std::string measure_text(const MapLayer& shown, double most) {
    const HazardMap& layer = shown.style;
    if (!layer.categories.empty()) return shown.legend;
    if (!std::isfinite(most)) return layer.unit;
    const std::string upper = fixed(most, shown.digits);
    if (layer.colours.empty()) return fmt::format("{}, at most {} {}", layer.unit, upper, layer.unit);
    return fmt::format("{}, from {} to {}", layer.unit, fixed(smallest(*shown.grid) * layer.factor, shown.digits),
                       upper);
}

/// Classes of a layer over its part inside the frame, finer than its cells: values are interpolated between them.
ClassImage paint(const HazardMap& layer, const Grid<float>& map, const Classes& classes) {
    const GridGeometry& g = map.geometry;
    const int longest = std::max(g.columns, g.rows);
    const int finer = std::clamp(1200 / std::max(1, longest), 1, 8);
    ClassImage image{g.columns * finer, g.rows * finer, {}, classes.colours};
    image.pixels.resize(static_cast<std::size_t>(image.width) * image.height);
    const double pixel = g.cell / finer, north = g.y_min + g.rows * g.cell;
    for_rows(image.height, [&](int y) {
        std::uint8_t* out = &image.pixels[static_cast<std::size_t>(image.width) * y];
        for (int x = 0; x < image.width; ++x) {
            const PlanPoint at{g.x_min + (x + 0.5) * pixel, north - (y + 0.5) * pixel};
            const double v = layer.categories.empty() ? interpolate(map, at) : value_at(map, at);
            *out++ = static_cast<std::uint8_t>(classes.of(v * layer.factor) + 1);
        }
    });
    return image;
}

struct ReadOut {
    ValueImage image;
    double base = 0, resolution = 1;
};

/// Values in steps of a 65 534th of their range, for the page's script.
ReadOut read_out_of(const Grid<float>& grid, double factor) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const float v : grid.values) {
        if (std::isnan(v)) continue;
        low = std::min(low, v * factor);
        high = std::max(high, v * factor);
    }
    ReadOut out;
    if (low <= high) {
        out.base = low;
        // Centimetres are sufficient, and compress better than millimetres.
        out.resolution = std::max(0.01, (high - low) / 65000);
    }
    out.image.width = grid.geometry.columns;
    out.image.height = grid.geometry.rows;
    for (int r = grid.geometry.rows; r-- > 0;) {
        for (int c = 0; c < grid.geometry.columns; ++c) {
            const float v = grid.at(c, r);
            const long step = std::isnan(v) ? 0 : 1 + std::lround((v * factor - out.base) / out.resolution);
            out.image.pixels.insert(out.image.pixels.end(), {static_cast<std::uint8_t>(step >> 8 & 255),
                                                             static_cast<std::uint8_t>(step & 255), 0});
        }
    }
    return out;
}

nlohmann::json placed(const Grid<float>& grid, const ReadOut& values, const std::string& uri) {
    const GridGeometry& g = grid.geometry;
    return {{"values", uri},
            {"x_min", g.x_min},
            {"y_max", g.y_min + g.rows * g.cell},
            {"cell", g.cell},
            {"columns", g.columns},
            {"rows", g.rows},
            {"base", values.base},
            {"resolution", values.resolution}};
}

void draw_classes(Svg& svg, const MapLayer& shown, const Classes& classes, double most, const MapFrame& frame) {
    const HazardMap& layer = shown.style;
    const double x = frame.right() + 20;
    constexpr std::size_t wide = 22;  // letters that the column has room for
    svg.text(shown.tab.size() > wide ? "legend-title long" : "legend-title", x, frame.top + 13, shown.tab);
    svg.text("legend-unit", x, frame.top + 31, measure_text(shown, most));
    const std::size_t n = classes.breaks.size();
    for (std::size_t k = n; k-- > 0;) {
        const double y = frame.top + 44 + 18.0 * static_cast<double>(n - 1 - k);
        const auto limit = [](double value) { return (value < 0 ? "−" : "") + plain(std::abs(value)); };
        const std::string from = limit(classes.breaks[k]);
        const std::string text = !layer.categories.empty()       ? layer.categories[k].name
                                 : std::isinf(classes.breaks[k]) ? "below " + limit(classes.breaks[k + 1])
                                 : k + 1 < n ? fmt::format("{} – {}", from, limit(classes.breaks[k + 1]))
                                             : (n > 1 ? "over " : "from ") + from;
        draw_swatch(svg, x, y, classes.colours[k]);
        svg.text("legend", x + 39, y + 13.5, text);
    }
}

std::string building_title(const terrain::Building& building, const observe::BuildingImpact& impact) {
    std::string title = building.name.empty() ? kind_of(impact) : building.name;
    if (!std::isnan(impact.removed_time)) title += fmt::format(" (until {} s)", fixed(impact.removed_time, 1));
    if (!impact.hit) return title + ": not reached";
    return title + fmt::format(": {} kPa, first hit at {} s", significant(impact.peak_impact_pressure / 1e3, 3),
                               fixed(impact.first_hit_time, 1));
}

Classes classes_of(const HazardMap& layer, double most) {
    Classes classes;
    for (const Category& category : layer.categories) {
        classes.breaks.push_back(static_cast<double>(classes.breaks.size() + 1));
        classes.colours.push_back(category.colour);
    }
    if (!classes.breaks.empty()) return classes;
    if (!layer.colours.empty()) return {layer.breaks, layer.colours};
    if (layer.breaks.empty()) return even_classes(most, layer.ramp);
    return fixed_classes(layer.breaks, std::max(layer.full_scale, std::isnan(most) ? 0 : most), layer.ramp);
}

}  // namespace

int impact_class(const observe::BuildingImpact& impact) {
    if (!impact.hit) return 0;
    return impact.peak_impact_pressure < 15e3 ? 1 : impact.peak_impact_pressure < 30e3 ? 2 : 3;
}

MapContent map_content(const scene::Scene& scene, const run::RunResult& result) {
    const observe::Observation& observation = result.observation;
    MapContent content;
    content.reached = &observation.maps.peak_depth;
    content.farthest_chainage = observation.run_out.front_chainage;
    if (result.zoom) content.zoom = result.zoom->area;
    content.cell = result.map_cell > 0 ? result.map_cell : observation.maps.peak_depth.geometry.cell;
    const bool barriers = hits_among(observation.buildings, true).all > 0;
    content.buildings.title = barriers ? "Structures, impact pressure" : "Buildings, impact pressure";
    content.buildings.class_names = {"not reached", "hit, below 15 kPa", "hit, 15 – 30 kPa", "hit, over 30 kPa"};
    for (std::size_t i = 0; i < std::min(scene.buildings.size(), observation.buildings.size()); ++i) {
        const observe::BuildingImpact& impact = observation.buildings[i];
        content.buildings.classes.push_back(impact_class(impact));
        content.buildings.titles.push_back(building_title(scene.buildings[i], impact));
        content.buildings.removed.push_back(!std::isnan(impact.removed_time));
    }
    for (const HazardMap& map : hazard_maps()) {
        content.layers.push_back({map, &(observation.maps.*map.grid), map.tab, map.caption, map.digits});
    }
    const IntensityGuideline& guideline = intensity_guideline(scene.spec.outputs.intensity_guideline);
    content.made = std::make_shared<const Grid<float>>(intensity_map(guideline, observation.maps));
    content.layers.push_back({intensity_style(guideline), content.made.get(), "Intensity",
                              "Classes of intensity by peak depth and peak speed at each place; see Intensity below.",
                              0, guideline.name});
    if (!observation.erosion.depth.values.empty()) {
        content.layers.push_back({erosion_map(), &observation.erosion.depth, "Erosion",
                                  "Depth that debris entrained from the bed, measured vertically, on the cells of the "
                                  "terrain, which sank by it.",
                                  2});
    }
    return content;
}

void draw_image(Svg& svg, std::string_view css_class, double x, double y, double width, double height,
                std::string_view uri) {
    svg.add("image", {{"class", css_class},
                      {"x", x},
                      {"y", y},
                      {"width", width},
                      {"height", height},
                      {"preserveAspectRatio", "none"},
                      {"href", uri}});
}

void draw_swatch(Svg& svg, double x, double y, const Colour& colour) {
    svg.rect("swatch-base", x, y, 30, 18);
    svg.rect("swatch layer", x, y, 30, 18, colour.hex());
}

namespace {

Svg::Attribute clip() {
    return {"clip-path", "url(#map-clip)"};
}

/// Elements shared by all maps, referenced by id.
std::string definitions(const scene::Scene& scene, const MapContent& content, const MapFrame& frame,
                        const std::string& relief, double key_top, double& contour_interval) {
    Svg svg;
    svg.open("svg", {{"class", "definitions"}, {"width", 0.0}, {"height", 0.0}, {"aria-hidden", "true"}});
    svg.open("defs", {});
    svg.open("clipPath", {{"id", "map-clip"}});
    svg.rect("", frame.left, frame.top, frame.width(), frame.height());
    svg.close("clipPath");
    svg.open("g", {{"id", "map-base"}, clip()});
    svg.rect("no-data", frame.left, frame.top, frame.width(), frame.height());
    draw_image(svg, "", frame.left, frame.top, frame.width(), frame.height(), relief);
    svg.close("g");
    svg.open("g", {{"id", "map-over"}});
    svg.open("g", {clip()});
    draw_contours(svg, scene, frame, contour_interval);
    draw_vectors(svg, scene, content, frame);
    svg.close("g");
    draw_frame(svg, scene, content, frame);
    svg.close("g");
    svg.open("g", {{"id", "map-key"}, {"transform", translation(0, key_top)}});
    draw_key(svg, scene, content, frame, contour_interval);
    svg.close("g");
    svg.close("defs");
    svg.close("svg");
    return svg.str();
}

}  // namespace

namespace {

/// A layer's pictures, which take most of the time of a report: for the eye, and the values for the page's script.
struct LayerPictures {
    std::string classes;                     ///< as a URI
    Extent extent;                           ///< of the picture
    std::unique_ptr<nlohmann::json> placed;  ///< the values, and where they lie
};

Result<LayerPictures> pictures_of(const MapLayer& shown, const MapFrame& frame, const Classes& classes) {
    const HazardMap& layer = shown.style;
    const bool classed = !layer.categories.empty();  // classes have no mean
    const Grid<float> part = crop(*shown.grid, frame.area, classed ? 1 << 20 : 1200);
    LayerPictures pictures;
    pictures.extent = part.geometry.extent();
    TALUS_ASSIGN(pictures.classes, png_uri(paint(layer, part, classes)));
    const Grid<float> coarse = classed ? part : crop(*shown.grid, frame.area, 500);
    const ReadOut values = read_out_of(coarse, layer.factor);
    TALUS_ASSIGN(const std::string uri, png_uri(values.image));
    pictures.placed = std::make_unique<nlohmann::json>(placed(coarse, values, uri));
    return Result<LayerPictures>(std::move(pictures));
}

/// Of every layer that has a value; nothing for the others.
std::vector<std::optional<Result<LayerPictures>>> all_pictures(const MapContent& content, const MapFrame& frame) {
    std::vector<std::optional<Result<LayerPictures>>> all(content.layers.size());
    simd::parallel_ranges(all.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            const MapLayer& shown = content.layers[k];
            const double most = largest(*shown.grid) * shown.style.factor;
            if (std::isfinite(most)) all[k] = pictures_of(shown, frame, classes_of(shown.style, most));
        }
    });
    return all;
}

}  // namespace

Result<Json> map_figures(const scene::Scene& scene, const MapContent& content) {
    const MapFrame frame = map_frame(scene, content);
    const Grid<float> ground = crop(scene.terrain.elevation(), frame.area, 900);
    const double pixels_per_metre = 1150 / std::max(frame.area.width(), frame.area.height());
    TALUS_ASSIGN(auto relief, png_uri(hillshade(ground, frame.area, pixels_per_metre)));

    const double width = frame.right() + 20 + MapFrame::key_width;
    std::size_t max_classes = 0;
    for (const MapLayer& layer : content.layers) {
        const double most = largest(*layer.grid) * layer.style.factor;
        max_classes = std::max(max_classes, classes_of(layer.style, most).breaks.size());
    }
    const double key_top = frame.top + 44 + 18.0 * static_cast<double>(max_classes) + 14;
    const double height = std::max(frame.bottom() + 30, key_top + key_height(scene, content));

    double contour_interval = 0;
    Json out = {{"definitions", definitions(scene, content, frame, relief, key_top, contour_interval)},
                {"layers", Json::array()}};
    out["contour_interval"] = contour_interval;
    out["ratio"] = print_ratio(frame);
    out["print_width_mm"] = print_width(frame);

    const Grid<float> coarse_ground = crop(scene.terrain.elevation(), frame.area, 260);
    const ReadOut ground_values = read_out_of(coarse_ground, 1);
    TALUS_ASSIGN(auto ground_uri, png_uri(ground_values.image));
    nlohmann::json page = {{"left", frame.left},
                           {"top", frame.top},
                           {"width", frame.width()},
                           {"height", frame.height()},
                           {"x_min", frame.area.x_min},
                           {"y_max", frame.area.y_max},
                           {"scale", frame.scale},
                           {"ground", placed(coarse_ground, ground_values, ground_uri)},
                           {"layers", nlohmann::json::array()}};

    auto pictures = all_pictures(content, frame);
    for (std::size_t k = 0; k < content.layers.size(); ++k) {
        const MapLayer& shown = content.layers[k];
        const HazardMap& layer = shown.style;
        const Grid<float>& map = *shown.grid;
        const double most = largest(map) * layer.factor;
        const Classes classes = classes_of(layer, most);
        Svg picture;
        picture.add("use", {{"href", "#map-base"}});
        if (pictures[k]) {
            TALUS_ASSIGN(LayerPictures made, std::move(*pictures[k]));
            const Extent& e = made.extent;
            picture.open("g", {clip()});
            draw_image(picture, "layer", frame.x(e.x_min), frame.y(e.y_max), e.width() * frame.scale,
                       e.height() * frame.scale, made.classes);
            picture.close("g");
            nlohmann::json entry = std::move(*made.placed);
            entry["id"] = layer.file;
            entry["name"] = shown.tab;
            entry["unit"] = layer.unit;
            entry["digits"] = shown.digits;
            for (const Category& category : layer.categories) entry["classes"].push_back(category.name);
            page["layers"].push_back(std::move(entry));
        }
        picture.add("use", {{"href", "#map-over"}});
        draw_classes(picture, shown, classes, most, frame);
        picture.add("use", {{"href", "#map-key"}});
        out["layers"].push_back(
            {{"file", layer.file},
             {"name", shown.tab},
             {"group", shown.group},
             {"svg", figure_svg(width, height, "Map: " + shown.tab, picture, 1.04 * width, print_width(frame))},
             {"about", shown.caption},
             {"classed", !layer.categories.empty()},
             {"cell", map.values.empty() ? content.cell : map.geometry.cell}});
    }
    std::string read_out = page.dump();
    // Inside a script element only "<" could end it; JSON may write it as an escape.
    for (std::size_t at = 0; (at = read_out.find('<', at)) != std::string::npos;) read_out.replace(at, 1, "\\u003c");
    out["read_out"] = std::move(read_out);
    return out;
}

}  // namespace talus::report
