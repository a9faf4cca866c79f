// What untrusted files say, and what nothing opens for them.
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>

#include <cpl_string.h>
#include <gmock/gmock.h>

#include "core/isolation.hpp"
#include "geo/mesh.hpp"
#include "geo/raster.hpp"
#include "geo/vector.hpp"
#include "support/fixtures.hpp"
#include "support/foreign.hpp"
#include "support/witness.hpp"

namespace talus::geo {
namespace {

namespace fs = std::filesystem;
using test::foreign_reader;
using test::RasterOptions;
using testing::HasSubstr;
using testing::IsEmpty;

/// Every test reads as on this kernel, and as on one that has neither Landlock nor seccomp.
class Foreign : public testing::TestWithParam<bool> {
  protected:
    void SetUp() override {
        GDALAllRegister();
        if (GetParam() && !available_isolation().complete()) GTEST_SKIP() << "this kernel lacks Landlock or seccomp";
        fs::create_directories(in());
        fs::create_directories(folder_.path() / "out");
        fs::create_directories(folder_.path() / "secret");
    }
    [[nodiscard]] fs::path in() const { return folder_.path() / "in"; }
    [[nodiscard]] std::string input(const std::string& name) const { return (in() / name).string(); }
    [[nodiscard]] std::string secret(const std::string& name) const {
        return (folder_.path() / "secret" / name).string();
    }
    static ForeignWanted any() {
        ForeignWanted wanted;
        wanted.raster = wanted.vector = wanted.mesh = true;
        wanted.purpose = "is nothing that is known";
        return wanted;
    }
    [[nodiscard]] Result<ForeignFile> convert(const std::string& file, const ForeignWanted& wanted) const {
        ForeignReader reader = reader_;
        reader.isolated = GetParam();
        return convert_foreign(file, wanted, folder_.path() / "out/again", reader);
    }
    /// Converts a file of somebody who means harm; whatever comes of it, nothing else is opened, and nothing remains of
    /// what is refused. The sentence; empty: it was taken.
    std::string hostile(const std::string& name, ForeignWanted wanted = any()) {
        fs::remove_all(folder_.path() / "out");
        fs::create_directories(folder_.path() / "out");
        const test::Witness witness(folder_.file("log"));
        const auto made = convert(input(name), wanted);
        EXPECT_THAT(witness.elsewhere({in().string(), (folder_.path() / "out").string()}), IsEmpty()) << name;
        EXPECT_THAT(witness.lines(), testing::Contains("open " + input(name))) << "the witness sees the child";
        if (made) return "";
        EXPECT_TRUE(fs::is_empty(folder_.path() / "out")) << "something remains";
        EXPECT_THAT(made.error().message, testing::Not(HasSubstr("\n")));
        return made.error().message;
    }
    /// A file of tests/foreign with a path in it put in place of the one that it has.
    void copy_with_path(const std::string& name, const std::string& path) const {
        const std::string original = "/talus-secret";
        std::string bytes = test::read_text(fs::path(TALUS_SOURCE_DIR) / "tests/foreign" / name);
        const std::size_t end = bytes.find(original) + original.size();
        ASSERT_LT(end, bytes.size());
        ASSERT_LT(path.size(), 150U);
        bytes.replace(end - path.size(), path.size(), path);  // slashes before it mean nothing
        test::write_text(input(name), bytes);
    }

