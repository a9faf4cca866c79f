// Where the maps lie in the whole terrain of the scene.
#include <cmath>

#include <fmt/format.h>

#include "core/try.hpp"
#include "report/image.hpp"
#include "report/map.hpp"
#include "report/number_text.hpp"
#include "report/relief.hpp"

namespace talus::report {

Result<Json> location_figure(const scene::Scene& scene, const MapContent& content) {
    const Extent area = map_frame(scene, content).area, terrain = scene.terrain.elevation().geometry.extent();
    constexpr double max_shown = 0.5;  // of the terrain: maps of so much of it say by themselves where they are
    if (area.width() * area.height() > max_shown * terrain.width() * terrain.height()) return Json();
    MapFrame frame;
    frame.area = terrain;
    frame.scale = std::min(620 / terrain.width(), 420 / terrain.height());

    const Grid<float> ground = crop(scene.terrain.elevation(), terrain, 700);
    TALUS_ASSIGN(auto relief, png_uri(hillshade(ground, terrain, 700 / std::max(terrain.width(), terrain.height()))));
    Svg svg;
    svg.open("clipPath", {{"id", "location-clip"}});
    svg.rect("", frame.left, frame.top, frame.width(), frame.height());
    svg.close("clipPath");
    svg.rect("no-data", frame.left, frame.top, frame.width(), frame.height());
    draw_image(svg, "", frame.left, frame.top, frame.width(), frame.height(), relief);
    double contour_interval = 0;
    svg.open("g", {{"clip-path", "url(#location-clip)"}});
    draw_contours(svg, scene, frame, contour_interval);
    const double left = frame.x(area.x_min), top = frame.y(area.y_max);
    svg.rect("location-case", left, top, area.width() * frame.scale, area.height() * frame.scale);
    svg.rect("location", left, top, area.width() * frame.scale, area.height() * frame.scale);
    svg.close("g");
    draw_frame(svg, scene, content, frame);

    const double x = frame.right() + 20;
    svg.rect("location", x + 2, frame.top + 3, 26, 13);
    svg.text("legend", x + 39, frame.top + 14, "Area of the maps");
    double y = frame.top + 20;
    if (contour_interval > 0) {
        svg.path("index-contour", fmt::format("M{} {}h30", coordinate(x), coordinate(y + 10)));
        svg.text("legend", x + 39, y + 14, fmt::format("Contours every {} m", coordinate(contour_interval)));
    }
    draw_scale(svg, frame, x, y + 40);
    const double width = x + MapFrame::key_width, height = std::max(frame.bottom() + 30, y + 110);
    return Json{{"svg", figure_svg(width, height, "Map: location", svg, 1.04 * width, print_width(frame))},
                {"ratio", print_ratio(frame)},
                {"print_width_mm", print_width(frame)}};
}

}  // namespace talus::report
