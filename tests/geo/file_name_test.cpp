#include "geo/file_name.hpp"

#include <cpl_vsi.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geo/raster.hpp"
#include "geo/vector.hpp"
#include "geo/zip_archive.hpp"
#include "rasters.hpp"
#include "support/fixtures.hpp"

namespace talus::geo {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;

class FileName : public testing::Test {
  protected:
    std::string zip(const std::string& name, const std::vector<ZipEntry>& entries) const {
        const Status written = write_zip(file(name), entries);
        EXPECT_TRUE(written) << written.error().message;
        return file(name);
    }
    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
    [[nodiscard]] std::string terrain(const std::string& name) const {
        return test::write_raster(file(name), {}, pattern);
    }
    static std::string refusal(const std::string& name) {
        const auto raster = read_terrain_raster(name, 1, std::nullopt);
        return raster ? "accepted" : raster.error().message;
    }
    test::TemporaryFolder folder_;
};

TEST_F(FileName, a_layer_is_named_behind_a_bar) {
    const auto split = split_layer("maps/all.gpkg|layername=release 2024");
    ASSERT_TRUE(split);
    EXPECT_EQ(split->file, "maps/all.gpkg");
    EXPECT_EQ(split->layer, "release 2024");
    EXPECT_EQ(split_layer("dem.tif")->layer, "");
    EXPECT_THAT(split_layer("all.gpkg|layerid=1").error().message, HasSubstr("as in all.gpkg|layername=NAME"));
    EXPECT_FALSE(split_layer("all.gpkg|layername="));
    const std::string odd = terrain("a|b.tif");
    EXPECT_EQ(split_layer(odd)->file, odd) << "a file whose name holds a bar";
}

TEST_F(FileName, one_raster_in_an_archive_is_read) {
    const std::string archive =
        zip("dem.ZIP",
            {{"valley/dem.tif", terrain("a.tif")}, {"valley/dem.tif.ovr", terrain("o.tif")}, {"README", {}, "hi"}});
    EXPECT_EQ(refusal(archive), "accepted");
    EXPECT_EQ(refusal(archive + "/valley/dem.tif"), "accepted");
    EXPECT_EQ(file_on_disk(archive + "/valley/dem.tif"), archive);
    EXPECT_THAT(refusal(archive + "/dem.tif"), HasSubstr("there is no dem.tif in " + archive));
    EXPECT_THAT(refusal(zip("text.zip", {{"README", {}, "hi"}})), HasSubstr("there is no raster in this archive"));
}

TEST_F(FileName, of_several_in_an_archive_one_is_named) {
    const std::string archive = zip("dem.zip", {{"a.tif", terrain("a.tif")}, {"b.tif", terrain("b.tif")}});
    EXPECT_THAT(refusal(archive), AllOf(HasSubstr("holds 2 data sets; name one of them: "),
                                        HasSubstr(archive + "/a.tif, " + archive + "/b.tif")));
    EXPECT_EQ(refusal(archive + "/b.tif"), "accepted");
}

TEST_F(FileName, a_virtual_raster_in_an_archive_is_not_read) {
    const std::string vrt =
        "<VRTDataset rasterXSize=\"2\" rasterYSize=\"2\"><VRTRasterBand dataType=\"Byte\" band=\"1\"><SimpleSource>"
        "<SourceFilename>" +
        terrain("secret.tif") + "</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>";
    const std::string archive = zip("dem.zip", {{"dem.vrt", {}, vrt}});
    EXPECT_THAT(refusal(archive), HasSubstr("a file of the format VRT may name other files"));
    EXPECT_THAT(refusal(archive + "/dem.vrt"), HasSubstr("a file of the format VRT may name other files"));
}

TEST_F(FileName, a_shapefile_in_an_archive_is_one_data_set) {
    test::write_vector(file("scar.shp"), {.driver = "ESRI Shapefile", .type = wkbPolygon},
                       {{test::rectangle_wkt(824100, 825600, 824110, 825620)}});
    const std::string archive = zip("scar.zip", {{"scar.shp", file("scar.shp")},
                                                 {"scar.shx", file("scar.shx")},
                                                 {"scar.dbf", file("scar.dbf")},
                                                 {"scar.prj", file("scar.prj")}});
    const auto layer = read_polygons(archive, "", hong_kong());
    ASSERT_TRUE(layer) << layer.error().message;
    EXPECT_EQ(layer->features.size(), 1U);
}

TEST_F(FileName, a_compressed_raster_is_read_and_nothing_is_written_beside_it) {
    const std::string plain = test::read_text(terrain("dem.tif")), packed = file("dem.tif.gz");
    VSILFILE* out = VSIFOpenL(("/vsigzip/" + packed).c_str(), "wb");
    ASSERT_NE(out, nullptr);
    VSIFWriteL(plain.data(), 1, plain.size(), out);
    VSIFCloseL(out);
    std::filesystem::remove(file("dem.tif.gz.properties"));
    EXPECT_EQ(refusal(packed), "accepted");
    EXPECT_FALSE(std::filesystem::exists(file("dem.tif.gz.properties")));
}

TEST_F(FileName, a_raster_of_a_container_is_named_as_a_layer) {
    const std::string gpkg = file("all.gpkg");
    for (const char* table : {"surface", "ground"}) {
        const GDALDatasetUniquePtr from(GDALDataset::Open(terrain("a.tif").c_str(), GDAL_OF_RASTER));
        char** options = CSLAddString(nullptr, (std::string("RASTER_TABLE=") + table).c_str());
        options = CSLAddString(options, "APPEND_SUBDATASET=YES");
        const GDALDatasetUniquePtr made(GetGDALDriverManager()->GetDriverByName("GPKG")->CreateCopy(
            gpkg.c_str(), from.get(), FALSE, options, nullptr, nullptr));
        CSLDestroy(options);
        ASSERT_NE(made, nullptr);
    }
    EXPECT_THAT(refusal(gpkg), AllOf(HasSubstr("name one of them as " + gpkg + "|layername=NAME: "),
                                     HasSubstr("surface"), HasSubstr("ground")));
    EXPECT_EQ(refusal(gpkg + "|layername=ground"), "accepted");
    EXPECT_THAT(refusal(gpkg + "|layername=trees"), HasSubstr("has no raster \"trees\"; its rasters: "));
    EXPECT_EQ(file_on_disk(gpkg + "|layername=ground"), gpkg);
}

TEST_F(FileName, a_raster_that_is_alone_may_be_named) {
    const std::string alone = terrain("dem.tif");
    EXPECT_EQ(refusal(alone + "|layername=dem"), "accepted");
    EXPECT_THAT(refusal(alone + "|layername=dtm"), EndsWith("has no raster \"dtm\"; it holds one, \"dem\""));
}

}  // namespace
}  // namespace talus::geo
