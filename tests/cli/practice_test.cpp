// Inputs of users that once gave a wrong value, each a folder with its README of what is right: ../cases/reports beside
// the folder that TALUS_DATA names. Every folder has a test here, run with the program as its users do.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/program.hpp"
#include "core/csv_table.hpp"
#include "core/utf8.hpp"
#include "support/fixtures.hpp"

namespace talus::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

using Arguments = std::vector<std::string>;

/// A copy of a report's folder; skips the test, by the folder's name, where the reports are not there.
class Practice : public testing::Test {
  protected:
    void use(const std::string& name) {
        const char* data = std::getenv("TALUS_DATA");
        const fs::path report = fs::path(data == nullptr ? "" : data) / "../cases/reports" / name;
        if (data == nullptr || !fs::is_directory(report)) {
            GTEST_SKIP() << name << " not run: TALUS_DATA does not say where ../cases/reports lies";
        }
        fs::copy(report, folder_.path(), fs::copy_options::recursive);
        GDALAllRegister();
    }
    [[nodiscard]] ProgramOutcome talus(const Arguments& arguments) const {
        return run_program(arguments, {.folder = folder_.path()});
    }
    /// Runs a scene to the folder `output`, with more options.
    [[nodiscard]] ProgramOutcome run(const std::string& scene, const std::string& output,
                                     const Arguments& options = {}) const {
        Arguments arguments{"run", scene, "-o", output};
        arguments.insert(arguments.end(), options.begin(), options.end());
        auto outcome = talus(arguments);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
        return outcome;
    }
    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
    [[nodiscard]] std::string text(const std::string& name) const { return read_text(file(name)); }

    [[nodiscard]] Arguments texts(const std::string& table_file, const std::string& column) const {
        const auto table = read_csv_table(file(table_file), 100000);
        if (!table) throw std::runtime_error(table.error().message);
        const auto at = std::find(table->columns.begin(), table->columns.end(), column);
        if (at == table->columns.end()) throw std::runtime_error("no column " + column);
        Arguments fields;
        for (const CsvRow& row : table->rows) {
            fields.push_back(row.fields[static_cast<std::size_t>(at - table->columns.begin())]);
        }
        return fields;
    }
    /// Empty fields are not a number.
    [[nodiscard]] std::vector<double> numbers(const std::string& table_file, const std::string& column) const {
        std::vector<double> values;
        for (const std::string& field : texts(table_file, column)) {
            values.push_back(field.empty() ? std::numeric_limits<double>::quiet_NaN() : std::stod(field));
        }
        return values;
    }
    [[nodiscard]] double number(const std::string& table_file, const std::string& column) const {
        return numbers(table_file, column).at(0);
    }
    [[nodiscard]] double largest(const std::string& table_file, const std::string& column) const {
        const auto values = numbers(table_file, column);
        return *std::max_element(values.begin(), values.end());
    }
    /// m3 in a map of depths, east of `x`.
    [[nodiscard]] double volume_east_of(const std::string& map, double x) const {
        const GDALDatasetUniquePtr data(GDALDataset::Open(file(map).c_str(), GDAL_OF_RASTER));
        if (!data) throw std::runtime_error("cannot open " + map);
        std::vector<double> transform(6), line(static_cast<std::size_t>(data->GetRasterXSize()));
        data->GetGeoTransform(transform.data());
        double volume = 0;
        for (int row = 0; row < data->GetRasterYSize(); ++row) {
            if (data->GetRasterBand(1)->RasterIO(GF_Read, 0, row, data->GetRasterXSize(), 1, line.data(),
                                                 data->GetRasterXSize(), 1, GDT_Float64, 0, 0, nullptr) != CE_None) {
                throw std::runtime_error("cannot read " + map);
            }
            for (std::size_t column = 0; column < line.size(); ++column) {
                const double centre = transform[0] + (static_cast<double>(column) + 0.5) * transform[1];
                if (centre > x && line[column] > 0) volume += line[column] * std::abs(transform[1] * transform[5]);
            }
        }
        return volume;
    }

  private:
    TemporaryFolder folder_;
};

