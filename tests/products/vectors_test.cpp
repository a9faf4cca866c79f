#include <algorithm>
#include <cmath>
#include <map>

#include <cpl_minixml.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geo/raster.hpp"
#include "geo/vector.hpp"
#include "products_fixture.hpp"
#include "report/hazard_map.hpp"

namespace talus::products {
namespace {

using test::TemporaryFolder;
using testing::StartsWith;

TEST_F(Products, outlines_hold_what_is_deep_enough) {
    const GDALDatasetUniquePtr data(GDALDataset::Open(folder_->file("results.gpkg").c_str(), GDAL_OF_VECTOR));
    ASSERT_TRUE(data);
    const double level = scene_->spec.outputs.arrival_depth;
    const HazardMaps& maps = result_->observation.maps;
    for (const auto& [name, map] :
         {std::pair{"inundation", &maps.peak_depth}, std::pair{"deposit", &maps.deposit_depth}}) {
        const auto cells = std::count_if(map->values.begin(), map->values.end(),
                                         [&](float depth) { return depth >= static_cast<float>(level); });
        const auto features = read_layer(*data, name);
        ASSERT_EQ(features.size(), 1U) << name;
        EXPECT_DOUBLE_EQ(features[0]->GetFieldAsDouble("above_m"), level);
        const double area = static_cast<double>(cells) * map->geometry.cell * map->geometry.cell;
        EXPECT_GT(area, 0) << name;
        EXPECT_NEAR(features[0]->GetFieldAsDouble("area_m2"), area, 1e-6) << name;
        EXPECT_NEAR(features[0]->GetGeometryRef()->toMultiPolygon()->get_Area(), area, 1e-6) << name;
    }
}

TEST_F(Products, every_layer_has_a_style_for_qgis_in_the_file) {
    const GDALDatasetUniquePtr data(GDALDataset::Open(folder_->file("results.gpkg").c_str(), GDAL_OF_VECTOR));
    ASSERT_TRUE(data);
    std::map<std::string, std::string> styles;
    for (const auto& style : read_layer(*data, "layer_styles")) {
        EXPECT_EQ(style->GetFieldAsInteger("useAsDefault"), 1);
        styles[style->GetFieldAsString("f_table_name")] = style->GetFieldAsString("styleQML");
    }
    for (int k = 0; k < data->GetLayerCount(); ++k) {
        OGRLayer& layer = *data->GetLayer(k);
        const std::string name = layer.GetName();
        if (name == "layer_styles") continue;
        ASSERT_EQ(styles.count(name), 1U) << name;
        CPLXMLNode* tree = CPLParseXMLString(styles[name].c_str());
        CPLXMLNode* renderer = tree != nullptr ? CPLGetXMLNode(tree, "=qgis.renderer-v2") : nullptr;
        ASSERT_NE(renderer, nullptr) << name;
        if (const char* attribute = CPLGetXMLValue(renderer, "attr", nullptr)) {
            EXPECT_GE(layer.GetLayerDefn()->GetFieldIndex(attribute), 0)
                << name << ": its classes are of a field that it has";
        }
        CPLDestroyXMLNode(tree);
    }
}

TEST_F(Products, one_file_opens_all_layers_in_qgis) {
    const TemporaryFolder folder;
    scene::Scene scene = *scene_;
    scene.spec.scene.title = "Slope <A> & \"B\"";
    ASSERT_TRUE(write_products(scene, *result_, folder.path()).ok());
    CPLXMLNode* tree = CPLParseXMLString(test::read_text(folder.path() / "results.qlr").c_str());
    ASSERT_NE(tree, nullptr);
    EXPECT_STREQ(CPLGetXMLValue(tree, "=qlr.layer-tree-group.layer-tree-group.name", ""),
                 "Slope <A> & \"B\" (reconstruction)");
    std::vector<std::string> in_tree, names;
    for (CPLXMLNode* node = CPLGetXMLNode(tree, "=qlr.layer-tree-group.layer-tree-group")->psChild; node != nullptr;
         node = node->psNext) {
        if (std::string(node->pszValue) == "layer-tree-layer") in_tree.emplace_back(CPLGetXMLValue(node, "id", ""));
    }
    std::vector<std::string> ids;
    for (CPLXMLNode* layer = CPLGetXMLNode(tree, "=qlr.maplayers")->psChild; layer != nullptr; layer = layer->psNext) {
        ids.emplace_back(CPLGetXMLValue(layer, "id", ""));
        names.emplace_back(CPLGetXMLValue(layer, "layername", ""));
        const std::string source = CPLGetXMLValue(layer, "datasource", "");
        ASSERT_THAT(source, StartsWith("./"));
        const std::size_t bar = source.find("|layername=");
        const std::string file = folder.file(source.substr(2, bar == std::string::npos ? bar : bar - 2));
        const GDALDatasetUniquePtr data(GDALDataset::Open(file.c_str()));
        ASSERT_TRUE(data) << source;
        const bool is_vector = bar != std::string::npos;
        EXPECT_EQ(std::string(CPLGetXMLValue(layer, "type", "")), is_vector ? "vector" : "raster");
        const std::string layer_name = is_vector ? source.substr(bar + 11) : std::string();
        EXPECT_EQ(is_vector, data->GetLayerByName(layer_name.c_str()) != nullptr) << source;
        EXPECT_NE(CPLGetXMLNode(layer, is_vector ? "renderer-v2" : "pipe.rasterrenderer"), nullptr) << source;
        EXPECT_EQ(CPLGetXMLValue(layer, "srs.spatialrefsys.wkt", ""), scene.crs.wkt);
    }
    CPLDestroyXMLNode(tree);
    EXPECT_EQ(ids, in_tree);
    EXPECT_THAT(names, testing::Contains("Buildings"));
    EXPECT_THAT(names, testing::Contains("Intensity"));
}

TEST_F(Products, qgis_gets_the_ground_below_the_maps) {
    const GDALDatasetUniquePtr data(GDALDataset::Open(folder_->file("terrain.tif").c_str()));
    ASSERT_TRUE(data);
    double to_world[6];
    data->GetGeoTransform(to_world);
    const GridGeometry& whole = scene_->terrain.elevation().geometry;
    const GridGeometry& maps = result_->observation.maps.peak_depth.geometry;
    const double width = data->GetRasterXSize() * to_world[1], height = data->GetRasterYSize() * to_world[1];
    EXPECT_LE(to_world[0],
              std::max(maps.extent().x_min - 0.4 * (maps.extent().x_max - maps.extent().x_min), whole.x_min));
    EXPECT_GE(to_world[0], whole.x_min - 1e-6);
    EXPECT_GE(to_world[3] - height, whole.y_min - 1e-6);
    const PlanPoint middle{to_world[0] + 0.5 * width, to_world[3] - 0.5 * height};
    float elevation = 0;
    ASSERT_EQ(data->GetRasterBand(1)->RasterIO(GF_Read, data->GetRasterXSize() / 2, data->GetRasterYSize() / 2, 1, 1,
                                               &elevation, 1, 1, GDT_Float32, 0, 0),
              CE_None);
    EXPECT_NEAR(elevation, scene_->terrain.elevation_at(middle), 3 * whole.cell) << "of a cell beside the middle";
    const std::string layers = test::read_text(folder_->path() / "results.qlr");
    EXPECT_GT(layers.find("name=\"Terrain, hillshade\""), layers.find("name=\"Intensity\"")) << "is at the bottom";
    EXPECT_THAT(layers, testing::HasSubstr("rasterrenderer type=\"hillshade\""));
    EXPECT_THAT(layers, testing::HasSubstr("zoomedInResampler=\"bilinear\""));
}

TEST_F(Products, qgis_does_not_open_tables_without_features) {
    const TemporaryFolder folder;
    scene::Scene scene = *scene_;
    scene.buildings.clear();
    run::RunResult result = *result_;
    const Grid<float> blank(result.observation.maps.peak_depth.geometry, std::nanf(""));
    result.observation = {};
    result.observation.maps = {blank, blank, blank, blank, blank};
    ASSERT_TRUE(write_products(scene, result, folder.path()).ok());
    const std::string layers = test::read_text(folder.path() / "results.qlr");
    EXPECT_THAT(layers, testing::Not(testing::HasSubstr("layername=buildings")));
    EXPECT_THAT(layers, testing::Not(testing::HasSubstr("layername=deposit")));
    EXPECT_THAT(layers, testing::HasSubstr("layername=release"));
    const GDALDatasetUniquePtr data(GDALDataset::Open(folder.file("results.gpkg").c_str(), GDAL_OF_VECTOR));
    ASSERT_TRUE(data);
    EXPECT_NE(data->GetLayerByName("buildings"), nullptr) << "the table is there";
}

TEST_F(Products, qgis_shows_maps_over_time) {
    scene::Scene scene = *scene_;
    const auto layers_with = [&](const std::vector<double>& times, const std::vector<std::string>& series) {
        const TemporaryFolder folder;
        std::filesystem::create_directory(folder.path() / "series");
        for (const std::string& file : series) (void)test::write_text(folder.file("series/" + file), "");
        EXPECT_TRUE(write_products(scene, *result_, folder.path(), {}, {}, times).ok());
        return test::read_text(folder.path() / "results.qlr");
    };
    const std::vector<double> times = {0, 1, 2.5};
    EXPECT_THAT(layers_with(times, {}), testing::Not(testing::HasSubstr("over time"))) << "there are no maps";
    EXPECT_THAT(layers_with(times, {"maps.nc"}), testing::HasSubstr("NETCDF:&quot;./series/maps.nc&quot;:depth"));

    const std::vector<std::string> both = {"maps.nc", "depth.tif", "speed.tif", "pressure.tif"};
    scene.spec.outputs.series_interval = 1;
    CPLXMLNode* tree = CPLParseXMLString(layers_with(times, both).c_str());
    ASSERT_NE(tree, nullptr);
    std::vector<std::string> seen;
    for (CPLXMLNode* layer = CPLGetXMLNode(tree, "=qlr.maplayers")->psChild; layer != nullptr; layer = layer->psNext) {
        if (CPLGetXMLValue(layer, "datasource", "") != std::string("./series/speed.tif")) continue;
        seen.push_back(std::string(CPLGetXMLValue(layer, "pipe.rasterrenderer.band", "")) + ": " +
                       CPLGetXMLValue(layer, "temporal.fixedRange.start", "") + " to " +
                       CPLGetXMLValue(layer, "temporal.fixedRange.end", ""));
    }
    CPLDestroyXMLNode(tree);
    EXPECT_THAT(seen, testing::ElementsAre("3: 2000-01-01T00:00:02.500Z to 2000-01-01T00:00:03.499Z",
                                           "2: 2000-01-01T00:00:01.000Z to 2000-01-01T00:00:02.499Z",
                                           "1: 2000-01-01T00:00:00.000Z to 2000-01-01T00:00:00.999Z"));

    std::vector<double> many;
    for (int k = 0; k < 250; ++k) many.push_back(60 * k);
    const std::string text = layers_with(many, both);
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find("<fixedRange>", at)) != std::string::npos; ++at) ++count;
    EXPECT_EQ(count, 3U * 84) << "every third frame of depth, speed and pressure";
    EXPECT_THAT(text, testing::HasSubstr("<start>2000-01-01T04:09:00.000Z</start>"));
}

