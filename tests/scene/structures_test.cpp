#include <cmath>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "run/run_scene.hpp"
#include "scene/scene.hpp"
#include "scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class Structures : public SceneFolder {
  protected:
    /// A dam across the valley, 60 m wide, 90 m from its western edge.
    static std::string dam(const std::string& more = "height_m = 8") {
        return fmt::format("[[barrier]]\nname = \"dam\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nthickness_m = 3\n{3}\n",
                           west + 90, south + 70, south + 130, more);
    }
    static std::string inflow(const std::string& hydrograph = "surge.csv") {
        return fmt::format("[[inflow]]\nname = \"gully\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nhydrograph = \"{3}\"\n",
                           west + 45, south + 95, south + 105, hydrograph);
    }
    [[nodiscard]] run::RunResult run(std::vector<std::string> overrides = {}) const {
        overrides.insert(overrides.begin(), {"solver.target_particle_count=1500", "solver.end_time_s=12",
                                             "material.friction_coefficient=0.25"});
        return test::value_of(run::run_scene(loaded(overrides), {}));
    }
};

TEST_F(Structures, barriers_come_behind_the_buildings) {
    write_features("houses.geojson", {rectangle(200, 90, 210, 110)});
    write_valley("[buildings]\nfile = \"houses.geojson\"\nresistance_Pa = 40000\n" +
                 dam("crest_elevation_m = 165\nresistance_Npm = 9e4") +
                 "[[barrier_opening]]\nbarrier = \"dam\"\nposition_m = 30\nwidth_m = 6\nsill_height_m = 1\n");
    const Scene scene = loaded();
    ASSERT_EQ(scene.buildings.size(), 2U);
    EXPECT_FALSE(scene.buildings[0].barrier);
    EXPECT_EQ(scene.buildings[0].resistance.pressure, 40000);
    ASSERT_TRUE(scene.buildings[1].barrier);
    EXPECT_EQ(scene.buildings[1].name, "dam");
    EXPECT_EQ(scene.buildings[1].resistance.force_per_metre, 9e4);
    EXPECT_TRUE(std::isinf(scene.buildings[1].resistance.pressure));
    ASSERT_EQ(scene.buildings[1].barrier->openings.size(), 1U);
    EXPECT_EQ(scene.buildings[1].barrier->openings[0].sill, 1);
}

TEST_F(Structures, every_line_of_a_file_is_a_barrier) {
    const auto dam_at = [](double x, const std::string& properties) {
        return fmt::format(R"({{"type": "Feature", "properties": {{{0}}}, "geometry": {{"type": "LineString", )"
                           R"("coordinates": [[{1}, {2}], [{1}, {3}]]}}}})",
                           properties, west + x, south + 70, south + 130);
    };
    write_valley("[[barrier]]\nname = \"dams\"\nfile = \"dams.geojson\"\nheight_m = 4\nthickness_m = 3\n" + dam() +
                 "[[barrier_opening]]\nbarrier = \"dams lower\"\nposition_m = 30\nwidth_m = 6\n");
    write_features("dams.geojson", {dam_at(120, R"("name": "upper")"), dam_at(180, R"("name": "lower")")});
    const Scene scene = loaded();
    ASSERT_EQ(scene.buildings.size(), 3U);
    EXPECT_EQ(scene.buildings[0].name, "dams upper");
    EXPECT_EQ(scene.buildings[1].name, "dams lower");
    EXPECT_NEAR(extent_of(scene.buildings[1].footprint[0]).x_min, west + 178.5, 1e-6);
    EXPECT_EQ(scene.buildings[0].barrier->openings.size(), 0U);
    EXPECT_EQ(scene.buildings[1].barrier->openings.size(), 1U);
    EXPECT_EQ(scene.buildings[2].name, "dam");
    EXPECT_THAT(scene.barrier_sections, ElementsAre(0U, 0U, 1U));
    EXPECT_THAT(scene.notes, Contains(HasSubstr("holds 2 lines, a barrier each: \"dams upper\", \"dams lower\"")));
    EXPECT_THAT(load_error({"barrier[1].name=dams lower"}), HasSubstr("barrier[1].name = \"dams lower\" is the name of "
                                                                      "another barrier too"));
    write_features("dams.geojson", {dam_at(120, R"("name": "a")"), dam_at(180, R"("name": "a")")});
    EXPECT_THAT(load_error(), HasSubstr("barriers: \"dams 1\", \"dams 2\", \"dam\""))
        << "names that are not unique are replaced by numbers";
}

