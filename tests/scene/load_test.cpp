#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/scene.hpp"
#include "scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::Contains;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class LoadScene : public SceneFolder {
  protected:
    [[nodiscard]] std::string line(int number) const {
        return path("scene.toml") + ":" + std::to_string(number) + ": ";
    }
};

TEST_F(LoadScene, brings_terrain_release_and_path_together) {
    write_valley();
    const Scene scene = loaded();
    EXPECT_EQ(scene.terrain.elevation().geometry.columns, columns);
    EXPECT_EQ(scene.crs.epsg, 2326);
    ASSERT_EQ(scene.releases.size(), 1U);
    // 20 m x 20 m on two facets, sloping 0.5 along and 0.2 across: 400 m2 / cos(slope) x 2 m.
    EXPECT_NEAR(scene.releases[0].volume, 800 * std::sqrt(1 + 0.25 + 0.04), 8);
    EXPECT_EQ(scene.spec.scene.title.rfind("LoadScene-", 0), 0U) << scene.spec.scene.title;
    ASSERT_EQ(scene.inputs.size(), 3U);
    EXPECT_EQ(scene.inputs[1].role, "terrain");
    EXPECT_EQ(scene.inputs[2].role, "release \"scarp\"");
    EXPECT_EQ(scene.inputs[2].bytes, std::filesystem::file_size(path("release.geojson")));
    EXPECT_EQ(scene.inputs[2].hash.size(), 16U);
}

TEST_F(LoadScene, knows_which_keys_were_given) {
    write_valley();
    const Scene scene = loaded({"material.viscosity=0.1"});  // which is the default
    EXPECT_THAT(scene.given_keys, Contains("terrain.file"));
    EXPECT_THAT(scene.given_keys, Contains("release[0].file"));
    EXPECT_THAT(scene.given_keys, Contains("material.viscosity"));
    EXPECT_THAT(scene.given_keys, Not(Contains("material.friction_coefficient")));
    EXPECT_THAT(scene.given_keys, Not(Contains("release[0]")));
}

TEST_F(LoadScene, traces_the_path_from_the_crown) {
    write_valley();
    const Scene scene = loaded();
    EXPECT_EQ(scene.flow_path_origin, PathOrigin::traced);
    EXPECT_TRUE(follows_debris(scene));
    // The crown is where the release is highest: at its western edge, on a flank.
    EXPECT_NEAR(scene.flow_path.points().front().x, west + 20, 1.5);
    EXPECT_NEAR(scene.flow_path.points().back().x, west + columns * cell, 2 * cell);
    EXPECT_NEAR(scene.flow_path.points().back().y, south + rows * cell / 2.0, 2 * cell);
    EXPECT_THAT(scene.notes, Contains(HasSubstr("flow path: traced downhill from release \"scarp\"")));
}

TEST_F(LoadScene, the_terrain_is_cropped_to_its_extent) {
    write_valley();
    const Scene scene = loaded({"terrain.extent_m=[824000, 825050, 824200, 825150]"});
    EXPECT_EQ(scene.terrain.elevation().geometry.columns, 40);
    EXPECT_EQ(scene.terrain.elevation().geometry.rows, 20);
}

TEST_F(LoadScene, a_missing_terrain_says_where_to_obtain_it) {
    write_valley();
    write("scene.toml",
          "[terrain]\nfile = \"absent.tif\"\nobtain = \"the survey's open data page\"\n[[release]]\n"
          "file = \"release.geojson\"\nthickness_m = 1\n");
    EXPECT_THAT(load_error(), AllOf(StartsWith(line(2) + "terrain.file: "), HasSubstr("absent.tif"),
                                    EndsWith("to obtain the file: the survey's open data page")));
}

TEST_F(LoadScene, terrain_errors_name_the_line_of_the_key) {
    write_valley();
    EXPECT_THAT(load_error({"terrain.band=7"}), AllOf(StartsWith(line(2) + "terrain.file: "), HasSubstr("band = 7")));
    EXPECT_THAT(load_error({"terrain.file=" + folder.string()}), StartsWith("--set terrain.file="));
    write("dem.tif", "");
    EXPECT_THAT(load_error(), AllOf(StartsWith(line(2) + "terrain.file: "), HasSubstr("dem.tif")));
}

