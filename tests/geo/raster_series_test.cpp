#include "geo/raster_series.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "geo/rasters.hpp"
#include "support/fixtures.hpp"

namespace talus::geo {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

constexpr double t_first = 0, t_last = 2.5;
const GridGeometry cells{824001, 825002, 2, 70, 30};

float value_of(std::size_t frame, int column, int row) {
    return column == row ? std::nanf("") : static_cast<float>(column + 100 * row) + 0.25F * static_cast<float>(frame);
}

RasterSeries depth() {
    return {"depth", "flow depth", "m", [](std::size_t frame, int row, float* values) {
                for (int column = 0; column < cells.columns; ++column) values[column] = value_of(frame, column, row);
                return Status();
            }};
}

SeriesFile series() {
    return {cells, {t_first, 1, t_last}, hong_kong(), {{"title", "Plane"}}};
}

/// A row of a band, north first.
std::vector<float> row_of(GDALDataset& data, int band, int row) {
    std::vector<float> values(static_cast<std::size_t>(data.GetRasterXSize()));
    EXPECT_EQ(data.GetRasterBand(band)->RasterIO(GF_Read, 0, row, data.GetRasterXSize(), 1, values.data(),
                                                 data.GetRasterXSize(), 1, GDT_Float32, 0, 0, nullptr),
              CE_None);
    return values;
}

void expect_frames(GDALDataset& data, float none) {
    ASSERT_EQ(data.GetRasterCount(), 3);
    ASSERT_EQ(data.GetRasterXSize(), cells.columns);
    ASSERT_EQ(data.GetRasterYSize(), cells.rows);
    double transform[6];
    ASSERT_EQ(data.GetGeoTransform(transform), CE_None);
    EXPECT_DOUBLE_EQ(transform[0], cells.x_min);
    EXPECT_DOUBLE_EQ(transform[3], cells.y_min + cells.rows * cells.cell);
    EXPECT_DOUBLE_EQ(transform[5], -cells.cell);
    ASSERT_NE(data.GetSpatialRef(), nullptr);
    EXPECT_STREQ(data.GetSpatialRef()->GetAuthorityCode(nullptr), "2326");
    for (int band = 1; band <= 3; ++band) {
        for (int row = 0; row < cells.rows; ++row) {
            const std::vector<float> values = row_of(data, band, cells.rows - 1 - row);
            for (int column = 0; column < cells.columns; ++column) {
                const float expected = value_of(static_cast<std::size_t>(band) - 1, column, row);
                const float found = values[static_cast<std::size_t>(column)];
                if (std::isnan(expected)) {
                    EXPECT_TRUE(found == none || (std::isnan(found) && std::isnan(none))) << found;
                } else {
                    EXPECT_EQ(found, expected);
                }
            }
        }
    }
}

TEST(RasterSeries, cog_has_a_band_per_frame) {
    const TemporaryFolder folder;
    const std::string file = folder.file("depth.tif");
    const Status status = write_cog_series(file, series(), depth());
    ASSERT_TRUE(status.ok()) << status.error().message;
    const GDALDatasetUniquePtr data(GDALDataset::Open(file.c_str()));
    ASSERT_NE(data, nullptr);
    expect_frames(*data, -9999);
    EXPECT_STREQ(data->GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE"), "COG");
    EXPECT_STREQ(data->GetMetadataItem("title"), "Plane");
    GDALRasterBand* last = data->GetRasterBand(3);
    EXPECT_STREQ(last->GetDescription(), "flow depth at 2.5 s");
    EXPECT_STREQ(last->GetUnitType(), "m");
    EXPECT_STREQ(last->GetMetadataItem("TIME_S"), "2.5");
    EXPECT_EQ(last->GetNoDataValue(), -9999);
}

TEST(RasterSeries, netcdf_follows_the_conventions) {
    const TemporaryFolder folder;
    const std::string file = folder.file("maps.nc");
    Grid<float> terrain(cells, 55);
    const Status status = write_netcdf_series(file, series(), terrain, {depth()});
    ASSERT_TRUE(status.ok()) << status.error().message;
    const GDALDatasetUniquePtr data(GDALDataset::Open(("NETCDF:" + file + ":depth").c_str()));
    ASSERT_NE(data, nullptr);
    expect_frames(*data, std::nanf(""));
    const auto says = [&](const char* key) {
        const char* value = data->GetMetadataItem(key);
        return std::string(value == nullptr ? "(nothing)" : value);
    };
    EXPECT_EQ(says("NC_GLOBAL#Conventions"), "CF-1.8");
    EXPECT_EQ(says("NC_GLOBAL#title"), "Plane");
    EXPECT_EQ(says("NETCDF_DIM_time_VALUES"), "{0,1,2.5}");
    EXPECT_THAT(says("time#units"), HasSubstr("seconds since "));
    EXPECT_EQ(says("time#standard_name"), "time");
    EXPECT_EQ(says("x#standard_name"), "projection_x_coordinate");
    EXPECT_EQ(says("y#standard_name"), "projection_y_coordinate");
    EXPECT_EQ(says("depth#units"), "m");
    EXPECT_EQ(says("depth#grid_mapping"), "transverse_mercator");
    EXPECT_EQ(says("transverse_mercator#grid_mapping_name"), "transverse_mercator");
    const GDALDatasetUniquePtr ground(GDALDataset::Open(("NETCDF:" + file + ":terrain").c_str()));
    ASSERT_NE(ground, nullptr);
    EXPECT_EQ(row_of(*ground, 1, 0)[0], 55);
}

TEST(RasterSeries, netcdf_of_a_local_system_has_metres_alone) {
    const TemporaryFolder folder;
    const std::string file = folder.file("maps.nc");
    SeriesFile local = series();
    local.crs = {};
    local.crs.name = "flume";
    local.crs.wkt = R"(LOCAL_CS["flume",UNIT["metre",1]])";
    const Status status = write_netcdf_series(file, local, Grid<float>(cells, 55), {depth()});
    ASSERT_TRUE(status.ok()) << status.error().message;
    const GDALDatasetUniquePtr data(GDALDataset::Open(("NETCDF:" + file + ":depth").c_str()));
    ASSERT_NE(data, nullptr);
    EXPECT_EQ(data->GetRasterCount(), 3);
    EXPECT_EQ(data->GetMetadataItem("depth#grid_mapping"), nullptr);
}

TEST(RasterSeries, netcdf_of_a_system_unknown_to_the_conventions_has_wkt_and_places) {
    for (const auto& [epsg, x, y, lon, lat] :
         {std::tuple{2056, 2600000.0, 1200000.0, 7.4386, 46.9511},  // Switzerland: Bern
          std::tuple{5514, -740000.0, -1050000.0, 14.49, 50.03},    // Czechia: south of Prague
          std::tuple{23700, 650000.0, 238000.0, 19.04, 47.49}}) {   // Hungary: Budapest
        const TemporaryFolder folder;
        const std::string file = folder.file("maps.nc");
        SeriesFile oblique = series();
        oblique.geometry.x_min = x;
        oblique.geometry.y_min = y;
        oblique.crs = {"", "", epsg};
        const Status status = write_netcdf_series(file, oblique, Grid<float>(oblique.geometry, 55), {depth()});
        ASSERT_TRUE(status.ok()) << status.error().message;
        const GDALDatasetUniquePtr data(GDALDataset::Open(("NETCDF:" + file + ":depth").c_str()));
        ASSERT_NE(data, nullptr);
        ASSERT_NE(data->GetSpatialRef(), nullptr) << epsg;
        EXPECT_STREQ(data->GetSpatialRef()->GetAuthorityCode(nullptr), std::to_string(epsg).c_str());
        EXPECT_STREQ(data->GetMetadataItem("depth#coordinates"), "lat lon");
        EXPECT_EQ(row_of(*data, 3, cells.rows - 1)[1], value_of(2, 1, 0));
        for (const auto& [name, expected] : {std::pair{"lon", lon}, std::pair{"lat", lat}}) {
            const GDALDatasetUniquePtr places(GDALDataset::Open(("NETCDF:" + file + ":" + name).c_str()));
            ASSERT_NE(places, nullptr) << name;
            EXPECT_NEAR(row_of(*places, 1, 0)[0], expected, 0.05) << epsg << ' ' << name;
        }
    }
}

TEST(RasterSeries, failure_names_the_file_and_leaves_none) {
    const TemporaryFolder folder;
    RasterSeries broken = depth();
    broken.read = [](std::size_t frame, int, float*) {
        return frame < 2 ? Status() : Status(Error{"frames: is gone"});
    };
    const std::string cog = folder.file("depth.tif"), netcdf = folder.file("maps.nc");
    const Status no_cog = write_cog_series(cog, series(), broken);
    ASSERT_FALSE(no_cog.ok());
    EXPECT_THAT(no_cog.error().message, testing::AllOf(HasSubstr(cog), HasSubstr("frames: is gone")));
    const Status no_netcdf = write_netcdf_series(netcdf, series(), Grid<float>(cells), {broken});
    ASSERT_FALSE(no_netcdf.ok());
    EXPECT_THAT(no_netcdf.error().message, HasSubstr("frames: is gone"));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    const Status nowhere = write_netcdf_series("/proc/maps.nc", series(), Grid<float>(cells), {depth()});
    ASSERT_FALSE(nowhere.ok());
    EXPECT_THAT(nowhere.error().message, HasSubstr("/proc/maps.nc: cannot be written: "));
}

}  // namespace
}  // namespace talus::geo
