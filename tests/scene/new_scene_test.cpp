#include "scene/new_scene.hpp"

#include <cmath>
#include <iterator>
#include <numbers>

#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include "geo/vector.hpp"
#include "geo/zip_archive.hpp"
#include "scene/check.hpp"
#include "scene/reach.hpp"
#include "scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

class NewSceneTest : public SceneFolder {
  protected:
    NewSceneTest() {
        write_valley();
        write_features("release.geojson", {rectangle(20, 90, 40, 110, "\"thickness_m\": 2")});
        options.dem = path("dem.tif");
        options.release = path("release.geojson");
        options.folder = folder / "new" / "valley";
    }
    [[nodiscard]] NewScene made() const { return test::value_of(write_new_scene(options)); }
    [[nodiscard]] std::string refusal() const {
        const auto scene = write_new_scene(options);
        EXPECT_FALSE(scene);
        EXPECT_FALSE(std::filesystem::exists(options.folder)) << "nothing may be left behind";
        return scene ? "" : scene.error().message;
    }
    static Scene loaded(const std::filesystem::path& file) { return test::value_of(load_scene(file)); }
    [[nodiscard]] static std::string text_of(const std::filesystem::path& file) {
        std::ifstream in(file);
        return {std::istreambuf_iterator<char>(in), {}};
    }

    NewSceneOptions options;
};

TEST_F(NewSceneTest, loads_and_names_its_inputs_relative_to_itself) {
    options.volume = 600;
    options.target_particle_count = 5000;
    const NewScene made_scene = made();
    EXPECT_EQ(made_scene.file, options.folder / "scene.toml");
    const std::string text = text_of(made_scene.file);
    EXPECT_THAT(text, HasSubstr("\nfile = \"../../dem.tif\"\n"));
    EXPECT_THAT(text, HasSubstr("\ntarget_particle_count = 5000\n"));
    EXPECT_THAT(text, HasSubstr("\n# friction_coefficient = 0.4\n"));
    const Scene scene = loaded(made_scene.file);
    EXPECT_NEAR(scene.releases.at(0).volume, 600, 0.1);
    EXPECT_EQ(scene.spec.scene.title, "valley");
}

TEST_F(NewSceneTest, works_from_relative_names) {
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(folder);
    options.dem = "dem.tif";
    options.release = "release.geojson";
    options.folder = "deep/er/valley";
    const auto scene = write_new_scene(options);
    std::filesystem::current_path(before);
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_THAT(text_of(folder / scene->file), HasSubstr("\nfile = \"../../../dem.tif\"\n"));
    EXPECT_EQ(loaded(folder / scene->file).releases.size(), 1U);
}

TEST_F(NewSceneTest, no_thickness_is_assumed) {
    write_features("release.geojson", {rectangle(20, 90, 40, 110, "\"depth\": 2")});
    EXPECT_THAT(refusal(), AllOf(HasSubstr("(--thickness-m M), or its volume (--volume-m3 M3)"),
                                 HasSubstr("thickness_m or thickness"), HasSubstr("it has depth")));
}

TEST_F(NewSceneTest, takes_thickness_height_and_name_from_their_attributes) {
    write_features("release.geojson", {rectangle(20, 90, 40, 110, "\"thickness_m\": 1.5")});
    write_features("houses.geojson", {rectangle(200, 90, 210, 100, "\"height_m\": 9, \"name\": \"House 38\"")});
    options.buildings = path("houses.geojson");
    const Scene scene = loaded(made().file);
    EXPECT_EQ(scene.releases.at(0).patches.at(0).thickness, 1.5);
    EXPECT_EQ(scene.buildings.at(0).name, "House 38");
    EXPECT_EQ(scene.buildings.at(0).height, 9);
    EXPECT_TRUE(scene.spec.scene.assumptions.empty());
}

TEST_F(NewSceneTest, finds_attributes_in_any_case) {
    write_features("release.geojson", {rectangle(20, 90, 40, 110, "\"THICKNESS\": 0.8")});
    write_features("houses.geojson", {rectangle(200, 90, 210, 100, "\"Height\": 11, \"NAME\": \"Hut\"")});
    options.buildings = path("houses.geojson");
    const Scene scene = loaded(made().file);
    EXPECT_EQ(scene.releases.at(0).patches.at(0).thickness, 0.8);
    EXPECT_EQ(scene.buildings.at(0).name, "Hut");
    EXPECT_EQ(scene.buildings.at(0).height, 11);
}