TEST_F(LoadScene, a_target_volume_is_met_by_a_uniform_thickness) {
    write_valley("", "volume_m3 = 600");
    const Scene scene = loaded();
    EXPECT_NEAR(scene.releases[0].volume, 600, 0.01);
    EXPECT_NEAR(scene.releases[0].patches[0].thickness, 600 / (400 * std::sqrt(1.29)), 0.01);
    EXPECT_THAT(scene.notes, Contains(HasSubstr("uniform thickness of 1.3")));
    write_valley("", "volume_m3 = 1e9");
    EXPECT_THAT(load_error(), AllOf(StartsWith(line(6) + "release[0].volume_m3: "), HasSubstr("m thick")));
}

TEST_F(LoadScene, a_viscosity_that_no_step_can_apply_names_the_most) {
    write_valley("[material]\nkinematic_viscosity_m2ps = 1e3\n[solver]\nparticle_spacing_m = 1");
    EXPECT_THAT(load_error(), AllOf(StartsWith(line(8) + "material.kinematic_viscosity_m2ps = 1000 is refused"),
                                    HasSubstr("particles of 1 m"), HasSubstr("at most 7")));
    write_valley("[material]\nkinematic_viscosity_m2ps = 30\n[solver]\nparticle_spacing_m = 1");
    EXPECT_EQ(load_error(), "(it loaded)") << "the adaptive step is shortened for it";
    write_valley("[material]\nviscosity = 0.9\n[solver]\ntime_step_s = 0.02");
    EXPECT_THAT(load_error(), AllOf(StartsWith(line(8) + "material.viscosity = 0.9"), HasSubstr("at most 0.8333")));
    write_valley("[material]\nviscosity = 0.8\n[solver]\ntime_step_s = 0.02");
    EXPECT_EQ(load_error(), "(it loaded)");
}

TEST_F(LoadScene, thickness_comes_from_the_attribute_of_each_polygon) {
    write_valley("", "thickness_attribute = \"d\"");
    write_features("release.geojson",
                   {rectangle(20, 90, 40, 100, "\"d\": 1.5"), rectangle(20, 100, 40, 110, "\"d\": 0.5")});
    const Scene scene = loaded();
    ASSERT_EQ(scene.releases[0].patches.size(), 2U);
    EXPECT_EQ(scene.releases[0].patches[0].thickness, 1.5);
    EXPECT_EQ(scene.releases[0].patches[1].thickness, 0.5);
}

TEST_F(LoadScene, a_thickness_attribute_that_is_absent_or_not_above_zero_names_the_feature) {
    write_valley("", "thickness_attribute = \"d\"");
    const std::string place = line(6) + "release[0].thickness_attribute: ";
    for (const std::string value : {"0", "-1", "null", "\"thick\"", "1e9"}) {
        write_features("release.geojson",
                       {rectangle(20, 90, 40, 100, "\"d\": 1.5"), rectangle(20, 100, 40, 110, "\"d\": " + value)});
        EXPECT_THAT(load_error(),
                    AllOf(StartsWith(place), HasSubstr("feature 2 has d = "), HasSubstr("greater than 0")));
    }
    write_features("release.geojson", {rectangle(20, 90, 40, 100, "\"depth\": 1.5")});
    EXPECT_THAT(load_error(), AllOf(StartsWith(place), EndsWith("its attributes: depth")));
}

TEST_F(LoadScene, a_thickness_raster_gives_thickness_where_it_is_above_zero) {
    write_valley("", "thickness_raster = \"thickness.tif\"");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    write_terrain("thickness.tif", [&](double x, double) { return x < west + 30 ? 2.0 : nan; });
    const Scene scene = loaded();
    EXPECT_NEAR(scene.releases[0].volume, 400 * std::sqrt(1.29), 4);
    EXPECT_THAT(scene.notes, Contains(HasSubstr("50 % of its area has no thickness")));
    EXPECT_THAT(scene.notes, Contains(AllOf(HasSubstr("times their thickness are 12000 m3"),
                                            HasSubstr("11600 m3 of these (97 %) lie outside the polygons"))));
    const Scene vertical = loaded({"release[0].thickness_direction=vertical"});
    EXPECT_THAT(vertical.notes, Contains(AllOf(HasSubstr("releases 400 m3; the cells"),
                                               HasSubstr("thickness being taken as vertical; 11600 m3 of these"))));
    write_terrain("thickness.tif", [&](double, double) { return 0.0; });
    EXPECT_THAT(load_error(), AllOf(StartsWith(line(6)), HasSubstr("no thickness above 0")));
}