TEST_F(Structures, one_line_is_needed_for_a_flow_path_and_for_an_inflow) {
    const std::string line = fmt::format(R"({{"type": "Feature", "properties": {{}}, "geometry": {{"type": )"
                                         R"("LineString", "coordinates": [[{}, {}], [{}, {}]]}}}})",
                                         west + 45, south + 95, west + 45, south + 105);
    write_features("lines.geojson", {line, line});
    write("surge.csv", "time_s,discharge_m3ps,velocity_mps\n0,1,4\n2,40,6\n");
    write_valley("[flow_path]\nfile = \"lines.geojson\"\n");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("flow_path.file: "), HasSubstr("has 2 lines, one is needed")));
    write_valley("[[inflow]]\nfile = \"lines.geojson\"\nhydrograph = \"surge.csv\"\n");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("inflow[0].file: "), HasSubstr("has 2 lines, one is needed")));
}

TEST_F(Structures, a_barrier_with_a_passing_share_is_a_net) {
    write_valley(dam("height_m = 8\npassing_share = 0.35"));
    const Scene scene = loaded();
    ASSERT_TRUE(scene.buildings[0].barrier);
    EXPECT_EQ(scene.buildings[0].barrier->passing_share, 0.35);
    for (const char* bad : {"1", "-0.1", "1.5", "nan", "\"half\""}) {
        write_valley(dam(fmt::format("height_m = 8\npassing_share = {}", bad)));
        const auto refused = load_scene(folder / "scene.toml");
        ASSERT_FALSE(refused) << bad;
        EXPECT_THAT(refused.error().message, AllOf(HasSubstr("scene.toml"), HasSubstr("barrier[0].passing_share")));
    }
}

TEST_F(Structures, a_net_holds_more_than_a_slot_lets_through_and_everything_is_accounted_for) {
    write_valley(dam("height_m = 8"));
    const run::RunResult wall = run();
    write_valley(dam("height_m = 8\npassing_share = 0.5"));
    const run::RunResult net = run();
    const observe::BuildingImpact& at_wall = wall.observation.buildings[0];
    const observe::BuildingImpact& at_net = net.observation.buildings[0];
    EXPECT_TRUE(std::isnan(at_wall.passing_share));
    EXPECT_EQ(at_net.passing_share, 0.5);
    EXPECT_EQ(at_wall.passed_volume, 0);
    EXPECT_GT(at_net.passed_volume, 1);
    EXPECT_GT(at_net.retained_volume, 1);
    EXPECT_LT(at_net.retained_volume, at_wall.retained_volume);
    EXPECT_LT(at_net.impulse, at_wall.impulse);
    EXPECT_GT(at_net.peak_filling_height, 0);
    ASSERT_GT(at_net.history.size(), 3U);
    EXPECT_EQ(at_net.history.back().passed_volume, at_net.passed_volume);
}

TEST_F(Structures, buildings_may_be_a_mesh) {
    // Two boxes side by side on ground at about 97 to 103 m, with roofs at 106 and 109 m; a third one far away.
    std::string obj;
    int vertex = 1;
    const auto box = [&](const std::string& name, double x, double y, double top) {
        obj += "o " + name + "\n";
        for (const double z : {90.0, top}) {
            for (const auto& [dx, dy] : {std::pair{0, 0}, {6, 0}, {6, 8}, {0, 8}}) {
                obj += fmt::format("v {} {} {}\n", west + x + dx, south + y + dy, z);
            }
        }
        obj += fmt::format("f {3} {2} {1} {0}\nf {4} {5} {6} {7}\n", vertex, vertex + 1, vertex + 2, vertex + 3,
                           vertex + 4, vertex + 5, vertex + 6, vertex + 7);
        vertex += 8;
    };
    box("low", 200, 96, 106);
    box("high", 206, 96, 109);
    box("away", 5000, 96, 109);
    write("houses.obj", obj);
    write_valley("[buildings]\nfile = \"houses.obj\"\nresistance_Pa = 3e4\n");
    const Scene scene = loaded();
    ASSERT_EQ(scene.buildings.size(), 2U);
    EXPECT_EQ(scene.buildings[0].name, "low");
    EXPECT_EQ(scene.buildings[1].roof_elevation, 109);
    EXPECT_NEAR(scene.buildings[0].height, 106 - (200 - 0.5 * 203 + 0.4), 0.2) << "above the mean ground";
    EXPECT_EQ(scene.buildings[0].resistance.pressure, 3e4);
    EXPECT_THAT(scene.notes, Contains(HasSubstr("1 of 3 lie outside the terrain")));
    const terrain::BuildingSolids solids(scene.terrain, scene.buildings, 1);
    const LocalPoint p = scene.terrain.frame().to_local({west + 203, south + 100, 105});
    EXPECT_TRUE(solids.inside(p));
    EXPECT_FALSE(solids.inside(LocalPoint{p.x, p.y, p.z + 2}));
    EXPECT_TRUE(solids.inside(LocalPoint{p.x + 6, p.y, p.z + 2}));
    EXPECT_THAT(load_error({"buildings.height_attribute=height"}),
                HasSubstr("buildings.height_attribute: is refused with the mesh"));
    write("houses.obj", "v 1 2\n");
    EXPECT_THAT(load_error(), HasSubstr("buildings.file: " + path("houses.obj") + ":1: a vertex needs three"));
}

