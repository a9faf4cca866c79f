#include "geo/orthophoto.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "geo/raster.hpp"
#include "geo/rasters.hpp"
#include "support/fixtures.hpp"
#include "support/photo.hpp"

namespace talus::test {
namespace {

using ::testing::HasSubstr;

constexpr Extent ground{824000, 825000, 824100, 825080};

/// Of the ground's extent.
PhotoOptions whole() {
    PhotoOptions options;
    options.x_min = ground.x_min;
    options.y_max = ground.y_max;
    return options;
}

void expect_colour(const std::array<int, 4>& pixel, const std::array<int, 4>& wanted) {
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(pixel[k], wanted[k], 25) << "band " << k + 1;
}

void expect_quarters(const ReadPhoto& photo) {
    expect_colour(photo.at(0.25, 0.25), {255, 0, 0, 255});
    expect_colour(photo.at(0.75, 0.25), {0, 255, 0, 255});
    expect_colour(photo.at(0.5, 0.75), {0, 0, 255, 255});
}

TEST(Orthophoto, lies_on_the_ground_north_up_and_is_thinned_to_what_is_asked) {
    const TemporaryFolder folder;
    const std::string file = write_photo(folder.file("photo.tif"), whole());
    const auto fine = read_orthophoto(file, geo::hong_kong(), ground, 4096);
    ASSERT_TRUE(fine) << fine.error().message;
    const ReadPhoto read(fine->bytes);
    EXPECT_EQ(read.columns(), 100) << "no more pixels than the file has";
    EXPECT_EQ(read.rows(), 80);
    expect_quarters(read);
    const auto coarse = read_orthophoto(file, geo::hong_kong(), ground, 50);
    ASSERT_TRUE(coarse);
    EXPECT_EQ(ReadPhoto(coarse->bytes).columns(), 50);
    expect_quarters(ReadPhoto(coarse->bytes));
}

TEST(Orthophoto, is_cut_to_the_terrain_and_transparent_beside_it) {
    const TemporaryFolder folder;
    PhotoOptions options = whole();
    options.x_min += 50;
    const auto photo = read_orthophoto(write_photo(folder.file("photo.tif"), options), geo::hong_kong(), ground, 4096);
    ASSERT_TRUE(photo);
    const ReadPhoto read(photo->bytes);
    EXPECT_EQ(read.at(0.25, 0.25)[3], 0);
    expect_colour(read.at(0.75, 0.25), {255, 0, 0, 255});
}

TEST(Orthophoto, comes_in_another_system_with_a_world_file_and_in_grey) {
    const TemporaryFolder folder;
    PhotoOptions other = whole();  // the same place on UTM zone 50 N
    other.epsg = 32650;
    OGRSpatialReference from, to;
    from.importFromEPSG(2326);
    to.importFromEPSG(32650);
    from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    to.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRCoordinateTransformation> transform(OGRCreateCoordinateTransformation(&from, &to));
    ASSERT_TRUE(transform->Transform(1, &other.x_min, &other.y_max));
    const auto moved = read_orthophoto(write_photo(folder.file("utm.tif"), other), geo::hong_kong(), ground, 4096);
    ASSERT_TRUE(moved) << moved.error().message;
    expect_quarters(ReadPhoto(moved->bytes));

    PhotoOptions plain = whole();
    plain.epsg = 0;
    plain.driver = "PNG";
    const auto world = read_orthophoto(write_photo(folder.file("photo.png"), plain), geo::hong_kong(), ground, 4096);
    ASSERT_TRUE(world) << world.error().message;
    expect_quarters(ReadPhoto(world->bytes));

    PhotoOptions grey = whole();
    grey.bands = 1;
    const auto single = read_orthophoto(write_photo(folder.file("grey.tif"), grey), geo::hong_kong(), ground, 4096);
    ASSERT_TRUE(single) << single.error().message;
    expect_colour(ReadPhoto(single->bytes).at(0.25, 0.25), {200, 200, 200, 255});
}

TEST(Orthophoto, that_cannot_be_laid_over_the_terrain_is_refused_with_the_file_s_name) {
    const TemporaryFolder folder;
    const auto problem = [&](const std::string& name, const PhotoOptions& options) {
        const std::string file = write_photo(folder.file(name), options);
        const Status status = check_orthophoto(file, geo::hong_kong(), ground);
        EXPECT_FALSE(status);
        if (status) return std::string();
        EXPECT_THAT(status.error().message, HasSubstr(name));
        EXPECT_EQ(read_orthophoto(file, geo::hong_kong(), ground, 100).error().message, status.error().message);
        return status.error().message;
    };
    PhotoOptions options = whole();
    options.placed = false;
    EXPECT_THAT(problem("nowhere.tif", options), HasSubstr("world file"));
    options = whole();
    options.type = GDT_UInt16;
    EXPECT_THAT(problem("deep.tif", options), HasSubstr("gdal_translate -ot Byte -scale"));
    options = whole();
    options.x_min += 1000;
    EXPECT_THAT(problem("beside.tif", options), HasSubstr("beside the terrain"));
    EXPECT_THAT(check_orthophoto(folder.file("missing.tif"), geo::hong_kong(), ground).error().message,
                HasSubstr("missing.tif"));
}

}  // namespace
}  // namespace talus::test