TEST_F(NewSceneTest, names_the_columns_where_heights_are_assumed) {
    write_features("houses.geojson", {rectangle(200, 90, 210, 100, "\"storeys\": 2")});
    options.buildings = path("houses.geojson");
    EXPECT_THAT(made().notes, Contains(AllOf(HasSubstr("no attribute height_m or height (it has storeys)"),
                                             HasSubstr("6 m high (buildings.default_height_m)"))));
}

TEST_F(NewSceneTest, takes_a_layer_behind_the_name_or_of_the_option) {
    const geo::Crs crs{"", "", 2326};
    const auto layer = [&](const char* name, double x) {
        geo::OutputFeature feature;
        feature.polygon.push_back(
            {{{west + x, south + 90}, {west + x + 20, south + 90}, {west + x + 20, south + 110}}, {}});
        feature.values.emplace_back(1.5);
        ASSERT_TRUE(geo::write_geopackage_layer(path("maps.gpkg"), name, {{"thickness_m", false}}, {feature}, crs));
    };
    layer("release 2024", 20);
    layer("houses", 200);
    options.release = path("maps.gpkg");
    EXPECT_THAT(refusal(), HasSubstr("maps.gpkg|layername=NAME"));
    options.release_layer = "release 2023";
    EXPECT_THAT(refusal(), HasSubstr("has no layer \"release 2023\""));
    options.release_layer = "release 2024";
    options.buildings = path("maps.gpkg|layername=houses");
    const Scene scene = loaded(made().file);
    EXPECT_EQ(scene.spec.releases.at(0).layer, "release 2024");
    EXPECT_EQ(scene.spec.buildings.layer, "houses");
    EXPECT_EQ(scene.buildings.size(), 1U);
    options.folder = folder / "again";
    options.release = path("maps.gpkg|layername=houses");
    EXPECT_THAT(refusal(), HasSubstr("names the layer \"houses\", and the option \"release 2024\""));
}

TEST_F(NewSceneTest, takes_one_feature_of_several) {
    write_features("release.geojson", {rectangle(20, 90, 40, 110, "\"Name\": \"upper\", \"thickness_m\": 2"),
                                       rectangle(60, 90, 90, 110, "\"Name\": \"lower\", \"thickness_m\": 1")});
    options.release_feature = "name=middle";
    EXPECT_THAT(refusal(), HasSubstr("has no feature with name=middle; the values there are: upper, lower"));
    options.release_feature = "7";
    EXPECT_THAT(refusal(), HasSubstr("has no feature 7; it must be the number that GIS programs show (fid: 0, 1)"));
    options.release_feature = "name=lower";
    const Scene scene = loaded(made().file);
    ASSERT_EQ(scene.releases.at(0).patches.size(), 1U);
    EXPECT_EQ(scene.releases.at(0).patches.at(0).thickness, 1);
    EXPECT_EQ(plan_area(scene.releases.at(0).patches.at(0).polygon), 600);
    EXPECT_EQ(scene.spec.releases.at(0).file, (options.folder / "release.gpkg").string());
}

TEST_F(NewSceneTest, takes_the_extent_and_coarser_cells) {
    options.extent = Extent{west + 10, south + 50, west + 200, south + 150};
    options.cell = 10;
    const NewScene coarse = made();
    const Scene scene = loaded(coarse.file);
    EXPECT_EQ(scene.terrain.elevation().geometry, (GridGeometry{west + 10, south + 50, 10, 19, 10}));
    EXPECT_EQ(scene.spec.terrain.file, (options.folder / "terrain.tif").string());
    EXPECT_FALSE(scene.spec.terrain.extent);
    EXPECT_NEAR(scene.terrain.elevation().at(5, 5), valley(west + 65, south + 105), 0.6);
    options.folder = folder / "again";
    options.cell.reset();
    EXPECT_EQ(loaded(made().file).terrain.elevation().geometry, (GridGeometry{west + 10, south + 50, 5, 38, 20}));
}

