// Sources of debris: releases, inflows, beds.
#include <cmath>

#include <fmt/format.h>

#include "params/declaration.hpp"

namespace talus::params {

namespace {

std::optional<Violation> lone_solid_fraction(const std::optional<double>& fraction, const SceneSpec& scene) {
    if (!fraction || scene.material.pore_pressure == PorePressure::dilatancy) return {};
    return Violation{"solid_fraction",
                     fmt::format(" = {} has no effect while material.pore_pressure = \"prescribed\"; set "
                                 "material.pore_pressure = \"dilatancy\" or leave it out",
                                 *fraction)};
}

}  // namespace

Section declare_release() {
    Declaration<ReleaseSpec> s("release",
                               "A body of debris that starts to move at one moment; a scene needs one, or an inflow.",
                               &SceneSpec::releases);
    s.text("name", &ReleaseSpec::name, "\"release N\"", "Name in reports and messages.");
    s.path("file", &ReleaseSpec::file, "the outline of thickness_raster where that is above 0",
           "Polygons of the release area: GeoJSON, GeoPackage, Shapefile.");
    s.text("layer", &ReleaseSpec::layer, "the only layer", "Layer of the file.");
    s.optional_key("thickness_m", "m", &ReleaseSpec::thickness, between(0.001, 1000), "one of the other three is given",
                   "Uniform thickness.")
        .live_in({.label = "Thickness", .slider_low = 0.1, .slider_high = 10, .first = 1.5})
        .also_called({"rel_th", "release_thickness", "release_depth", "d0"});
    s.text("thickness_attribute", &ReleaseSpec::thickness_attribute, "one of the other three is given",
           "Attribute of the polygons that holds their thickness in metres, or text with its unit such as '5 ft'.");
    s.path("thickness_raster", &ReleaseSpec::thickness_raster, "one of the other three is given",
           "Raster of thickness in metres, in the terrain's reference system (GeoTIFF, .asc); without file it is the "
           "release area too.");
    s.choice("thickness_direction", &ReleaseSpec::thickness_direction, {"normal", "vertical"},
             "Whether thickness is measured normal to the slope or vertically, as a difference of elevations is.")
        .assumes("Direction in which the release's thickness is measured");
    s.optional_key("volume_m3", "m3", &ReleaseSpec::volume, between(1e-6, 1e12), "one of the other three is given",
                   "Volume to release, spread as a uniform thickness over the polygons.")
        .also_called({"release_volume", "V0"});
    s.key("start_time_s", "s", &ReleaseSpec::start_time, between(0, 1e7),
          "When the body starts to move; until then it is held in place.");
    s.key("shift_along_m", "m", &ReleaseSpec::shift_along, between(-1e5, 1e5),
          "How far its polygons, with the raster of their thickness, are moved in plan down the mean slope under them; "
          "negative: uphill. For places that are not known well.");
    s.key("shift_across_m", "m", &ReleaseSpec::shift_across, between(-1e5, 1e5),
          "The same across that slope: to the left as seen looking downhill; negative: to the right.");
    s.optional_key("pore_pressure_ratio", "", &ReleaseSpec::pore_pressure_ratio, between(0, 1), "that of the material",
                   "Pore-pressure ratio r_u of this body when it starts.")
        .needs(stress());
    s.path(
         "pore_pressure_hydrograph", &ReleaseSpec::pore_pressure_hydrograph, "no water rises",
         "CSV with the columns time_s and pore_pressure_ratio, of water that rises in this body until it fails; linear "
         "between rows, as in the first before it and in the last after it.")
        .needs(stress())
        .refused_by_depth_averaged("has no debris that waits for water to rise");
    s.optional_key("solid_fraction", "", &ReleaseSpec::solid_fraction, between(0.4, 0.75), "that of the material",
                   "Share of this body's volume that grains fill when it starts, with material.pore_pressure = "
                   "\"dilatancy\".");
    s.rule([](const ReleaseSpec& release, const SceneSpec& scene, double) -> std::optional<Violation> {
        return lone_solid_fraction(release.solid_fraction, scene);
    });
    s.rule([](const ReleaseSpec& release, const SceneSpec&, double) -> std::optional<Violation> {
        if (release.pore_pressure_hydrograph.empty() || !release.pore_pressure_ratio) return {};
        return Violation{
            "pore_pressure_ratio",
            fmt::format(" = {} is refused beside pore_pressure_hydrograph, which says what the ratio is at "
                        "any time; leave one of them out",
                        *release.pore_pressure_ratio)};
    });
    s.exactly_one_of({"thickness_m", "thickness_attribute", "thickness_raster", "volume_m3"}, "file");
    s.rule([](const ReleaseSpec& release, const SceneSpec& scene, double) -> std::optional<Violation> {
        // A release that a user draws waits until it is triggered: it has no start time of its own.
        if (release.start_time < scene.solver.end_time || std::isinf(release.start_time)) return {};
        return Violation{"start_time_s", fmt::format(" = {} is refused; it must be below solver.end_time_s = {}",
                                                     release.start_time, scene.solver.end_time)};
    });
    return s.take();
}

Section declare_bed() {
    Declaration<BedSpec> s("bed", "Loose material on the ground that debris entrains where it moves over it.",
                           &SceneSpec::beds);
    s.text("name", &BedSpec::name, "\"bed N\"", "Name in reports and messages.");
    s.path("file", &BedSpec::file, "it lies everywhere", "Polygons of the bed: GeoJSON, GeoPackage, Shapefile.");
    s.text("layer", &BedSpec::layer, "the only layer", "Layer of the file.");
    s.optional_key("depth_m", "m", &BedSpec::depth, above_to(0, 100), "one of the other two is given",
                   "Uniform depth of the bed, vertical; debris entrains no more.")
        .live_in({.label = "Depth", .slider_low = 0.1, .slider_high = 5.1, .first = 1});
    s.text("depth_attribute", &BedSpec::depth_attribute, "one of the other two is given",
           "Attribute of the polygons that holds their depth in metres, or text with its unit such as '5 ft'.");
    s.path("depth_raster", &BedSpec::depth_raster, "one of the other two is given",
           "Raster of depth in metres, in the terrain's reference system.");
    s.choice("law", &BedSpec::law, {"growth", "shear"},
             "How debris picks it up: growth adds a share of its volume per metre that it moves (McDougall & Hungr "
             "2005); shear goes by the shear stress on the bed (Frank et al. 2015).")
        .assumes("Law of erosion")
        .live_as();
    s.optional_key("growth_rate_per_m", "1/m", &BedSpec::growth_rate, above_to(0, 1),
                   "law = \"growth\" needs it, and law = \"shear\" does not have it",
                   "Share of its volume that debris entrains per metre: ln(volume after / volume before) over the "
                   "length of the bed.")
        .live_in({.label = "Growth rate", .slider_low = 0.0005, .slider_high = 0.0505, .first = 0.005});
    s.key("critical_shear_stress_Pa", "Pa", &BedSpec::critical_shear_stress, between(0, 1e7),
          "With law = \"shear\": less shear stress, rest density x gravity x depth x sine of the slope, entrains "
          "nothing.")
        .assumes("Critical shear stress of the bed")
        .live_in({.label = "Critical shear stress", .slider_low = 0, .slider_high = 5, .first = 1});
    s.key("erosion_rate_mps", "m/s", &BedSpec::erosion_rate, above_to(0, 10),
          "With law = \"shear\": how fast the bed is lowered.")
        .assumes("Rate of erosion")
        .live_in({.label = "Erosion rate", .slider_low = 0.001, .slider_high = 0.101, .first = 0.013});
    s.key("erosion_depth_mpPa", "m/Pa", &BedSpec::erosion_depth_per_shear, above_to(0, 1),
          "With law = \"shear\": how deep at most, per shear stress above the critical one.")
        .assumes("Depth of erosion per shear stress")
        .live_in({.label = "Erosion depth", .slider_low = 0.01, .slider_high = 1.01, .first = 0.05});
    s.exactly_one_of({"depth_m", "depth_attribute", "depth_raster"});
    s.rule([](const BedSpec& bed, const SceneSpec&, double) -> std::optional<Violation> {
        if (bed.depth_attribute.empty() || !bed.file.empty()) return {};
        return Violation{"depth_attribute", ": needs the polygons that have it; give file"};
    });
    s.rule([](const BedSpec& bed, const SceneSpec&, double) -> std::optional<Violation> {
        if (bed.law != EntrainmentLaw::growth || bed.growth_rate) return {};
        return Violation{
            "growth_rate_per_m",
            ": missing; law = \"growth\" needs it: ln(volume after / volume before) over the length of the "
            "bed, greater than 0 and at most 1 (1/m)"};
    });
    return s.take();
}

Section declare_inflow() {
    Declaration<InflowSpec> s("inflow",
                              "Inflow of debris during the run, any number of them: across a straight line, "
                              "at right angles to it and towards its right, or all over an area, such as a slope "
                              "that rain wears down.",
                              &SceneSpec::inflows);
    s.text("name", &InflowSpec::name, "\"inflow N\"", "Name in reports and messages.");
    s.key(
        "line_m", "m", &InflowSpec::line, anything(),
        "The two ends of the line in plan, in the terrain's reference system: first the one on the right-hand side of "
        "the debris that comes.");
    s.path("file", &InflowSpec::file, "another one is given", "The line in a file: GeoJSON, GeoPackage, Shapefile.");
    s.text("layer", &InflowSpec::layer, "the only layer", "Layer of file or polygon_file.");
    s.key("polygon_m", "m", &InflowSpec::polygon, anything(),
          "The corners of the area in plan, in the terrain's reference system.");
    s.path("polygon_file", &InflowSpec::polygon_file, "another one is given",
           "The area in a file, one polygon or more: GeoJSON, GeoPackage, Shapefile.");
    s.optional_key("direction_deg", "deg", &InflowSpec::direction, from_to_below(0, 360), "down the slope",
                   "Over an area: direction in which the debris flows in, clockwise from north.")
        .live_in({.label = "Clockwise from north",
                  .slider_low = 0,
                  .slider_high = 359,
                  .tick = "Set direction",
                  .tick_help = "Direction in which debris flows in; unticked: downhill"});
    s.path("hydrograph", &InflowSpec::hydrograph, "",
           "CSV with the columns time_s, discharge_m3ps (bulk debris), velocity_mps and, if its density changes, "
           "density_kgpm3; linear between rows, nothing before the first and after the last. Several surges are rows "
           "without discharge between them.")
        .required = true;
    s.optional_key("solid_fraction", "", &InflowSpec::solid_fraction, between(0.4, 0.75), "that of the material",
                   "Share of the volume that grains fill in what flows in, with material.pore_pressure = "
                   "\"dilatancy\".");
    s.rule([](const InflowSpec& inflow, const SceneSpec& scene, double) -> std::optional<Violation> {
        return lone_solid_fraction(inflow.solid_fraction, scene);
    });
    s.exactly_one_of({"line_m", "file", "polygon_m", "polygon_file"});
    s.rule([](const InflowSpec& inflow, const SceneSpec&, double) -> std::optional<Violation> {
        if (!inflow.direction || inflow.over_area()) return {};
        return Violation{"direction_deg", ": is refused across a line, which has a direction of its own"};
    });
    return s.take();
}

Section declare_hydrograph() {
    Declaration<InflowSample> s("hydrograph",
                                "A row of an inflow's hydrograph, a CSV of its own in a scene; linear between rows.",
                                &SceneSpec::hydrograph);
    s.key("time_s", "s", &InflowSample::time, between(0, 1e7), "Simulated time; above that of the row before.")
        .live_in({.label = "Time", .slider_low = 0, .slider_high = 60})
        .required = true;
    s.key("discharge_m3ps", "m3/s", &InflowSample::discharge, between(0, 1e7),
          "Bulk volume of debris that flows in per second.")
        .live_in({.label = "Discharge", .slider_low = 0, .slider_high = 50})
        .required = true;
    s.key("velocity_mps", "m/s", &InflowSample::velocity, between(0, 300),
          "Along the ground; above 0 where debris flows in across a line.")
        .live_in({.label = "Velocity", .slider_low = 0, .slider_high = 20})
        .required = true;
    Parameter& density = s.key("density_kgpm3", "kg/m3", &InflowSample::density, between(1, 30000),
                               "Bulk density of the inflow; in every row or in none.")
                             .live_in({.label = "Density", .slider_low = 1000, .slider_high = 2500, .first = 2000});
    density.absent = "the material's rest density";
    density.get = [get = density.get](const SceneSpec& spec, std::size_t row) {
        const ParameterValue value = get(spec, row);
        return std::get<double>(value) > 0 ? value : ParameterValue{};
    };
    density.set = [set = density.set](SceneSpec& spec, std::size_t row, const ParameterValue& value) {
        set(spec, row, std::holds_alternative<std::monostate>(value) ? ParameterValue{0.0} : value);
    };
    s.rule([](const InflowSample& row, const SceneSpec& scene, double) -> std::optional<Violation> {
        const std::vector<InflowSample>& rows = scene.hydrograph;
        const auto index = static_cast<std::size_t>(&row - rows.data());
        if (index == 0 || row.time > rows[index - 1].time) return {};
        return Violation{"time_s", fmt::format(" = {:.6g} is refused; it must be above that of the row before, {:.6g}",
                                               row.time, rows[index - 1].time)};
    });
    s.rule([](const InflowSample& row, const SceneSpec& scene, double) -> std::optional<Violation> {
        if ((row.density > 0) == (scene.hydrograph.front().density > 0)) return {};
        return Violation{"density_kgpm3", ": must be in every row or in none"};
    });
    s.rule([](const InflowSample& row, const SceneSpec& scene, double) -> std::optional<Violation> {
        if (row.discharge == 0 || row.velocity > 0 || scene.inflows.front().over_area()) return {};
        return Violation{
            "velocity_mps",
            fmt::format(" = {:.6g} is refused; it must be above 0 where there is discharge", row.velocity)};
    });
    return s.take();
}

}  // namespace talus::params
