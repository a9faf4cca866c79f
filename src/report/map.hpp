#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "core/result.hpp"
#include "report/chart.hpp"
#include "report/hazard_map.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"

/// The report's maps: rasters as PNG, everything else as SVG on top, in the same coordinates.
namespace talus::report {

/// Places the part of the world that the maps show inside the SVG.
struct MapFrame {
    Extent area;                              ///< shown, world
    double left = 34, top = 8;                ///< SVG units
    double scale = 1;                         ///< SVG units per metre
    static constexpr double key_width = 196;  ///< of the column to the right with the legend

    [[nodiscard]] double width() const { return area.width() * scale; }
    [[nodiscard]] double height() const { return area.height() * scale; }
    [[nodiscard]] double right() const { return left + width(); }
    [[nodiscard]] double bottom() const { return top + height(); }
    [[nodiscard]] double x(double east) const { return left + (east - area.x_min) * scale; }
    [[nodiscard]] double y(double north) const { return top + (area.y_max - north) * scale; }
};

/// One map: its raster and its texts.
struct MapLayer {
    HazardMap style;
    const Grid<float>* grid = nullptr;  ///< SI; NaN: no value
    std::string tab;                    ///< "Peak depth"
    std::string caption;                ///< a sentence
    int digits = 2;                     ///< of values
    std::string legend{};               ///< over the classes of a map without a measure
    std::string group{};                ///< begins the tabs of maps that belong together; empty: none
};

/// How the maps' buildings are coloured: classes 0 (not at all) to 3.
struct BuildingMarks {
    std::string title;                       ///< over the classes in the key
    std::array<std::string, 4> class_names;  ///< from 0 up
    std::vector<int> classes;                ///< as in Scene::buildings
    std::vector<std::string> titles;         ///< likewise; shown under the pointer
    std::vector<bool> removed;               ///< likewise, if any; removed during the run
};

/// The content common to all maps of a report.
struct MapContent {
    const Grid<float>* reached = nullptr;  ///< has a value wherever debris came
    double farthest_chainage = 0;          ///< m, of any front; NaN: none
    double cell = 0;                       ///< m
    BuildingMarks buildings;
    std::vector<MapLayer> layers;
    std::shared_ptr<const Grid<float>> made{};  ///< the grid of a layer that the maps alone have
    std::string beyond_limits{};                ///< said on every map; empty: nothing is
    std::optional<Polygon> zoom{};              ///< all results are of this area
};

/// The maps of a single run. `result` must outlive them.
[[nodiscard]] MapContent map_content(const scene::Scene& scene, const run::RunResult& result);

/// The area of interest: the ground reached by debris, the releases, the flow path (to 20 % beyond the run-out and the
/// last observation), the buildings hit, and a margin, kept within the terrain. Of a zoom: its area.
[[nodiscard]] MapFrame map_frame(const scene::Scene& scene, const MapContent& content);

/// Data of the template `maps`: `definitions`, a hidden <svg> with the shared parts of all maps; `layers`, one per map;
/// `read_out` for the page's script: position and values of the maps. And `contour_interval`, m. Errors: a picture
/// could not be encoded.
[[nodiscard]] Result<Json> map_figures(const scene::Scene& scene, const MapContent& content);

/// Data of the template `zones`: zones and beds over the relief of the maps. Null where there are none. Errors: a
/// picture could not be encoded.
[[nodiscard]] Result<Json> zone_figure(const scene::Scene& scene, const MapContent& content, double contour_interval);

/// Impact class of a building: 0 not hit, 1 below 15 kPa, 2 to 30 kPa, 3 above. The limits are those between slight,
/// extensive and complete damage to buildings not of reinforced concrete (Kang & Kim 2014).
[[nodiscard]] int impact_class(const observe::BuildingImpact& impact);

/// The terrain with the area of the maps in it, as the template shows it. Null where the maps show most of it.
/// Errors: a picture could not be encoded.
[[nodiscard]] Result<Json> location_figure(const scene::Scene& scene, const MapContent& content);

/// The scale of a map on A4 paper, 1 : ratio, a round one at which map and key fit beside the margins; and how wide map
/// and key then are, mm. report.css prints them so.
[[nodiscard]] double print_ratio(const MapFrame& frame);
[[nodiscard]] double print_width(const MapFrame& frame);

// The parts of the drawing that all maps share.
void draw_contours(Svg& svg, const scene::Scene& scene, const MapFrame& frame, double& interval);
void draw_vectors(Svg& svg, const scene::Scene& scene, const MapContent& content, const MapFrame& frame);
void draw_frame(Svg& svg, const scene::Scene& scene, const MapContent& content, const MapFrame& frame);
void draw_key(Svg& svg, const scene::Scene& scene, const MapContent& content, const MapFrame& frame,
              double contour_interval);
/// Scale bar, scale on paper and north; (x, y) is its upper left corner.
void draw_scale(Svg& svg, const MapFrame& frame, double x, double y);
/// A picture over an area of the frame, cut where the frame ends.
void draw_image(Svg& svg, std::string_view css_class, double x, double y, double width, double height,
                std::string_view uri);
/// A class of the key, (x, y) being its upper left corner.
void draw_swatch(Svg& svg, double x, double y, const Colour& colour);

/// Height of what draw_key draws, SVG units.
[[nodiscard]] double key_height(const scene::Scene& scene, const MapContent& content);

}  // namespace talus::report