TEST_F(Structures, a_barriers_line_may_be_a_file) {
    write("line.geojson",
          fmt::format(R"({{"type": "FeatureCollection", "crs": {{"type": "name", "properties": {{"name": )"
                      R"("urn:ogc:def:crs:EPSG::2326"}}}}, "features": [{{"type": "Feature", "properties": {{}}, )"
                      R"("geometry": {{"type": "LineString", "coordinates": [[{0}, {1}], [{0}, {2}]]}}}}]}})",
                      west + 90, south + 70, south + 130));
    write_valley("[[barrier]]\nfile = \"line.geojson\"\nheight_m = 8\n");
    const Scene scene = loaded();
    ASSERT_EQ(scene.buildings.size(), 1U);
    EXPECT_EQ(scene.buildings[0].name, "barrier 1");
    EXPECT_EQ(scene.inputs.back().role, "barrier \"barrier 1\"");
}

TEST_F(Structures, bad_barriers_are_refused_by_key) {
    const auto refusal = [&](const std::string& text) {
        write_valley(text);
        return load_error();
    };
    EXPECT_THAT(refusal(dam("height_m = 8\ncrest_elevation_m = 170")),
                AllOf(HasSubstr("scene.toml:12: barrier[0].crest_elevation_m"),
                      HasSubstr("given are height_m, crest_elevation_m")));
    EXPECT_THAT(refusal(dam("")), HasSubstr("barrier[0].height_m: exactly one of height_m, crest_elevation_m must"));
    EXPECT_THAT(refusal("[[barrier]]\nheight_m = 8\n"), HasSubstr("exactly one of line_m, file must be given"));
    EXPECT_THAT(refusal("[[barrier]]\nheight_m = 8\nline_m = [[1, 2, 3]]\n"),
                HasSubstr("must be a list of places, a pair of numbers each (m)"));
    EXPECT_THAT(refusal("[[barrier]]\nheight_m = 8\nline_m = [[1, 2]]\n"),
                HasSubstr("has 1 place; a line needs at least two"));
    EXPECT_THAT(refusal("[[barrier]]\nheight_m = 8\nline_m = [[1, 2], [3, 4]]\n"), HasSubstr("is not on known ground"));
    EXPECT_THAT(refusal(dam("height_m = 8\nresistance_Npm = 0")),
                HasSubstr("must be a number from 1 to 1000000000000 (N/m)"));
    EXPECT_THAT(refusal(dam() + "[[barrier_opening]]\nbarrier = \"dyke\"\nposition_m = 3\nwidth_m = 3\n"),
                HasSubstr("barrier_opening[0].barrier = \"dyke\": there is no such barrier; barriers: \"dam\""));
    EXPECT_THAT(refusal(dam() + "[[barrier_opening]]\nbarrier = \"dam\"\nposition_m = 3\nwidth_m = 0.2\n"),
                HasSubstr("barrier_opening[0].width_m = 0.2 is refused; with particles of"));
    EXPECT_THAT(refusal(dam() + dam()), HasSubstr("is the name of another barrier too"));
    EXPECT_THAT(refusal(fmt::format("[[barrier]]\nheight_m = 8\nline_m = [[{0}, {1}], [{0}, {2}]]\n", west + 30,
                                    south + 80, south + 120)),
                HasSubstr("stands on release \"scarp\""));
}

