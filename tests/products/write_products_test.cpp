#include <algorithm>
#include <cmath>
#include <csignal>
#include <map>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cpl_minixml.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/hash.hpp"
#include "geo/raster.hpp"
#include "geo/vector.hpp"
#include "params/fields.hpp"
#include "products/products.hpp"
#include "products/writers.hpp"
#include "report/hazard_map.hpp"
#include "report/intensity.hpp"
#include "report/report_fixture.hpp"
#include "support/fixtures.hpp"

namespace talus::products {
namespace {

using nlohmann::json;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

/// Rows of a CSV without quoted fields; the first is the header.
std::vector<std::vector<std::string>> rows_of(const std::string& text) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        std::vector<std::string> row(1);
        for (const char c : line) {
            if (c == ',') {
                row.emplace_back();
            } else {
                row.back() += c;
            }
        }
        rows.push_back(row);
    }
    return rows;
}

/// All products of the sample valley, written once.
class Products : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        scene_ = new scene::Scene(test::sample_scene());
        result_ = new run::RunResult(test::sample_result(*scene_));
        result_->simulated_time = 41.2;
        result_->wall_time = 1;  // beside the stages
        for (std::size_t i = 0; i < sim::stage_count; ++i) {
            result_->stage_times.seconds[i] = 0.5 * static_cast<double>(i + 1);
            result_->wall_time += result_->stage_times.seconds[i];
        }
        folder_ = new TemporaryFolder;
        const Status status = write_products(*scene_, *result_, folder_->path());
        ASSERT_TRUE(status.ok()) << status.error().message;
    }
    static void TearDownTestSuite() {
        delete folder_;
        delete result_;
        delete scene_;
    }
    static json manifest() { return json::parse(test::read_text(folder_->path() / "manifest.json")); }

    static inline scene::Scene* scene_ = nullptr;
    static inline run::RunResult* result_ = nullptr;
    static inline TemporaryFolder* folder_ = nullptr;
};

TEST_F(Products, FolderHoldsWhatItShouldAndNothingElse) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_->path())) {
        names.push_back(entry.path().filename());
    }
    EXPECT_THAT(names, testing::UnorderedElementsAre(
                           "arrival_time.qml", "arrival_time.tif", "buildings.csv", "deposit_depth.qml",
                           "deposit_depth.tif", "front.csv", "intensity.qml", "intensity.tif", "manifest.json",
                           "peak_depth.qml", "peak_depth.tif", "peak_pressure.qml", "peak_pressure.tif",
                           "peak_speed.qml", "peak_speed.tif", "report.html", "results.gpkg", "results.json",
                           "results.qlr", "run_out.csv", "structures_over_time.csv", "timeseries.csv"));
}