TEST_F(LoadScene, a_raster_alone_is_a_release) {
    // An L of 300 m2 in plan, 2 m thick, with a part apart; the valley's side is 1.14 times its plan.
    write_terrain("thickness.tif", [&](double x, double y) {
        const double east = x - west, north = y - south;
        const bool corner = east < 30 && east > 20 && north > 90 && north < 110;
        return corner || (east > 30 && east < 40 && north > 90 && north < 100) ? 2.0 : 0.0;
    });
    const std::string scene_start = "[terrain]\nfile = \"dem.tif\"\n[[release]]\nname = \"scarp\"\n";
    write_valley("");
    write("scene.toml", scene_start + "thickness_raster = \"thickness.tif\"\n");
    const Scene normal = loaded();
    ASSERT_EQ(normal.releases[0].patches.size(), 1U);
    EXPECT_NEAR(plan_area(normal.releases[0].patches[0].polygon), 300, 1e-6);
    EXPECT_TRUE(normal.releases[0].extent().contains({west + 25, south + 105}));
    EXPECT_FALSE(contains(normal.releases[0].patches[0].polygon, {west + 35, south + 105}));
    EXPECT_NEAR(normal.releases[0].volume, 600 * std::sqrt(1.29), 6);
    EXPECT_THAT(normal.notes, Contains(HasSubstr("the cells of its raster times their thickness are 600 m3")));

    write("scene.toml", scene_start + "thickness_raster = \"thickness.tif\"\nthickness_direction = \"vertical\"\n");
    const Scene vertical = loaded();
    EXPECT_NEAR(vertical.releases[0].volume, 600, 0.1);
    EXPECT_NEAR(vertical.releases[0].depth_at(vertical.terrain, {west + 25, south + 95}), 2, 1e-6);

    write_terrain("thickness.tif", [&](double, double) { return 0.0; });
    EXPECT_THAT(load_error(), HasSubstr("thickness.tif: has no thickness above 0 over the terrain"));
}

TEST_F(LoadScene, an_ascii_grid_without_a_reference_system_is_in_the_terrains) {
    write_valley("");
    std::string grid = fmt::format("ncols 4\nnrows 4\nxllcorner {}\nyllcorner {}\ncellsize 5\nNODATA_value -9999\n",
                                   west + 20, south + 90);
    for (int row = 0; row < 4; ++row) grid += "-9999 1.5 1.5 -9999\n";
    write("thickness.asc", grid);
    write("scene.toml", "[terrain]\nfile = \"dem.tif\"\n[[release]]\nthickness_raster = \"thickness.asc\"\n");
    const Scene scene = loaded();
    EXPECT_NEAR(scene.releases[0].volume, 300 * std::sqrt(1.29), 3);
    EXPECT_THAT(scene.notes, Contains(HasSubstr("states no coordinate reference system, taken as the terrain's")));
}

TEST_F(LoadScene, elevations_in_feet_are_asked_about) {
    write_valley("", "thickness_m = 1.5");
    const auto asks = Contains(AllOf(StartsWith("terrain: "), HasSubstr("in feet")));
    EXPECT_THAT(loaded().notes, Not(asks));
    write_terrain("dem.tif", [](double x, double y) { return valley(x, y) / 0.3048; });
    const Scene feet = loaded();
    EXPECT_THAT(feet.notes, asks);
    EXPECT_THAT(feet.notes, Contains(HasSubstr("half of it is steeper than 60 degrees")));
    EXPECT_THAT(feet.notes, Contains(HasSubstr("release \"scarp\" lies at ")));
    EXPECT_THAT(feet.notes, Contains(HasSubstr("steeper than 28 degrees in truth")));
}