TEST_F(Structures, a_dam_holds_debris_and_its_slot_lets_some_through) {
    write_valley(dam());
    const run::RunResult held = run();
    const observe::BuildingImpact& dam_alone = held.observation.buildings.at(0);
    EXPECT_TRUE(dam_alone.is_barrier);
    EXPECT_TRUE(dam_alone.hit);
    EXPECT_EQ(dam_alone.passed_volume, 0);
    EXPECT_GT(dam_alone.impulse, 0);
    EXPECT_GT(dam_alone.peak_filling_height, 0.5);
    EXPECT_GT(dam_alone.history.size(), 20U);
    write_valley(dam() + "[[barrier_opening]]\nbarrier = \"dam\"\nposition_m = 30\nwidth_m = 8\n");
    const run::RunResult open = run();
    EXPECT_GT(open.observation.buildings.at(0).passed_volume, 20);
    EXPECT_LT(open.observation.buildings.at(0).retained_volume, dam_alone.retained_volume);
}

TEST_F(Structures, a_resistance_that_is_exceeded_brings_it_down_the_same_on_any_number_of_threads) {
    write_valley(dam());
    const run::RunResult stood = run();
    const double peak = stood.observation.buildings.at(0).peak_force / 60;  // N/m
    EXPECT_TRUE(std::isnan(stood.observation.buildings.at(0).failure_time));
    const std::string weak = fmt::format("barrier[0].resistance_Npm={}", peak / 10);  // early: what it held must run on
    const run::RunResult one = run({weak, "solver.thread_count=1"}), two = run({weak, "solver.thread_count=2"});
    const observe::BuildingImpact& fallen = one.observation.buildings.at(0);
    EXPECT_GT(fallen.failure_time, fallen.first_hit_time);
    EXPECT_EQ(one.hash, two.hash);
    EXPECT_EQ(fallen.failure_time, two.observation.buildings.at(0).failure_time);
    EXPECT_NE(one.hash, stood.hash);
    EXPECT_GT(one.observation.run_out.front_chainage, stood.observation.run_out.front_chainage + 5);
    EXPECT_GT(one.observation.run_out.along_flow, stood.observation.run_out.along_flow + 5);
    const run::RunResult strong = run({fmt::format("barrier[0].resistance_Npm={}", 2 * peak)});
    EXPECT_EQ(strong.hash, stood.hash) << "a resistance that is not exceeded changes nothing";
}

TEST_F(Structures, inflow_brings_its_volume_to_the_particle) {
    write_valley();
    write("surge.csv", "time_s,discharge_m3ps,velocity_mps\n0,0,4\n2,40,6\n4,0,4\n6,0,4\n7,30,5\n8,0,5\n");
    write("scene.toml", "[terrain]\nfile = \"dem.tif\"\n" + inflow());
    const Scene scene = loaded();
    ASSERT_EQ(scene.inflows.size(), 1U);
    EXPECT_NEAR(scene.inflows[0].volume(), 110, 1e-9);
    EXPECT_NEAR(total_volume(scene), 110, 1e-9);
    EXPECT_THAT(scene.notes, Contains(HasSubstr("flow path: traced downhill from inflow \"gully\"")));
    EXPECT_THAT(scene.notes, Contains(HasSubstr("where the ground falls by 0.5 in its direction")));
    const run::RunResult result = run();
    EXPECT_EQ(result.status, run::RunStatus::complete) << result.stop_reason;
    EXPECT_EQ(result.particles, 1500U);
    EXPECT_NEAR(result.observation.volume_released, 110, 1e-6);
    const observe::TimeSample& last = result.observation.timeseries.back();
    EXPECT_NEAR(last.volume_held + last.volume_moving + last.volume_deposited + last.volume_left, 110, 1e-6);
    EXPECT_EQ(run({"solver.thread_count=1"}).hash, result.hash);
    EXPECT_GT(result.observation.run_out.along_flow, 5);
}

