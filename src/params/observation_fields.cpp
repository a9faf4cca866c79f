#include "params/declaration.hpp"

namespace talus {
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
    s.key("chainage_m", "m", &Struct::chainage, at_least(0),
          "Horizontal distance along the flow path from its first point.")
        .required = true;
}
template <class Struct>
void add_place(Declaration<Struct>& s) {
    s.key("x_m", "m", &Struct::x, anything(), "East coordinate in the terrain's reference system.").required = true;
    s.key("y_m", "m", &Struct::y, anything(), "North coordinate in the terrain's reference system.").required = true;
}

Section declare_observation() {
    Declaration<ObservationSpec> s("observation",
                                   "A front velocity measured in the field, drawn beside the computed one; any number.",
                                   &SceneSpec::observations);
    add_name(s);
    add_chainage(s);
    s.key("front_velocity_mps", "m/s", &ObservationSpec::front_velocity, above(0),
          "Velocity at which debris first reached this chainage.")
        .required = true;
    add_source(s);
    s.optional_key("uncertainty_mps", "m/s", &ObservationSpec::uncertainty, above(0), "a fifth of the velocity",
                   "Standard deviation of the velocity.");
    return s.take();
}

Section declare_superelevation() {
    Declaration<SuperelevationSpec> s("superelevation",
                                      "Marks on both sides of a bend: velocity = sqrt(9.81 x bend radius x level "
                                      "difference / (correction factor x width)).",
                                      &SceneSpec::superelevations);
    add_name(s);
    add_chainage(s);
    s.key("bend_radius_m", "m", &SuperelevationSpec::bend_radius, above(0), "Radius of the path's centre line in plan.")
        .required = true;
    s.key("width_m", "m", &SuperelevationSpec::width, above(0), "Width of the flow between the marks in plan.")
        .required = true;
    s.key("level_difference_m", "m", &SuperelevationSpec::level_difference, above(0),
          "Height of the outer mark above the inner one.")
        .required = true;
    s.key("correction_factor", "", &SuperelevationSpec::correction_factor, between(0.1, 20),
          "For viscosity and sorting in the bend; 1 is a frictionless fluid, and published values for debris go to 5.");
    s.optional_key("uncertainty_mps", "m/s", &SuperelevationSpec::uncertainty, above(0), "a quarter of the velocity",
                   "Standard deviation of the velocity.");
    add_source(s);
    return s.take();
}

Section declare_arrival() {
    Declaration<ArrivalSpec> s("arrival", "When debris first came to a chainage.", &SceneSpec::arrivals);
    add_name(s);
    add_chainage(s);
    s.key("time_s", "s", &ArrivalSpec::time, above(0), "Time since the release.").required = true;
    s.optional_key("uncertainty_s", "s", &ArrivalSpec::uncertainty, above(0), "a fifth of the time",
                   "Standard deviation of the time.");
    add_source(s);
    return s.take();
}

Section declare_run_up() {
    Declaration<RunUpSpec> s("run_up", "A mark of how high debris stood at a place.", &SceneSpec::run_ups);
    add_name(s);
    add_place(s);
    s.key("height_m", "m", &RunUpSpec::height, at_least(0), "Height of the mark above the ground at that place.")
        .required = true;
    s.key("uncertainty_m", "m", &RunUpSpec::uncertainty, above(0), "Standard deviation of the height.");
    add_source(s);
    return s.take();
}

Section declare_deposit_depth() {
    Declaration<DepositDepthSpec> s("deposit_depth", "What debris left at a place.", &SceneSpec::deposit_depths);
    add_name(s);
    add_place(s);
    s.key("depth_m", "m", &DepositDepthSpec::depth, at_least(0), "Vertical depth of the deposit; 0: none.").required =
        true;
    s.key("uncertainty_m", "m", &DepositDepthSpec::uncertainty, above(0), "Standard deviation of the depth.");
    add_source(s);
    return s.take();
}

Section declare_damage() {
    Declaration<DamageSpec> s("damage", "A building that was damaged, or that was not.", &SceneSpec::damages);
    s.text("building", &DamageSpec::building, "", "Name of the building.").required = true;
    s.key("damaged", "", &DamageSpec::damaged, anything(), "Whether it was damaged.");
    s.key("pressure_Pa", "Pa", &DamageSpec::pressure, above(0),
          "Impact pressure (outputs.impact_patch_edge_m) from which such a building is damaged.");
    s.key("uncertainty_Pa", "Pa", &DamageSpec::uncertainty, above(0), "Standard deviation of that limit.");
    add_source(s);
    return s.take();
}

Section declare_run_out() {
    Declaration<ObservedRunOutSpec> s("observed_run_out", "Where the front stopped.", &SceneSpec::observed_run_outs);
    add_name(s);
    add_chainage(s);
    s.key("uncertainty_m", "m", &ObservedRunOutSpec::uncertainty, above(0), "Standard deviation of the chainage.");
    add_source(s);
    return s.take();
}

Section declare_deposit_outline() {
    Declaration<DepositOutlineSpec> s("deposit_outline",
                                      "The edge of the deposit. The prediction is the area that outline and computed "
                                      "deposit share over the area that either covers; 1 is perfect.",
                                      &SceneSpec::deposit_outlines);
    add_name(s);
    s.path("file", &DepositOutlineSpec::file, "", "Polygons: GeoJSON, GeoPackage, Shapefile.").required = true;
    s.text("layer", &DepositOutlineSpec::layer, "the only layer", "Layer of the file.");
    s.key("depth_m", "m", &DepositOutlineSpec::depth, at_least(0), "Thinner computed deposit does not count.");
    s.key("uncertainty", "", &DepositOutlineSpec::uncertainty, above_to(0, 1), "Standard deviation of that share.");
    add_source(s);
    return s.take();
}

}  // namespace

std::vector<Section> declare_observations() {
    return {declare_observation(),   declare_superelevation(), declare_arrival(), declare_run_up(),
            declare_deposit_depth(), declare_damage(),         declare_run_out(), declare_deposit_outline()};
}

}  // namespace talus
