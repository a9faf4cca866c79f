#include "products/series.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "geo/raster.hpp"
#include "report/report_fixture.hpp"
#include "support/fixtures.hpp"

namespace talus::products {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

/// A window of the map two cells from its west edge and one from its south, three cells wide and two high.
run::Frame frame_at(double time, const GridGeometry& map) {
    run::Frame frame;
    frame.time = time;
    frame.thinnest_depth = 0.1;
    frame.debris.first_column = 2;
    frame.debris.first_row = 1;
    const GridGeometry window{map.x_min + 2 * map.cell, map.y_min + map.cell, map.cell, 3, 2};
    frame.debris.depth = frame.debris.speed = Grid<float>(window);
    frame.debris.depth.values = {1, 0, 0.05F, 2, 3, 4};
    frame.debris.speed.values = {5, 0, 0, 0, static_cast<float>(time), 2};
    return frame;
}

std::vector<float> row_of(const SeriesFrames& frames, std::size_t quantity, const GridGeometry& grid, int row) {
    std::vector<float> values(static_cast<std::size_t>(grid.columns));
    EXPECT_TRUE(frames.read(quantity, 1, grid, row, values.data()));
    for (float& value : values) value = std::isnan(value) ? -1 : value;
    return values;
}

TEST(SeriesFrames, give_their_rows_on_any_grid_of_their_cells) {
    const TemporaryFolder folder;
    const GridGeometry map{1000, 2000, 2.5, 6, 4};
    {
        SeriesFrames frames(folder.path() / ".frames");
        ASSERT_TRUE(frames.add(frame_at(0, map), 2000));
        ASSERT_TRUE(frames.add(frame_at(3, map), 2000));
        EXPECT_EQ(frames.times(), (std::vector<double>{0, 3}));
        using Values = std::vector<float>;
        EXPECT_EQ(row_of(frames, 0, map, 0), (Values{-1, -1, -1, -1, -1, -1}));
        EXPECT_EQ(row_of(frames, 0, map, 1), (Values{-1, -1, 1, -1, 0.05F, -1}));
        EXPECT_EQ(row_of(frames, 0, map, 2), (Values{-1, -1, 2, 3, 4, -1}));
        EXPECT_EQ(row_of(frames, 1, map, 1), (Values{-1, -1, 5, -1, -1, -1})) << "too thin to have a speed";
        EXPECT_EQ(row_of(frames, 1, map, 2), (Values{-1, -1, 0, 3, 2, -1})) << "at rest is 0";
        EXPECT_EQ(row_of(frames, 2, map, 1), (Values{-1, -1, 50, -1, -1, -1})) << "kPa";
        const GridGeometry part{1007.5, 2005, 2.5, 5, 2};  // begins within the window and ends beyond it
        EXPECT_EQ(row_of(frames, 0, part, 0), (Values{3, 4, -1, -1, -1}));
        EXPECT_EQ(row_of(frames, 0, part, 1), (Values{-1, -1, -1, -1, -1}));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "the file is deleted";
}

class SeriesOfARun : public testing::Test {
  protected:
    Status write(const std::vector<std::string>& formats) {
        scene.spec.outputs.series = formats;
        Series series(scene, folder.path() / "series");
        const GridGeometry& map = result.observation.maps.peak_depth.geometry;
        for (const double time : {0.0, 1.0, 2.5}) {
            if (Status added = series.add(frame_at(time, map)); !added) return added;
        }
        const std::vector<std::string> missing = series.finish(result);
        return missing.empty() ? Status() : Status(Error{missing.front()});
    }

    scene::Scene scene = test::sample_scene();
    run::RunResult result = test::sample_result(scene);
    TemporaryFolder folder;
};

TEST_F(SeriesOfARun, one_that_fails_takes_no_other_with_it) {
    scene.spec.outputs.series = {"netcdf", "geotiff"};
    Series series(scene, folder.path() / "series");
    ASSERT_TRUE(series.add(frame_at(0, result.observation.maps.peak_depth.geometry)));
    std::filesystem::create_directories(folder.path() / "series/maps.nc/in the way");
    const std::vector<std::string> missing = series.finish(result);
    ASSERT_EQ(missing.size(), 1U);
    EXPECT_THAT(missing.front(), HasSubstr("maps.nc"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "series/pressure.tif"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "series/maps.nc"));
}

TEST_F(SeriesOfARun, is_on_the_cells_of_its_maps_and_says_where_it_is_from) {
    const Status status = write({"netcdf", "geotiff"});
    ASSERT_TRUE(status.ok()) << status.error().message;
    std::set<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "series")) {
        files.insert(entry.path().filename().string());
    }
    EXPECT_EQ(files, (std::set<std::string>{"depth.tif", "maps.nc", "pressure.tif", "speed.tif"}));

    const GridGeometry& map = result.observation.maps.peak_depth.geometry;
    for (const std::string& file :
         {folder.file("series/speed.tif"), "NETCDF:" + folder.file("series/maps.nc") + ":speed"}) {
        const GDALDatasetUniquePtr data(GDALDataset::Open(file.c_str()));
        ASSERT_NE(data, nullptr) << file;
        EXPECT_EQ(data->GetRasterCount(), 3);
        EXPECT_EQ(data->GetRasterXSize(), map.columns);
        EXPECT_EQ(data->GetRasterYSize(), map.rows);
        float speed = 0;
        ASSERT_EQ(data->GetRasterBand(3)->RasterIO(GF_Read, 3, map.rows - 1 - 2, 1, 1, &speed, 1, 1, GDT_Float32, 0, 0,
                                                   nullptr),
                  CE_None);
        EXPECT_EQ(speed, 2.5F) << file;
    }
    const GDALDatasetUniquePtr netcdf(
        GDALDataset::Open(("NETCDF:" + folder.file("series/maps.nc") + ":depth").c_str()));
    EXPECT_EQ(netcdf->GetMetadataItem("NC_GLOBAL#title"), scene.spec.scene.title);
    EXPECT_THAT(netcdf->GetMetadataItem("transverse_mercator#crs_wkt"), testing::StartsWith("PROJCRS[")) << "WKT 2";
    EXPECT_THAT(netcdf->GetMetadataItem("NC_GLOBAL#source"), HasSubstr("talus "));
}

TEST_F(SeriesOfARun, names_the_file_that_it_cannot_write) {
    test::write_text(folder.file("series"), "in the way");
    const Status status = write({"netcdf"});
    ASSERT_FALSE(status.ok());
    EXPECT_THAT(status.error().message, HasSubstr(folder.file("series") + ": cannot be made: "));
}

}  // namespace
}  // namespace talus::products