// No speed above free fall, no front beyond the energy line, and a run-out that the grid does not choose.
TEST_F(Practice, cliff_depth_averaged) {
    use("cliff_depth_averaged");
    if (IsSkipped()) return;
    std::vector<double> run_outs;
    for (const char* cell : {"5", "2.5", "1.25"}) {
        const std::string output = std::string("cells_") + cell;
        (void)run("scene.toml", output, {"--set", std::string("solver.grid_cell_m=") + cell});
        EXPECT_LT(largest(output + "/timeseries.csv", "largest_speed_mps"), 34.9) << cell;
        EXPECT_LT(number(output + "/run_out.csv", "front_chainage_m"), 214) << cell;
        run_outs.push_back(number(output + "/run_out.csv", "run_out_along_flow_m"));
    }
    const auto [shortest, longest] = std::minmax_element(run_outs.begin(), run_outs.end());
    EXPECT_LT(*longest - *shortest, 0.15 * *longest) << "148, 260 and 388 m once";
    (void)run("scene.toml", "particles",
              {"--set", "solver.model=particles", "--set", "solver.target_particle_count=1000"});
    EXPECT_NEAR(number("particles/run_out.csv", "run_out_along_flow_m"), 140, 10);
    EXPECT_NEAR(largest("particles/timeseries.csv", "largest_speed_mps"), 24.4, 2);
}

// What comes over a dam and what it holds, and a front that goes on where the particles' path ends.
TEST_F(Practice, dam_depth_averaged_zeros) {
    use("dam_depth_averaged_zeros");
    if (IsSkipped()) return;
    const auto compared = talus({"compare", "scene.toml", "-o", "low", "--set", "solver.target_particle_count=700"});
    ASSERT_EQ(compared.exit_code, 0) << compared.error;
    const std::string low = "low/depth_averaged/";
    EXPECT_NEAR(volume_east_of(low + "deposit_depth.tif", 650230), 1510, 3);
    EXPECT_NEAR(number(low + "buildings.csv", "overtopped_m3"), 1510, 3);
    EXPECT_NEAR(number(low + "buildings.csv", "retained_m3"), 1.5, 1.5);
    EXPECT_NEAR(largest(low + "structures_over_time.csv", "overtopped_m3"), 1510, 3);
    const double front = number(low + "run_out.csv", "front_chainage_m");
    EXPECT_GT(front, number("low/particles/run_out.csv", "front_chainage_m") + 10);
    EXPECT_NEAR(front, number(low + "run_out.csv", "run_out_along_flow_m"), 10);

    const auto high = run("scene.toml", "high", {"--set", "barrier[0].height_m=20"});
    EXPECT_EQ(number("high/buildings.csv", "overtopped_m3"), 0);
    EXPECT_NEAR(number("high/buildings.csv", "retained_m3"), 1512, 2);
    EXPECT_THAT(high.out, HasSubstr("1512.0 m3 retained"));
}

// Drop and angles are known also where the toe lies between the last cell centre and the edge of the terrain.
TEST_F(Practice, drop_after_leaving_terrain) {
    use("drop_nan_after_leaving_terrain");
    if (IsSkipped()) return;
    const auto outcome = run("scene.toml", "result", {"--set", "solver.target_particle_count=700"});
    EXPECT_NEAR(number("result/run_out.csv", "drop_m"), 93, 4);
    EXPECT_NEAR(number("result/run_out.csv", "runout_angle_deg"), 14, 0.7);
    EXPECT_EQ(texts("result/run_out.csv", "at_least"), Arguments{"yes"});
    EXPECT_THAT(outcome.out, AllOf(Not(HasSubstr("nan")), HasSubstr("debris left the terrain")));
    EXPECT_EQ(text("result/report.html").find("nan degrees"), std::string::npos);
}

TEST_F(Practice, hillshade_as_terrain) {
    use("hillshade_as_terrain");
    if (IsSkipped()) return;
    const auto created =
        talus({"scene", "new", "--dem", "hs.tif", "--release", "rel.geojson", "--thickness-m", "1", "-o", "x"});
    EXPECT_THAT(created.out,
                AllOf(HasSubstr("8-bit numbers"), HasSubstr("these are rarely elevations"), HasSubstr("hillshade")))
        << created.error;
}

// Quoted decimal commas, semicolons and UTF-16 are one hydrograph.
TEST_F(Practice, hydrograph_quoted_decimal_comma) {
    use("hydrograph_quoted_decimal_comma");
    if (IsSkipped()) return;
    const auto checked = [&](const std::string& table) {
        return talus({"scene", "check", "scene.toml", "--set", "inflow[0].hydrograph=" + table}).out;
    };
    EXPECT_THAT(checked("hyd_dec.csv"), HasSubstr(": 131.2 m3 between 0 and 25 s"));
    for (const char* table : {"hyd_ok.csv", "hyd_de.csv", "hyd_utf16.csv"}) {
        EXPECT_THAT(checked(table), HasSubstr(": 210 m3 between 0 and 25 s")) << table;
    }
    (void)run("scene.toml", "result", {"--set", "solver.end_time_s=30"});
    double volume = 0;
    for (const char* part : {"volume_moving_m3", "volume_deposited_m3", "volume_left_m3"}) {
        volume += numbers("result/timeseries.csv", part).back();
    }
    EXPECT_NEAR(volume, 131.25, 0.1);
    write_text(file("surplus.csv"), "time_s,discharge_m3ps,velocity_mps\n0,0,3\n5,10,5,3\n25,0,3\n");
    const auto refused = talus({"scene", "check", "scene.toml", "--set", "inflow[0].hydrograph=surplus.csv"});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.error, HasSubstr("surplus.csv:3"));
}

