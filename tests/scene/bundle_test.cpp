#include "scene/bundle.hpp"

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "geo/vector.hpp"
#include "geo/zip_archive.hpp"
#include "scene/scene_folder.hpp"
#include "support/foreign.hpp"
#include "support/witness.hpp"

namespace talus::scene {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

class Bundle : public SceneFolder {
  protected:
    [[nodiscard]] fs::path archive() const { return folder / "scene.zip"; }
    [[nodiscard]] fs::path unpacked() const { return folder / "unpacked"; }

    /// The archive with a name in it replaced by another of the same length, as no writer would make it.
    void rename_in_archive(const std::string& name, const std::string& by) const {
        std::string bytes = text_of(archive());
        ASSERT_EQ(name.size(), by.size());
        std::size_t count = 0;
        for (std::size_t at = bytes.find(name); at != std::string::npos; at = bytes.find(name, at + 1), ++count) {
            bytes.replace(at, name.size(), by);
        }
        ASSERT_EQ(count, 2U) << "once beside the file, once in the list";
        write("scene.zip", bytes);
    }
    [[nodiscard]] std::string refusal(const geo::ZipLimits& limits = {}) const {
        const auto scene = unpack_bundle(archive(), unpacked(), limits, test::foreign_reader());
        EXPECT_TRUE(scene || !fs::exists(unpacked())) << "something remains";
        return scene ? "(it was unpacked)" : scene.error().message;
    }
    void pack(const std::vector<geo::ZipEntry>& entries) const {
        const Status written = geo::write_zip(archive(), entries);
        ASSERT_TRUE(written) << written.error().message;
    }
};

TEST_F(Bundle, holds_the_scene_and_its_files_with_other_paths) {
    write_valley("[scene]\ntitle = \"Schön\"  # a remark\n");
    const auto packed = write_bundle(folder / "scene.toml", archive());
    ASSERT_TRUE(packed) << packed.error().message;
    EXPECT_EQ(packed->files, 2U);
    const auto bundle = unpack_bundle(archive(), unpacked(), {}, test::foreign_reader());
    ASSERT_TRUE(bundle) << bundle.error().message;
    const std::string text = text_of(bundle->scene);
    EXPECT_THAT(text, HasSubstr("file = \"data/dem.tif\""));
    EXPECT_THAT(text, HasSubstr("file = \"data/release.gpkg\""));
    EXPECT_FALSE(fs::exists(unpacked() / "archive"));
    EXPECT_THAT(text, HasSubstr("title = \"Schön\"  # a remark"));

    const auto before = load_scene(folder / "scene.toml");
    auto after = load_scene(bundle->scene);
    ASSERT_TRUE(before && after);
    EXPECT_EQ(before->terrain.elevation().values, after->terrain.elevation().values);
    EXPECT_EQ(total_volume(*before), total_volume(*after));
    name_originals(*after, bundle->originals);
    ASSERT_EQ(before->inputs.size(), after->inputs.size());
    for (std::size_t k = 0; k < before->inputs.size(); ++k) {
        if (before->inputs[k].role == "scene") continue;
        EXPECT_EQ(before->inputs[k].hash, after->inputs[k].hash);
        EXPECT_EQ(before->inputs[k].role, after->inputs[k].role);
        EXPECT_EQ(fs::path(before->inputs[k].path).filename(), fs::path(after->inputs[k].path).filename());
    }
}

TEST_F(Bundle, keeps_files_of_one_name_apart) {
    write_valley();
    fs::create_directories(folder / "a");
    fs::create_directories(folder / "b");
    fs::rename(folder / "dem.tif", folder / "a" / "data.tif");
    fs::copy(folder / "a" / "data.tif", folder / "b" / "data.tif");
    write(
        "scene.toml",
        "[terrain]\nfile = \"a/data.tif\"\n[[release]]\nname = \"scar\"\nfile = 'release.geojson'\nthickness_raster = "
        "\"b/data.tif\"\n");
    const auto packed = write_bundle(folder / "scene.toml", archive());
    ASSERT_TRUE(packed) << packed.error().message;
    const auto bundle = unpack_bundle(archive(), unpacked(), {}, test::foreign_reader());
    ASSERT_TRUE(bundle) << bundle.error().message;
    EXPECT_THAT(text_of(bundle->scene), HasSubstr("thickness_raster = \"data/data-2.tif\""));
    EXPECT_TRUE(fs::exists(unpacked() / "data" / "data-2.tif"));
}

TEST_F(Bundle, keeps_a_layer_that_stands_behind_a_file) {
    write_valley();
    for (const char* name : {"scar", "other"}) {
        geo::OutputFeature feature;
        const double x = west + (name == std::string("scar") ? 20 : 60);
        feature.polygon.push_back({{{x, south + 90}, {x + 20, south + 90}, {x + 20, south + 110}}, {}});
        ASSERT_TRUE(geo::write_geopackage_layer(path("maps.gpkg"), name, {}, {feature}, {"", "", 2326}));
    }
    write("scene.toml",
          "[terrain]\nfile = \"dem.tif\"\n[[release]]\nfile = \"maps.gpkg|layername=scar\"\nthickness_m = 2\n");
    const auto packed = write_bundle(folder / "scene.toml", archive());
    ASSERT_TRUE(packed) << packed.error().message;
    const auto bundle = unpack_bundle(archive(), unpacked(), {}, test::foreign_reader());
    ASSERT_TRUE(bundle) << bundle.error().message;
    EXPECT_THAT(text_of(bundle->scene), HasSubstr("file = \"data/maps.gpkg|layername=scar\""));
    const auto scene = load_scene(bundle->scene);
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_NEAR(scene->releases.at(0).extent().x_min, west + 20, 1e-6);
}

TEST_F(Bundle, refuses_files_that_are_not_there_or_in_an_archive_of_its_own) {
    write_valley();
    ASSERT_TRUE(geo::write_zip(path("data.zip"), {{"x.geojson", path("release.geojson"), {}}}));
    const auto with_release = [&](const std::string& file) {
        pack({{"scene.toml",
               {},
               "[terrain]\nfile = \"dem.tif\"\n[[release]]\nfile = \"" + file + "\"\nthickness_m = 2\n"},
              {"dem.tif", path("dem.tif"), {}},
              {"data.zip", path("data.zip"), {}}});
    };
    with_release("data/absent.gpkg");
    EXPECT_THAT(refusal(), HasSubstr("absent.gpkg: no such file"));
    with_release("data.zip/x.geojson");
    EXPECT_THAT(refusal(), testing::AnyOf(HasSubstr("x.geojson: no such file"), HasSubstr("outside the archive")));
    with_release("data.zip");
    EXPECT_THAT(refusal(), HasSubstr("is no layer of polygons"));
}

TEST_F(Bundle, refuses_a_virtual_raster) {
    write_valley();
    write("dem.vrt",
          "<VRTDataset rasterXSize=\"2\" rasterYSize=\"2\"><VRTRasterBand dataType=\"Float32\" "
          "band=\"1\"/></VRTDataset>");
    const auto files = geo::files_of(folder / "dem.vrt");
    ASSERT_FALSE(files);
    EXPECT_THAT(files.error().message, HasSubstr("may name other files"));
}

TEST_F(Bundle, writes_nothing_outside_its_folder) {
    pack({{"scene.toml", {}, "[terrain]\n"}, {"aa/evil.txt", {}, "evil"}});
    rename_in_archive("aa/evil.txt", "../evil.txt");
    const std::string said = refusal();
    EXPECT_THAT(said, testing::Not(HasSubstr("it was unpacked")));
    EXPECT_FALSE(fs::exists(folder / "evil.txt"));
    EXPECT_FALSE(fs::exists(folder.parent_path() / "evil.txt"));

    pack({{"scene.toml", {}, "[terrain]\n"}, {"aaaaaaa/evil.txt", {}, "evil"}});
    rename_in_archive("aaaaaaa/evil.txt", "/tmp/xx/evil.txt");
    EXPECT_THAT(refusal(), testing::Not(HasSubstr("it was unpacked")));
    EXPECT_FALSE(fs::exists("/tmp/xx/evil.txt"));
}

TEST_F(Bundle, refuses_more_than_its_limits) {
    pack({{"scene.toml", {}, "[terrain]\n"}, {"zeros.txt", {}, std::string(4'000'000, '0')}});
    EXPECT_LT(fs::file_size(archive()), 20'000U);
    EXPECT_THAT(refusal({.bytes = 1'000'000}), HasSubstr("holds more than 0.001 GB unpacked"));
    EXPECT_FALSE(fs::exists(unpacked())) << "something remains";
    EXPECT_THAT(refusal({.files = 1}), HasSubstr("holds more than 1 files"));
}

TEST_F(Bundle, needs_one_scene) {
    pack({{"readme.txt", {}, "nothing"}});
    EXPECT_THAT(refusal(), HasSubstr("there is no scene in it"));
    pack({{"a.toml", {}, ""}, {"b.toml", {}, ""}});
    EXPECT_THAT(refusal(), HasSubstr("there are 2 scenes in it, a.toml and b.toml"));
    write("scene.zip", "not an archive");
    EXPECT_THAT(refusal(), HasSubstr("is not a ZIP archive"));
}

TEST_F(Bundle, refuses_a_scene_that_names_files_outside) {
    write_valley();
    const std::string dem = (folder / "dem.tif").string();
    pack({{"scene.toml",
           {},
           "[terrain]\nfile = \"" + dem + "\"\n[[release]]\nfile = \"r.geojson\"\nthickness_m = 1\n"}});
    EXPECT_THAT(refusal(), HasSubstr("terrain.file in its scene names a file outside the archive"));
    pack(
        {{"scene.toml", {}, "[terrain]\nfile = \"../dem.tif\"\n[[release]]\nfile = \"r.geojson\"\nthickness_m = 1\n"}});
    EXPECT_THAT(refusal(), HasSubstr("names a file outside the archive"));
}

TEST_F(Bundle, refuses_a_variant_that_names_what_the_scene_does_not) {
    write_valley();
    for (const char* file : {"/etc/hostname", "../../dem.tif", "other.tif", "/vsicurl/http://127.0.0.1:9/a.tif"}) {
        pack({{"scene.toml",
               {},
               std::string("[terrain]\nfile = \"dem.tif\"\n[[release]]\nfile = \"r.geojson\"\nthickness_m = 1\n"
                           "[[variant]]\nname = \"wet\"\nset = ['terrain.file=\"") +
                   file + "\"']\n"},
              {"dem.tif", folder / "dem.tif"},
              {"other.tif", folder / "dem.tif"},
              {"r.geojson", folder / "release.geojson"}});
        const test::Witness witness((folder / "log").string());
        EXPECT_THAT(refusal(), HasSubstr("variant \"wet\" of its scene names a file that the scene itself does not"));
        EXPECT_THAT(witness.elsewhere({folder.string()}), testing::IsEmpty());
    }
}

TEST_F(Bundle, overrides_of_a_saved_session_name_no_file_that_its_scene_does_not) {
    write_valley("[[variant]]\nname = \"other\"\nset = ['terrain.file=\"other.tif\"']\n");
    const fs::path scene = folder / "scene.toml";
    EXPECT_TRUE(check_saved_overrides(scene, {}));
    EXPECT_TRUE(check_saved_overrides(scene, {"material.friction_coefficient=0.3", "terrain.file=dem.tif"}));
    EXPECT_TRUE(check_saved_overrides(scene, {"variant=other"}));
    EXPECT_TRUE(check_saved_overrides(scene, {"terrain.file=other.tif"}));
    for (const char* override_text :
         {"terrain.file=/etc/hostname", "terrain.file=../x.tif", "terrain.orthophoto=/vsicurl/http://127.0.0.1:9/a.tif",
          "terrain.file=NETCDF:\"/etc/a.nc\":b", "release.file=${HOME}/a.geojson",
          "buildings.file=http://127.0.0.1:9/"}) {
        const Status refused = check_saved_overrides(scene, {override_text});
        ASSERT_FALSE(refused) << override_text;
        EXPECT_THAT(refused.error().message, HasSubstr("the session sets a file that its scene does not name"));
    }
}

}  // namespace
}  // namespace talus::scene
