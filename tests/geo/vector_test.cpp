#include "geo/vector.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geo/crs.hpp"
#include "geo/raster.hpp"
#include "support/fixtures.hpp"

namespace talus::geo {
namespace {

using test::TemporaryFolder;
using test::VectorFeature;
using test::VectorOptions;
using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

const Crs without_wkt{.wkt = "", .name = "Hong Kong 1980 Grid System", .epsg = 2326};
const std::string square = test::rectangle_wkt(824100, 825600, 824110, 825620);

/// The origin of the Hong Kong 1980 Grid, 22 18 43.68 N 114 10 42.80 E on its own datum, and the same place on WGS 84
/// by the published shift of -5.5" and +8.8" (Explanatory Notes on Geodetic Datums in Hong Kong, 1995).
constexpr double longitude = 114.181, latitude = 22.310606;
constexpr double easting = 836694.05, northing = 819069.80;

class Vectors : public testing::Test {
  protected:
    /// The message of a refused file: one line that begins with the file; nothing may reach stderr.
    static std::string refusal(const std::string& file, const std::string& layer = "") {
        testing::internal::CaptureStderr();
        const auto read = read_polygons(file, layer, without_wkt);
        EXPECT_THAT(testing::internal::GetCapturedStderr(), IsEmpty());
        if (read.ok()) return "accepted";
        EXPECT_THAT(read.error().message, StartsWith(file + ": "));
        EXPECT_THAT(read.error().message, Not(HasSubstr("\n")));
        return read.error().message;
    }
    std::string write(const std::vector<VectorFeature>& features, const VectorOptions& options = {},
                      const std::string& name = "release.geojson") {
        std::filesystem::remove(folder_.file(name));
        return test::write_vector(folder_.file(name), options, features);
    }
    TemporaryFolder folder_;
};

TEST_F(Vectors, polygons_with_holes_and_attributes_from_every_format) {
    for (const auto& [driver, name] :
         {std::pair{"GeoJSON", "a.geojson"}, {"GPKG", "a.gpkg"}, {"ESRI Shapefile", "a.shp"}}) {
        const std::string file = write(
            {{"POLYGON ((0 0, 40 0, 40 30, 0 30, 0 0), (10 10, 10 20, 20 20, 20 10, 10 10))", {"scarp", "1.5", "7"}},
             {square, {"", "", ""}}},
            {.driver = driver,
             .layer = "a",
             .fields = {{"name", OFTString}, {"thickness", OFTReal}, {"number", OFTInteger}},
             .type = wkbPolygon},
            name);
        const auto layer = read_polygons(file, "", without_wkt);
        ASSERT_TRUE(layer.ok()) << layer.error().message;
        ASSERT_EQ(layer->features.size(), 2U) << driver;
        EXPECT_EQ(layer->reprojection, "") << driver;
        const PolygonFeature& first = layer->features[0];
        ASSERT_EQ(first.parts.size(), 1U);
        EXPECT_EQ(first.parts[0].outer.size(), 4U) << "the closing point is not repeated";
        EXPECT_EQ(first.parts[0].holes.size(), 1U);
        EXPECT_DOUBLE_EQ(plan_area(first.parts[0]), 1100);
        EXPECT_EQ(first.attributes.at("name"), Attribute("scarp"));
        EXPECT_EQ(first.attributes.at("thickness"), Attribute(1.5));
        EXPECT_EQ(first.attributes.at("number"), Attribute(7.0));
        EXPECT_EQ(layer->features[1].attributes.at("thickness"), Attribute()) << driver;
    }
}

TEST_F(Vectors, multi_polygons_keep_their_parts) {
    const auto layer =
        read_polygons(write({{"MULTIPOLYGON (((0 0, 1 0, 1 1, 0 0)), ((5 5, 6 5, 6 6, 5 5)))"}}), "", without_wkt);
    ASSERT_TRUE(layer.ok()) << layer.error().message;
    ASSERT_EQ(layer->features.size(), 1U);
    EXPECT_EQ(layer->features[0].parts.size(), 2U);
}

TEST_F(Vectors, curves_heights_and_measures_are_flattened) {
    const std::string file = write({{"CURVEPOLYGON ZM (CIRCULARSTRING ZM (0 0 5 1, 10 0 5 1, 0 0 5 1))"},
                                    {"POLYGON Z ((0 0 9, 1 0 9, 1 1 9, 0 0 9))"}},
                                   {.driver = "GPKG"}, "curve.gpkg");
    const auto layer = read_polygons(file, "", without_wkt);
    ASSERT_TRUE(layer.ok()) << layer.error().message;
    EXPECT_NEAR(plan_area(layer->features[0].parts[0]), M_PI * 25, 0.1);
    EXPECT_DOUBLE_EQ(plan_area(layer->features[1].parts[0]), 0.5);
}

TEST_F(Vectors, geojson_without_crs_is_wgs84_and_is_reprojected) {
    const std::string file = test::write_text(folder_.file("wgs84.geojson"), R"({"type": "FeatureCollection",
        "features": [{"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates":
        [[[114.181, 22.310606], [114.182, 22.310606], [114.182, 22.312], [114.181, 22.310606]]]}}]})");
    const auto layer = read_polygons(file, "", without_wkt);
    ASSERT_TRUE(layer.ok()) << layer.error().message;
    EXPECT_EQ(layer->reprojection, "reprojected from EPSG:4326 (WGS 84) to EPSG:2326 (Hong Kong 1980 Grid System)");
    const PlanPoint first = layer->features[0].parts[0].outer[0];
    EXPECT_NEAR(first.x, easting, 5);
    EXPECT_NEAR(first.y, northing, 5);
}