    test::TemporaryFolder folder_;
    ForeignReader reader_ = foreign_reader();
};

INSTANTIATE_TEST_SUITE_P(Kernel, Foreign, testing::Values(true, false),
                         [](const auto& given) { return given.param ? "that_isolates" : "that_does_not"; });

TEST_P(Foreign, a_raster_is_the_same_written_again) {
    RasterOptions options;
    options.declare_nodata = true;
    options.nodata = -9999;
    options.unit = "m";
    options.bands = 2;
    const std::string file = write_raster(input("dem.tif"), options, [](int column, int row) {
        return column == 3 && row == 4 ? -9999 : 100 + 0.123456789 * column + row;
    });
    ForeignWanted wanted = any();
    wanted.bands = 2;
    const auto made = convert(file, wanted);
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_EQ(made->kind, FileKind::raster);
    for (const int band : {1, 2}) {
        const auto before = read_terrain_raster(file, band, {}), after = read_terrain_raster(made->file, band, {});
        ASSERT_TRUE(before && after);
        EXPECT_EQ(before->crs.label(), after->crs.label());
        EXPECT_EQ(before->vertical_unit, after->vertical_unit);
        EXPECT_EQ(before->nodata_share, after->nodata_share);
        ASSERT_EQ(before->grid.values.size(), after->grid.values.size());
        for (std::size_t k = 0; k < before->grid.values.size(); ++k) {
            EXPECT_TRUE(before->grid.values[k] == after->grid.values[k] || std::isnan(after->grid.values[k]));
        }
        EXPECT_EQ(before->grid.geometry.x_min, after->grid.geometry.x_min);
    }
}

TEST_P(Foreign, polygons_with_their_attributes_are_the_same_in_every_format) {
    for (const auto& [driver, name] : {std::pair{"GPKG", "a.gpkg"},
                                       {"GeoJSON", "a.geojson"},
                                       {"ESRI Shapefile", "a.shp"},
                                       {"FlatGeobuf", "a.fgb"}}) {
        test::VectorOptions options;
        options.driver = driver;
        options.layer = "houses";
        options.epsg = std::string(driver) == "GeoJSON" ? 4326 : 2326;
        options.fields = {{"name", OFTString}, {"height", OFTReal}};
        const double x = options.epsg == 4326 ? 114.06 : 824000, y = options.epsg == 4326 ? 22.36 : 825000;
        const double size = options.epsg == 4326 ? 1e-4 : 10;
        const std::string file =
            write_vector(input(name), options,
                         {{test::rectangle_wkt(x, y, x + size, y + size), {"one", "3.25"}},
                          {test::rectangle_wkt(x + size, y, x + 2 * size, y + size), {"two", ""}}});
        const auto made = convert(file, any());
        ASSERT_TRUE(made) << made.error().message;
        EXPECT_EQ(made->kind, FileKind::vector);
        const Crs terrain = *crs_from_text("EPSG:2326");
        const auto before = read_polygons(file, "", terrain), after = read_polygons(made->file, "", terrain);
        ASSERT_TRUE(before) << before.error().message;
        ASSERT_TRUE(after) << after.error().message;
        EXPECT_EQ(before->reprojection, after->reprojection);
        ASSERT_EQ(before->features.size(), after->features.size());
        for (std::size_t k = 0; k < before->features.size(); ++k) {
            EXPECT_EQ(before->features[k].attributes, after->features[k].attributes) << name;
            const Ring &ring = before->features[k].parts[0].outer, &again = after->features[k].parts[0].outer;
            ASSERT_EQ(ring.size(), again.size());
            for (std::size_t p = 0; p < ring.size(); ++p) {
                EXPECT_EQ(ring[p].x, again[p].x);
                EXPECT_EQ(ring[p].y, again[p].y);
            }
        }
    }
}

TEST_P(Foreign, a_mesh_is_kept_as_arrays) {
    const fs::path corpus = fs::path(TALUS_SOURCE_DIR) / "tests/fuzz/corpus";
    for (const auto& [from, name] : {std::pair{"obj/box.obj", "a.obj"},
                                     {"gltf/box.gltf", "a.gltf"},
                                     {"glb/box.glb", "a.glb"},
                                     {"city_json/house.city.json", "a.city.json"}}) {
        fs::copy_file(corpus / from, input(name));
        const auto made = convert(input(name), any());
        ASSERT_TRUE(made) << made.error().message;
        EXPECT_TRUE(made->file.string().ends_with(".roofs.json"));
        std::vector<std::string> ignored;
        const auto before = read_mesh_buildings(input(name), {}, ignored);
        const auto after = read_mesh_buildings(made->file, {}, ignored);
        ASSERT_TRUE(before) << before.error().message;
        ASSERT_TRUE(after) << after.error().message;
        ASSERT_EQ(before->size(), after->size());
        for (std::size_t k = 0; k < before->size(); ++k) {
            EXPECT_EQ((*before)[k].name, (*after)[k].name);
            EXPECT_EQ((*before)[k].attributes, (*after)[k].attributes);
            ASSERT_EQ((*before)[k].roofs.size(), (*after)[k].roofs.size());
            for (std::size_t r = 0; r < (*before)[k].roofs.size(); ++r) {
                EXPECT_EQ((*before)[k].roofs[r].elevation, (*after)[k].roofs[r].elevation);
                EXPECT_EQ((*before)[k].roofs[r].outline.outer.size(), (*after)[k].roofs[r].outline.outer.size());
            }
        }
    }
}

TEST_P(Foreign, hdf5_that_keeps_its_data_in_another_file_shows_nothing_of_it) {
    test::write_text(secret("heights"), std::string(1200, 'A'));
    fs::copy_file(fs::path(TALUS_SOURCE_DIR) / "tests/foreign/secret.h5", secret("heights.h5"));
    copy_with_path("external_storage.h5", secret("heights"));
    copy_with_path("external_link.h5", secret("heights.h5"));
    copy_with_path("virtual.h5", secret("heights.h5"));
    for (const char* name : {"external_storage.h5", "external_link.h5", "virtual.h5"}) {
        const std::string said = hostile(name);
        if (!GetParam()) {
            EXPECT_THAT(said, HasSubstr("is not read where the kernel lacks Landlock")) << name;
        }
        // The same as netCDF would have it.
        const std::string other = fs::path(name).stem().string() + ".nc";
        fs::copy_file(input(name), input(other));
        (void)hostile(other);
    }
}

TEST_P(Foreign, a_text_that_looks_like_two_formats_is_opened_as_one) {
    test::write_text(secret("a.csv"), "x,y\n1,2\n");
    for (const std::string& source : {secret("a.csv"), std::string("/vsicurl/http://127.0.0.1:9/a.csv"),
                                      std::string("http://127.0.0.1:9/a.geojson")}) {
        test::write_text(input("dem.asc"),
                         "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 5\n<OGRVRTDataSource><OGRVRTLayer "
                         "name=\"a\"><SrcDataSource>" +
                             source + "</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>\n1 2\n3 4\n");
        // As a raster, which it is; as anything else it is refused.
        EXPECT_EQ(hostile("dem.asc"), "");
        ForeignWanted layer;
        layer.vector = true;
        layer.purpose = "is no layer";
        EXPECT_THAT(hostile("dem.asc", layer), HasSubstr("is no layer"));
        test::write_text(input("a.vrt"), "<OGRVRTDataSource><OGRVRTLayer name=\"a\"><SrcDataSource>" + source +
                                             "</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>");
        EXPECT_THAT(hostile("a.vrt"), HasSubstr("may name other files"));
    }
}

TEST_P(Foreign, overviews_masks_and_metadata_beside_a_raster_lead_nowhere) {
    test::write_plane(secret("other.tif"));
    test::write_plane(input("dem.tif"));
    for (const std::string& other : {secret("other.tif"), std::string("/vsicurl/http://127.0.0.1:9/other.tif")}) {
        {
            const GDALDatasetUniquePtr data(GDALDataset::Open(input("dem.tif").c_str(), GDAL_OF_UPDATE));
            data->SetMetadataItem("OVERVIEW_FILE", other.c_str(), "OVERVIEWS");
        }
        const std::string xml = "<PAMDataset><Metadata domain=\"OVERVIEWS\"><MDI key=\"OVERVIEW_FILE\">" + other +
                                "</MDI></Metadata></PAMDataset>";
        test::write_text(input("dem.tif.aux.xml"), xml);
        const std::string vrt =
            "<VRTDataset rasterXSize=\"20\" rasterYSize=\"15\"><VRTRasterBand dataType=\"Byte\" "
            "band=\"1\"><SimpleSource><SourceFilename>" +
            other + "</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>";
        test::write_text(input("dem.tif.ovr"), vrt);
        test::write_text(input("dem.tif.msk"), vrt);
        EXPECT_EQ(hostile("dem.tif"), "") << "it is taken, without them";
        ForeignWanted photo;
        photo.picture = true;
        photo.cells = 100;
        EXPECT_THAT(hostile("dem.tif", photo), HasSubstr("20 x 15 cells, at most"));
    }
}

TEST_P(Foreign, a_reference_system_that_names_a_grid_is_refused) {
    test::write_text(secret("grid.gsb"), "x");
    RasterOptions options;
    options.wkt =
        "BOUNDCRS[SOURCECRS[PROJCRS[\"a\",BASEGEOGCRS[\"b\",DATUM[\"c\",ELLIPSOID[\"International "
        "1924\",6378388,297]]],CONVERSION[\"TM\",METHOD[\"Transverse Mercator\"],PARAMETER[\"Latitude of natural "
        "origin\",22.3],PARAMETER[\"Longitude of natural origin\",114.2],PARAMETER[\"Scale factor at natural "
        "origin\",1],PARAMETER[\"False easting\",836694],PARAMETER[\"False northing\",819069]],CS[Cartesian,2],"
        "AXIS[\"easting\",east],AXIS[\"northing\",north],LENGTHUNIT[\"metre\",1]]],TARGETCRS[GEOGCRS[\"WGS 84\","
        "DATUM[\"World Geodetic System 1984\",ELLIPSOID[\"WGS 84\",6378137,298.257223563]],CS[ellipsoidal,2],"
        "AXIS[\"latitude\",north],AXIS[\"longitude\",east],ANGLEUNIT[\"degree\",0.0174532925199433]]],"
        "ABRIDGEDTRANSFORMATION[\"d\",METHOD[\"NTv2\"],PARAMETERFILE[\"Latitude and longitude difference file\",\"" +
        secret("grid.gsb") + "\"]]]";
    options.driver = "GPKG";
    options.type = GDT_Byte;
    test::VectorOptions layer;
    // A .prj holds the text as it is.
    layer.driver = "ESRI Shapefile";
    test::write_vector(input("a.shp"), layer, {{test::rectangle_wkt(0, 0, 5, 5), {}}});
    test::write_text(input("a.prj"), options.wkt);
    const std::string said = hostile("a.shp");
    EXPECT_THAT(said, testing::AnyOf(std::string(), HasSubstr("names a file of a change of datum")));
    if (said.empty()) {
        const GDALDatasetUniquePtr made(GDALDataset::Open((folder_.path() / "out/again.gpkg").c_str(), GDAL_OF_VECTOR));
        const OGRSpatialReference* reference = made->GetLayer(0)->GetSpatialRef();
        char* text = nullptr;
        if (reference != nullptr) reference->exportToWkt(&text);
        EXPECT_THAT(std::string(text != nullptr ? text : ""), testing::Not(HasSubstr("grid.gsb")));
        CPLFree(text);
    }
}

TEST_P(Foreign, buffers_and_materials_of_meshes_lie_in_their_folder) {
    test::write_text(secret("box.bin"), std::string(10000, 'x'));
    for (const std::string& uri : {secret("box.bin"), std::string("../secret/box.bin"), "file://" + secret("box.bin"),
                                   std::string("http://127.0.0.1:9/box.bin"), std::string("%2e%2e/secret/box.bin")}) {
        test::write_text(input("a.gltf"),
                         R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":100,"uri":")" + uri + R"("}]})");
        EXPECT_THAT(hostile("a.gltf"), HasSubstr("must be a file in the folder"));
    }
    test::write_text(input("a.obj"), "mtllib " + secret("box.bin") +
                                         "\nusemtl x\nv 0 0 9\nv 5 0 9\nv 5 5 9\nv 0 0 0\n" +
                                         "v 5 0 0\nv 5 5 0\no a\nf 1 2 3\nf 4 6 5\n");
    EXPECT_EQ(hostile("a.obj"), "");
}

TEST_P(Foreign, gml_and_kml_fetch_no_schemas_and_no_links) {
    test::write_text(secret("schema.xsd"), "<schema/>");
    for (const std::string& place : {secret("schema.xsd"), std::string("http://127.0.0.1:9/schema.xsd")}) {
        test::write_text(input("a.gml"), "<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY e SYSTEM \"file://" +
                                             secret("schema.xsd") +
                                             "\">]><ogr:FeatureCollection xmlns:ogr=\"http://ogr.maptools.org/\" "
                                             "xmlns:gml=\"http://www.opengis.net/gml\" "
                                             "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
                                             "xsi:schemaLocation=\"http://ogr.maptools.org/ " +
                                             place + "\"><gml:boundedBy>&e;</gml:boundedBy></ogr:FeatureCollection>");
        EXPECT_THAT(hostile("a.gml"), HasSubstr("may name other files"));
        test::write_text(input("a.kml"),
                         "<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document><NetworkLink><Link>"
                         "<href>" +
                             place + "</href></Link></NetworkLink></Document></kml>");
        (void)hostile("a.kml");
    }
}

/// A GeoPackage with what SQL is put into it.
void change_geopackage(const std::string& file, const std::vector<std::string>& commands) {
    const GDALDatasetUniquePtr data(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE));
    ASSERT_TRUE(data);
    for (const std::string& command : commands) {
        CPLErrorReset();
        data->ReleaseResultSet(data->ExecuteSQL(command.c_str(), nullptr, nullptr));
        ASSERT_NE(CPLGetLastErrorType(), CE_Failure) << command << ": " << CPLGetLastErrorMsg();
    }
}

std::string endless_view(const std::string& file) {
    test::VectorOptions options;
    options.driver = "GPKG";
    options.layer = "scar";
    write_vector(file, options, {{test::rectangle_wkt(824200, 825090, 824220, 825110), {}}});
    change_geopackage(
        file, {"CREATE VIEW endless AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT n.i AS "
               "fid, scar.geom AS geom FROM n, scar WHERE n.i < 0",
               "INSERT INTO gpkg_contents (table_name, identifier, data_type, srs_id) SELECT 'endless', 'endless', "
               "'features', srs_id FROM gpkg_contents WHERE table_name = 'scar'",
               "INSERT INTO gpkg_geometry_columns SELECT 'endless', column_name, geometry_type_name, srs_id, z, m FROM "
               "gpkg_geometry_columns WHERE table_name = 'scar'"});
    return file;
}

TEST_P(Foreign, an_endless_view_ends_in_a_sentence_or_when_it_is_cancelled) {
    endless_view(input("a.gpkg"));
    reader_.processor_time = std::chrono::seconds(1);
    EXPECT_THAT(hostile("a.gpkg"), HasSubstr("takes more than 1 s to read"));
    reader_.processor_time = std::chrono::seconds(60);
    const auto begun = std::chrono::steady_clock::now();
    reader_.shall_end = [&] { return std::chrono::steady_clock::now() - begun > std::chrono::seconds(1); };
    EXPECT_THAT(hostile("a.gpkg"), HasSubstr("cancelled"));
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(20));
    reader_.shall_end = {};
    reader_.patience = std::chrono::seconds(1);
    EXPECT_THAT(hostile("a.gpkg"), HasSubstr("takes more than 1 s to read"));
}

