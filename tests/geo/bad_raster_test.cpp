#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geo/raster.hpp"
#include "geo/rasters.hpp"
#include "geo/repair_raster.hpp"
#include "geo/terrain_frame.hpp"
#include "support/fixtures.hpp"

namespace talus::geo {
namespace {

using test::RasterOptions;
using test::TemporaryFolder;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

/// The message of a refused file; it must be one line that begins with the file, and nothing may reach stderr.
std::string refusal(const std::string& file, int band = 1) {
    testing::internal::CaptureStderr();
    const auto raster = read_terrain_raster(file, band, std::nullopt);
    EXPECT_THAT(testing::internal::GetCapturedStderr(), IsEmpty());
    if (raster.ok()) return "accepted";
    const std::string message = raster.error().message;
    EXPECT_THAT(message, StartsWith(file + ": "));
    EXPECT_THAT(message, Not(HasSubstr("\n")));
    return message;
}

class BadRaster : public testing::Test {
  protected:
    std::string write(const RasterOptions& options, const std::function<double(int, int)>& value = pattern) {
        return test::write_raster(folder_.file("dem.tif"), options, value);
    }
    TemporaryFolder folder_;
};

TEST_F(BadRaster, missing_file) {
    EXPECT_THAT(refusal(folder_.file("nowhere.tif")), EndsWith(": no such file"));
}

TEST_F(BadRaster, folder) {
    EXPECT_THAT(refusal(folder_.path().string()), HasSubstr("is a folder"));
}

TEST_F(BadRaster, empty_file) {
    EXPECT_THAT(refusal(test::write_text(folder_.file("empty.tif"), "")), HasSubstr("is empty (0 bytes)"));
}

TEST_F(BadRaster, not_a_raster) {
    EXPECT_THAT(refusal(test::write_text(folder_.file("notes.tif"), "dear diary")),
                HasSubstr("cannot be read as a raster"));
}

TEST_F(BadRaster, truncated_at_any_length) {
    for (const char* compression : {"NONE", "DEFLATE"}) {
        const std::string file = write(
            {.columns = 200, .rows = 150, .creation_options = {std::string("COMPRESS=") + compression, "TILED=YES"}},
            [](int column, int row) { return 100 + std::sin(column * 12.9 + row * 78.2); });
        const auto whole = std::filesystem::file_size(file);
        ASSERT_EQ(refusal(file), "accepted");
        for (const double share : {0.95, 0.5, 0.2, 0.02, 0.001}) {
            const std::string cut = folder_.file("cut.tif");
            std::filesystem::copy_file(file, cut, std::filesystem::copy_options::overwrite_existing);
            std::filesystem::resize_file(cut, static_cast<std::uintmax_t>(share * static_cast<double>(whole)));
            EXPECT_THAT(refusal(cut), Not("accepted")) << compression << " cut to " << share;
        }
    }
}

TEST_F(BadRaster, truncated_text_and_raw_grids) {
    for (const auto& [driver, name] : {std::pair{"AAIGrid", "dem.asc"}, {"ENVI", "dem.bil"}, {"HFA", "dem.img"}}) {
        const std::string file =
            test::write_raster(folder_.file(name), {.columns = 100, .rows = 100, .driver = driver}, pattern);
        std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
        EXPECT_THAT(refusal(file), Not("accepted")) << driver;
    }
}

TEST_F(BadRaster, blocks_that_were_never_written_are_nodata_or_0) {
    // The directory is there, half of the blocks are not: a sparse raster, or a copy that was stopped.
    for (const bool declared : {true, false}) {
        const std::string file = folder_.file(declared ? "declared.tif" : "sparse.tif");
        char** options = CSLAddString(CSLAddString(nullptr, "SPARSE_OK=TRUE"), "TILED=YES");
        GDALAllRegister();
        {
            const GDALDatasetUniquePtr data(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
                file.c_str(), 1024, 1024, 1, GDT_Float32, options));
            double transform[6] = {824000, 5, 0, 830000, 0, -5};
            data->SetGeoTransform(transform);
            const OGRSpatialReference reference = test::spatial_reference(2326);
            data->SetSpatialRef(&reference);
            if (declared) data->GetRasterBand(1)->SetNoDataValue(-9999);
            std::vector<float> half(1024 * 512, 50);
            ASSERT_EQ(data->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, 1024, 512, half.data(), 1024, 512, GDT_Float32,
                                                       0, 0, nullptr),
                      CE_None);
        }
        CSLDestroy(options);
        const auto raster = read_terrain_raster(file, 1, std::nullopt);
        ASSERT_TRUE(raster) << raster.error().message;
        EXPECT_EQ(raster->grid.at(500, 1000), 50);
        if (declared) {
            EXPECT_TRUE(std::isnan(raster->grid.at(500, 10)));
        } else {
            EXPECT_EQ(raster->grid.at(500, 10), 0);
        }
        EXPECT_EQ(read_terrain_frame(file, 1)->holes_read_0, !declared);
    }
}