TEST_F(Vectors, axes_in_the_order_of_the_authority_are_turned) {
    // GML keeps latitude first for EPSG:4326 and northing first for EPSG:2326.
    const auto gml = [](int epsg, double a, double b, double step) {
        std::ostringstream text;
        text.precision(12);
        const std::string srs = "urn:ogc:def:crs:EPSG::" + std::to_string(epsg);
        text << R"(<?xml version="1.0"?><ogr:FeatureCollection xmlns:ogr="http://ogr.maptools.org/")"
             << R"( xmlns:gml="http://www.opengis.net/gml/3.2" gml:id="c"><ogr:featureMember><ogr:a gml:id="a.0">)"
             << "<ogr:geometryProperty><gml:Polygon srsName=\"" << srs << "\" gml:id=\"g\"><gml:exterior>"
             << "<gml:LinearRing><gml:posList>" << a << ' ' << b << ' ' << a << ' ' << b + step << ' ' << a + step
             << ' ' << b + step << ' ' << a << ' ' << b
             << "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>"
             << "</ogr:geometryProperty></ogr:a></ogr:featureMember></ogr:FeatureCollection>";
        return text.str();
    };
    for (const auto& text : {gml(4326, latitude, longitude, 0.001), gml(2326, northing, easting, 100)}) {
        const std::string file = test::write_text(folder_.file("a.gml"), text);
        std::filesystem::remove(folder_.file("a.gfs"));
        const auto layer = read_polygons(file, "", without_wkt);
        ASSERT_TRUE(layer.ok()) << layer.error().message;
        EXPECT_NEAR(layer->features[0].parts[0].outer[0].x, easting, 5);
        EXPECT_NEAR(layer->features[0].parts[0].outer[0].y, northing, 5);
    }
}

TEST_F(Vectors, shapefile_in_the_terrains_crs_is_not_reprojected) {
    const std::string file = write({{square}}, {.driver = "ESRI Shapefile", .type = wkbPolygon}, "same.shp");
    const auto layer = read_polygons(file, "", without_wkt);
    ASSERT_TRUE(layer.ok()) << layer.error().message;
    EXPECT_EQ(layer->reprojection, "");
    EXPECT_EQ(layer->features[0].parts[0].outer[0].x, 824100);
}