TEST_F(Products, geopackage_holds_buildings_releases_path_and_marks) {
    const std::string file = folder_->file("results.gpkg");
    const auto buildings = read_polygons(file, "buildings", scene_->crs);
    ASSERT_TRUE(buildings.ok()) << buildings.error().message;
    ASSERT_EQ(buildings->features.size(), 5U);
    EXPECT_EQ(buildings->features[0].attributes.at("peak_force_kN"), geo::Attribute(412.0));
    EXPECT_EQ(buildings->features[0].attributes.at("name"), geo::Attribute("House 38"));
    EXPECT_EQ(buildings->features[4].attributes.at("first_hit_time_s"), geo::Attribute());
    EXPECT_NEAR(plan_area(buildings->features[0].parts[0]), 12 * 9, 1e-6);

    const auto releases = read_polygons(file, "release", scene_->crs);
    ASSERT_TRUE(releases.ok()) << releases.error().message;
    EXPECT_EQ(releases->features[0].attributes.at("thickness_m"), geo::Attribute(1.4));

    const auto path = read_line(file, "flow_path", scene_->crs);
    ASSERT_TRUE(path.ok()) << path.error().message;
    EXPECT_EQ(path->points.size(), scene_->flow_path.points().size());

    const GDALDatasetUniquePtr data(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR));
    OGRLayer* marks = data->GetLayerByName("chainage");
    ASSERT_NE(marks, nullptr);
    EXPECT_EQ(marks->GetFeatureCount(), static_cast<GIntBig>(scene_->flow_path.length() / 10) + 1);
    marks->SetAttributeFilter("chainage_m = 100");
    const OGRFeatureUniquePtr mark(marks->GetNextFeature());
    ASSERT_TRUE(mark);
    EXPECT_NEAR(mark->GetFieldAsDouble("front_velocity_mps"), test::SampleValley::velocity_at(100), 1e-9);
    EXPECT_EQ(data->GetLayerByName("gauges"), nullptr);
    EXPECT_EQ(data->GetLayerByName("zoom"), nullptr);
}

