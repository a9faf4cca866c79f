#include <unistd.h>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "geo/vector.hpp"
#include "scene/scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Limits : public SceneFolder {
  protected:
    static constexpr const char* loaded = "(it loaded)";
};

TEST_F(Limits, too_many_particles_name_the_spacing_that_fits) {
    write_valley("", "volume_m3 = 512");
    EXPECT_THAT(load_error({"solver.particle_spacing_m=0.1", "solver.particle_limit=1024"}),
                AllOf(HasSubstr("solver.particle_spacing_m: "), HasSubstr("512000 particles"),
                      HasSubstr("a spacing of 0.794 m or more would fit")));
}

TEST_F(Limits, particles_too_far_apart_are_refused) {
    write_valley("", "thickness_m = 1000");
    EXPECT_EQ(load_error({"solver.target_particle_count=1"}), std::string(loaded));
    write_features("release.geojson", {rectangle(20, 50, 120, 150)});
    EXPECT_THAT(load_error({"solver.target_particle_count=1"}),
                AllOf(HasSubstr("solver.target_particle_count = 1 is refused"), HasSubstr("0.0001 to 100 m")));
}

TEST_F(Limits, more_memory_than_the_machine_has_is_refused) {
    const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
    if (memory > 140e9) GTEST_SKIP() << "a scene of the largest number of particles fits";
    write_valley("", "thickness_m = 1000");
    EXPECT_THAT(load_error({"solver.target_particle_count=100000000", "solver.particle_limit=100000000"}),
                AllOf(HasSubstr("1e+08 particles"), HasSubstr("GB of memory, and this machine has")));
}

TEST_F(Limits, a_thin_release_is_refused_however_its_thickness_is_given) {
    write_valley("", "volume_m3 = 0.01");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("scene.toml:6: release[0].volume_m3: "), HasSubstr("0.01 m3 over"),
                                    HasSubstr("at least 0.001 m")));
    write_features("release.geojson", {rectangle(20, 90, 40, 110, R"("t": 1e-9)")});
    write("scene.toml",
          "[terrain]\nfile = \"dem.tif\"\n[[release]]\nfile = \"release.geojson\"\nthickness_attribute = \"t\"\n");
    EXPECT_THAT(load_error(),
                AllOf(HasSubstr("release[0].thickness_attribute: "), HasSubstr("1e-09 m thick on average")));
}

TEST_F(Limits, maps_and_front_table_have_a_size_that_can_be_written) {
    write_valley("[outputs]\nmap_cell_m = 0.01\n");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("scene.toml:8: outputs.map_cell_m = 0.01 is refused"),
                                    HasSubstr("6e+08 cells"), HasSubstr("at least 0.013 (m)")));
    EXPECT_EQ(load_error({"outputs.map_cell_m=0.013"}), std::string(loaded));
}

TEST_F(Limits, the_run_over_time_has_a_size_that_can_be_written) {
    write_valley("[outputs]\nseries = [\"netcdf\"]\nseries_interval_s = 0.01\n");
    EXPECT_THAT(load_error(),
                AllOf(HasSubstr("scene.toml:9: outputs.series_interval_s = 0.01 is refused"), HasSubstr("12001 frames"),
                      HasSubstr("there may be 10000: it must be at least 0.013 (s)")));
    EXPECT_EQ(load_error({"outputs.series_interval_s=0.013"}), std::string(loaded));
    EXPECT_EQ(load_error({"outputs.series=[]"}), std::string(loaded));
    EXPECT_THAT(load_error({"solver.model=depth_averaged"}), HasSubstr("12001 frames"));
    EXPECT_THAT(load_error({"outputs.series=[\"netcdf\", \"avi\"]"}),
                AllOf(HasSubstr("outputs.series: \"avi\" is refused"), HasSubstr("\"netcdf\", \"geotiff\"")));
}

TEST_F(Limits, tiles_of_a_place_that_nobody_knows_are_refused) {
    write_valley("");
    EXPECT_EQ(load_error({"outputs.series=[\"3dtiles\"]"}), std::string(loaded));
    const geo::Crs local{"LOCAL_CS[\"site\",UNIT[\"metre\",1]]", "site", 0};
    const Grid<float> plain({west, south, cell, columns, rows}, 7);
    ASSERT_TRUE(geo::write_cog(path("dem.tif"), {&plain, "elevation", "m"}, local));
    const Polygon area{{{west + 20, south + 90}, {west + 40, south + 90}, {west + 40, south + 110}}, {}};
    ASSERT_TRUE(geo::write_geopackage_layer(path("release.gpkg"), "release", {}, {{{area}, {}, {}}}, local));
    write("scene.toml", "[terrain]\nfile = \"dem.tif\"\n[[release]]\nfile = \"release.gpkg\"\nthickness_m = 2\n");
    EXPECT_EQ(load_error(), std::string(loaded));
    EXPECT_THAT(load_error({"outputs.series=[\"gltf\", \"3dtiles\"]"}),
                AllOf(HasSubstr("outputs.series: \"3dtiles\" is refused"), HasSubstr("site")));
}

TEST_F(Limits, hundreds_of_structures_upon_each_other_are_refused_before_their_walls_are_cut) {
    const auto barriers = [](int count) {
        std::string text;
        for (int k = 0; k < count; ++k) {
            text += fmt::format("[[barrier]]\nline_m = [[{0}, {1}], [{0}, {2}]]\nheight_m = 2\nthickness_m = 1\n",
                                west + 150 + 0.001 * k, south + 96, south + 104);
        }
        return text;
    };
    write_valley(barriers(1500));
    EXPECT_THAT(load_error(), AllOf(HasSubstr("scene.toml: 1500 buildings and barriers overlap so much"),
                                    HasSubstr("may be cut into 5e+07; place them apart")));
    write_valley(barriers(100));
    EXPECT_EQ(load_error(), std::string(loaded));
}

TEST_F(Limits, a_map_has_no_cells_that_every_particle_covers_in_thousands) {
    write_valley("[outputs]\nmap_cell_m = 0.05\n[solver]\nparticle_spacing_m = 3\n");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("scene.toml:8: outputs.map_cell_m = 0.05 is refused"),
                                    HasSubstr("it must be at least 0.06 (m)")));
    EXPECT_EQ(load_error({"outputs.map_cell_m=0.06"}), std::string(loaded));
}

TEST_F(Limits, an_inflow_deeper_than_any_release_is_refused) {
    write_valley("[[inflow]]\nline_m = [[824100, 825110], [824100, 825090]]\nhydrograph = \"h.csv\"\n");
    const auto error = [&](const std::string& lines) {
        write("h.csv", "time_s,discharge_m3ps,velocity_mps\n" + lines);
        return load_error();
    };
    EXPECT_EQ(error("0,10,2\n10,10,2\n"), std::string(loaded));
    EXPECT_THAT(error("0,1e308,1\n10,1e308,1\n"), HasSubstr("h.csv:2: discharge_m3ps = \"1e308\" is refused"));
    EXPECT_THAT(error("0,1e7,300\n1e308,1e7,300\n"), HasSubstr("h.csv:3: time_s = \"1e308\" is refused"));
    EXPECT_THAT(
        error("0,1e6,1\n10,10,2\n"),
        AllOf(HasSubstr("inflow[0].hydrograph: at 0 s, 1e+06 m3/s at 1 m/s across 20 m is a flow 5e+04 m thick"),
              HasSubstr("at most 1000 m")));
}

}  // namespace
}  // namespace talus::scene