TEST_F(BadRaster, band_that_does_not_exist) {
    const std::string file = write({.bands = 3});
    EXPECT_THAT(refusal(file, 4), HasSubstr("band = 4 does not exist, the file has bands 1 to 3"));
    EXPECT_THAT(refusal(file, 0), HasSubstr("the file has bands 1 to 3"));
}

TEST_F(BadRaster, all_nodata) {
    EXPECT_THAT(refusal(write({.nodata = 7, .declare_nodata = true}, [](int, int) { return 7.0; })),
                HasSubstr("no cell holds data"));
}

TEST_F(BadRaster, smaller_than_two_by_two) {
    EXPECT_THAT(refusal(write({.columns = 1, .rows = 9})), HasSubstr("has 1 x 9 cells, at least 2 x 2 are needed"));
}

TEST_F(BadRaster, geographic_crs_names_the_utm_zone_of_its_centre) {
    const std::string file = write({.x_min = 114.05, .y_min = 22.36, .cell = 0.001, .epsg = 4326});
    EXPECT_THAT(refusal(file), AllOf(HasSubstr("EPSG:4326 (WGS 84) is geographic (degrees)"),
                                     HasSubstr("gdalwarp -t_srs EPSG:32650 -r bilinear -ot Float32 -dstnodata -9999 " +
                                               file + " " + folder_.file("dem_metric.tif"))));
    EXPECT_THAT(refusal(write({.x_min = -72, .y_min = -16.5, .cell = 0.001, .epsg = 4326})), HasSubstr("EPSG:32719"));
}

/// The file of an office whose positions and heights are in feet, with elevations from 500 to 520 feet.
std::string write_in_feet(const std::string& file) {
    OGRSpatialReference reference;
    reference.SetFromUserInput("EPSG:6529+6360");  // NAD83(2011) / New Mexico Central + NAVD88 height, both in feet
    char* wkt = nullptr;
    reference.exportToWkt(&wkt);
    const std::string text = wkt;
    CPLFree(wkt);
    return test::write_raster(file, {.x_min = 1650000, .y_min = 1700000, .cell = 10, .wkt = text},
                              [](int column, int row) { return 500 + 20 * (column + row) / 33.0; });
}

TEST_F(BadRaster, feet_in_both_directions_are_mended_one_after_the_other) {
    const std::string file = write_in_feet(folder_.file("feet.tif"));
    EXPECT_THAT(refusal(file), AllOf(HasSubstr("a CRS in metres is needed"),
                                     HasSubstr("gdalwarp -novshift -t_srs EPSG:32613 -r bilinear")));
    // The same, of an upload: heights are converted once.
    const std::string mended = folder_.file("mended.tif");
    Mending mending;
    mending.metric = true;
    mending.metres_per_unit = 0.3048006096;
    const Status done = repair_raster(file, mended, mending, 1e6);
    ASSERT_TRUE(done.ok()) << done.error().message;
    const auto terrain = read_terrain_raster(mended, 1, std::nullopt);
    ASSERT_TRUE(terrain.ok()) << terrain.error().message;
    const auto& heights = terrain->grid.values;
    EXPECT_THAT(heights, testing::Each(testing::AnyOf(testing::IsNan(), testing::FloatNear(510 * 0.3048F, 3.1F))));
    EXPECT_FALSE(std::isnan(terrain->grid.at(10, 7)));
}