TEST_F(NewSceneTest, refuses_an_extent_or_cells_that_cannot_be) {
    options.extent = Extent{west + 200, south, west, south + 100};
    EXPECT_THAT(refusal(), HasSubstr("it must be XMIN YMIN XMAX YMAX"));
    options.extent = Extent{west + 100, south, west + 300, south + 200};
    EXPECT_THAT(refusal(), HasSubstr("release \"release\" lies outside the terrain"));
    options.extent.reset();
    options.cell = 2;
    EXPECT_THAT(refusal(), HasSubstr("has cells of 5 m, and it must be a multiple of that"));
    options.cell = 12;
    EXPECT_THAT(refusal(), HasSubstr("whole multiple of 5 m, the cells of " + path("dem.tif") + ": 10 or 15"));
}

TEST_F(NewSceneTest, of_a_large_raster_only_what_debris_can_reach_is_read) {
    // 300 million cells over 100 km x 75 km that hold nothing; the ground of the valley lies in one block.
    char** sparse = CSLAddString(CSLAddString(nullptr, "SPARSE_OK=TRUE"), "TILED=YES");
    GDALAllRegister();
    {
        const GDALDatasetUniquePtr data(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
            path("large.tif").c_str(), 20000, 15000, 1, GDT_Float32, sparse));
        double transform[6] = {west - 50000, cell, 0, south + 37500, 0, -cell};
        data->SetGeoTransform(transform);
        OGRSpatialReference reference;
        reference.importFromEPSG(2326);
        data->SetSpatialRef(&reference);
        data->GetRasterBand(1)->SetNoDataValue(-9999);
        std::vector<float> ground;
        for (int line = 0; line < rows; ++line) {
            for (int column = 0; column < columns; ++column) {
                ground.push_back(
                    static_cast<float>(valley(west + (column + 0.5) * cell, south + (rows - line - 0.5) * cell)));
            }
        }
        ASSERT_EQ(data->GetRasterBand(1)->RasterIO(GF_Write, 10000, 7500 - rows, columns, rows, ground.data(), columns,
                                                   rows, GDT_Float32, 0, 0, nullptr),
                  CE_None);
    }
    CSLDestroy(sparse);
    const Extent small = *loaded(made().file).spec.terrain.extent;
    options.folder = folder / "large";
    options.dem = path("large.tif");
    const Extent large = *loaded(made().file).spec.terrain.extent;
    EXPECT_LE(large.x_min, small.x_min);
    EXPECT_GE(large.x_max, small.x_max);
    EXPECT_LT(large.width(), 2000);
}

TEST_F(NewSceneTest, reads_archives_and_names_them_in_the_scene) {
    ASSERT_TRUE(geo::write_zip(path("dem.zip"), {{"valley.tif", path("dem.tif"), {}}}));
    ASSERT_TRUE(geo::write_zip(path("scar.zip"), {{"scar.geojson", path("release.geojson"), {}}}));
    options.dem = path("dem.zip");
    options.release = path("scar.zip");
    const NewScene packed = made();
    EXPECT_THAT(text_of(packed.file),
                AllOf(HasSubstr("\nfile = \"../../dem.zip\"\n"), HasSubstr("\nname = \"scar\"\n")));
    EXPECT_EQ(loaded(packed.file).releases.size(), 1U);
    options.folder = folder / "again";
    options.dem = path("dem.zip/valley.tif");
    const NewScene named = made();
    EXPECT_THAT(text_of(named.file), HasSubstr("\nfile = \"../dem.zip/valley.tif\"\n"));
    const Scene scene = loaded(named.file);
    EXPECT_THAT(scene.inputs, Contains(testing::Field(&InputFile::path, path("dem.zip"))));
}

TEST_F(NewSceneTest, the_extent_leaves_out_what_debris_cannot_reach) {
    // Ground that climbs away from the release on both sides, and level ground 100 m down the way.
    write_terrain("dem.tif", [](double x, double y) {
        return 100 + 1.5 * std::abs(y - (south + 100)) - 0.1 * std::min(x - west, 100.0);
    });
    const Scene scene = loaded(made().file);
    const Extent extent = scene.terrain.elevation().geometry.extent();
    EXPECT_TRUE(extent.contains({west + 20, south + 90}) && extent.contains({west + 40, south + 110}));
    EXPECT_LT(extent.x_max, west + columns * cell);
    EXPECT_GT(extent.x_max, west + 100);
    EXPECT_EQ(std::fmod(extent.x_min - west, cell), 0);
}

