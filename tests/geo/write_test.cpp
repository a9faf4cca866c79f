#include <cmath>
#include <csignal>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geo/crs.hpp"
#include "geo/raster.hpp"
#include "geo/rasters.hpp"
#include "geo/vector.hpp"
#include "geo/versions.hpp"
#include "support/fixtures.hpp"

namespace talus::geo {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;
using testing::StartsWith;

Grid<float> example(int columns, int rows) {
    Grid<float> grid({824001, 825002, 0.5, columns, rows});
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            grid.at(column, row) = column == row ? std::nanf("") : 0.25F * static_cast<float>(column + 1000 * row);
        }
    }
    return grid;
}

/// Runs `write` in a child that may write files of at most `limit` bytes, as on a full disk; gives its message.
std::string message_on_full_disk(rlim_t limit, const std::function<Status()>& write) {
    int ends[2];
    if (pipe(ends) != 0) return "no pipe";
    const pid_t child = fork();
    if (child == 0) {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit size{limit, limit};
        setrlimit(RLIMIT_FSIZE, &size);
        const Status status = write();
        const std::string message = status.ok() ? "written" : status.error().message;
        if (::write(ends[1], message.data(), message.size()) < 0) _exit(1);
        _exit(0);
    }
    close(ends[1]);
    std::string message;
    char buffer[4096];
    for (ssize_t n = 0; (n = read(ends[0], buffer, sizeof buffer)) > 0;) message.append(buffer, static_cast<size_t>(n));
    close(ends[0]);
    waitpid(child, nullptr, 0);
    return message;
}

