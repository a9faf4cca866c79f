// Obstacles: buildings, barriers.
#include "params/declaration.hpp"

namespace talus::params {

Section declare_buildings() {
    Declaration<BuildingsSpec> s("buildings", "Solid obstacles with vertical walls and flat roofs.",
                                 &SceneSpec::buildings);
    s.path(
        "file", &BuildingsSpec::file, "no buildings",
        "Footprint polygons (GeoJSON, GeoPackage, Shapefile), or a mesh in the terrain's reference system: CityJSON "
        "(.city.json, .cityjson) and Wavefront OBJ (.obj), z upward, or glTF 2.0 (.gltf, .glb), x east, y upward, -z "
        "north; the translation of a node may bring it to its place.");
    s.text("layer", &BuildingsSpec::layer, "the only layer", "Layer of the file.");
    s.text("height_attribute", &BuildingsSpec::height_attribute, "every building has the default height",
           "Attribute that holds a building's height above the mean ground of its footprint in metres, or text with "
           "its unit such as '30 ft'.");
    s.text("name_attribute", &BuildingsSpec::name_attribute, "\"building N\"",
           "Attribute that holds a building's name.");
    s.key("default_height_m", "m", &BuildingsSpec::height, above_to(0, 1000),
          "Height above the ground where the attribute is absent, empty or not above zero; counted as assumed.")
        .assumes("Height of buildings whose data give none")
        .live_in({.label = "Height", .slider_low = 0.5, .slider_high = 40, .first = 6}, "height_m");
    s.text(
         "resistance_attribute", &BuildingsSpec::resistance_attribute, "every building has resistance_Pa",
         "Attribute that holds the pressure in Pa that a building withstands, or text with its unit such as '30 kPa'.")
        .refused_by_depth_averaged("has no structures that fail");
    s.optional_key(
         "resistance_Pa", "Pa", &BuildingsSpec::resistance, between(1, 1e12), "buildings never fail",
         "Impact pressure (outputs.impact_patch_edge_m) above which a building is destroyed: it is gone from then on.")
        .assumes("Resistance of buildings")
        .refused_by_depth_averaged("has no structures that fail");
    return s.take();
}

Section declare_barrier() {
    Declaration<BarrierSpec> s("barrier", "A wall, a dam or a net along a line; any number.", &SceneSpec::barriers);
    s.text("name", &BarrierSpec::name, "\"barrier N\"", "Name in reports and messages.");
    s.key("line_m", "m", &BarrierSpec::line, anything(),
          "Its line in plan, in the terrain's reference system; at least two places.");
    s.path("file", &BarrierSpec::file, "line_m is given",
           "Its line in a file: GeoJSON, GeoPackage, Shapefile; several lines are a barrier each, called after this "
           "one and their attribute 'name' or number.");
    s.text("layer", &BarrierSpec::layer, "the only layer", "Layer of the file.");
    s.optional_key("height_m", "m", &BarrierSpec::height, above_to(0, 200), "crest_elevation_m is given",
                   "Height above the ground under the line: the crest follows the ground.")
        .live_in({.label = "Height", .slider_low = 0.5, .slider_high = 15, .first = 3});
    s.optional_key("crest_elevation_m", "m", &BarrierSpec::crest_elevation, between(-20000, 20000), "height_m is given",
                   "Elevation of a level crest.")
        .live_as();
    s.key("thickness_m", "m", &BarrierSpec::thickness, above_to(0, 100),
          "Thickness across the line; at least half a particle spacing.")
        .live_in({.label = "Thickness", .slider_low = 0.1, .slider_high = 5, .first = 1})
        .at_least_spacings(0.5, "thinner walls let debris interact across them");
    s.optional_key("passing_share", "", &BarrierSpec::passing_share, from_to_below(0, 1), "it is a wall",
                   "Makes it a net: the share of the debris, by volume, in grains that pass its meshes (the percentage "
                   "passing at the size of the opening, over 100). The others are held as by a wall.")
        .live_in({.label = "Passes the meshes",
                  .slider_low = 0,
                  .slider_high = 95,
                  .first = 50,
                  .tick = "Net",
                  .tick_help = "Lets the finer share of the debris through its meshes and holds the rest",
                  .unit = "%",
                  .factor = 100})
        .refused_by_depth_averaged("has no nets");
    s.optional_key("clearance_m", "m", &BarrierSpec::clearance, above_to(0, 100), "it reaches the ground",
                   "Height above the ground of the gap below it, as nets hang across a torrent: debris passes freely "
                   "there; at least one particle spacing, or nothing gets through.")
        .live_in({.label = "Clearance",
                  .slider_low = 0.1,
                  .slider_high = 3,
                  .first = 0.5,
                  .tick = "Gap below",
                  .tick_help = "It hangs above the ground: debris passes below it"})
        .at_least_spacings(1, "nothing passes through lower gaps; smaller particles allow less")
        .below_key("height_m")
        .refused_by_depth_averaged("has nothing below a structure");
    s.optional_key("resistance_Npm", "N/m", &BarrierSpec::resistance_force, between(1, 1e12), "it never fails",
                   "Filtered force per metre of the line above which it is destroyed: it is gone from then on.")
        .live_in({.label = "Resistance",
                  .slider_low = 10,
                  .slider_high = 1000,
                  .first = 200,
                  .tick = "Fails under load",
                  .tick_help = "Beyond this mean force on its line it is gone"})
        .refused_by_depth_averaged("has no structures that fail");
    s.optional_key("resistance_Pa", "Pa", &BarrierSpec::resistance_pressure, between(1, 1e12), "it never fails",
                   "Impact pressure (outputs.impact_patch_edge_m) above which it is destroyed.")
        .live_as()
        .refused_by_depth_averaged("has no structures that fail");
    s.exactly_one_of({"line_m", "file"});
    s.exactly_one_of({"height_m", "crest_elevation_m"});
    return s.take();
}

Section declare_barrier_opening() {
    Declaration<BarrierOpeningSpec> s("barrier_opening",
                                      "A slot or a spillway in a barrier, as check dams have; any number.",
                                      &SceneSpec::barrier_openings);
    s.text("barrier", &BarrierOpeningSpec::barrier, "", "Name of the barrier.").required = true;
    s.key("position_m", "m", &BarrierOpeningSpec::position, between(0, 1e5),
          "Distance of its middle along the barrier's line from its first place.")
        .live_as()
        .required = true;
    s.key("width_m", "m", &BarrierOpeningSpec::width, above_to(0, 1e5),
          "Width along the line; at least two particle spacings, or nothing gets through.")
        .live_as()
        .at_least_spacings(2, "nothing passes through narrower ones; smaller particles allow less")
        .required = true;
    s.key("sill_height_m", "m", &BarrierOpeningSpec::sill, between(0, 200),
          "How much of the barrier stands there, above the ground; 0: open to the ground.")
        .live_as();
    return s.take();
}

}  // namespace talus::params
