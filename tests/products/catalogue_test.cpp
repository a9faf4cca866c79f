// Files for readers other than a GIS: results.kml for phones and globes, stac_item.json for catalogues of geodata.
#include <cpl_minixml.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "products/writers.hpp"
#include "products_fixture.hpp"

namespace talus::products {
namespace {

using nlohmann::json;

TEST_F(Products, kml_has_the_hit_buildings_the_outline_and_the_arrival_in_degrees) {
    const std::string file = folder_->file("results.kml");
    const GDALDatasetUniquePtr data(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR));
    ASSERT_TRUE(data);
    std::vector<std::string> layers;
    for (int k = 0; k < data->GetLayerCount(); ++k) layers.emplace_back(data->GetLayer(k)->GetName());
    EXPECT_THAT(layers, testing::ElementsAre("Buildings hit", "Inundation", "Arrival"));
    std::size_t hit = 0;
    for (const observe::BuildingImpact& b : result_->observation.buildings) hit += b.hit ? 1 : 0;
    EXPECT_EQ(data->GetLayer(0)->GetFeatureCount(), static_cast<GIntBig>(hit));
    for (const char* layer : {"Inundation", "Arrival"}) {
        OGREnvelope box;
        ASSERT_EQ(data->GetLayerByName(layer)->GetExtent(&box), OGRERR_NONE) << layer;
        EXPECT_GT(box.MinX, 113.8) << "Hong Kong";
        EXPECT_LT(box.MaxX, 114.5);
        EXPECT_GT(box.MinY, 22.1);
        EXPECT_LT(box.MaxY, 22.6);
    }
}

TEST_F(Products, kml_is_well_formed_whatever_names_hold) {
    const test::TemporaryFolder folder;
    scene::Scene scene = *scene_;
    scene.spec.scene.title = "a < b & \x01 \"c\"";
    ASSERT_TRUE(write_products(scene, *result_, folder.path()).ok());
    const std::string text = test::read_text(folder.path() / "results.kml");
    CPLXMLNode* root = CPLParseXMLString(text.c_str());
    EXPECT_NE(root, nullptr);
    CPLDestroyXMLNode(root);
    EXPECT_EQ(text.find('\x01'), std::string::npos);
    EXPECT_THAT(text, testing::HasSubstr("a &lt; b &amp; "));
}

TEST_F(Products, titles_say_once_that_the_scene_is_a_reconstruction) {
    scene::Scene scene = *scene_;
    scene.spec.scene.title = "Valley";
    EXPECT_EQ(title_of(scene, *result_), "Valley (reconstruction)");
    scene.spec.scene.title = "Valley 1999 (reconstruction)";
    EXPECT_EQ(title_of(scene, *result_), "Valley 1999 (reconstruction)");
    run::RunResult partial = *result_;
    partial.status = run::RunStatus::interrupted;
    EXPECT_EQ(title_of(scene, partial), "Valley 1999 (reconstruction) (partial result: interrupted)");
    scene.spec.scene.reconstruction = false;
    EXPECT_EQ(title_of(scene, *result_), "Valley 1999 (reconstruction)");
}

TEST_F(Products, no_kml_where_the_place_on_the_globe_is_not_known) {
    const test::TemporaryFolder folder;
    scene::Scene scene = *scene_;
    scene.crs = {"LOCAL_CS[\"site\",UNIT[\"metre\",1]]", "site", 0};
    ASSERT_TRUE(write_products(scene, *result_, folder.path()).ok());
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "results.kml"));
    EXPECT_TRUE(json::parse(test::read_text(folder.path() / "stac_item.json"))["geometry"].is_null());
}

TEST_F(Products, stac_item_has_place_software_and_every_file) {
    const json item = json::parse(test::read_text(folder_->path() / "stac_item.json"));
    EXPECT_EQ(item["type"], "Feature");
    EXPECT_EQ(item["stac_version"], "1.0.0");
    EXPECT_EQ(item["properties"]["talus:result_hash"], manifest()["result_hash"]);
    EXPECT_EQ(item["properties"]["processing:software"]["talus"], manifest()["versions"]["talus"]);
    const auto box = item["bbox"].get<std::vector<double>>();
    ASSERT_EQ(box.size(), 4U);
    EXPECT_LT(box[0], box[2]);
    EXPECT_LT(box[1], box[3]);
    EXPECT_NEAR(box[0], 114.0, 0.3);
    EXPECT_NEAR(box[1], 22.4, 0.3);
    for (const auto& entry : std::filesystem::directory_iterator(folder_->path())) {
        const std::string name = entry.path().filename();
        if (name == "stac_item.json") continue;
        EXPECT_TRUE(item["assets"].contains(name)) << name;
    }
    for (const auto& [name, asset] : item["assets"].items()) {
        EXPECT_TRUE(std::filesystem::exists(folder_->path() / asset["href"].get<std::string>())) << name;
    }
}

TEST_F(Products, stac_item_has_the_run_over_time) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "series/paraview");
    for (const char* name :
         {"series/maps.nc", "series/depth.tif", "series/run.glb", "series/run.usda", "series/paraview/run.py"}) {
        test::write_text(folder.file(name), "x");
    }
    ASSERT_TRUE(write_stac_item(*scene_, *result_, folder.path()));
    const json assets = json::parse(test::read_text(folder.path() / "stac_item.json"))["assets"];
    EXPECT_EQ(assets["series/maps.nc"]["type"], "application/netcdf");
    EXPECT_EQ(assets["series/maps.nc"]["href"], "./series/maps.nc");
    for (const char* name : {"series/depth.tif", "series/run.glb", "series/run.usda"}) {
        EXPECT_TRUE(assets.contains(name)) << name;
    }
    EXPECT_FALSE(assets.contains("series/paraview/run.py")) << "a part of a scene, not a file to open";
}

}  // namespace
}  // namespace talus::products
