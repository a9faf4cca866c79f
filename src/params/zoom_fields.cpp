// Gauges, cross-sections, and the zoom of the depth-averaged model into particles.
#include <fmt/format.h>

#include "params/declaration.hpp"

namespace talus::params {

Section declare_gauge() {
    Declaration<GaugeSpec> s("gauge",
                             "A place at which depth and speed of the debris are recorded over time, with both models; "
                             "any number.",
                             &SceneSpec::gauges);
    s.text("name", &GaugeSpec::name, "\"gauge N\"", "Name in reports and tables.");
    s.optional_key("x_m", "m", &GaugeSpec::x, between(-1e9, 1e9), "chainage_m is given",
                   "East coordinate in the terrain's reference system.");
    s.optional_key("y_m", "m", &GaugeSpec::y, between(-1e9, 1e9), "chainage_m is given",
                   "North coordinate in the terrain's reference system.");
    s.optional_key("chainage_m", "m", &GaugeSpec::chainage, between(0, 1e6), "x_m and y_m are given",
                   "Horizontal distance along the flow path from its first point: the gauge is on the path.");
    s.exactly_one_of({"x_m", "chainage_m"});
    s.rule([](const GaugeSpec& gauge, const SceneSpec&, double) -> std::optional<Violation> {
        if (gauge.x.has_value() == gauge.y.has_value()) return {};
        return gauge.x ? Violation{"y_m", ": missing; x_m needs it"}
                       : Violation{"y_m", ": is refused without x_m, beside chainage_m"};
    });
    return s.take();
}

Section declare_cross_section() {
    Declaration<CrossSectionSpec> s("cross_section",
                                    "A line across which the discharge of debris is recorded over time, with both "
                                    "models; any number. What passes from its left to its right is positive, seen from "
                                    "its first place to its last.",
                                    &SceneSpec::cross_sections);
    s.text("name", &CrossSectionSpec::name, "\"section N\"", "Name in reports and tables.");
    s.key("line_m", "m", &CrossSectionSpec::line, anything(),
          "Places along the line in plan, two or more, in the terrain's reference system.");
    s.path("file", &CrossSectionSpec::file, "line_m is given",
           "The line in a file, or several, each a cross-section named by its attribute \"name\": GeoJSON, GeoPackage, "
           "Shapefile.");
    s.text("layer", &CrossSectionSpec::layer, "the only layer", "Layer of file.");
    s.key("interval_s", "s", &CrossSectionSpec::interval, between(0.01, 1e6),
          "Simulated time over which discharge is averaged, between rows of discharge.csv.");
    s.exactly_one_of({"line_m", "file"});
    return s.take();
}

Section declare_zoom() {
    const ZoomSpec usual;
    Declaration<ZoomSpec> s(
        "zoom",
        "Particles in one area only: the depth-averaged model runs the event, and what crosses the "
        "area's boundary becomes inflow of particles (docs/depth-averaged.md). Without an area there "
        "is no zoom.",
        &SceneSpec::zoom);
    s.text("structure", &ZoomSpec::structure, "no zoom, or another area",
           "Name of a building or barrier; the area is the rectangle around it.");
    s.key("margin_m", "m", &ZoomSpec::margin, between(0.1, 1e4), "From the structure to the boundary of the area.");
    s.key("polygon_m", "m", &ZoomSpec::polygon, anything(),
          "The corners of the area in plan, in the terrain's reference system.");
    s.path("polygon_file", &ZoomSpec::polygon_file, "no zoom, or another area",
           "The area in a file, one polygon without holes: GeoJSON, GeoPackage, Shapefile.");
    s.text("layer", &ZoomSpec::layer, "the only layer", "Layer of polygon_file.");
    s.at_most_one_of({"structure", "polygon_m", "polygon_file"});
    s.optional_key("particle_spacing_m", "m", &ZoomSpec::particle_spacing, between(1e-4, 100),
                   "from target_layers, or that of the solver section", "Spacing of the particles in the zoom.");
    s.optional_key("target_layers", "", &ZoomSpec::target_layers, between(1, 1000), "from particle_spacing_m",
                   "Particles over the greatest thickness, normal to the slope, with which debris crosses the boundary "
                   "in the depth-averaged model.");
    s.at_most_one_of({"particle_spacing_m", "target_layers"});
    s.key("surroundings_m", "m", &ZoomSpec::surroundings, between(0, 1e4),
          "How far beyond the boundary particles are computed on; farther out they are removed.");
    s.for_particles_only();
    s.rule([usual](const ZoomSpec& zoom, const SceneSpec&, double) -> std::optional<Violation> {
        if (zoom.structure.empty() && zoom.margin != usual.margin) {
            return Violation{"margin_m", ": needs structure; it is the distance from that to the boundary"};
        }
        if (!zoom.polygon.empty() && zoom.polygon.size() < 3) {
            return Violation{"polygon_m",
                             fmt::format(": has {} corners; an area needs three or more", zoom.polygon.size())};
        }
        const char* without_area = zoom.wanted()                             ? nullptr
                                   : zoom.particle_spacing                   ? "particle_spacing_m"
                                   : zoom.target_layers                      ? "target_layers"
                                   : zoom.surroundings != usual.surroundings ? "surroundings_m"
                                                                             : nullptr;
        if (without_area == nullptr) return {};
        return Violation{without_area, ": needs an area; give structure, polygon_m or polygon_file"};
    });
    return s.take();
}

}  // namespace talus::params