TEST_P(Foreign, triggers_views_and_functions_of_a_geopackage_do_nothing_and_do_not_stay) {
    test::VectorOptions options;
    options.driver = "GPKG";
    options.layer = "scar";
    write_vector(input("a.gpkg"), options, {{test::rectangle_wkt(824200, 825090, 824220, 825110), {}}});
    test::write_plane(secret("other.tif"));
    change_geopackage(
        input("a.gpkg"),
        {"CREATE TRIGGER mischief AFTER INSERT ON scar BEGIN DELETE FROM gpkg_contents; END",
         "CREATE VIEW named AS SELECT fid, geom FROM scar WHERE gdal_get_pixel_value('" + secret("other.tif") +
             "', 1, 'pixel', 0, 0) > 0 OR ogr_geocode('Hong Kong') IS NULL",
         "INSERT INTO gpkg_contents (table_name, identifier, data_type, srs_id) SELECT 'named', 'named', "
         "'features', srs_id FROM gpkg_contents WHERE table_name = 'scar'",
         "INSERT INTO gpkg_geometry_columns SELECT 'named', column_name, geometry_type_name, srs_id, z, m "
         "FROM gpkg_geometry_columns WHERE table_name = 'scar'"});
    (void)hostile("a.gpkg");
    if (fs::exists(folder_.path() / "out/again.gpkg")) {
        const std::string bytes = test::read_text(folder_.path() / "out/again.gpkg");
        EXPECT_THAT(bytes, testing::Not(HasSubstr("mischief")));
        EXPECT_THAT(bytes, testing::Not(HasSubstr("CREATE VIEW")));
    }
}