TEST_F(LoadScene, particles_as_thick_as_the_release_are_noted) {
    write_valley("", "thickness_m = 1.5");
    const auto note_at = [&](double spacing) {
        for (const std::string& note : loaded({fmt::format("solver.particle_spacing_m={}", spacing)}).notes) {
            if (note.find("layers need solver.particle_spacing_m = 0.3") != std::string::npos) return note;
        }
        return std::string();
    };
    EXPECT_THAT(note_at(3), HasSubstr("particles are 3 m apart, more than it is thick (1.5 m)"));
    EXPECT_THAT(note_at(0.75), HasSubstr("it is 2 particles thick (1.5 m)"));
    EXPECT_THAT(note_at(1.5), HasSubstr("it is 1 particle thick (1.5 m)"));
    EXPECT_EQ(note_at(0.29), "");
}

TEST_F(LoadScene, a_release_outside_the_terrain_is_named_with_place_and_extent) {
    write_valley();
    write_features("release.geojson", {rectangle(-100, 90, -80, 110)});
    EXPECT_THAT(load_error(),
                AllOf(StartsWith(line(5) + "release[0].file: release \"scarp\" lies outside the terrain"),
                      HasSubstr("(823900.0, 825090.0)"), HasSubstr("x 824002.5 to 824297.5"), HasSubstr("EPSG:2326")));
    write_features("release.geojson", {rectangle(-10, 90, 20, 110)});
    EXPECT_THAT(load_error(), HasSubstr("release \"scarp\" reaches beyond the terrain"));
    write_features("release.geojson", {rectangle(20, 90, 40, 110)});
    EXPECT_THAT(load_error({"terrain.extent_m=[824100, 825000, 824300, 825200]"}), HasSubstr("widen terrain.extent_m"));
}

TEST_F(LoadScene, a_release_over_nodata_is_named_with_the_place) {
    write_valley();
    write_terrain("dem.tif", [](double x, double y) {
        const bool hole = std::abs(x - (west + 32.5)) < 1 && std::abs(y - (south + 102.5)) < 1;
        return hole ? std::numeric_limits<double>::quiet_NaN() : valley(x, y);
    });
    EXPECT_THAT(load_error(), AllOf(StartsWith(line(5)), HasSubstr("release \"scarp\" lies over nodata")));
}

TEST_F(LoadScene, empty_and_broken_release_layers_are_refused) {
    write_valley();
    write_features("release.geojson", {});
    EXPECT_THAT(load_error(), AllOf(StartsWith(line(5) + "release[0].file: "), HasSubstr("release.geojson")));
    write_features("release.geojson", {R"({"type": "Feature", "properties": {}, "geometry": {"type": "Polygon",
        "coordinates": [[[824020, 825090], [824040, 825110], [824040, 825090], [824020, 825110], [824020, 825090]]]}})"});
    EXPECT_THAT(load_error(), AllOf(StartsWith(line(5) + "release[0].file: "), HasSubstr("feature 1")));
    std::filesystem::remove(path("release.geojson"));
    EXPECT_THAT(load_error(), StartsWith(line(5) + "release[0].file: "));
}

TEST_F(LoadScene, overlapping_releases_are_named) {
    const std::string second = "[[release]]\nname = \"flank\"\nfile = \"flank.geojson\"\nthickness_m = 1\n";
    write_valley(second);
    write_features("flank.geojson", {rectangle(39, 90, 60, 110)});
    EXPECT_THAT(load_error(),
                AllOf(StartsWith(line(9) + "release[1].file: releases \"scarp\" and \"flank\" overlap by 20 m2"),
                      HasSubstr("(824039.5")));
    write_features("flank.geojson", {rectangle(40, 90, 60, 110)});  // shares an edge only
    EXPECT_EQ(loaded().releases.size(), 2U);
}

TEST_F(LoadScene, overlapping_polygons_of_one_release_are_refused) {
    write_valley();
    write_features("release.geojson", {rectangle(20, 90, 40, 110), rectangle(25, 95, 30, 100)});
    EXPECT_THAT(load_error(), AllOf(StartsWith(line(5)), HasSubstr("polygons of release \"scarp\" overlap by 25 m2")));
}