TEST_F(NewSceneTest, refuses_a_folder_that_is_there) {
    std::filesystem::create_directories(options.folder);
    write("new/valley/mine.txt", "keep");
    const auto scene = write_new_scene(options);
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().message, HasSubstr("is already there"));
    EXPECT_TRUE(std::filesystem::exists(options.folder / "mine.txt"));
}

TEST_F(NewSceneTest, bad_inputs_leave_nothing_behind) {
    options.dem = path("absent.tif");
    EXPECT_THAT(refusal(), HasSubstr("absent.tif"));
    options.dem = path("dem.tif");
    options.thickness = -1;
    EXPECT_THAT(refusal(), HasSubstr("thickness -1 is refused; it must be a number from 0.001 to 1000 (m)"));
    options.thickness = 1;
    options.volume = 3;
    EXPECT_THAT(refusal(), HasSubstr("give one of them"));
    options.volume.reset();
    options.buildings = path("absent.geojson");
    EXPECT_THAT(refusal(), AllOf(HasSubstr("buildings.file"), HasSubstr("absent.geojson")));
    options.buildings.clear();
    write_features("release.geojson", {rectangle(900, 90, 940, 110)});
    EXPECT_THAT(refusal(), HasSubstr("lies outside the terrain"));
}

TEST_F(NewSceneTest, a_folder_that_cannot_be_made_is_named) {
    write("file", "");
    options.folder = folder / "file" / "valley";
    const auto scene = write_new_scene(options);
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().message, AllOf(HasSubstr("valley"), HasSubstr("cannot be made")));
}

TEST(ReachableExtent, follows_the_energy_line_over_a_level_plain) {
    // A step of 20 m down to a plain: at 45 degrees debris gets 20 m plus its thickness of 1 m away from the edge.
    Grid<float> elevation(GridGeometry{0, 0, 1, 100, 21});
    for (int row = 0; row < 21; ++row) {
        for (int column = 0; column < 100; ++column) elevation.at(column, row) = column < 10 ? 20.0F : 0.0F;
    }
    terrain::Release release;
    release.patches.push_back({{{{5, 5}, {10, 5}, {10, 16}, {5, 16}}, {}}, 1});
    const Extent reach = reachable_extent(terrain::Terrain(elevation), {release}, std::numbers::pi / 4);
    EXPECT_NEAR(reach.x_max, 10 + 20 + 1, 1.01);
    EXPECT_NEAR(reach.x_min, 5 - 1, 1.01);
}

TEST(ReachableExtent, nodata_is_not_crossed) {
    Grid<float> elevation(GridGeometry{0, 0, 1, 100, 5});
    for (int row = 0; row < 5; ++row) {
        for (int column = 0; column < 100; ++column) elevation.at(column, row) = static_cast<float>(100 - column);
        elevation.at(50, row) = std::numeric_limits<float>::quiet_NaN();
    }
    terrain::Release release;
    release.patches.push_back({{{{5, 1}, {10, 1}, {10, 4}, {5, 4}}, {}}, 1});
    EXPECT_EQ(reachable_extent(terrain::Terrain(elevation), {release}, 0.2).x_max, 50);
}

class DescribeScene : public SceneFolder {};

TEST_F(DescribeScene, tells_what_a_run_would_take) {
    write_valley("[buildings]\nfile = \"houses.geojson\"\n", "volume_m3 = 512");
    write_features("houses.geojson", {rectangle(200, 90, 210, 100)});
    const Scene scene = loaded({"solver.particle_spacing_m=0.8"});
    const std::string text = describe_scene(scene);
    EXPECT_THAT(text, HasSubstr("60 x 40 cells of 5 m, EPSG:2326 (Hong Kong 1980 Grid System)"));
    EXPECT_THAT(text, HasSubstr("\"scarp\": 512 m3, 400 m2 in plan, mean thickness 1.1"));
    EXPECT_THAT(text, HasSubstr("about 1000 with a spacing of 0.8 m (solver.particle_spacing_m)"));
    EXPECT_THAT(text, HasSubstr("map cell    "));
    EXPECT_THAT(text, HasSubstr("buildings   1, 1 with an assumed height"));
    EXPECT_THAT(text, HasSubstr("traced downhill from the release"));
    for (const std::string& note : scene.notes) EXPECT_THAT(text, HasSubstr("  - " + note + "\n"));
}

}  // namespace
}  // namespace talus::scene