TEST_F(Structures, inflow_and_release_run_together) {
    write("surge.csv", "time_s,discharge_m3ps,velocity_mps\n1,20,6\n4,20,6\n");
    write_valley(inflow());
    const run::RunResult result = run();
    EXPECT_EQ(result.status, run::RunStatus::complete) << result.stop_reason;
    EXPECT_NEAR(result.observation.volume_released, total_volume(loaded()),
                0.5 * std::pow(result.particle_spacing, 3) * 2);
}

TEST_F(Structures, inflow_over_an_area_brings_its_volume_and_its_density) {
    const std::string source = fmt::format(
        "[[inflow]]\nname = \"scarp\"\npolygon_m = [[{0}, {2}], [{1}, {2}], [{1}, {3}], [{0}, {3}]]\nhydrograph = "
        "\"rain.csv\"\n",
        west + 40, west + 60, south + 90, south + 110);
    write("rain.csv", "time_s,discharge_m3ps,velocity_mps\n0,0,1\n2,40,2\n4,0,1\n");
    write_features("houses.geojson", {rectangle(90, 90, 96, 110)});
    const std::string houses = "[buildings]\nfile = \"houses.geojson\"\n";
    write("scene.toml", "[terrain]\nfile = \"dem.tif\"\n" + houses + source);
    write_valley();
    write("scene.toml", "[terrain]\nfile = \"dem.tif\"\n" + houses + source);
    const Scene scene = loaded();
    EXPECT_THAT(scene.notes, Contains(HasSubstr("inflow \"scarp\": 80 m3 over 400 m2, down the slope")));
    const run::RunResult result = run();
    EXPECT_EQ(result.status, run::RunStatus::complete) << result.stop_reason;
    EXPECT_NEAR(result.observation.volume_released, 80, 1e-6);
    EXPECT_EQ(run({"solver.thread_count=1"}).hash, result.hash);
    ASSERT_TRUE(result.observation.buildings[0].hit);

    // Half as dense: the same motion, half the force and half the pressure.
    write("rain.csv", "time_s,discharge_m3ps,velocity_mps,density_kgpm3\n0,0,1,1000\n2,40,2,1000\n4,0,1,1000\n");
    const run::RunResult light = run();
    EXPECT_EQ(light.hash, result.hash);
    const observe::BuildingImpact &heavy_impact = result.observation.buildings[0],
                                  &impact = light.observation.buildings[0];
    EXPECT_NEAR(impact.peak_force, heavy_impact.peak_force / 2, 1e-5 * heavy_impact.peak_force);
    EXPECT_NEAR(impact.peak_dynamic_pressure, heavy_impact.peak_dynamic_pressure / 2,
                1e-5 * heavy_impact.peak_dynamic_pressure);
    const observe::TimeSample &heavy_row = result.observation.timeseries[30], &row = light.observation.timeseries[30];
    EXPECT_GT(row.kinetic_energy, 0);
    EXPECT_NEAR(row.kinetic_energy, heavy_row.kinetic_energy / 2, 1e-5 * heavy_row.kinetic_energy);
    const std::vector<float>&heavy_map = result.observation.maps.peak_pressure.values,
          &map = light.observation.maps.peak_pressure.values;
    ASSERT_EQ(map.size(), heavy_map.size());
    for (std::size_t k = 0; k < map.size(); ++k) {
        if (!(heavy_map[k] > 0)) continue;
        EXPECT_NEAR(map[k], heavy_map[k] / 2, 1e-4F * heavy_map[k]);
    }
    // Densities that differ: between those of the ends.
    write("rain.csv", "time_s,discharge_m3ps,velocity_mps,density_kgpm3\n0,0,1,1000\n2,40,2,1500\n4,0,1,2000\n");
    const run::RunResult mixed = run();
    EXPECT_EQ(mixed.hash, result.hash);
    EXPECT_GT(mixed.observation.buildings[0].peak_force, 1.02 * impact.peak_force);
    EXPECT_LT(mixed.observation.buildings[0].peak_force, 0.98 * heavy_impact.peak_force);
    EXPECT_EQ(run({"solver.thread_count=1"}).observation.maps.peak_pressure.values.size(),
              mixed.observation.maps.peak_pressure.values.size());
}

