#include "geo/terrain_frame.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rasters.hpp"

namespace talus::geo {
namespace {

using testing::HasSubstr;

class TerrainFrames : public testing::Test {
  protected:
    std::string write(const test::RasterOptions& options, const std::function<double(int, int)>& value = pattern) {
        return test::write_raster(folder_.file("dem.tif"), options, value);
    }
    test::TemporaryFolder folder_;
};

TEST_F(TerrainFrames, tells_the_whole_raster_without_its_cells) {
    const auto frame = read_terrain_frame(write({}), 1);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(frame->geometry, (GridGeometry{824000, 825000, 5, 20, 15}));
    EXPECT_EQ(frame->crs.epsg, 2326);
    EXPECT_FALSE(frame->eight_bit);
    EXPECT_FALSE(frame->holes_read_0);
    EXPECT_TRUE(read_terrain_frame(write({.type = GDT_Byte}), 1)->eight_bit);
    EXPECT_FALSE(read_terrain_frame(folder_.file("nowhere.tif"), 1));
}

TEST_F(TerrainFrames, coarse_cells_are_means_of_those_with_data) {
    // 20 x 15 cells: three times as large, there are 6 x 5 of them, and two columns are left over in the east.
    const std::string file = write({.nodata = -9999, .declare_nodata = true}, [](int column, int row) {
        if (column < 3 && row < 2) return -9999.0;  // of the first coarse cell, a third has data
        if (column == 3 && row == 0) return -9999.0;
        return 100.0 + column;
    });
    const auto coarse = read_coarse_terrain(file, 1, std::nullopt, 3);
    ASSERT_TRUE(coarse) << coarse.error().message;
    EXPECT_EQ(coarse->grid.geometry, (GridGeometry{824000, 825000, 15, 6, 5}));
    EXPECT_TRUE(std::isnan(coarse->grid.at(0, 0)));
    EXPECT_NEAR(coarse->grid.at(1, 0), 100 + (2 * 3 + 3 * 4 + 3 * 5) / 8.0, 1e-4);
    EXPECT_NEAR(coarse->grid.at(5, 4), 116, 1e-4);
    const auto part = read_coarse_terrain(file, 1, Extent{824020, 825000, 824061, 825045}, 3);
    ASSERT_TRUE(part) << part.error().message;
    EXPECT_EQ(part->grid.geometry, (GridGeometry{824015, 825000, 15, 4, 3})) << "whole coarse cells around the extent";
    EXPECT_THAT(read_coarse_terrain(file, 1, std::nullopt, 10).error().message, HasSubstr("fewer than 2 x 2 cells"));
}

TEST_F(TerrainFrames, commands_keep_the_nodata_value_that_is_declared) {
    const std::string plain = write({});
    EXPECT_EQ(declare_nodata_command(plain, 1, 0),
              "gdal_translate -a_nodata 0 " + plain + " " + folder_.file("dem_nodata.tif"));
    const std::string declared = write({.nodata = -9999, .declare_nodata = true, .scale = 0.1});
    EXPECT_THAT(declare_nodata_command(declared, 1, 5), HasSubstr("--calc='where(A==50,-9999,A)'"));
    EXPECT_THAT(cut_below_command(declared, 1, 5), HasSubstr("--calc='where(A<50,-9999,A)'"));
    EXPECT_THAT(scale_command(declared, 1, 0.3048), HasSubstr("--calc='A*0.03048'"));
}

}  // namespace
}  // namespace talus::geo
