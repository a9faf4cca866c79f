#include "geo/mesh.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace talus::geo {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

class Mesh : public testing::Test {
  protected:
    Mesh() : folder_(std::filesystem::path(testing::TempDir()) / ("mesh-" + std::to_string(getpid()))) {
        std::filesystem::create_directories(folder_);
    }
    ~Mesh() override { std::filesystem::remove_all(folder_); }

    Result<std::vector<MeshBuilding>> read(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        std::vector<std::string> more_files;
        return read_mesh_buildings((folder_ / name).string(), {"", "", 2326}, more_files);
    }
    std::string refusal(const std::string& name, const std::string& text) const {
        const auto read_in = read(name, text);
        return read_in ? "(it was read)" : read_in.error().message;
    }

    std::filesystem::path folder_;
};

/// A house of 10 x 6 m, its eaves at 56 and its ridge at 59 m, over ground at 50 m; vertices in centimetres.
const char* const city_house = R"({"type": "CityJSON", "version": "2.0",
 "metadata": {"referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/2326"},
 "transform": {"scale": [0.01, 0.01, 0.01], "translate": [824000, 825000, 50]},
 "CityObjects": {
  "id-1": {"type": "Building", "attributes": {"name": "hut", "year": 1990}, "children": ["id-1-0"]},
  "id-1-0": {"type": "BuildingPart", "parents": ["id-1"], "geometry": [
   {"type": "MultiSurface", "lod": "0", "boundaries": [[[0, 1, 2, 3]]]},
   {"type": "Solid", "lod": "2.2", "boundaries": [[
     [[3, 2, 1, 0]], [[4, 5, 9, 8]], [[8, 9, 6, 7]],
     [[0, 1, 5, 4]], [[2, 3, 7, 6]], [[1, 2, 6, 9, 5]], [[3, 0, 4, 8, 7]]]]}]},
  "tree": {"type": "SolitaryVegetationObject"}},
 "vertices": [[0, 0, 0], [1000, 0, 0], [1000, 600, 0], [0, 600, 0], [0, 0, 600], [1000, 0, 600], [1000, 600, 600],
  [0, 600, 600], [0, 300, 900], [1000, 300, 900]]})";

TEST_F(Mesh, cityjson_gives_the_roof_faces_of_the_most_detailed_geometry) {
    const auto buildings = read("a.city.json", city_house);
    ASSERT_TRUE(buildings) << buildings.error().message;
    ASSERT_EQ(buildings->size(), 1U);
    const MeshBuilding& hut = buildings->front();
    EXPECT_EQ(hut.name, "id-1");
    EXPECT_EQ(hut.attributes.at("name"), "hut");
    ASSERT_EQ(hut.roofs.size(), 2U);
    double area = 0;
    for (const RoofFace& roof : hut.roofs) {
        area += plan_area(roof.outline);
        EXPECT_NEAR(roof.elevation, 57.5, 1e-9);
        EXPECT_NEAR(extent_of(roof.outline).x_max, 824010, 1e-6);
    }
    EXPECT_NEAR(area, 60, 1e-6);
}

TEST_F(Mesh, obj_gives_a_building_per_object_whichever_way_its_faces_turn) {
    for (const bool turned : {false, true}) {
        const std::string top = turned ? "f 8 7 6 5\n" : "f 5 6 7 8\n";
        const auto buildings = read(
            "b.obj",
            "# two boxes\no tower\nv 0 0 10\nv 4 0 10\nv 4 4 10\nv 0 4 10\nv 0 0 30\nv 4 0 30\nv 4 4 30\nv 0 4 30\n"
            "f 1/1/1 2/2/2 6//3 5\nf 1 2 3 4\n" +
                top +
                "o shed\nv 9 9 10\nv 12 9 10\nv 9 12 10\nv 9 9 12\nv 12 9 12\n"
                "v 9 12 13\nf -3 -2 -1\nf -6 -5 -4\n");
        ASSERT_TRUE(buildings) << buildings.error().message;
        ASSERT_EQ(buildings->size(), 2U);
        EXPECT_EQ((*buildings)[0].name, "tower");
        ASSERT_EQ((*buildings)[0].roofs.size(), 1U);
        EXPECT_EQ((*buildings)[0].roofs[0].elevation, 30);
        EXPECT_NEAR(plan_area((*buildings)[0].roofs[0].outline), 16, 1e-12);
        EXPECT_NEAR((*buildings)[1].roofs[0].elevation, 37.0 / 3, 1e-12);
    }
}

