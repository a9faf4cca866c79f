#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geo/latitude.hpp"
#include "geo/raster.hpp"
#include "geo/rasters.hpp"
#include "support/fixtures.hpp"

namespace talus::geo {
namespace {

using test::RasterOptions;
using test::TemporaryFolder;
using testing::HasSubstr;

/// A value that tells column and row apart.
TEST(TerrainRaster, gives_cells_counted_from_the_south_west) {
    const TemporaryFolder folder;
    const std::string file = test::write_raster(folder.file("dem.tif"), {.columns = 7, .rows = 5}, pattern);
    const auto raster = read_terrain_raster(file, 1, std::nullopt);
    ASSERT_TRUE(raster.ok()) << raster.error().message;
    const GridGeometry& g = raster->grid.geometry;
    EXPECT_EQ(g, (GridGeometry{824000, 825000, 5, 7, 5}));
    for (int row = 0; row < 5; ++row) {
        for (int column = 0; column < 7; ++column) {
            EXPECT_FLOAT_EQ(raster->grid.at(column, row), static_cast<float>(pattern(column, row)));
        }
    }
    EXPECT_EQ(raster->crs.epsg, 2326);
    EXPECT_EQ(raster->crs.label(), "EPSG:2326 (Hong Kong 1980 Grid System)");
    EXPECT_EQ(raster->vertical_unit, "not stated");
    EXPECT_EQ(raster->nodata_share, 0);
    EXPECT_FALSE(raster->nodata_value.has_value());
}

TEST(TerrainRaster, tells_the_latitude_of_a_place) {
    const TemporaryFolder folder;
    const auto raster = read_terrain_raster(test::write_raster(folder.file("dem.tif"), {}, pattern), 1, std::nullopt);
    ASSERT_TRUE(raster.ok()) << raster.error().message;
    // The false origin of the Hong Kong 1980 grid: 22 degrees 18 minutes 43.68 seconds north.
    EXPECT_NEAR(latitude_deg(raster->crs, {836694.05, 819069.80}).value_or(0), 22.312133, 1e-5);
    EXPECT_EQ(latitude_deg({}, {0, 0}), std::nullopt);
}

TEST(TerrainRaster, turns_a_south_up_raster) {
    const TemporaryFolder folder;
    const auto north = read_terrain_raster(test::write_raster(folder.file("n.tif"), {}, pattern), 1, std::nullopt);
    const auto south =
        read_terrain_raster(test::write_raster(folder.file("s.tif"), {.south_up = true}, pattern), 1, std::nullopt);
    ASSERT_TRUE(north.ok());
    ASSERT_TRUE(south.ok()) << south.error().message;
    EXPECT_EQ(north->grid.geometry, south->grid.geometry);
    EXPECT_EQ(north->grid.values, south->grid.values);
}

TEST(TerrainRaster, respects_pixel_is_point) {
    const TemporaryFolder folder;
    const std::string file = test::write_raster(folder.file("point.tif"), {.pixel_is_point = true}, pattern);
    // The file really stores its position for the middle of the first cell: GDAL's raw view differs by half a cell.
    CPLSetConfigOption("GTIFF_POINT_GEO_IGNORE", "TRUE");
    double raw[6];
    {
        const GDALDatasetUniquePtr data(GDALDataset::Open(file.c_str()));
        ASSERT_EQ(data->GetGeoTransform(raw), CE_None);
    }
    CPLSetConfigOption("GTIFF_POINT_GEO_IGNORE", nullptr);
    EXPECT_DOUBLE_EQ(raw[0], 824002.5);

    const auto raster = read_terrain_raster(file, 1, std::nullopt);
    ASSERT_TRUE(raster.ok());
    EXPECT_EQ(raster->grid.geometry.x_min, 824000);
    EXPECT_EQ(raster->grid.geometry.y_min, 825000);
}

TEST(TerrainRaster, reads_integers_doubles_scale_and_offset) {
    const TemporaryFolder folder;
    for (const GDALDataType type : {GDT_Int16, GDT_UInt16, GDT_Int32, GDT_Float32, GDT_Float64}) {
        const std::string file =
            test::write_raster(folder.file(GDALGetDataTypeName(type)), {.type = type, .scale = 0.5, .offset = 10},
                               [](int column, int) { return 20 + column; });
        const auto raster = read_terrain_raster(file, 1, std::nullopt);
        ASSERT_TRUE(raster.ok()) << raster.error().message;
        EXPECT_FLOAT_EQ(raster->grid.at(4, 2), 22.0F) << GDALGetDataTypeName(type);
    }
}

TEST(TerrainRaster, nodata_and_infinity_become_na_n) {
    const TemporaryFolder folder;
    const std::string file =
        test::write_raster(folder.file("dem.tif"), {.columns = 10, .rows = 10, .nodata = -9999, .declare_nodata = true},
                           [](int column, int row) {
                               if (row == 0 && column < 8) return -9999.0;
                               if (row == 9 && column == 0) return std::numeric_limits<double>::infinity();
                               if (row == 9 && column == 1) return -std::numeric_limits<double>::infinity();
                               return 50.0;
                           });
    const auto raster = read_terrain_raster(file, 1, std::nullopt);
    ASSERT_TRUE(raster.ok()) << raster.error().message;
    EXPECT_TRUE(std::isnan(raster->grid.at(7, 0)));
    EXPECT_FALSE(std::isnan(raster->grid.at(8, 0)));
    EXPECT_TRUE(std::isnan(raster->grid.at(0, 9)));
    EXPECT_TRUE(std::isnan(raster->grid.at(1, 9)));
    EXPECT_DOUBLE_EQ(raster->nodata_share, 0.1);
    EXPECT_EQ(raster->nodata_value, -9999.0);
}

TEST(TerrainRaster, rounded_float_nodata_is_recognised) {
    const TemporaryFolder folder;
    const double lowest = -std::numeric_limits<float>::max();
    const std::string file =
        test::write_raster(folder.file("dem.tif"), {.nodata = -3.4028234e38, .declare_nodata = true},
                           [&](int column, int) { return column == 0 ? lowest : 50.0; });
    const auto raster = read_terrain_raster(file, 1, std::nullopt);
    ASSERT_TRUE(raster.ok()) << raster.error().message;
    EXPECT_TRUE(std::isnan(raster->grid.at(0, 3)));
}

TEST(TerrainRaster, reads_only_the_extent_snapped_outward_to_cells) {
    const TemporaryFolder folder;
    for (const bool south_up : {false, true}) {
        const std::string file = test::write_raster(folder.file("dem.tif"), {.south_up = south_up}, pattern);
        // From inside column 2 to the eastern edge of column 5; rows 1 to 3.
        const auto part = read_terrain_raster(file, 1, Extent{824011, 825005, 824030, 825019});
        ASSERT_TRUE(part.ok()) << part.error().message;
        EXPECT_EQ(part->grid.geometry, (GridGeometry{824010, 825005, 5, 4, 3}));
        EXPECT_FLOAT_EQ(part->grid.at(0, 0), static_cast<float>(pattern(2, 1)));
        EXPECT_FLOAT_EQ(part->grid.at(3, 2), static_cast<float>(pattern(5, 3)));
    }
}

TEST(TerrainRaster, extent_beyond_the_raster_is_clipped_and_one_outside_refused) {
    const TemporaryFolder folder;
    const std::string file = test::write_raster(folder.file("dem.tif"), {}, pattern);
    const auto clipped = read_terrain_raster(file, 1, Extent{823000, 824000, 824020, 825020});
    ASSERT_TRUE(clipped.ok());
    EXPECT_EQ(clipped->grid.geometry, (GridGeometry{824000, 825000, 5, 4, 4}));
    const auto outside = read_terrain_raster(file, 1, Extent{500000, 600000, 500100, 600100});
    ASSERT_FALSE(outside.ok());
    EXPECT_THAT(outside.error().message, HasSubstr("the raster lies at 824000 to 824100 east"));
}

TEST(TerrainRaster, of_a_large_raster_only_the_extent_is_read) {
    // 10^10 cells, of which a block is there: reading all of it would need 40 GB.
    const TemporaryFolder folder;
    const std::string file = folder.file("country.tif");
    GDALAllRegister();
    char** options = CSLAddString(CSLAddString(nullptr, "SPARSE_OK=TRUE"), "TILED=YES");
    {
        const GDALDatasetUniquePtr data(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
            file.c_str(), 100000, 100000, 1, GDT_Float32, options));
        double transform[6] = {800000, 1, 0, 900000, 0, -1};
        data->SetGeoTransform(transform);
        const OGRSpatialReference reference = test::spatial_reference(2326);
        data->SetSpatialRef(&reference);
        GDALRasterBand* band = data->GetRasterBand(1);
        band->SetNoDataValue(-9999);
        std::vector<float> block(256 * 256, 70);
        ASSERT_EQ(band->RasterIO(GF_Write, 51200, 51200, 256, 256, block.data(), 256, 256, GDT_Float32, 0, 0, nullptr),
                  CE_None);
    }
    CSLDestroy(options);
    const auto part = read_terrain_raster(file, 1, Extent{851200, 848600, 851700, 848800});
    ASSERT_TRUE(part.ok()) << part.error().message;
    EXPECT_EQ(part->grid.geometry, (GridGeometry{851200, 848600, 1, 500, 200}));
    EXPECT_EQ(part->grid.at(0, 199), 70);
    const auto all = read_terrain_raster(file, 1, std::nullopt);
    ASSERT_FALSE(all.ok());
    EXPECT_THAT(all.error().message, HasSubstr("100000 x 100000 cells are to be read, at most 200 million can be"));
}

TEST(TerrainRaster, states_the_vertical_unit_of_the_band_or_of_the_crs) {
    const TemporaryFolder folder;
    const auto stated =
        read_terrain_raster(test::write_raster(folder.file("m.tif"), {.unit = "metre"}, pattern), 1, std::nullopt);
    ASSERT_TRUE(stated.ok());
    EXPECT_EQ(stated->vertical_unit, "m");
    // HK 1980 grid with Hong Kong Principal Datum height.
    const auto compound = read_terrain_raster(test::write_raster(folder.file("c.tif"),
                                                                 {.wkt =
                                                                      [] {
                                                                          OGRSpatialReference both;
                                                                          both.SetFromUserInput("EPSG:2326+5738");
                                                                          char* text = nullptr;
                                                                          both.exportToWkt(&text);
                                                                          std::string wkt = text;
                                                                          CPLFree(text);
                                                                          return wkt;
                                                                      }()},
                                                                 pattern),
                                              1, std::nullopt);
    ASSERT_TRUE(compound.ok()) << compound.error().message;
    EXPECT_EQ(compound->vertical_unit, "m");
    EXPECT_EQ(compound->crs.epsg, 2326) << "the vertical part does not belong to maps of depth";
}

TEST(TerrainRaster, reads_other_formats) {
    const TemporaryFolder folder;
    for (const auto& [driver, name] : {std::pair{"AAIGrid", "dem.asc"}, {"HFA", "dem.img"}, {"ENVI", "dem.bil"}}) {
        const std::string file = test::write_raster(folder.file(name), {.driver = driver}, pattern);
        const auto raster = read_terrain_raster(file, 1, std::nullopt);
        ASSERT_TRUE(raster.ok()) << driver << ": " << raster.error().message;
        EXPECT_NEAR(raster->grid.at(3, 2), pattern(3, 2), 1e-3) << driver;
        EXPECT_EQ(raster->crs.name, "Hong Kong 1980 Grid System") << driver;
    }
}

TEST(TerrainRaster, reads_from_memory_files) {
    const std::string file = test::write_raster("/vsimem/talus_test_dem.tif", {}, pattern);
    EXPECT_TRUE(read_terrain_raster(file, 1, std::nullopt).ok());
    VSIUnlink(file.c_str());
}

TEST(ValueRaster, must_be_in_the_crs_of_the_terrain_and_may_hold_anything) {
    const TemporaryFolder folder;
    const std::string file = test::write_raster(folder.file("thickness.tif"), {.nodata = 0, .declare_nodata = true},
                                                [](int column, int) { return column == 0 ? 0 : 1.5; });
    const auto terrain = read_terrain_raster(test::write_plane(folder.file("dem.tif")), 1, std::nullopt);
    ASSERT_TRUE(terrain.ok());
    const auto same = read_value_raster(file, terrain->crs);
    ASSERT_TRUE(same.ok()) << same.error().message;
    EXPECT_TRUE(std::isnan(same->grid.at(0, 0)));
    EXPECT_FLOAT_EQ(same->grid.at(1, 0), 1.5F);

    const std::string other =
        test::write_raster(folder.file("utm.tif"), {.x_min = 200000, .y_min = 2475000, .epsg = 32650}, pattern);
    const auto refused = read_value_raster(other, terrain->crs);
    ASSERT_FALSE(refused.ok());
    EXPECT_THAT(refused.error().message, HasSubstr("gdalwarp -t_srs EPSG:2326 "));
}

}  // namespace
}  // namespace talus::geo