TEST_F(Vectors, terrains_crs_as_read_from_a_raster_serves) {
    const auto terrain = read_terrain_raster(test::write_plane(folder_.file("dem.tif")), 1, std::nullopt);
    ASSERT_TRUE(terrain.ok());
    const auto layer = read_polygons(write({{square}}), "", terrain->crs);
    ASSERT_TRUE(layer.ok()) << layer.error().message;
    EXPECT_EQ(layer->reprojection, "");
}

TEST_F(Vectors, unknown_change_of_datum_is_said) {
    Crs local;
    local.name = "site grid";
    local.wkt = R"(PROJCRS["site grid",BASEGEOGCRS["site",DATUM["site datum",ELLIPSOID["e",6378000,298,)"
                R"(LENGTHUNIT["metre",1]]],PRIMEM["Greenwich",0,ANGLEUNIT["degree",0.0174532925199433]]],)"
                R"(CONVERSION["tm",METHOD["Transverse Mercator",ID["EPSG",9807]],)"
                R"(PARAMETER["Latitude of natural origin",22,ANGLEUNIT["degree",0.0174532925199433]],)"
                R"(PARAMETER["Longitude of natural origin",114,ANGLEUNIT["degree",0.0174532925199433]],)"
                R"(PARAMETER["Scale factor at natural origin",1,SCALEUNIT["unity",1]],)"
                R"(PARAMETER["False easting",0,LENGTHUNIT["metre",1]],)"
                R"(PARAMETER["False northing",0,LENGTHUNIT["metre",1]]],CS[Cartesian,2],AXIS["easting",east],)"
                R"(AXIS["northing",north],LENGTHUNIT["metre",1]])";
    const auto layer = read_polygons(write({{square}}), "", local);
    ASSERT_TRUE(layer.ok()) << layer.error().message;
    EXPECT_THAT(layer->reprojection,
                AllOf(StartsWith("reprojected from EPSG:2326"), HasSubstr("without a known change of datum")));
}

TEST_F(Vectors, missing_file_folder_and_nonsense) {
    EXPECT_THAT(refusal(folder_.file("nowhere.gpkg")), EndsWith(": no such file"));
    EXPECT_THAT(refusal(folder_.path().string()), HasSubstr("is a folder"));
    EXPECT_THAT(refusal(test::write_text(folder_.file("a.geojson"), "")), HasSubstr("is empty (0 bytes)"));
    EXPECT_THAT(refusal(test::write_text(folder_.file("b.geojson"), "{\"type\": \"FeatureColl")),
                HasSubstr("cannot be read as a vector file"));
}

TEST_F(Vectors, self_intersection_names_feature_and_place) {
    const std::string file = write({{square}, {"POLYGON ((0 0, 10 10, 10 0, 0 10, 0 0))"}});
    EXPECT_THAT(refusal(file), AllOf(HasSubstr("feature 2 (fid 1) is not a valid polygon: Self-intersection"),
                                     HasSubstr("5 5"), HasSubstr("ogr2ogr -makevalid")));
}

TEST_F(Vectors, empty_layer) {
    EXPECT_THAT(refusal(write({}, {.driver = "GPKG"}, "a.gpkg")), HasSubstr("layer \"layer\" has no features"));
}

TEST_F(Vectors, null_and_empty_geometry) {
    EXPECT_THAT(refusal(write({{square}, {""}})), HasSubstr("feature 2 (fid 1) has no geometry"));
    EXPECT_THAT(refusal(write({{"POLYGON EMPTY"}}, {.driver = "GPKG"}, "a.gpkg")), HasSubstr("has no geometry"));
}