// A flume has metres of its own, and volumes, lengths and chainages with the digits that it needs.
TEST_F(Practice, lab_flume_local_system) {
    use("lab_flume_local_system");
    if (IsSkipped()) return;
    const auto create = [&](const std::string& terrain, const std::string& release, const Arguments& options = {}) {
        Arguments arguments{"scene", "new", "--dem", terrain, "--release", release, "--thickness-m", "0.08"};
        arguments.insert(arguments.end(), {"--particles", "1500", "-o", terrain + "_" + release});
        arguments.insert(arguments.end(), options.begin(), options.end());
        return talus(arguments);
    };
    for (const char* release : {"rel.geojson", "rel_undefined.gpkg", "rel_local.gpkg"}) {
        EXPECT_EQ(create("flume.tif", release).exit_code, 0) << release;
    }
    const auto refused = create("flume_nocrs.tif", "rel.geojson");
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.error, HasSubstr("\"local\""));
    EXPECT_EQ(create("flume_nocrs.tif", "rel.geojson", {"--crs", "local"}).exit_code, 0);

    const auto outcome = run("flume.tif_rel_local.gpkg/scene.toml", "result");
    EXPECT_THAT(outcome.out, HasSubstr("0.0112 m3 released"));
    EXPECT_NEAR(number("result/run_out.csv", "run_out_along_flow_m"), 2.47, 0.08);
    EXPECT_NEAR(number("result/run_out.csv", "drop_m"), 1.23, 0.04);
    EXPECT_GE(numbers("result/front.csv", "chainage_m").size(), 15u) << "a row per 0.1 m";
}

// The name of a .dbf in Latin-1 is UTF-8 in every output.
TEST_F(Practice, latin1_dbf_names) {
    use("latin1_dbf_names");
    if (IsSkipped()) return;
    (void)run("scene.toml", "result", {"--set", "solver.target_particle_count=500"});
    const std::string name = "M\xC3\xBCllerh\xC3\xBCtte";
    EXPECT_EQ(texts("result/buildings.csv", "name"), Arguments{name});
    for (const char* output : {"report.html", "results.kml", "results.json", "buildings.csv"}) {
        const std::string written = text(std::string("result/") + output);
        EXPECT_NE(written.find(name), std::string::npos) << output;
        EXPECT_EQ(invalid_utf8(written), std::string::npos) << output;
    }
    const GDALDatasetUniquePtr data(GDALDataset::Open(file("result/results.gpkg").c_str(), GDAL_OF_VECTOR));
    ASSERT_TRUE(data);
    OGRLayer* const buildings = data->GetLayerByName("buildings");
    ASSERT_NE(buildings, nullptr);
    const OGRFeatureUniquePtr feature(buildings->GetNextFeature());
    ASSERT_TRUE(feature);
    EXPECT_EQ(std::string(feature->GetFieldAsString("name")), name);
}

// A file of two dams is two barriers.
TEST_F(Practice, line_files_all_features) {
    use("line_files_first_feature_only");
    if (IsSkipped()) return;
    const auto checked = talus({"scene", "check", "dams.toml"});
    EXPECT_THAT(checked.out,
                AllOf(HasSubstr("barriers    2\n"), HasSubstr("\"dams upper\""), HasSubstr("\"dams lower\"")))
        << checked.error;
    (void)run("dams.toml", "result", {"--set", "solver.end_time_s=1"});
    EXPECT_THAT(texts("result/buildings.csv", "name"), ElementsAre("dams upper", "dams lower"));
}

TEST_F(Practice, netcdf_of_an_oblique_mercator_system) {
    use("netcdf_oblique_mercator");
    if (IsSkipped()) return;
    (void)run("scene2056.toml", "result");
    EXPECT_TRUE(fs::exists(file("result/report.html")));
    const std::string maps = "NETCDF:\"" + file("result/series/maps.nc") + "\":depth";
    const GDALDatasetUniquePtr data(GDALDataset::Open(maps.c_str(), GDAL_OF_RASTER));
    ASSERT_TRUE(data);
    EXPECT_EQ(data->GetRasterCount(), 4) << "0, 1, 2 and 3 s";
}