TEST_P(Foreign, what_takes_too_much_is_refused) {
    RasterOptions options;
    options.columns = options.rows = 400;
    test::write_plane(input("dem.tif"), options);
    ForeignWanted wanted = any();
    wanted.cells = 1000;
    EXPECT_THAT(hostile("dem.tif", wanted), HasSubstr("has 400 x 400 cells, at most 0.001 million"));
    reader_.bytes = 100'000;
    EXPECT_NE(hostile("dem.tif"), "");
    reader_ = foreign_reader();
    test::write_text(input("dem.asc"), "nothing of the kind");
    EXPECT_THAT(hostile("dem.asc"), HasSubstr("is nothing that is known"));
}

/// What the tests above would see if these files were simply opened, as they were once.
TEST(Witness, sees_what_gdal_opens_for_such_files) {
    GDALAllRegister();
    const test::TemporaryFolder in, beside;
    const std::string heights = beside.file("heights"), table = beside.file("a.csv"), other = beside.file("other.tif");
    test::write_text(heights, std::string(1200, 'A'));
    test::write_text(table, "x,y\n1,2\n");
    test::write_plane(other);
    const auto opened = [&](const std::function<void()>& work) {
        const test::Witness witness(beside.file("log"));
        work();
        return witness.elsewhere({in.path().string()});
    };
    std::string bytes = test::read_text(fs::path(TALUS_SOURCE_DIR) / "tests/foreign/external_storage.h5");
    const std::size_t end = bytes.find("/talus-secret") + 13;
    bytes.replace(end - heights.size(), heights.size(), heights);
    test::write_text(in.file("a.h5"), bytes);
    EXPECT_THAT(opened([&] {
                    const GDALDatasetUniquePtr data(GDALDataset::Open(in.file("a.h5").c_str(), GDAL_OF_RASTER));
                    float value = 0;
                    ASSERT_TRUE(data);
                    EXPECT_EQ(
                        data->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, 1, 1, &value, 1, 1, GDT_Float32, 0, 0, nullptr),
                        CE_None);
                    EXPECT_NEAR(value, 12.08, 0.01) << "the letters as a height";
                }),
                testing::Contains(testing::AllOf(testing::StartsWith("open /"), testing::EndsWith(heights))));
    test::write_text(
        in.file("dem.asc"),
        "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 5\n<OGRVRTDataSource><OGRVRTLayer name=\"a\">"
        "<SrcDataSource>" +
            table + "</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>\n1 2\n3 4\n");
    const GDALDatasetUniquePtr layer(GDALDataset::Open(in.file("dem.asc").c_str(), GDAL_OF_VECTOR));
    ASSERT_TRUE(layer);
    EXPECT_STREQ(layer->GetDriverName(), "OGR_VRT") << "a raster by its first line, and this by its last";
    test::write_plane(in.file("dem.tif"));
    GDALDatasetUniquePtr(GDALDataset::Open(in.file("dem.tif").c_str(), GDAL_OF_UPDATE))
        ->SetMetadataItem("OVERVIEW_FILE", other.c_str(), "OVERVIEWS");
    EXPECT_THAT(opened([&] {
                    const GDALDatasetUniquePtr data(GDALDataset::Open(in.file("dem.tif").c_str(), GDAL_OF_RASTER));
                    ASSERT_TRUE(data);
                    (void)CPLStringList(data->GetFileList());
                }),
                testing::Contains("open " + other));
    const GDALDatasetUniquePtr remote(GDALDataset::Open("/vsicurl/http://127.0.0.9:9/a.tif", GDAL_OF_RASTER));
    EXPECT_THAT(
        opened([&] { GDALDatasetUniquePtr(GDALDataset::Open("/vsicurl/http://127.0.0.9:9/b.tif", GDAL_OF_RASTER)); }),
        testing::Contains("connect 127.0.0.9"));
}