TEST_F(LoadScene, buildings_take_height_and_name_or_say_what_is_assumed) {
    write_valley("[buildings]\nfile = \"houses.geojson\"\nheight_attribute = \"h\"\nname_attribute = \"n\"\n");
    write_features("houses.geojson", {rectangle(200, 90, 210, 100, "\"h\": 9, \"n\": \"House 38\""),
                                      rectangle(220, 90, 230, 100, "\"h\": null, \"n\": null"),
                                      rectangle(240, 90, 250, 100, "\"h\": 0, \"n\": \"\""),
                                      rectangle(900, 90, 910, 100, "\"h\": 5, \"n\": \"far\"")});
    const Scene scene = loaded();
    ASSERT_EQ(scene.buildings.size(), 3U);
    EXPECT_EQ(scene.buildings[0].name, "House 38");
    EXPECT_EQ(scene.buildings[0].height, 9);
    EXPECT_FALSE(scene.buildings[0].height_assumed);
    EXPECT_NEAR(scene.buildings[0].roof_elevation, valley(west + 205, south + 95) + 9, 0.5);
    EXPECT_EQ(scene.buildings[1].name, "building 2");
    EXPECT_EQ(scene.buildings[1].height, 6);
    EXPECT_TRUE(scene.buildings[2].height_assumed);
    EXPECT_THAT(scene.notes, Contains("buildings: 1 of 4 lie outside the terrain and were left out"));
    EXPECT_THAT(scene.notes, Contains("buildings: the height of 2 of 3 is assumed to be 6 m"));
}

TEST_F(LoadScene, heights_with_units_are_read_and_others_assumed) {
    write_valley("[buildings]\nfile = \"houses.geojson\"\nheight_attribute = \"height\"\n");
    const std::vector<std::pair<std::string, double>> heights = {
        {"12 m", 12}, {"30 ft", 9.144}, {"12,5", 12.5},   {"40'", 12.192}, {"7", 7},  {"1e1", 10},
        {"9m", 9},    {"", 0},          {"2 storeys", 0}, {"~8", 0},       {"yes", 0}};  // 0: assumed
    std::vector<std::string> houses;
    for (const auto& [text, height] : heights) {
        const double x = 100 + 15 * static_cast<double>(houses.size());
        houses.push_back(rectangle(x, 90, x + 10, 100, "\"height\": \"" + text + "\""));
    }
    write_features("houses.geojson", houses);
    const Scene scene = loaded();
    ASSERT_EQ(scene.buildings.size(), heights.size());
    for (std::size_t k = 0; k < heights.size(); ++k) {
        const auto& [text, height] = heights[k];
        EXPECT_EQ(scene.buildings[k].height_assumed, height == 0) << text;
        EXPECT_NEAR(scene.buildings[k].height, height == 0 ? 6 : height, 1e-9) << text;
    }
    EXPECT_THAT(scene.notes, Contains("buildings: the height of 4 of 11 is assumed to be 6 m"));
    EXPECT_THAT(scene.notes, Contains(AllOf(HasSubstr("houses.geojson: 3 of these have a height that is no height"),
                                            HasSubstr("feature 9, \"2 storeys\": after its number comes"))));
}

TEST_F(LoadScene, every_attribute_is_read_with_its_unit) {
    write_valley("[buildings]\nfile = \"houses.geojson\"\nresistance_attribute = \"stands\"\n",
                 "thickness_attribute = \"d\"");
    const auto with = [&](const std::string& thickness, const std::string& resistance) {
        write_features("release.geojson", {rectangle(20, 90, 40, 110, "\"d\": \"" + thickness + "\"")});
        write_features("houses.geojson", {rectangle(200, 90, 210, 100, "\"stands\": \"" + resistance + "\"")});
    };
    with("150 cm", "500 kPa");
    const Scene scene = loaded();
    EXPECT_DOUBLE_EQ(scene.releases[0].patches[0].thickness, 1.5);
    EXPECT_EQ(scene.buildings[0].resistance.pressure, 5e5);
    with("1,500", "500 kPa");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("release.geojson: feature 1 has d = \"1,500\", where its comma may"),
                                    HasSubstr("must be a thickness greater than 0")));
    with("1.5", "5 bar");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("buildings.resistance_attribute: "),
                                    HasSubstr("houses.geojson: feature 1 has stands = \"5 bar\", where after its "
                                              "number comes \"bar\"; units are Pa, kPa")));
}

