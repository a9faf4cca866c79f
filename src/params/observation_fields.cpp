#include "params/declaration.hpp"

namespace talus::params {
namespace {

/// The keys that every kind of observation has.
template <class Struct>
void add_name(Declaration<Struct>& s) {
    s.text("name", &Struct::name, "none", "Label in plots and tables.");
}
template <class Struct>
void add_source(Declaration<Struct>& s) {
    s.text("source", &Struct::source, "none", "Who measured it and how.");
}
template <class Struct>
void add_chainage(Declaration<Struct>& s) {
    s.key("chainage_m", "m", &Struct::chainage, between(0, 1e6),
          "Horizontal distance along the flow path from its first point.")
        .required = true;
}
template <class Struct>
void add_place(Declaration<Struct>& s) {
    s.key("x_m", "m", &Struct::x, between(-1e9, 1e9), "East coordinate in the terrain's reference system.").required =
        true;
    s.key("y_m", "m", &Struct::y, between(-1e9, 1e9), "North coordinate in the terrain's reference system.").required =
        true;
}

Section declare_observation() {
    Declaration<ObservationSpec> s("observation",
                                   "A velocity measured in the field, drawn next to the computed one; any number.",
                                   &SceneSpec::observations);
    add_name(s);
    add_chainage(s);
    s.optional_key("front_velocity_mps", "m/s", &ObservationSpec::front_velocity, between(0.001, 1000),
                   "debris_speed_mps is given", "Velocity of the front here, as arrivals along the path give it.");
    s.optional_key("debris_speed_mps", "m/s", &ObservationSpec::debris_speed, between(0.001, 1000),
                   "front_velocity_mps is given",
                   "Speed of the debris as it came through here, as superelevation marks or run-up give it.");
    s.exactly_one_of({"front_velocity_mps", "debris_speed_mps"});
    add_source(s);
    s.optional_key("uncertainty_mps", "m/s", &ObservationSpec::uncertainty, between(0.001, 1e6), "a fifth of the value",
                   "Standard deviation of the value.");
    return s.take();
}

Section declare_superelevation() {
    Declaration<SuperelevationSpec> s("superelevation",
                                      "Marks on both sides of a bend: speed of the debris = sqrt(9.81 x bend radius x "
                                      "level difference / (correction factor x width)).",
                                      &SceneSpec::superelevations);
    add_name(s);
    add_chainage(s);
    s.key("bend_radius_m", "m", &SuperelevationSpec::bend_radius, between(0.01, 1e5),
          "Radius of the path's centre line in plan.")
        .required = true;
    s.key("width_m", "m", &SuperelevationSpec::width, between(0.01, 1e5),
          "Width of the flow between the marks in plan.")
        .required = true;
    s.key("level_difference_m", "m", &SuperelevationSpec::level_difference, between(0.001, 1e4),
          "Height of the outer mark above the inner one.")
        .required = true;
    s.key("correction_factor", "", &SuperelevationSpec::correction_factor, between(0.1, 20),
          "For viscosity and sorting in the bend; 1 is a frictionless fluid, and published values for debris go to 5.");
    s.optional_key("uncertainty_mps", "m/s", &SuperelevationSpec::uncertainty, between(0.001, 1e6),
                   "a quarter of the velocity", "Standard deviation of the velocity.");
    add_source(s);
    return s.take();
}

Section declare_arrival() {
    Declaration<ArrivalSpec> s("arrival", "When debris first came to a chainage.", &SceneSpec::arrivals);
    add_name(s);
    add_chainage(s);
    s.key("time_s", "s", &ArrivalSpec::time, between(0.001, 1e7), "Time since the release.").required = true;
    s.optional_key("uncertainty_s", "s", &ArrivalSpec::uncertainty, between(0.001, 1e6), "a fifth of the time",
                   "Standard deviation of the time.");
    add_source(s);
    return s.take();
}

Section declare_run_up() {
    Declaration<RunUpSpec> s("run_up", "A mark of how high debris stood at a place.", &SceneSpec::run_ups);
    add_name(s);
    add_place(s);
    s.key("height_m", "m", &RunUpSpec::height, between(0, 1e4), "Height of the mark above the ground at that place.")
        .required = true;
    s.key("uncertainty_m", "m", &RunUpSpec::uncertainty, between(0.001, 1e6), "Standard deviation of the height.");
    add_source(s);
    return s.take();
}

Section declare_deposit_depth() {
    Declaration<DepositDepthSpec> s("deposit_depth", "What debris left at a place.", &SceneSpec::deposit_depths);
    add_name(s);
    add_place(s);
    s.key("depth_m", "m", &DepositDepthSpec::depth, between(0, 1e4), "Vertical depth of the deposit; 0: none.")
        .required = true;
    s.key("uncertainty_m", "m", &DepositDepthSpec::uncertainty, between(0.001, 1e6),
          "Standard deviation of the depth.");
    add_source(s);
    return s.take();
}

Section declare_damage() {
    Declaration<DamageSpec> s("damage", "A building that was damaged, or that was not.", &SceneSpec::damages);
    s.text("building", &DamageSpec::building, "", "Name of the building.").required = true;
    s.key("damaged", "", &DamageSpec::damaged, anything(), "Whether it was damaged.");
    s.key("pressure_Pa", "Pa", &DamageSpec::pressure, between(1, 1e12),
          "Impact pressure (outputs.impact_patch_edge_m) from which such a building is damaged.");
    s.key("uncertainty_Pa", "Pa", &DamageSpec::uncertainty, between(1, 1e12), "Standard deviation of that limit.");
    add_source(s);
    return s.take();
}

Section declare_run_out() {
    Declaration<ObservedRunOutSpec> s("observed_run_out", "The farthest chainage that the front came to, as observed.",
                                      &SceneSpec::observed_run_outs);
    add_name(s);
    add_chainage(s);
    s.key("uncertainty_m", "m", &ObservedRunOutSpec::uncertainty, between(0.001, 1e6),
          "Standard deviation of the chainage.");
    add_source(s);
    return s.take();
}

void add_outline(Declaration<OutlineSpec>& s, const char* depth_help) {
    add_name(s);
    s.path("file", &OutlineSpec::file, "", "Polygons: GeoJSON, GeoPackage, Shapefile.").required = true;
    s.text("layer", &OutlineSpec::layer, "the only layer", "Layer of the file.");
    s.key("depth_m", "m", &OutlineSpec::depth, between(0, 1e4), depth_help);
    s.key("uncertainty", "", &OutlineSpec::uncertainty, above_to(0, 1), "Standard deviation of that share.");
    add_source(s);
}

Section declare_deposit_outline() {
    Declaration<OutlineSpec> s("deposit_outline",
                               "The edge of the deposit. The prediction is the area that outline and computed "
                               "deposit share over the area that either covers; 1 is perfect.",
                               &SceneSpec::deposit_outlines);
    add_outline(s, "Thinner computed deposit does not count.");
    return s.take();
}

Section declare_affected_area() {
    Declaration<OutlineSpec> s("affected_area",
                               "The edge of all that debris covered, with its release. The prediction is the area that "
                               "outline and computed trail share over the area that either covers; 1 is perfect.",
                               &SceneSpec::affected_areas);
    add_outline(s, "Places with a smaller peak depth do not count.");
    return s.take();
}

Section declare_elevation_change() {
    Declaration<ElevationChangeSpec> s("elevation_change",
                                       "A DEM of difference: elevation after the event minus before. The prediction is "
                                       "its agreement with computed deposit minus erosion outside the releases: 1 is "
                                       "perfect, 0 is no overlap.",
                                       &SceneSpec::elevation_changes);
    add_name(s);
    s.path("file", &ElevationChangeSpec::file, "", "Raster of the change in m, deposit positive.").required = true;
    s.key("detection_limit_m", "m", &ElevationChangeSpec::detection_limit, between(0, 1e4),
          "Smaller changes count as none, observed and computed.");
    s.key("uncertainty", "", &ElevationChangeSpec::uncertainty, above_to(0, 1), "Standard deviation of the agreement.");
    add_source(s);
    return s.take();
}

}  // namespace

std::vector<Section> declare_observations() {
    return {declare_observation(),   declare_superelevation(),  declare_arrival(), declare_run_up(),
            declare_deposit_depth(), declare_damage(),          declare_run_out(), declare_deposit_outline(),
            declare_affected_area(), declare_elevation_change()};
}

}  // namespace talus::params