// Heights as OpenStreetMap has them: read with their unit, or assumed and counted so.
TEST_F(Practice, numbers_with_units_in_text) {
    use("numbers_with_units_in_text");
    if (IsSkipped()) return;
    (void)run("heights.toml", "result", {"--set", "solver.end_time_s=1"});
    const auto heights = numbers("result/buildings.csv", "height_m");
    const std::vector<double> right{12, 9.144, 12.5, 12.192, 7, 6, 6, 10, 9, 6};
    ASSERT_EQ(heights.size(), right.size());
    for (std::size_t i = 0; i < right.size(); ++i) EXPECT_NEAR(heights[i], right[i], 1e-3) << i;
    EXPECT_THAT(texts("result/buildings.csv", "height_assumed"),
                ElementsAre("no", "no", "no", "no", "no", "yes", "yes", "no", "no", "yes"));
}

// Layers, folders, closed lines, archives, a raster far too large, and attributes in capitals.
TEST_F(Practice, scene_new_dead_ends) {
    use("scene_new_dead_ends");
    if (IsSkipped()) return;
    const auto create = [&](const Arguments& options) {
        fs::remove_all(file("x"));
        Arguments arguments{"scene", "new", "-o", "x"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const auto created = talus(arguments);
        if (created.exit_code != 0) return created.error;
        return talus({"scene", "check", "x/scene.toml"}).out;
    };
    const auto release = [&](const Arguments& options) {
        Arguments arguments{"--dem", "dem.tif", "--thickness-m", "1.5", "--release"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return create(arguments);
    };
    EXPECT_THAT(release({"multi.gpkg"}), AllOf(HasSubstr("|layername=NAME"), HasSubstr("release 2024, houses")));
    const auto scar = HasSubstr(": 1512.26 m3, ");
    EXPECT_THAT(release({"multi.gpkg", "--release-layer", "release 2024"}), scar);
    EXPECT_THAT(release({"multi.gpkg|layername=release 2024"}), scar);
    EXPECT_THAT(release({"folders.kml|layername=release"}), scar);
    EXPECT_THAT(release({"line.kml"}), scar);
    EXPECT_THAT(release({"ring.kml"}), scar);
    EXPECT_THAT(release({"scar.zip"}), scar);
    EXPECT_THAT(create({"--dem", "dem.zip", "--thickness-m", "1.5", "--release", "scar.zip"}), scar);

    const Arguments large{"--dem", "big.vrt", "--thickness-m", "1.5", "--release", "bigrel.geojson"};
    EXPECT_THAT(create(large), AllOf(HasSubstr(" cells of 1 m"), HasSubstr(", cropped"), HasSubstr("2500 m2 in plan")));
    Arguments part = large;
    part.insert(part.end(), {"--extent", "659900", "5249900", "660300", "5250100", "--cell", "2"});
    EXPECT_THAT(create(part), HasSubstr("200 x 100 cells of 2 m"));

    EXPECT_THAT(create({"--dem", "dem.tif", "--release", "upper.shp", "--buildings", "bupper.geojson"}),
                AllOf(HasSubstr("mean thickness 0.8 m"), HasSubstr("buildings   1, 0 with an assumed height")));
    EXPECT_THAT(text("x/scene.toml"),
                AllOf(HasSubstr("\nthickness_attribute = \"THICKNESS\""), HasSubstr("\nheight_attribute = \"HEIGHT\""),
                      HasSubstr("\nname_attribute = \"NAME\"")));
}

// A 0 that the file does not declare is refused with the command that mends it, and what is left runs as it should.
TEST_F(Practice, undeclared_zero) {
    use("undeclared_zero");
    if (IsSkipped()) return;
    const auto refused = talus({"run", "zero.toml", "-o", "zero"});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.error, AllOf(HasSubstr("hold exactly 0 m"), HasSubstr("gdal_translate -a_nodata 0 zero.tif")));
    EXPECT_FALSE(fs::exists(file("zero")));
    (void)run("zero.toml", "result",
              {"--set", "terrain.extent_m=[650000, 5240500, 652000, 5241500]", "--set", "solver.end_time_s=15"});
    EXPECT_LT(largest("result/timeseries.csv", "largest_speed_mps"), 60) << "14010 m/s once";
}

}  // namespace
}  // namespace talus::test