TEST_F(BadRaster, missing_crs) {
    const std::string file = write({.epsg = 0});
    EXPECT_THAT(refusal(file), HasSubstr("gdal_edit.py -a_srs EPSG:nnnn " + file));
    const std::string text = test::write_raster(folder_.file("dem.asc"), {.epsg = 0, .driver = "AAIGrid"}, pattern);
    EXPECT_THAT(refusal(text), HasSubstr("gdal_translate -a_srs EPSG:nnnn " + text)) << "cannot be edited in place";
}

TEST_F(BadRaster, crs_in_feet) {
    // NAD83 / California zone 3 in US survey feet, San Francisco.
    const std::string file = write({.x_min = 6000000, .y_min = 2110000, .epsg = 2227});
    EXPECT_THAT(refusal(file), AllOf(HasSubstr("EPSG:2227"), HasSubstr("0.304801 m"), HasSubstr("-t_srs EPSG:32610")));
}

TEST_F(BadRaster, web_mercator_is_not_true_to_scale) {
    const std::string file = write({.x_min = 12696000, .y_min = 2556000, .epsg = 3857});
    EXPECT_THAT(refusal(file), AllOf(HasSubstr("is 0.923 m on the ground here"), HasSubstr("-t_srs EPSG:32650")));
}

TEST_F(BadRaster, heights_in_feet) {
    for (const char* unit : {"ft", "US survey foot", "Feet"}) {
        const std::string file = write({.unit = unit});
        EXPECT_THAT(refusal(file),
                    AllOf(HasSubstr(std::string("values are in ") + unit),
                          HasSubstr("gdal_calc.py -A " + file + " --A_band=1 --calc='A*0.3048"),
                          HasSubstr("gdal_edit.py -units m -a_srs EPSG:2326 " + folder_.file("dem_m.tif"))));
    }
}

TEST_F(BadRaster, command_for_feet_counts_scale_and_offset) {
    EXPECT_THAT(refusal(write({.scale = 0.1, .offset = -10, .unit = "ft"})), HasSubstr("--calc='A*0.03048-3.048'"));
}

TEST_F(BadRaster, heights_in_feet_by_the_vertical_crs) {
    // UTM 10N with NAVD88 height in US survey feet.
    OGRSpatialReference both;
    both.SetFromUserInput("EPSG:26910+6360");
    char* text = nullptr;
    both.exportToWkt(&text);
    const std::string file = write({.x_min = 550000, .y_min = 4180000, .wkt = text});
    CPLFree(text);
    EXPECT_THAT(refusal(file), HasSubstr("values are in US survey foot of 0.30480061 m"));
}

TEST_F(BadRaster, rotated) {
    EXPECT_THAT(refusal(write({.rotation = 1})),
                AllOf(HasSubstr("the raster is rotated"), HasSubstr("gdalwarp -tr 5.099019514 5.099019514")));
}

TEST_F(BadRaster, cells_that_are_not_square) {
    EXPECT_THAT(refusal(write({.cell = 5, .cell_height = 4})),
                AllOf(HasSubstr("cells are 5 m x 4 m"), HasSubstr("gdalwarp -tr 4 4 ")));
}

TEST_F(BadRaster, no_position) {
    EXPECT_THAT(refusal(write({.georeferenced = false})), HasSubstr("gdal_translate -a_ullr"));
}

TEST_F(BadRaster, undeclared_nodata) {
    for (const double value : {-9999.0, -32768.0, 32767.0, -3.4028234663852886e38}) {
        const std::string file = write({}, [&](int column, int row) { return column == 3 ? value : 40.0 + row; });
        EXPECT_THAT(refusal(file), AllOf(HasSubstr("15 cells hold"), HasSubstr("declared nodata value: none"),
                                         HasSubstr("gdal_edit.py -a_nodata"), HasSubstr(file)))
            << value;
    }
}

TEST_F(BadRaster, file_names_with_blanks_are_quoted_in_commands) {
    const std::string file = test::write_raster(folder_.file("my dem.tif"), {.epsg = 0}, pattern);
    EXPECT_THAT(refusal(file), AllOf(HasSubstr("EPSG:nnnn '" + file + "'"), HasSubstr("terrain.crs = \"local\"")));
}

}  // namespace
}  // namespace talus::geo