TEST_F(Products, geopackage_holds_gauges_and_the_boundary_of_a_zoom) {
    run::RunResult result = *result_;
    observe::GaugeRecord gully{.gauge = {"gully", {824200, 825550}, 121}};
    gully.arrival_time = 14;
    gully.peak_depth = 1.75;
    result.observation.gauges = {gully, {.gauge = {"mill", {824210, 825560}}}};
    result.zoom.emplace();
    result.zoom->around = "House 38";
    result.zoom->area = {{{824100, 825500}, {824140, 825500}, {824140, 825530}, {824100, 825530}}, {}};
    const test::TemporaryFolder folder;
    ASSERT_TRUE(write_products(*scene_, result, folder.path()).ok());

    const GDALDatasetUniquePtr data(GDALDataset::Open(folder.file("results.gpkg").c_str(), GDAL_OF_VECTOR));
    OGRLayer* gauges = data->GetLayerByName("gauges");
    ASSERT_NE(gauges, nullptr);
    EXPECT_EQ(wkbFlatten(gauges->GetGeomType()), wkbPoint);
    OGRFeatureUniquePtr gauge(gauges->GetNextFeature());
    EXPECT_EQ(std::string(gauge->GetFieldAsString("name")), "gully");
    EXPECT_DOUBLE_EQ(gauge->GetGeometryRef()->toPoint()->getX(), 824200);
    EXPECT_DOUBLE_EQ(gauge->GetFieldAsDouble("first_arrival_time_s"), 14);
    EXPECT_DOUBLE_EQ(gauge->GetFieldAsDouble("peak_depth_m"), 1.75);
    gauge.reset(gauges->GetNextFeature());
    EXPECT_FALSE(gauge->IsFieldSetAndNotNull(gauge->GetFieldIndex("first_arrival_time_s")));
    EXPECT_FALSE(gauge->IsFieldSetAndNotNull(gauge->GetFieldIndex("chainage_m")));

    const auto zoom = read_polygons(folder.file("results.gpkg"), "zoom", scene_->crs);
    ASSERT_TRUE(zoom.ok()) << zoom.error().message;
    EXPECT_NEAR(plan_area(zoom->features.at(0).parts[0]), 40 * 30, 1e-6);
    EXPECT_EQ(zoom->features[0].attributes.at("around"), geo::Attribute("House 38"));
    const std::string layers = test::read_text(folder.path() / "results.qlr");
    EXPECT_THAT(layers, testing::HasSubstr("layername=gauges"));
    EXPECT_THAT(layers, testing::HasSubstr("layername=zoom"));
    EXPECT_THAT(layers, testing::HasSubstr("SimpleMarker"));
}

}  // namespace
}  // namespace talus::products