/// Programs in the child's place: what a file that has taken the child over could make of it.
TEST_P(Foreign, a_child_that_lies_leaves_a_sentence_and_nothing_else) {
    test::write_text(input("a"), "x");
    const auto lie = [&](const std::string& script) {
        const std::string program = test::write_text(folder_.file("liar"), "#!/bin/sh\n" + script + "\n");
        fs::permissions(program, fs::perms::owner_all);
        reader_.program = program;
        const auto made = convert(input("a"), any());
        if (made) return std::string("(taken)");
        EXPECT_TRUE(fs::is_empty(folder_.path() / "out")) << script;
        return made.error().message;
    };
    const std::string malformed = "its data are malformed";
    EXPECT_THAT(lie("exit 0"), HasSubstr(malformed));
    EXPECT_THAT(lie("kill -9 $$"), HasSubstr("ended unexpectedly"));
    EXPECT_THAT(lie("kill -11 $$"), HasSubstr("ended unexpectedly"));
    EXPECT_THAT(lie("echo '{\"raster\": 3}'"), HasSubstr(malformed));
    const std::string head =
        R"({"raster": {"columns": 2, "rows": %s, "bands": [{"type": "%s", "nodata": null}], "crs": "%s"}})";
    const auto raster = [&](const char* rows, const char* type, const char* crs, int bytes) {
        std::string text = head;
        for (const char* part : {rows, type, crs}) text.replace(text.find("%s"), 2, part);
        return lie("echo '" + text + "'; head -c " + std::to_string(bytes) + " /dev/zero");
    };
    EXPECT_THAT(raster("1000000000", "Float32", "", 8), HasSubstr(malformed));
    EXPECT_THAT(raster("-2", "Float32", "", 8), HasSubstr(malformed));
    EXPECT_THAT(raster("2", "CFloat64", "", 64), HasSubstr(malformed));
    EXPECT_THAT(raster("2", "Float32", "", 15), HasSubstr(malformed));
    EXPECT_THAT(raster("2", "Float32", "", 17), HasSubstr(malformed));
    EXPECT_THAT(raster("2", "Float32", "nonsense", 16), HasSubstr(malformed));
    EXPECT_THAT(raster("2", "Float32", "PARAMETERFILE", 16), HasSubstr("names a file"));
    const std::string layers = R"(echo '{"layers": [{"name": "a", "crs": "", "fields": []}]}'; printf ')";
    EXPECT_THAT(lie(layers + R"(\001\003\000\000\000\377\377\377\377')"), HasSubstr(malformed));
    EXPECT_THAT(lie(layers + R"(\001\007\000\000\000\001\000\000\000\007\000')"), HasSubstr(malformed));
    EXPECT_THAT(lie(layers + R"(\000x')"), HasSubstr(malformed));
    EXPECT_THAT(lie(R"(echo '{"mesh": []}'; echo '{"talus_roofs": 1, "buildings": [{"roofs": [{"z": 1e999}]}]}')"),
                HasSubstr(malformed));
    EXPECT_THAT(lie("printf '{\"error\": \"\\\\u202etxt.exe\\\\u001b[31m\"}\\n'"),
                testing::AllOf(HasSubstr("\\u202E"), HasSubstr("\\u001B")));
    EXPECT_EQ(raster("2", "Float32", "", 16), "(taken)") << "the others are refused for what is wrong with them";
}

TEST(Isolation, says_what_the_kernel_lacks) {
    EXPECT_EQ(missing_isolation({true, true}), "");
    EXPECT_THAT(missing_isolation({false, true}), HasSubstr("lacks Landlock:"));
    EXPECT_THAT(missing_isolation({true, false}), HasSubstr("lacks seccomp:"));
    EXPECT_THAT(missing_isolation({}), HasSubstr("lacks Landlock and seccomp:"));
}

}  // namespace
}  // namespace talus::geo