TEST_F(Vectors, wrong_geometry) {
    EXPECT_THAT(refusal(write({{"POINT (1 2)"}})), HasSubstr("feature 1 (fid 0) is a Point, a polygon is needed"));
    EXPECT_THAT(refusal(write({{"LINESTRING (1 2, 3 4)"}})), HasSubstr("is an open line, a polygon is needed"));
    EXPECT_THAT(refusal(write({{"POINT (1 2)"}})), HasSubstr("is a Point, a polygon is needed"));
    const auto line = read_line(write({{square}}), "", without_wkt);
    ASSERT_FALSE(line.ok());
    EXPECT_THAT(line.error().message, HasSubstr("is a Polygon, a line is needed"));
}

TEST_F(Vectors, closed_lines_are_polygons) {
    const std::string ring = "LINESTRING Z (0 0 1, 40 0 1, 40 30 1, 0 30 1, 0 0 1)";
    const auto layer =
        read_polygons(write({{ring}, {"MULTILINESTRING ((50 0, 60 0, 60 10, 50 0))"}, {square}}), "", without_wkt);
    ASSERT_TRUE(layer.ok()) << layer.error().message;
    EXPECT_EQ(layer->closed_lines, 2U);
    EXPECT_EQ(plan_area(layer->features[0].parts[0]), 1200);
    EXPECT_EQ(plan_area(layer->features[1].parts[0]), 50);
    EXPECT_THAT(refusal(write({{"LINESTRING (0 0, 40 0, 40 30, 0 30)"}})), HasSubstr("end it where it begins"));
    EXPECT_THAT(refusal(write({{"LINESTRING (0 0, 40 0, 0 0)"}})), HasSubstr("is an open line"));
    EXPECT_THAT(refusal(write({{"LINESTRING (0 0, 10 10, 0 10, 10 0, 0 0)"}})), HasSubstr("is not a valid polygon"));
}

TEST_F(Vectors, missing_crs) {
    const std::string file =
        write({{square}}, {.driver = "ESRI Shapefile", .epsg = 0, .type = wkbPolygon}, "nocrs.shp");
    EXPECT_THAT(refusal(file), HasSubstr("ogr2ogr -a_srs EPSG:nnnn " + folder_.file("nocrs_crs.gpkg") + " " + file));
}

TEST_F(Vectors, several_layers_need_a_name) {
    const std::string file = write({{square}}, {.driver = "GPKG", .layer = "first"}, "two.gpkg");
    test::write_vector(file, {.driver = "GPKG", .layer = "second", .append = true}, {{square}, {square}});
    EXPECT_THAT(refusal(file), HasSubstr("has 2 layers; name one of them with layer = \"...\" in the scene, or as " +
                                         file + "|layername=NAME: first, second"));
    EXPECT_THAT(refusal(file, "third"), HasSubstr("has no layer \"third\"; its layers: first, second"));
    const auto second = read_polygons(file, "second", without_wkt);
    ASSERT_TRUE(second.ok()) << second.error().message;
    EXPECT_EQ(second->features.size(), 2U);
    const auto behind = read_polygons(file + "|layername=second", "", without_wkt);
    ASSERT_TRUE(behind.ok()) << behind.error().message;
    EXPECT_EQ(behind->features.size(), 2U);
    EXPECT_THAT(refusal(file + "|layername=second", "first"), HasSubstr("and layer = \"first\" another"));
}

TEST_F(Vectors, line_parts_are_joined_whichever_way_they_run) {
    const auto line = read_line(
        write({{"MULTILINESTRING Z ((20 0 1, 10 0 1, 10 0 1), (20 0 1, 30 5 1), (40 5 1, 30 5 1))"}}), "", without_wkt);
    ASSERT_TRUE(line.ok()) << line.error().message;
    std::vector<double> x;
    for (const PlanPoint& p : line->points) x.push_back(p.x);
    EXPECT_THAT(x, ElementsAre(10, 20, 30, 40));
    const auto apart = read_line(write({{"MULTILINESTRING ((0 0, 1 0), (5 0, 6 0))"}}), "", without_wkt);
    ASSERT_FALSE(apart.ok());
    EXPECT_THAT(apart.error().message, HasSubstr("parts that are not connected"));
}