TEST(WriteCog, reads_back_with_values_nodata_crs_unit_and_description) {
    const TemporaryFolder folder;
    const std::string file = folder.file("depth.tif");
    const Grid<float> grid = example(700, 600);
    const Status status = write_cog(file, {&grid, "peak flow depth", "m"}, hong_kong());
    ASSERT_TRUE(status.ok()) << status.error().message;

    const GDALDatasetUniquePtr data(GDALDataset::Open(file.c_str()));
    ASSERT_TRUE(data);
    EXPECT_STREQ(data->GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE"), "COG");
    EXPECT_STREQ(data->GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE"), "DEFLATE");
    EXPECT_STREQ(data->GetMetadataItem(GDALMD_AREA_OR_POINT), GDALMD_AOP_AREA);
    ASSERT_EQ(data->GetRasterCount(), 1);
    GDALRasterBand* band = data->GetRasterBand(1);
    EXPECT_EQ(band->GetRasterDataType(), GDT_Float32);
    EXPECT_EQ(band->GetNoDataValue(), -9999);
    EXPECT_STREQ(band->GetDescription(), "peak flow depth");
    EXPECT_STREQ(band->GetUnitType(), "m");
    EXPECT_GE(band->GetOverviewCount(), 1);
    double transform[6];
    data->GetGeoTransform(transform);
    EXPECT_THAT(transform, testing::ElementsAre(824001, 0.5, 0, 825302, 0, -0.5));
    EXPECT_STREQ(data->GetSpatialRef()->GetAuthorityCode(nullptr), "2326");

    const auto again = read_value_raster(file, hong_kong());
    ASSERT_TRUE(again.ok()) << again.error().message;
    EXPECT_EQ(again->grid.geometry, grid.geometry);
    EXPECT_EQ(again->vertical_unit, "m");
    for (std::size_t i = 0; i < grid.values.size(); ++i) {
        ASSERT_EQ(std::isnan(grid.values[i]), std::isnan(again->grid.values[i]));
        if (std::isnan(grid.values[i])) continue;
        ASSERT_EQ(grid.values[i], again->grid.values[i]);
    }
}

TEST(WriteCog, leaves_nothing_else_in_the_folder) {
    const TemporaryFolder folder;
    const Grid<float> grid = example(700, 600);
    ASSERT_TRUE(write_cog(folder.file("depth.tif"), {&grid, "depth", "m"}, hong_kong()).ok());
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(WriteCog, full_disk_is_an_error_and_leaves_no_file) {
    const TemporaryFolder folder;
    const Grid<float> grid = example(700, 600);
    const Crs crs = hong_kong();
    const std::string file = folder.file("depth.tif");
    EXPECT_EQ(message_on_full_disk(20000,
                                   [&] {
                                       return write_cog(file, {&grid, "depth", "m"}, crs);
                                   }),
              file + ": cannot be written: File too large");
    EXPECT_FALSE(std::filesystem::exists(file));
    const Status device = write_cog("/dev/full", {&grid, "depth", "m"}, crs);
    ASSERT_FALSE(device.ok());
    EXPECT_EQ(device.error().message, "/dev/full: cannot be written: No space left on device");
    EXPECT_TRUE(std::filesystem::exists("/dev/full"));
}

TEST(WriteCog, missing_folder_is_an_error) {
    const Grid<float> grid = example(4, 4);
    const Status status = write_cog("/nowhere/depth.tif", {&grid, "depth", "m"}, hong_kong());
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().message, "/nowhere/depth.tif: cannot be written: No such file or directory");
}

std::vector<OutputFeature> houses(int count) {
    std::vector<OutputFeature> features;
    for (int i = 0; i < count; ++i) {
        const double x = 824000 + 20 * i;
        const Ring outer{{x, 825000}, {x + 10, 825000}, {x + 10, 825010}, {x, 825010}};
        const Ring hole{{x + 4, 825004}, {x + 6, 825004}, {x + 6, 825006}, {x + 4, 825006}};
        features.push_back({{{outer, {hole}}}, {}, {Attribute("house " + std::to_string(i)), Attribute(2.5 * i)}});
    }
    return features;
}

TEST(WriteGeoPackage, layers_read_back) {
    const TemporaryFolder folder;
    const std::string file = folder.file("results.gpkg");
    const std::vector<Field> fields{{"name", true}, {"peak_force_kN"}};
    auto features = houses(3);
    features[2].values[1] = Attribute(std::nan(""));
    Status status = write_geopackage_layer(file, "buildings", fields, features, hong_kong());
    ASSERT_TRUE(status.ok()) << status.error().message;
    status =
        write_geopackage_layer(file, "flow_path", {}, {{{}, {{824000, 825000}, {824100, 825050}}, {}}}, hong_kong());
    ASSERT_TRUE(status.ok()) << status.error().message;

    const auto buildings = read_polygons(file, "buildings", hong_kong());
    ASSERT_TRUE(buildings.ok()) << buildings.error().message;
    EXPECT_EQ(buildings->reprojection, "");
    ASSERT_EQ(buildings->features.size(), 3U);
    EXPECT_DOUBLE_EQ(plan_area(buildings->features[1].parts[0]), 96);
    EXPECT_EQ(buildings->features[1].attributes.at("name"), Attribute("house 1"));
    EXPECT_EQ(buildings->features[1].attributes.at("peak_force_kN"), Attribute(2.5));
    EXPECT_EQ(buildings->features[2].attributes.at("peak_force_kN"), Attribute()) << "NaN is written as null";
    const auto path = read_line(file, "flow_path", hong_kong());
    ASSERT_TRUE(path.ok()) << path.error().message;
    EXPECT_EQ(path->points.size(), 2U);

    const Status twice = write_geopackage_layer(file, "buildings", fields, features, hong_kong());
    ASSERT_FALSE(twice.ok());
    EXPECT_THAT(twice.error().message, StartsWith(file + ": layer \"buildings\" cannot be written: "));
}

TEST(WriteGeoPackage, full_disk_is_an_error) {
    const TemporaryFolder folder;
    const std::string file = folder.file("results.gpkg");
    const Crs crs = hong_kong();
    const auto many = houses(5000);
    for (const rlim_t limit : {1000, 150000}) {
        std::filesystem::remove(file);
        const std::string message = message_on_full_disk(limit, [&] {
            return write_geopackage_layer(file, "buildings", {{"name", true}, {"peak_force_kN"}}, many, crs);
        });
        EXPECT_THAT(message, StartsWith(file + ": layer \"buildings\" cannot be written: ")) << limit;
    }
}

TEST(Versions, are_known) {
    EXPECT_THAT(gdal_version(), StartsWith("3."));
    EXPECT_THAT(proj_version(), HasSubstr("."));
}

}  // namespace
}  // namespace talus::geo
