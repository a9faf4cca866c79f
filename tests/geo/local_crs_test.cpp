#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geo/longitude_latitude.hpp"
#include "geo/raster.hpp"
#include "geo/vector.hpp"
#include "support/fixtures.hpp"

namespace talus::geo {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const char* const flume_system = R"(LOCAL_CS["flume",UNIT["metre",1]])";
const char* const square_wkt = "POLYGON ((0.1 0.1, 0.3 0.1, 0.3 0.2, 0.1 0.2, 0.1 0.1))";

/// A flume of 20 x 15 cells of 0.02 m.
class LocalCoordinates : public testing::Test {
  protected:
    [[nodiscard]] std::string flume(const std::string& wkt, int epsg = 0) const {
        return test::write_plane(folder_.file("flume.tif"),
                                 {.x_min = 0, .y_min = 0, .cell = 0.02, .epsg = epsg, .wkt = wkt});
    }
    [[nodiscard]] std::string refusal(const std::string& file) const {
        const auto layer = read_polygons(file, "", Crs::own_metres());
        return layer.ok() ? "" : layer.error().message;
    }

    test::TemporaryFolder folder_;
};

TEST_F(LocalCoordinates, a_terrain_that_states_none_is_taken_where_it_is_said) {
    const std::string file = flume("");
    const auto refused = read_terrain_raster(file, 1, std::nullopt);
    ASSERT_FALSE(refused.ok());
    EXPECT_THAT(refused.error().message, AllOf(HasSubstr("EPSG:nnnn"), HasSubstr("crs = \"local\"")));
    const auto terrain = read_terrain_raster(file, 1, std::nullopt, true);
    ASSERT_TRUE(terrain.ok()) << terrain.error().message;
    EXPECT_TRUE(terrain->crs.local);
    EXPECT_EQ(terrain->crs.label(), "local coordinates");
    EXPECT_FALSE(to_wgs84(terrain->crs).ok()) << "its place on the globe is not known";
}

TEST_F(LocalCoordinates, a_terrain_keeps_the_local_system_that_it_states) {
    const std::string file = flume(flume_system);
    for (const bool said : {false, true}) {
        const auto terrain = read_terrain_raster(file, 1, std::nullopt, said);
        ASSERT_TRUE(terrain.ok()) << terrain.error().message;
        EXPECT_TRUE(terrain->crs.local);
        EXPECT_EQ(terrain->crs.label(), "flume");
    }
}

TEST_F(LocalCoordinates, a_terrain_with_a_place_on_the_globe_is_not_local) {
    const auto terrain = read_terrain_raster(flume("", 2326), 1, std::nullopt, true);
    ASSERT_FALSE(terrain.ok());
    EXPECT_THAT(terrain.error().message, AllOf(HasSubstr("EPSG:2326"), HasSubstr("crs = \"local\" is for")));
}

TEST_F(LocalCoordinates, layers_that_say_nothing_are_taken_to_be_in_them) {
    const std::vector<std::string> files = {
        test::write_text(folder_.file("a.geojson"),
                         R"({"type": "Polygon", "coordinates": [[[0.1, 0.1], [0.3, 0.1], [0.3, 0.2], [0.1, 0.1]]]})"),
        test::write_vector(folder_.file("b.shp"), {.driver = "ESRI Shapefile", .epsg = 0, .type = wkbPolygon},
                           {{square_wkt, {}}}),
        test::write_vector(folder_.file("c.gpkg"), {.driver = "GPKG", .epsg = 0, .type = wkbPolygon},
                           {{square_wkt, {}}})};
    for (const std::string& file : files) {
        const auto layer = read_polygons(file, "", Crs::own_metres());
        ASSERT_TRUE(layer.ok()) << layer.error().message;
        const Extent extent = extent_of(layer->features[0].parts[0]);
        EXPECT_EQ(extent.x_max, 0.3) << file;
        EXPECT_EQ(extent.y_max, 0.2) << file << ": x east, y north";
        EXPECT_THAT(layer->reprojection, HasSubstr("taken to be in the terrain's local coordinates")) << file;
    }
}

TEST_F(LocalCoordinates, a_layer_with_a_local_system_of_any_name_is_in_them) {
    const std::string file = folder_.file("a.gpkg");
    const auto terrain = read_terrain_raster(flume(flume_system), 1, std::nullopt);
    ASSERT_TRUE(terrain.ok()) << terrain.error().message;
    const Polygon outline{{{0.1, 0.1}, {0.2, 0.1}, {0.2, 0.2}}, {}};
    ASSERT_TRUE(write_geopackage_layer(file, "release", {}, {{{outline}, {}, {}}}, terrain->crs));
    const auto layer = read_polygons(file, "", Crs::own_metres());
    ASSERT_TRUE(layer.ok()) << layer.error().message;
    EXPECT_EQ(layer->reprojection, "");
    EXPECT_EQ(layer->features[0].parts[0].outer[1].x, 0.2);
}

TEST_F(LocalCoordinates, a_layer_with_a_place_on_the_globe_is_refused_in_one_sentence) {
    const std::string file = test::write_vector(
        folder_.file("a.gpkg"), {.driver = "GPKG", .epsg = 2326, .type = wkbPolygon}, {{square_wkt, {}}});
    EXPECT_THAT(refusal(file), AllOf(HasSubstr("is in EPSG:2326"), HasSubstr("the terrain in local coordinates")));
    EXPECT_LT(refusal(file).size(), file.size() + 120) << "no WKT";
}

TEST_F(LocalCoordinates, a_local_layer_on_a_terrain_with_a_system_is_refused_in_one_sentence) {
    const std::string file = folder_.file("a.gpkg");
    const Polygon outline{{{0.1, 0.1}, {0.2, 0.1}, {0.2, 0.2}}, {}};
    ASSERT_TRUE(write_geopackage_layer(file, "release", {}, {{{outline}, {}, {}}}, Crs::own_metres()));
    const auto layer = read_polygons(file, "", Crs{"", "", 2326});
    ASSERT_FALSE(layer.ok());
    EXPECT_THAT(layer.error().message, AllOf(HasSubstr("local coordinates"), HasSubstr("ogr2ogr -a_srs EPSG:nnnn")));
    EXPECT_LT(layer.error().message.size(), 3 * file.size() + 250) << "no WKT";
}

TEST_F(LocalCoordinates, rasters_of_the_terrain_are_in_them_as_well) {
    const auto values = read_value_raster(flume(flume_system), Crs::own_metres());
    ASSERT_TRUE(values.ok()) << values.error().message;
    const auto elsewhere = read_value_raster(flume("", 2326), Crs::own_metres());
    ASSERT_FALSE(elsewhere.ok());
    EXPECT_THAT(elsewhere.error().message, HasSubstr("the terrain in local coordinates"));
}

}  // namespace
}  // namespace talus::geo