TEST_F(LoadScene, buildings_that_cannot_be_used_are_refused) {
    write_valley("[buildings]\nfile = \"houses.geojson\"\n");
    write_features("houses.geojson", {rectangle(900, 90, 910, 100)});
    EXPECT_THAT(load_error(),
                AllOf(StartsWith(line(8) + "buildings.file: "), HasSubstr("all 1 buildings lie outside")));
    write_features("houses.geojson", {rectangle(200, 90, 210, 100, "\"height\": 4")});
    EXPECT_THAT(load_error({"buildings.height_attribute=h"}),
                AllOf(StartsWith("--set buildings.height_attribute=h: "), EndsWith("its attributes: height")));
}

TEST_F(LoadScene, a_building_on_a_release_is_left_out_and_noted) {
    write_valley("[buildings]\nfile = \"houses.geojson\"\n");
    write_features("houses.geojson", {rectangle(35, 90, 45, 100), rectangle(200, 90, 210, 100)});
    const Scene scene = loaded();
    ASSERT_EQ(scene.buildings.size(), 1U);
    EXPECT_EQ(scene.buildings[0].name, "building 2");
    EXPECT_THAT(scene.notes, Contains(HasSubstr("\"building 1\" stands on release \"scarp\" with 50 m2")));
}

TEST_F(LoadScene, a_flow_path_from_a_file_is_turned_downstream) {
    write_valley("[flow_path]\nfile = \"path.geojson\"\n[[observation]]\nchainage_m = 500\nfront_velocity_mps = 5\n");
    write_features("path.geojson", {R"({"type": "Feature", "properties": {}, "geometry": {"type": "LineString",
        "coordinates": [[824250, 825100], [824130, 825100], [824030, 825100]]}})"});
    const Scene scene = loaded();
    EXPECT_EQ(scene.flow_path_origin, PathOrigin::file);
    EXPECT_EQ(scene.flow_path.points().front().x, 824030);
    EXPECT_NEAR(scene.flow_path.length(), 220, 1e-6);
    EXPECT_THAT(scene.notes, Contains(HasSubstr("has been turned")));
    EXPECT_THAT(scene.notes, Contains(HasSubstr("observation[0]: chainage 500 m lies beyond")));
}

TEST_F(LoadScene, a_flow_path_far_from_the_release_is_noted) {
    write_valley("[flow_path]\nfile = \"path.geojson\"\n");
    write_features("path.geojson", {R"({"type": "Feature", "properties": {}, "geometry": {"type": "LineString",
        "coordinates": [[824030, 825180], [824250, 825180]]}})"});
    EXPECT_THAT(loaded().notes, Contains(HasSubstr("outside the corridor of 60 m")));
    write_features("path.geojson", {R"({"type": "Feature", "properties": {}, "geometry": {"type": "LineString",
        "coordinates": [[834030, 825180], [834250, 825180]]}})"});
    EXPECT_THAT(load_error(), AllOf(StartsWith(line(8) + "flow_path.file: "), HasSubstr("lies outside the terrain")));
}

TEST_F(LoadScene, reprojected_vectors_are_noted) {
    write_valley();
    // About 24 m x 22 m near the valley's top, in longitude and latitude.
    write("release.geojson", R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {},
        "geometry": {"type": "Polygon", "coordinates": [[[114.0580, 22.3651], [114.0582, 22.3651],
        [114.0582, 22.3653], [114.0580, 22.3653], [114.0580, 22.3651]]]}}]})");
    EXPECT_THAT(loaded().notes, Contains(HasSubstr("release \"scarp\": reprojected from EPSG:4326")));
}

}  // namespace
}  // namespace talus::scene