TEST_F(Structures, bad_inflow_areas_are_refused) {
    write("rain.csv", "time_s,discharge_m3ps,velocity_mps\n0,10,0\n2,10,0\n");
    const auto refusal = [&](const std::string& keys) {
        write_valley("[[inflow]]\nhydrograph = \"rain.csv\"\n" + keys);
        return load_error();
    };
    const auto corners = [](double x, double y, double to_x, double to_y) {
        return fmt::format("polygon_m = [[{0}, {1}], [{2}, {1}], [{2}, {3}]]\n", west + x, south + y, west + to_x,
                           south + to_y);
    };
    EXPECT_THAT(refusal(""), HasSubstr("exactly one of line_m, file, polygon_m, polygon_file must be given"));
    EXPECT_THAT(refusal(corners(40, 90, 60, 110) + "polygon_file = \"a.geojson\"\n"),
                HasSubstr("given are polygon_m, polygon_file"));
    EXPECT_THAT(refusal("polygon_m = [[0, 0], [1, 1]]\n"), HasSubstr("has 2 corners; an area needs three or more"));
    EXPECT_THAT(refusal(corners(40, 90, 40, 110)), HasSubstr("inflow[0].polygon_m: touches or crosses itself"));
    EXPECT_THAT(refusal(corners(40, 90, 6000, 110)), HasSubstr("where the ground is not known; the terrain covers"));
    EXPECT_THAT(refusal("polygon_file = \"none.geojson\"\n"), HasSubstr("inflow[0].polygon_file"));
    EXPECT_THAT(refusal(corners(40, 90, 60, 110) + "direction_deg = 360\n"),
                AllOf(HasSubstr("direction_deg"), HasSubstr("0 to below 360")));
    write_valley(inflow("rain.csv") + "direction_deg = 90\n");
    EXPECT_THAT(load_error(), HasSubstr("inflow[0].direction_deg: is refused across a line"));
    write_valley(inflow("rain.csv"));
    EXPECT_THAT(load_error(), HasSubstr("velocity_mps = 0 is refused")) << "across a line nothing comes in standing";
    const std::string header = "time_s,discharge_m3ps,velocity_mps,density_kgpm3\n";
    for (const auto& [row, message] :
         {std::pair{"0,1,1,0\n", "density_kgpm3 = \"0\" is refused; it must be a number from 1 to 30000"},
          {"0,1,1,1e9\n", "density_kgpm3 = \"1e9\" is refused"},
          {"0,1,1\n", "density_kgpm3 = \"\" is refused"}}) {
        write("rain.csv", header + row);
        EXPECT_THAT(load_error(), HasSubstr(message));
    }
}

TEST_F(Structures, bad_hydrographs_are_refused_by_line) {
    const auto refusal = [&](const std::string& text) {
        write("surge.csv", text);
        write_valley(inflow());
        return load_error();
    };
    const std::string header = "time_s,discharge_m3ps,velocity_mps\n";
    EXPECT_THAT(refusal("time,Q,v\n0,1,1\n"), HasSubstr("surge.csv:1: there is no column time_s"));
    EXPECT_THAT(refusal(header + "0,1,1\n0,2,1\n"), HasSubstr("surge.csv:3: time_s = 0 is refused"));
    EXPECT_THAT(refusal(header + "0,1,1\n1,-2,1\n"), HasSubstr("surge.csv:3: discharge_m3ps = \"-2\" is refused"));
    EXPECT_THAT(refusal(header + "0,1,1\n1,nan,1\n"), HasSubstr("discharge_m3ps = \"nan\" is refused"));
    EXPECT_THAT(refusal(header + "0,1,1\n1,5,0\n"), HasSubstr("velocity_mps = 0 is refused"));
    EXPECT_THAT(refusal(header + "0,1,1\n1,5\n"), HasSubstr("velocity_mps = \"\" is refused"));
    EXPECT_THAT(refusal(header + "0,1,1\n"), HasSubstr("has 1 rows of values; it must have at least 2"));
    EXPECT_THAT(refusal(header + "0,0,1\n1,0,1\n"), HasSubstr("brings no debris at all"));
    EXPECT_THAT(refusal(""), HasSubstr("surge.csv:1: there is no column time_s"));
    EXPECT_THAT(refusal(header + "500,1,1\n600,1,1\n"), HasSubstr("that must be below solver.end_time_s"));
    write_valley(inflow("none.csv"));
    EXPECT_THAT(load_error(), HasSubstr("inflow[0].hydrograph"));
}

}  // namespace
}  // namespace talus::scene
