#include <algorithm>
#include <cmath>

#include <cpl_minixml.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/hash.hpp"
#include "products_fixture.hpp"
#include "report/hazard_map.hpp"
#include "report/intensity.hpp"

namespace talus::products {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST_F(Products, maps_read_back_in_their_units) {
    const HazardMaps& maps = result_->observation.maps;
    const std::tuple<const char*, const Grid<float>*, const char*, double> expected[] = {
        {"peak_depth", &maps.peak_depth, "m", 1},
        {"peak_speed", &maps.peak_speed, "m/s", 1},
        {"peak_pressure", &maps.peak_pressure, "kPa", 1e-3},
        {"arrival_time", &maps.arrival_time, "s", 1},
        {"deposit_depth", &maps.deposit_depth, "m", 1}};
    for (const auto& [name, grid, unit, factor] : expected) {
        const GDALDatasetUniquePtr data(GDALDataset::Open(folder_->file(std::string(name) + ".tif").c_str()));
        ASSERT_TRUE(data) << name;
        EXPECT_STREQ(data->GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE"), "COG") << name;
        GDALRasterBand* band = data->GetRasterBand(1);
        EXPECT_STREQ(band->GetUnitType(), unit) << name;
        EXPECT_EQ(band->GetNoDataValue(), -9999) << name;
        EXPECT_EQ(band->GetRasterDataType(), GDT_Float32) << name;
        EXPECT_THAT(band->GetDescription(), HasSubstr("(reconstruction)")) << name;
        EXPECT_STREQ(data->GetSpatialRef()->GetAuthorityCode(nullptr), "2326") << name;
        const GridGeometry& g = grid->geometry;
        std::vector<float> cells(g.size());
        ASSERT_EQ(band->RasterIO(GF_Read, 0, 0, g.columns, g.rows, cells.data(), g.columns, g.rows, GDT_Float32, 0, 0,
                                 nullptr),
                  CE_None);
        for (int row = 0; row < g.rows; ++row) {
            for (int column = 0; column < g.columns; ++column) {
                const float written = cells[static_cast<std::size_t>(g.rows - 1 - row) * g.columns + column];
                const float value = grid->at(column, row);
                const auto wanted = static_cast<float>(value * factor);
                ASSERT_EQ(written, std::isnan(value) ? -9999.0F : wanted) << name << " " << column << " " << row;
            }
        }
    }
}

TEST_F(Products, every_map_has_a_style_that_parses_with_ascending_limits_and_units) {
    for (const report::HazardMap& map : report::hazard_maps()) {
        const std::string text = test::read_text(folder_->path() / (std::string(map.file) + ".qml"));
        CPLXMLNode* tree = CPLParseXMLString(text.c_str());
        ASSERT_NE(tree, nullptr) << map.file;
        CPLXMLNode* renderer = CPLGetXMLNode(tree, "=qgis.pipe.rasterrenderer");
        ASSERT_NE(renderer, nullptr);
        EXPECT_STREQ(CPLGetXMLValue(renderer, "type", ""), "singlebandpseudocolor");
        CPLXMLNode* shader = CPLGetXMLNode(renderer, "rastershader.colorrampshader");
        ASSERT_NE(shader, nullptr);
        double previous = -1;
        int shown = 0;
        std::string last;
        for (CPLXMLNode* item = shader->psChild; item != nullptr; item = item->psNext) {
            if (std::string(item->pszValue) != "item") continue;
            last = CPLGetXMLValue(item, "value", "");
            const double limit = std::stod(last);
            EXPECT_GT(limit, previous) << map.file;
            previous = limit;
            if (std::string(CPLGetXMLValue(item, "alpha", "")) == "0") continue;
            ++shown;
            EXPECT_THAT(CPLGetXMLValue(item, "label", ""), testing::EndsWith(map.unit)) << map.file;
            EXPECT_THAT(CPLGetXMLValue(item, "color", ""), testing::MatchesRegex("#[0-9a-f]{6}"));
        }
        EXPECT_EQ(last, "inf") << "no value may go uncoloured";
        EXPECT_GE(shown, 3) << map.file;
        CPLDestroyXMLNode(tree);
    }
}

TEST_F(Products, styles_order_classes_by_lightness) {
    for (const report::HazardMap& map : report::hazard_maps()) {
        const auto classes =
            map.breaks.empty() ? report::even_classes(40, map.ramp) : report::fixed_classes(map.breaks, 1e6, map.ramp);
        const bool darkens = map.ramp.high_lightness < map.ramp.low_lightness;
        for (std::size_t k = 1; k < classes.colours.size(); ++k) {
            const double step = report::lightness(classes.colours[k]) - report::lightness(classes.colours[k - 1]);
            EXPECT_GT(darkens ? -step : step, 0.02) << map.file << " class " << k;
        }
    }
}

TEST_F(Products, style_leaves_zero_depth_and_thin_deposits_transparent) {
    EXPECT_THAT(test::read_text(folder_->path() / "peak_depth.qml"), HasSubstr("<item value=\"0\""));
    EXPECT_THAT(test::read_text(folder_->path() / "deposit_depth.qml"), HasSubstr("label=\"up to 0.05 m\""));
    EXPECT_THAT(test::read_text(folder_->path() / "arrival_time.qml"), Not(HasSubstr("alpha=\"0\"")));
}

TEST_F(Products, maps_say_which_run_they_are_of) {
    const GDALDatasetUniquePtr data(GDALDataset::Open(folder_->file("peak_depth.tif").c_str()));
    ASSERT_TRUE(data);
    const auto item = [&](const char* key) {
        const char* value = data->GetMetadataItem(key);
        return std::string(value != nullptr ? value : "");
    };
    EXPECT_THAT(item("TIFFTAG_SOFTWARE"), testing::StartsWith("talus "));
    EXPECT_EQ(item("TITLE"), scene_->spec.scene.title);
    EXPECT_EQ(item("RESULT_HASH"), to_hex(result_->hash));
    EXPECT_DOUBLE_EQ(std::stod(item("SIMULATED_TIME_S")), result_->simulated_time);
    EXPECT_EQ(item("STATUS"), "complete");
}

TEST_F(Products, intensity_is_a_raster_of_classes_with_a_style_and_polygons_of_the_same_area) {
    const Grid<float> map =
        intensity_map(report::intensity_guideline(scene_->spec.outputs.intensity_guideline), result_->observation.maps);
    const GDALDatasetUniquePtr data(GDALDataset::Open(folder_->file("intensity.tif").c_str()));
    ASSERT_TRUE(data);
    EXPECT_THAT(data->GetRasterBand(1)->GetDescription(),
                testing::StartsWith("intensity, Swiss debris-flow classes: 1 medium, 2 high"));
    const std::string style = test::read_text(folder_->path() / "intensity.qml");
    EXPECT_THAT(style, HasSubstr("type=\"paletted\""));
    EXPECT_THAT(style, HasSubstr("<paletteEntry value=\"2\" color=\"#481470\" alpha=\"255\" label=\"high\"/>"));
    CPLXMLNode* tree = CPLParseXMLString(style.c_str());
    EXPECT_NE(tree, nullptr);
    CPLDestroyXMLNode(tree);

    const GDALDatasetUniquePtr vectors(GDALDataset::Open(folder_->file("results.gpkg").c_str(), GDAL_OF_VECTOR));
    ASSERT_TRUE(vectors);
    OGRLayer* layer = vectors->GetLayerByName("intensity");
    ASSERT_NE(layer, nullptr);
    ASSERT_EQ(layer->GetFeatureCount(), 2);
    for (const auto& feature : *layer) {
        const double number = feature->GetFieldAsDouble("class");
        const auto cells = std::count(map.values.begin(), map.values.end(), static_cast<float>(number));
        EXPECT_GT(cells, 100);
        const double area = static_cast<double>(cells) * map.geometry.cell * map.geometry.cell;
        EXPECT_NEAR(feature->GetFieldAsDouble("area_m2"), area, 1e-6);
        EXPECT_NEAR(OGR_G_Area(OGRGeometry::ToHandle(feature->GetGeometryRef())), area, 1e-6);
        EXPECT_STREQ(feature->GetFieldAsString("intensity"), number == 2 ? "high" : "medium");
    }
}

}  // namespace
}  // namespace talus::products
