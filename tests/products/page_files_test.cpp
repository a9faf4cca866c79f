#include "products/page_files.hpp"

#include <array>
#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "products/products_fixture.hpp"
#include "products/text_file.hpp"

namespace talus::products {
namespace {

using PageFiles = Products;

TEST_F(PageFiles, tables_are_those_of_the_folder) {
    const auto tables = tables_of(*result_, "");
    ASSERT_GE(tables.size(), 5U);
    for (const PageFile& table : tables) {
        EXPECT_EQ(table.bytes(*scene_, *result_), test::read_text(folder_->path() / table.name)) << table.name;
        EXPECT_FALSE(table.what.empty());
    }
}

/// Values, place and what the band says of itself, as GDAL reads them.
struct Read {
    std::array<double, 6> transform{};
    std::vector<float> values;
    std::string title, description, unit, result_hash, epsg;
};

Read read_map(const std::string& file) {
    GDALAllRegister();
    const GDALDatasetUniquePtr data(GDALDataset::Open(file.c_str()));
    Read read;
    EXPECT_TRUE(data) << file;
    if (!data) return read;
    data->GetGeoTransform(read.transform.data());
    GDALRasterBand& band = *data->GetRasterBand(1);
    const int columns = band.GetXSize(), rows = band.GetYSize();
    read.values.resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    EXPECT_EQ(band.RasterIO(GF_Read, 0, 0, columns, rows, read.values.data(), columns, rows, GDT_Float32, 0, 0),
              CE_None);
    EXPECT_EQ(band.GetNoDataValue(), -9999);
    read.description = band.GetDescription();
    read.unit = band.GetUnitType();
    if (const char* title = data->GetMetadataItem("TITLE"); title != nullptr) read.title = title;
    if (const char* hash = data->GetMetadataItem("RESULT_HASH"); hash != nullptr) read.result_hash = hash;
    const OGRSpatialReference* reference = data->GetSpatialRef();
    const char* code = reference != nullptr ? reference->GetAuthorityCode(nullptr) : nullptr;
    read.epsg = code != nullptr ? code : "";
    return read;
}

TEST_F(PageFiles, maps_are_those_of_the_folder) {
    scene::Scene scene = *scene_;
    scene.spec.outputs.peak_thickness = true;
    scene.spec.scene.title = "Fan A & B <c> \"d\" 'e' &amp; ü";
    const test::TemporaryFolder own, theirs;
    const Status written = write_products(scene, *result_, theirs.path());
    ASSERT_TRUE(written.ok()) << written.error().message;
    std::set<std::string> expected, names;
    for (const auto& entry : std::filesystem::directory_iterator(theirs.path())) {
        const std::string name = entry.path().filename().string();
        if (entry.path().extension() == ".tif" && name != "terrain.tif") expected.insert(name);
    }
    for (const PageFile& map : plain_maps_of(scene, *result_)) {
        names.insert(map.name);
        const std::string file = own.file(map.name);
        ASSERT_TRUE(write_text_file(file, map.bytes(scene, *result_)).ok());
        const Read here = read_map(file), there = read_map(theirs.file(map.name));
        EXPECT_EQ(here.title, there.title);
        EXPECT_EQ(there.title, scene.spec.scene.title);
        EXPECT_EQ(here.transform, there.transform) << map.name;
        ASSERT_EQ(here.values.size(), there.values.size()) << map.name;
        EXPECT_EQ(here.values, there.values) << map.name;
        EXPECT_EQ(here.description, there.description);
        EXPECT_EQ(here.unit, there.unit) << map.name;
        EXPECT_EQ(here.result_hash, there.result_hash);
        EXPECT_EQ(here.epsg, there.epsg);
        EXPECT_FALSE(there.result_hash.empty());
    }
    EXPECT_EQ(names, expected);
}

TEST(PlainGeotiff, of_a_local_system_says_none) {
    Grid<float> grid({10, 20, 0.5, 3, 2});
    for (std::size_t k = 0; k < grid.values.size(); ++k) grid.values[k] = static_cast<float>(k);
    const test::TemporaryFolder folder;
    ASSERT_TRUE(write_text_file(folder.file("local.tif"), plain_geotiff(grid, 0, "")).ok());
    const Read read = read_map(folder.file("local.tif"));
    EXPECT_EQ(read.epsg, "");
    EXPECT_THAT(read.values, testing::ElementsAre(3, 4, 5, 0, 1, 2)) << "from the north";
    EXPECT_THAT(read.transform, testing::ElementsAre(10, 0.5, 0, 21, 0, -0.5));
}

}  // namespace
}  // namespace talus::products