TEST_F(Mesh, bad_files_are_refused_with_the_place) {
    EXPECT_THAT(refusal("a.obj", "v 1 2\n"), HasSubstr("a.obj:1: a vertex needs three finite numbers"));
    EXPECT_THAT(refusal("a.obj", "v 1 2 nan\n"), HasSubstr("three finite numbers"));
    EXPECT_THAT(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
                HasSubstr("a.obj:4: a face names vertex 4; there are 3 so far"));
    EXPECT_THAT(refusal("a.obj", "v 0 0 0\nf 1 1\n"), HasSubstr("a.obj:2: a face needs three vertices"));
    EXPECT_THAT(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n"), HasSubstr("a face names vertex x"));
    EXPECT_THAT(refusal("a.obj", "hello\n"), HasSubstr("has no faces"));
    EXPECT_THAT(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 1 0 5\nf 1 2 3\n"), HasSubstr("has no roof"));
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string text = city_house;
        text.replace(text.find(from), from.size(), to);
        return refusal("a.city.json", text);
    };
    EXPECT_THAT(changed("CityJSON", "CityGML"), HasSubstr("is no CityJSON file"));
    EXPECT_THAT(changed(R"("version": "2.0")", R"("version": "3.0")"), HasSubstr("version is \"3.0\"; it must be"));
    EXPECT_THAT(changed("0/2326", "0/28992"), HasSubstr("is EPSG:28992, the terrain's is EPSG:2326"));
    EXPECT_THAT(changed("[8, 9, 6, 7]", "[8, 9, 6, 70]"),
                HasSubstr("\"id-1-0\": a ring names vertex 70; there are 10"));
    EXPECT_THAT(changed("[8, 9, 6, 7]", "[8, 9, 6, -1]"), HasSubstr("a ring names vertex -1"));
    EXPECT_THAT(changed("[8, 9, 6, 7]", "[8, 9]"), HasSubstr("a ring must have 3 to"));
    EXPECT_THAT(changed("[[8, 9, 6, 7]]", "7"), HasSubstr("a face has no rings"));
    EXPECT_THAT(changed("\"Solid\"", "\"MultiPoint\""),
                HasSubstr("geometry type \"MultiPoint\" is no surface or solid"));
    EXPECT_THAT(changed("[1000, 600, 0]", "[1000, 600]"), HasSubstr("vertices[2]: must be three numbers"));
    EXPECT_THAT(changed("\"scale\"", "\"size\""), HasSubstr("transform: needs scale and translate"));
    EXPECT_THAT(changed("]]]]}]}", "]]]]}]"), HasSubstr("is not valid JSON"));
}

TEST_F(Mesh, hostile_files_are_refused_and_nothing_else) {
    std::mt19937 random(11);
    const std::string deep(200'000, '[');
    EXPECT_THAT(refusal("a.city.json", deep), HasSubstr("is nested 200000 levels deep; at most 64 are read"));
    EXPECT_THAT(refusal("a.city.json", R"({"CityObjects": {"a": {}, "a": {}}})"), HasSubstr("has the key \"a\" twice"));
    const std::string nested = std::string(20, '[') + std::string(20, ']');
    EXPECT_THAT(
        refusal("a.city.json", R"({"type": "CityJSON", "vertices": [], "CityObjects": {"a": {"type": "Building",)"
                               R"( "attributes": {"x": )" +
                                   nested + R"(}, "geometry": [{"type": )" + nested + R"(, "lod": "1"}]}}})"),
        HasSubstr("geometry type a list is no surface"));
    std::string faces = "v 0 0 0\nv 1 0 1\nv 0 1 1\n";
    for (int k = 0; k < 30'001; ++k) faces += "f 1 2 3\n";
    EXPECT_THAT(refusal("a.obj", faces), HasSubstr("there are more than 30000 faces"));
    // Bytes changed at random: read or refused, never more than that.
    for (int round = 0; round < 2000; ++round) {
        std::string text = city_house;
        for (int k = 0; k < 3; ++k) text[random() % text.size()] = static_cast<char>(random() % 256);
        EXPECT_THAT(refusal("a.city.json", text), AnyOf("(it was read)", HasSubstr("a.city.json"))) << text;
    }
}

}  // namespace
}  // namespace talus::geo