TEST_F(Vectors, every_line_of_a_file_is_read_or_all_are_refused) {
    const std::string file =
        write({{"LINESTRING (0 0, 0 60)", {"upper"}}, {"LINESTRING (50 0, 50 80, 50 90)", {"lower"}}},
              {.fields = {{"Name", OFTString}}});
    const auto lines = read_lines(file, "", without_wkt);
    ASSERT_TRUE(lines.ok()) << lines.error().message;
    ASSERT_EQ(lines->features.size(), 2U);
    EXPECT_EQ(lines->features[0].name, "upper") << "an attribute \"Name\" is one too";
    EXPECT_EQ(lines->features[1].points.size(), 3U);
    const auto one = read_line(file, "", without_wkt);
    ASSERT_FALSE(one.ok());
    EXPECT_THAT(one.error().message, AllOf(StartsWith(file + ": has 2 lines, one is needed"),
                                           HasSubstr("ogr2ogr -fid N " + folder_.file("release_one.gpkg"))));
    const auto mixed = read_lines(write({{"LINESTRING (0 0, 0 60)"}, {"POINT (1 2)"}}), "", without_wkt);
    ASSERT_FALSE(mixed.ok());
    EXPECT_THAT(mixed.error().message, HasSubstr("feature 2 (fid 1) is a Point, a line is needed"));
}

/// A shapefile of a square with a text attribute, whose .dbf has these bytes and says nothing of their encoding.
std::string shapefile_with_bytes(const TemporaryFolder& folder, const std::string& field, const std::string& value) {
    const std::string file = test::write_vector(
        folder.file("a.shp"),
        {.driver = "ESRI Shapefile", .fields = {{std::string(field.size(), '#'), OFTString}}, .type = wkbPolygon},
        {{square, {std::string(value.size(), '@')}}});
    std::filesystem::remove(folder.file("a.cpg"));
    std::string table = test::read_text(folder.file("a.dbf"));
    table[29] = 0;  // the code page
    table.replace(table.find('#'), field.size(), field);
    table.replace(table.find('@'), value.size(), value);
    test::write_text(folder.file("a.dbf"), table);
    return file;
}

TEST_F(Vectors, text_is_utf8_whatever_the_file_holds) {
    const auto latin1 =
        read_polygons(shapefile_with_bytes(folder_, "Geb\xE4ude", "M\xFCllerh\xFCtte"), "", without_wkt);
    ASSERT_TRUE(latin1.ok()) << latin1.error().message;
    EXPECT_TRUE(latin1->encoding_assumed);
    ASSERT_EQ(latin1->features[0].attributes.count("Gebäude"), 1U);
    EXPECT_EQ(latin1->features[0].attributes.at("Gebäude"), Attribute("Müllerhütte"));

    const auto utf8 = read_polygons(shapefile_with_bytes(folder_, "name", "Müllerhütte"), "", without_wkt);
    ASSERT_TRUE(utf8.ok()) << utf8.error().message;
    EXPECT_FALSE(utf8->encoding_assumed);
    EXPECT_EQ(utf8->features[0].attributes.at("name"), Attribute("Müllerhütte"));
}

TEST_F(Vectors, line_is_reprojected) {
    const auto line =
        read_line(write({{"LINESTRING (114.181 22.310606, 114.182 22.312)"}}, {.epsg = 4326}), "", without_wkt);
    ASSERT_TRUE(line.ok()) << line.error().message;
    EXPECT_NEAR(line->points[0].x, easting, 5);
    EXPECT_THAT(line->reprojection, StartsWith("reprojected from EPSG:4326"));
}

}  // namespace
}  // namespace talus::geo