TEST_F(Products, MapsReadBackInTheirUnits) {
    const observe::HazardMaps& maps = result_->observation.maps;
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

TEST_F(Products, EveryMapHasAStyleThatParsesWithAscendingLimitsAndUnits) {
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

TEST_F(Products, StylesOrderClassesByLightness) {
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

TEST_F(Products, StyleLeavesZeroDepthAndThinDepositsTransparent) {
    EXPECT_THAT(test::read_text(folder_->path() / "peak_depth.qml"), HasSubstr("<item value=\"0\""));
    EXPECT_THAT(test::read_text(folder_->path() / "deposit_depth.qml"), HasSubstr("label=\"up to 0.05 m\""));
    EXPECT_THAT(test::read_text(folder_->path() / "arrival_time.qml"), Not(HasSubstr("alpha=\"0\"")));
}

std::vector<OGRFeatureUniquePtr> read_layer(GDALDataset& data, const char* name) {
    std::vector<OGRFeatureUniquePtr> features;
    OGRLayer* layer = data.GetLayerByName(name);
    EXPECT_NE(layer, nullptr) << name;
    if (layer == nullptr) return features;
    for (auto& feature : layer) features.push_back(std::move(feature));
    return features;
}

TEST_F(Products, MapsSayWhichRunTheyAreOf) {
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

TEST_F(Products, OutlinesHoldWhatIsDeepEnough) {
    const GDALDatasetUniquePtr data(GDALDataset::Open(folder_->file("results.gpkg").c_str(), GDAL_OF_VECTOR));
    ASSERT_TRUE(data);
    const double level = scene_->spec.outputs.arrival_depth;
    const observe::HazardMaps& maps = result_->observation.maps;
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

TEST_F(Products, EveryLayerHasAStyleForQgisInTheFile) {
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

TEST_F(Products, OneFileOpensAllLayersInQgis) {
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

TEST_F(Products, IntensityIsARasterOfClassesWithAStyleAndPolygonsOfTheSameArea) {
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

TEST_F(Products, ManifestCountsBarriersApart) {
    const TemporaryFolder folder;
    run::RunResult result = *result_;
    result.observation.buildings[0].is_barrier = true;
    ASSERT_TRUE(write_manifest(*scene_, result, {}, folder.path()).ok());
    const json m = json::parse(test::read_text(folder.path() / "manifest.json"));
    EXPECT_EQ(m["results"]["buildings"], 4);
    EXPECT_EQ(m["results"]["buildings_hit"], 2);
    EXPECT_EQ(m["results"]["barriers"], 1);
    EXPECT_EQ(m["results"]["barriers_hit"], 1);
}

TEST_F(Products, FrontTableLeavesUnknownVelocitiesEmpty) {
    const auto rows = rows_of(test::read_text(folder_->path() / "front.csv"));
    const auto& front = result_->observation.front;
    ASSERT_EQ(rows.size(), front.size() + 1);
    EXPECT_THAT(rows[0],
                ElementsAre("chainage_m", "first_arrival_time_s", "front_velocity_mps", "front_particle_speed_mps"));
    EXPECT_EQ(rows[1][2], "") << "no window there yet";
    const observe::FrontSample& sample = front[50];
    EXPECT_DOUBLE_EQ(std::stod(rows[51][0]), sample.chainage);
    EXPECT_NEAR(std::stod(rows[51][1]), sample.arrival_time, 1e-6);
    EXPECT_NEAR(std::stod(rows[51][2]), sample.front_velocity, 1e-6);
    EXPECT_NEAR(std::stod(rows[51][3]), sample.particle_speed, 1e-6);
}

TEST_F(Products, RunOutTableGivesAnglesInDegrees) {
    const auto rows = rows_of(test::read_text(folder_->path() / "run_out.csv"));
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_THAT(rows[0], ElementsAre("run_out_along_flow_m", "run_out_straight_m", "at_least", "toe_x_m", "toe_y_m",
                                     "drop_m", "runout_angle_deg", "travel_angle_deg", "front_chainage_m"));
    EXPECT_NEAR(std::tan(std::stod(rows[1][6]) * M_PI / 180), std::stod(rows[1][5]) / std::stod(rows[1][0]), 1e-6);
    EXPECT_EQ(rows[1][2], "no");
}

TEST_F(Products, BuildingTableUsesKilonewtonAndKilopascal) {
    const auto rows = rows_of(test::read_text(folder_->path() / "buildings.csv"));
    ASSERT_EQ(rows.size(), 6U);
    EXPECT_THAT(rows[0], ElementsAre("name", "hit", "first_hit_time_s", "peak_force_kN", "peak_impact_pressure_kPa",
                                     "peak_dynamic_pressure_kPa", "peak_depth_m", "filter_window_s", "patch_edge_m",
                                     "height_m", "height_assumed", "kind", "impulse_kNs", "failed_s", "overtopped_m3",
                                     "first_overtopped_s", "passed_m3", "held_m3", "peak_held_m3",
                                     "peak_filling_height_m", "removed_time_s", "peak_speed_mps", "intensity"));
    EXPECT_EQ(rows[1][0], "House 38");
    EXPECT_EQ(rows[1][1], "yes");
    EXPECT_EQ(rows[1][3], "412");
    EXPECT_EQ(rows[1][4], "38.4");
    EXPECT_EQ(rows[1][5], "61");
    EXPECT_EQ(rows[1][7], "0.2");
    EXPECT_EQ(rows[1][8], "1");
    EXPECT_EQ(rows[2][10], "yes");
    EXPECT_EQ(rows[1][20], "") << "it stands";
    EXPECT_EQ(rows[1].back(), "medium");
    EXPECT_EQ(rows[5][1], "no");
    EXPECT_EQ(rows[5][2], "") << "never hit: no time";
    EXPECT_EQ(rows[5].back(), "") << "never hit: no intensity";
}

TEST_F(Products, BarriersHaveTheirVolumesAndTheirHistory) {
    const TemporaryFolder folder;
    run::RunResult result = *result_;
    observe::BuildingImpact& dam = result.observation.buildings[0];
    dam.is_barrier = true;
    dam.impulse = 81000;
    dam.failure_time = 12.5;
    dam.overtopped_volume = 7.25;
    dam.history = {{11, 2000, 900, 0.75, 600, 3000, 1, 0.5, 40, 1.5}, {12, 5000, 1100, 1.5, 0, 7000, 7.25, 0.5, 44, 2}};
    ASSERT_TRUE(write_tables(*scene_, result, folder.path()).ok());
    const auto rows = rows_of(test::read_text(folder.path() / "buildings.csv"));
    EXPECT_EQ(rows[1][11], "barrier");
    EXPECT_EQ(rows[1][12], "81");
    EXPECT_EQ(rows[1][13], "12.5");
    EXPECT_EQ(rows[1][14], "7.25");
    EXPECT_EQ(rows[2][11], "building");
    EXPECT_EQ(rows[2][14], "") << "no barrier: nothing goes over it";
    EXPECT_EQ(
        test::read_text(folder.path() / "structures_over_time.csv"),
        "name,time_s,force_kN,impact_pressure_kPa,depth_m,dynamic_pressure_kPa,impulse_kNs,overtopped_m3,passed_m3,"
        "held_m3,filling_height_m\n"
        "House 38,11,2,0.9,0.75,0.6,3,1,0.5,40,1.5\nHouse 38,12,5,1.1,1.5,0,7,7.25,0.5,44,2\n");
    const std::string report = test::report_page(*scene_, result);
    EXPECT_THAT(report, HasSubstr("House 38 failed at 12.50 s"));
    EXPECT_THAT(report, HasSubstr("Force on structures over time."));
    EXPECT_THAT(report, HasSubstr("<h3>Barriers</h3>"));
    EXPECT_THAT(report, testing::Not(HasSubstr("What nets held and let through.")));
    dam.passing_share = 0.4;
    dam.hit = true;
    dam.held_volume = 44;
    dam.passed_volume = 8.75;
    ASSERT_TRUE(write_tables(*scene_, result, folder.path()).ok());
    EXPECT_EQ(rows_of(test::read_text(folder.path() / "buildings.csv"))[1][11], "net");
    const std::string of_net = test::report_page(*scene_, result);
    EXPECT_THAT(of_net, HasSubstr("What nets held and let through."));
    EXPECT_THAT(of_net, HasSubstr("its meshes let 40 % of the grains through"));
    EXPECT_THAT(of_net, HasSubstr("Of 60.0 m³ that came to it, 44.0 m³ lie behind it (73 %), 8.8 m³ went through"));
    const std::string without = test::report_page(*scene_, *result_);
    EXPECT_THAT(without, testing::Not(HasSubstr("Force on structures over time.")));
}

TEST_F(Products, NamesWithCommasAndQuotesAreQuoted) {
    const TemporaryFolder folder;
    run::RunResult result = *result_;
    result.observation.buildings[0].name = "Block \"A\", 沙田";
    ASSERT_TRUE(write_tables(*scene_, result, folder.path()).ok());
    EXPECT_THAT(test::read_text(folder.path() / "buildings.csv"), HasSubstr("\n\"Block \"\"A\"\", 沙田\",yes,"));
}

TEST_F(Products, TablesOfARunThatWasChangedOnTheWaySaySoInEveryRow) {
    const TemporaryFolder folder;
    run::RunResult result = *result_;
    result.observation.buildings[0].history = {{11, 2000, 900, 0.75, 600, 3000, 1, 0.5, 40, 1.5}};
    ASSERT_TRUE(write_tables(*scene_, result, folder.path(), "friction 0.4 -> 0.27 at 3.0 s, \"trial\"").ok());
    for (const char* name : {"front", "run_out", "buildings", "structures_over_time", "timeseries"}) {
        SCOPED_TRACE(name);
        const auto rows = rows_of(test::read_text(folder.path() / (std::string(name) + ".csv")));
        ASSERT_GE(rows.size(), 2U);
        EXPECT_EQ(rows[0].back(), "changed_on_the_way");
        for (std::size_t i = 1; i < rows.size(); ++i) EXPECT_THAT(rows[i].back(), HasSubstr("trial"));
    }
    ASSERT_TRUE(write_tables(*scene_, result, folder.path()).ok());
    EXPECT_THAT(test::read_text(folder.path() / "front.csv"), testing::Not(HasSubstr("changed")));
}

TEST_F(Products, TimeSeriesBalancesItsVolumes) {
    const auto rows = rows_of(test::read_text(folder_->path() / "timeseries.csv"));
    ASSERT_EQ(rows.size(), result_->observation.timeseries.size() + 1);
    ASSERT_EQ(rows[0][7], "volume_balance_m3");
    for (std::size_t i = 1; i < rows.size(); ++i) {
        ASSERT_EQ(rows[i].size(), rows[0].size());
        EXPECT_NEAR(std::stod(rows[i][7]), 0, 1e-9);
    }
    EXPECT_THAT(rows[0], testing::IsSupersetOf({"time_s", "front_chainage_m", "volume_moving_m3", "kinetic_energy_J",
                                                "steps_per_second"}));
}

TEST_F(Products, GeoPackageHoldsBuildingsReleasesPathAndMarks) {
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
}

TEST_F(Products, ManifestHoldsEveryParameterOfTheFieldTable) {
    const json parameters = manifest()["parameters"];
    int count = 0;
    for_each_value(scene_->spec, [&](const params::Section& section, std::size_t index,
                                     const params::Parameter& parameter, const params::ParameterValue& value) {
        const json& table = section.repeats ? parameters[section.name][index] : parameters[section.name];
        ASSERT_TRUE(table.contains(parameter.key)) << key_path(section, index, parameter);
        EXPECT_EQ(table[parameter.key].is_null(), std::holds_alternative<std::monostate>(value))
            << key_path(section, index, parameter);
        ++count;
    });
    EXPECT_GT(count, 40);
    EXPECT_EQ(parameters["material"]["rest_density_kgpm3"], 2000);
    EXPECT_EQ(parameters["release"][0]["volume_m3"], 600);
    EXPECT_EQ(parameters["observation"].size(), 2U);
}

TEST_F(Products, ManifestSaysWhatRanWhereAndHowFast) {
    const json m = manifest();
    EXPECT_EQ(m["program"], "talus");
    EXPECT_EQ(m["status"], "complete");
    EXPECT_EQ(m["partial"], false);
    EXPECT_EQ(m["reconstruction"], true);
    EXPECT_EQ(m["result_hash"], "8c1f00d2a4b39e57");
    EXPECT_EQ(m["inputs"][0]["fnv1a_64"], "9f1c22ab74d10e55");
    EXPECT_EQ(m["inputs"][0]["bytes"], 61234);
    EXPECT_THAT(m["versions"]["gdal"].get<std::string>(), StartsWith("3."));
    for (const char* key : {"talus", "proj", "tbb", "compiler"}) {
        EXPECT_THAT(m["versions"][key].get<std::string>(), Not(IsEmpty())) << key;
    }
    EXPECT_GT(m["hardware"]["logical_cores"], 0);
    EXPECT_GT(m["hardware"]["memory_GiB"], 0);
    EXPECT_NEAR(m["performance"]["real_time_factor"], 41.2 / result_->wall_time, 1e-9);
    double share = 0, step = 0;
    for (const json& stage : m["performance"]["stages"]) {
        share += stage["share"].get<double>();
        step += stage["per_step_ms"].get<double>();
    }
    EXPECT_NEAR(share, 1, 1e-9) << "with what is not in a stage";
    EXPECT_NEAR(step, m["performance"]["step_ms"], 1e-9);
    EXPECT_EQ(m["performance"]["stages"][2]["stage"], sim::step_stages[2].name);
    EXPECT_NEAR(m["performance"]["stages"][2]["total_s"], 1.5, 1e-9);
    EXPECT_NEAR(m["performance"]["stages"][2]["share"], 1.5 / result_->wall_time, 1e-9);
    EXPECT_EQ(m["resolved"]["particle_spacing_m"], 0.42);
    EXPECT_EQ(m["results"]["buildings_hit"], 3);
    EXPECT_NEAR(m["results"]["greatest"]["peak_pressure_kPa"],
                2 * std::pow(m["results"]["greatest"]["peak_speed_mps"].get<double>(), 2), 0.01);
    EXPECT_EQ(m["results"]["volumes"]["released_m3"], 600);
    EXPECT_EQ(m["assumptions"].size(), 3U);
    EXPECT_THAT(m["files"].get<std::vector<std::string>>(), testing::Contains("report.html"));
}

TEST_F(Products, ManifestWritesNullForWhatDoesNotExist) {
    const TemporaryFolder folder;
    run::RunResult result = *result_;
    result.observation.run_out = {};
    ASSERT_TRUE(write_manifest(*scene_, result, {}, folder.path()).ok());
    const json m = json::parse(test::read_text(folder.path() / "manifest.json"));
    EXPECT_TRUE(m["results"]["runout_angle_deg"].is_null());
}

TEST_F(Products, ManifestSurvivesNamesThatAreNotUtf8) {
    const TemporaryFolder folder;
    scene::Scene scene = *scene_;
    scene.releases[0].name = "Gr\xfcn";
    ASSERT_TRUE(write_manifest(scene, *result_, {}, folder.path()).ok());
    EXPECT_TRUE(json::accept(test::read_text(folder.path() / "manifest.json")));
}

TEST_F(Products, PartialResultSaysSoEverywhere) {
    const TemporaryFolder folder;
    run::RunResult result = *result_;
    result.status = run::RunStatus::fault;
    result.stop_reason = "at 12.5 s the mean compression is 0.61, above compression_limit 0.5";
    ASSERT_TRUE(write_products(*scene_, result, folder.path()).ok());
    EXPECT_THAT(test::read_text(folder.path() / "PARTIAL.txt"), HasSubstr(result.stop_reason));
    const json m = json::parse(test::read_text(folder.path() / "manifest.json"));
    EXPECT_EQ(m["partial"], true);
    EXPECT_EQ(m["status"], "fault");
    EXPECT_EQ(m["stop_reason"], result.stop_reason);
    const GDALDatasetUniquePtr data(GDALDataset::Open(folder.file("peak_depth.tif").c_str()));
    EXPECT_THAT(data->GetRasterBand(1)->GetDescription(), HasSubstr("partial result: fault"));
}

TEST_F(Products, RunWithoutDebrisPathOrBuildingsIsWrittenToo) {
    const TemporaryFolder folder;
    scene::Scene scene = *scene_;
    scene.buildings.clear();
    scene.flow_path = terrain::FlowPath();
    run::RunResult result = *result_;
    result.status = run::RunStatus::interrupted;
    const Grid<float> blank(GridGeometry{824100, 825500, 1, 4, 3}, std::nanf(""));
    result.observation = {};
    result.observation.maps = {blank, blank, blank, blank, blank};
    result.steps = 0;
    result.wall_time = 0;
    const Status status = write_products(scene, result, folder.path());
    ASSERT_TRUE(status.ok()) << status.error().message;
    EXPECT_TRUE(json::accept(test::read_text(folder.path() / "manifest.json")));
}

TEST_F(Products, FullDiskIsAnErrorThatNamesTheFile) {
    // In a child, since the limit on file sizes holds for the whole process.
    const TemporaryFolder folder;
    for (const rlim_t limit : {500, 2000, 20000}) {
        int ends[2];
        ASSERT_EQ(pipe(ends), 0);
        const pid_t child = fork();
        if (child == 0) {
            std::signal(SIGXFSZ, SIG_IGN);
            const rlimit size{limit, limit};
            setrlimit(RLIMIT_FSIZE, &size);
            const Status status = write_products(*scene_, *result_, folder.path());
            const std::string message = status.ok() ? "written" : status.error().message;
            _exit(write(ends[1], message.data(), message.size()) < 0 ? 1 : 0);
        }
        close(ends[1]);
        char buffer[4096];
        const ssize_t count = read(ends[0], buffer, sizeof buffer);
        close(ends[0]);
        waitpid(child, nullptr, 0);
        const std::string message(buffer, count > 0 ? static_cast<std::size_t>(count) : 0);
        EXPECT_THAT(message, StartsWith(folder.path().string() + "/")) << limit;
        EXPECT_THAT(message, HasSubstr("cannot be written")) << limit;
        EXPECT_FALSE(std::filesystem::exists(folder.path() / "manifest.json")) << limit;
    }
}

}  // namespace
}  // namespace talus::products
