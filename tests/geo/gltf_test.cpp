#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geo/mesh.hpp"

namespace talus::geo {
namespace {

using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;

template <class Number>
std::string bytes_of(const std::vector<Number>& numbers) {
    std::string bytes(numbers.size() * sizeof(Number), '\0');
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    return bytes;
}

std::string base64(const std::string& bytes) {
    constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t k = 0; k < bytes.size(); k += 3) {
        std::uint32_t bits = 0;
        for (std::size_t b = 0; b < 3; ++b) {
            bits = bits << 8U | (k + b < bytes.size() ? static_cast<unsigned char>(bytes[k + b]) : 0U);
        }
        for (std::size_t d = 0; d < 4; ++d) text += k + d > bytes.size() ? '=' : digits[bits >> (18 - 6 * d) & 63U];
    }
    return text;
}

/// A house of 10 m along x, 6 m along -z and 5 m high, y upward, as a box without a floor: 8 vertices of 12 bytes and
/// 30 indices of 2 bytes.
std::string box() {
    const std::vector<float> corners{0, 0, 0, 10, 0, 0, 10, 0, -6, 0, 0, -6, 0, 5, 0, 10, 5, 0, 10, 5, -6, 0, 5, -6};
    const std::vector<std::uint16_t> indices{0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7,
                                             2, 7, 6, 3, 0, 4, 3, 4, 7, 4, 5, 6, 4, 6, 7};
    return bytes_of(corners) + bytes_of(indices);
}

/// `buffer`: its uri, as a member with a comma, or nothing.
std::string gltf_house(const std::string& buffer) {
    return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
 "nodes": [{"translation": [824000, 50, -825000], "children": [1, 2]},
  {"name": "hut", "mesh": 0, "extras": {"resistance": 35000}},
  {"mesh": 0, "translation": [20, 0, 0], "scale": [0.5, 2, 0.5]}],
 "meshes": [{"name": "box", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
  {"bufferView": 1, "componentType": 5123, "count": 30, "type": "SCALAR"}],
 "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 60}],
 "buffers": [{)" +
           buffer + R"("byteLength": 156}], "images": [{"uri": "roof.jpg"}]})";
}

std::string embedded() {
    return gltf_house("\"uri\": \"data:application/octet-stream;base64," + base64(box()) + "\", ");
}

std::string word(std::uint32_t number) {
    return bytes_of(std::vector<std::uint32_t>{number});
}

std::string container(std::string text, std::string binary) {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    const auto size = static_cast<std::uint32_t>(28 + text.size() + binary.size());
    return "glTF" + word(2) + word(size) + word(static_cast<std::uint32_t>(text.size())) + "JSON" + text +
           word(static_cast<std::uint32_t>(binary.size())) + std::string("BIN\0", 4) + binary;
}

class Gltf : public testing::Test {
  protected:
    Gltf() : folder_(std::filesystem::path(testing::TempDir()) / ("gltf-" + std::to_string(getpid()))) {
        std::filesystem::create_directories(folder_);
    }
    ~Gltf() override { std::filesystem::remove_all(folder_); }

    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
    }
    Result<std::vector<MeshBuilding>> read(const std::string& name, const std::string& text) {
        write(name, text);
        more_files_.clear();
        return read_mesh_buildings((folder_ / name).string(), {"", "", 2326}, more_files_);
    }
    std::string refusal(const std::string& name, const std::string& text) {
        const auto read_in = read(name, text);
        return read_in ? "(it was read)" : read_in.error().message;
    }
    /// That of the embedded house with a passage changed.
    std::string changed(const std::string& from, const std::string& to) {
        std::string text = embedded();
        text.replace(text.find(from), from.size(), to);
        return refusal("a.gltf", text);
    }

    std::filesystem::path folder_;
    std::vector<std::string> more_files_;
};

void expect_hut_and_its_copy(const Result<std::vector<MeshBuilding>>& buildings) {
    ASSERT_TRUE(buildings) << buildings.error().message;
    ASSERT_EQ(buildings->size(), 2U);
    const MeshBuilding &hut = (*buildings)[0], &copy = (*buildings)[1];
    EXPECT_EQ(hut.name, "hut");
    EXPECT_EQ(hut.attributes.at("resistance"), "35000");
    ASSERT_EQ(hut.roofs.size(), 2U);
    const Extent extent = extent_of(hut.roofs[0].outline);
    EXPECT_NEAR(extent.x_min, 824000, 1e-9);
    EXPECT_NEAR(extent.x_max, 824010, 1e-9);
    EXPECT_NEAR(extent.y_min, 825000, 1e-9) << "-z is north";
    EXPECT_NEAR(extent.y_max, 825006, 1e-9);
    EXPECT_NEAR(hut.roofs[0].elevation, 55, 1e-9);
    EXPECT_EQ(copy.name, "box");
    ASSERT_EQ(copy.roofs.size(), 2U);
    EXPECT_NEAR(plan_area(copy.roofs[0].outline) + plan_area(copy.roofs[1].outline), 15, 1e-9);
    EXPECT_NEAR(extent_of(copy.roofs[0].outline).x_max, 824025, 1e-9);
    EXPECT_NEAR(copy.roofs[0].elevation, 60, 1e-9);
}

TEST_F(Gltf, a_node_with_a_mesh_is_a_building_wherever_its_buffer_is) {
    expect_hut_and_its_copy(read("a.gltf", embedded()));
    EXPECT_TRUE(more_files_.empty());
    write("my box.bin", box());
    expect_hut_and_its_copy(read("b.gltf", gltf_house("\"uri\": \"my%20box.bin\", ")));
    EXPECT_THAT(more_files_, ElementsAre((folder_ / "my box.bin").string()));
    expect_hut_and_its_copy(read("c.GLB", container(gltf_house(""), box())));
}

TEST_F(Gltf, strips_fans_and_rotations_are_read) {
    // A square of 4 m, 3 m above a post at the foot, which only says where the foot is.
    const std::vector<float> corners{0, 3, 0, 4, 3, 0, 0, 3, -4, 4, 3, -4, 0, 0, 0, 1, 0, 0, 0, 0, -1};
    for (const int mode : {4, 5, 6}) {
        // Without indices the vertices follow each other: two triangles of a strip, then upright and foot ones.
        const std::vector<std::uint8_t> order = mode == 4   ? std::vector<std::uint8_t>{0, 1, 2, 2, 1, 3, 4, 5, 6}
                                                : mode == 5 ? std::vector<std::uint8_t>{0, 1, 2, 3, 3, 4, 4, 5, 6}
                                                            : std::vector<std::uint8_t>{0, 1, 3, 2};
        const std::string bytes = bytes_of(corners) + bytes_of(order);
        const auto buildings = read(
            "a.gltf",
            R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0, "rotation": [0, 0.7071067811865476, 0, 0.7071067811865476]}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": )" +
                std::to_string(mode) +
                R"(}, {"attributes": {"POSITION": 2}}, {"attributes": {"POSITION": 0}, "mode": 0}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 7, "type": "VEC3"},
  {"bufferView": 1, "componentType": 5121, "count": )" +
                std::to_string(order.size()) + R"(, "type": "SCALAR"},
  {"bufferView": 0, "byteOffset": 48, "componentType": 5126, "count": 3, "type": "VEC3"}],
 "bufferViews": [{"buffer": 0, "byteLength": 84}, {"buffer": 0, "byteOffset": 84, "byteLength": )" +
                std::to_string(order.size()) + R"(}],
 "buffers": [{"uri": "data:;base64,)" +
                base64(bytes) + R"(", "byteLength": )" + std::to_string(bytes.size()) + "}]}");
        ASSERT_TRUE(buildings) << buildings.error().message;
        ASSERT_EQ(buildings->size(), 1U);
        double area = 0;
        Extent extent = extent_of(buildings->front().roofs.front().outline);
        for (const RoofFace& roof : buildings->front().roofs) {
            if (roof.elevation == 3) area += plan_area(roof.outline);
        }
        EXPECT_NEAR(area, 16, 1e-5) << mode;
        // A quarter turn about y brings x to -z: the square, from 0 to 4 east and north, then lies from -4 to 0 east.
        EXPECT_NEAR(extent.x_min, -4, 1e-5);
        EXPECT_NEAR(extent.y_max, 4, 1e-5);
    }
}

TEST_F(Gltf, bad_files_are_refused_with_the_place) {
    EXPECT_THAT(refusal("a.gltf", "hello"), HasSubstr("a.gltf: is no glTF file"));
    EXPECT_THAT(refusal("a.gltf", "{}"), HasSubstr("is no glTF file: it has no asset.version"));
    EXPECT_THAT(changed(R"("version": "2.0")", R"("version": "1.0")"), HasSubstr("asset.version is \"1.0\""));
    EXPECT_THAT(refusal("a.gltf", gltf_house("\"uri\": \"gone.bin\", ")), HasSubstr("buffers[0]: "));
    EXPECT_THAT(refusal("a.gltf", gltf_house("\"uri\": \"gone.bin\", ")), HasSubstr("gone.bin: no such file"));
    for (const char* uri : {"../a.bin", "/etc/passwd", "http://example.org/a.bin", "b/%2e%2e/%2e%2e/a.bin"}) {
        EXPECT_THAT(refusal("a.gltf", gltf_house("\"uri\": \"" + std::string(uri) + "\", ")),
                    HasSubstr("must be a file in the folder of the glTF file or below"));
    }
    write("short.bin", box().substr(1));
    EXPECT_THAT(refusal("a.gltf", gltf_house("\"uri\": \"short.bin\", ")),
                HasSubstr("buffers[0]: should have 156 bytes and has 155"));
    EXPECT_THAT(refusal("a.gltf", gltf_house("")), HasSubstr("has no uri, and there is no binary chunk"));
    EXPECT_THAT(refusal("a.gltf", gltf_house("\"uri\": \"data:;base64,A*==\", ")), HasSubstr("not written as base64"));
    EXPECT_THAT(changed(R"("byteLength": 156)", R"("byteLength": 1000000000000)"),
                HasSubstr("should have 1000000000000 bytes and has 156"));
    EXPECT_THAT(changed(R"("byteLength": 156)", R"("byteLength": -1)"), HasSubstr("must be a whole number of bytes"));
    EXPECT_THAT(changed(R"("byteLength": 96)", R"("byteLength": 157)"),
                HasSubstr("bufferViews[0]: does not lie within the 156 bytes of buffers[0]"));
    EXPECT_THAT(changed(R"("count": 8)", R"("count": 9)"),
                HasSubstr("accessors[0]: does not lie within the 96 bytes of bufferViews[0]"));
    EXPECT_THAT(changed(R"("count": 8)", R"("count": 1099511627775)"), HasSubstr("does not lie within"));
    EXPECT_THAT(changed(R"("count": 8)", R"("count": 7)"),
                HasSubstr("meshes[0].primitives[0]: names vertex 7; there are 7"));
    EXPECT_THAT(changed("\"bufferView\": 1", "\"bufferView\": 2"), HasSubstr("bufferViews[2] is named but not there"));
    EXPECT_THAT(changed(R"("indices": 1)", R"("indices": 2)"), HasSubstr("accessors[2] is named but not there"));
    EXPECT_THAT(changed(R"("indices": 1)", R"("indices": 0)"), HasSubstr("its indices must be whole numbers"));
    EXPECT_THAT(changed("5123", "5124"), HasSubstr("accessors[1]: must be scalars or vectors"));
    EXPECT_THAT(changed("\"VEC3\"", "\"VEC2\""), HasSubstr("POSITION must be of three numbers"));
    EXPECT_THAT(changed(R"("mesh": 0)", R"("mesh": 1)"), HasSubstr("nodes[1]: names a mesh that is not there"));
    EXPECT_THAT(changed("[1, 2]", "[1, 3]"), HasSubstr("nodes[0]: names a node that is not there; there are 3"));
    EXPECT_THAT(changed("[1, 2]", "[1, 1]"), HasSubstr("nodes[1]: is below two others, or below itself"));
    EXPECT_THAT(changed("[1, 2]", "[1, 0]"), HasSubstr("nodes[0]: is below two others, or below itself"));
    EXPECT_THAT(changed("[20, 0, 0]", "[20, 0]"), HasSubstr("nodes[2]: its matrix, translation"));
    EXPECT_THAT(changed("[20, 0, 0]", "[1e308, 0, 0]"), HasSubstr("\"box\" has no roof"));
    EXPECT_THAT(changed("[0.5, 2, 0.5]", "[1e308, 2, 0.5]"), HasSubstr("vertex 1 is not finite"));
    EXPECT_THAT(changed("\"scene\": 0", "\"scene\": 1"), HasSubstr("names a scene that is not there"));
    EXPECT_THAT(changed("\"scene\": 0", R"("extensionsRequired": ["KHR_draco_mesh_compression"])"),
                HasSubstr("is compressed with Draco (KHR_draco_mesh_compression), which is not supported"));
    EXPECT_THAT(changed("\"indices\": 1", R"("extensions": {"KHR_draco_mesh_compression": {}})"),
                HasSubstr("primitives[0]: is compressed with Draco"));
    EXPECT_THAT(changed("\"scene\": 0", R"("extensionsRequired": ["VENDOR_shapes"])"),
                HasSubstr("needs the extension \"VENDOR_shapes\""));
    std::string bytes = box();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::memcpy(bytes.data() + 48, &nan, 4);
    EXPECT_THAT(refusal("a.glb", container(gltf_house(""), bytes)), HasSubstr("vertex 4 is not finite"));
    const std::string whole = container(gltf_house(""), box());
    EXPECT_THAT(refusal("a.glb", whole.substr(0, 19)), HasSubstr("ends within its header"));
    EXPECT_THAT(refusal("a.glb", whole.substr(0, whole.size() - 8)), HasSubstr("is a damaged .glb file: it says that"));
    EXPECT_THAT(refusal("a.glb", whole.substr(0, 12) + word(1U << 31U) + whole.substr(16)), HasSubstr("chunk 0 says"));
    EXPECT_THAT(refusal("a.glb", whole.substr(0, 4) + word(1) + whole.substr(8)), HasSubstr("container version 1"));
}

TEST_F(Gltf, hostile_files_are_refused_and_nothing_else) {
    // One mesh that thousands of nodes show.
    std::string text = embedded();
    const std::size_t begin = text.find("\"nodes\": [{\"translation\"");
    std::string list = "\"nodes\": [";
    for (int k = 0; k < 4000; ++k) list += std::string(k == 0 ? "" : ", ") + R"({"mesh": 0})";
    text.replace(begin, text.find("\"meshes\"") - begin, list + "], ");
    text.replace(text.find("\"scenes\": [{\"nodes\": [0]}],"), 27, "");
    text.replace(text.find("\"scene\": 0,"), 11, "");
    EXPECT_THAT(refusal("a.gltf", text), HasSubstr("there are more than 30000 faces"));
    const std::string deep = std::string(200'000, '[') + std::string(200'000, ']');
    EXPECT_THAT(changed("35000", deep), HasSubstr("levels deep; at most 64 are read"));
    EXPECT_THAT(changed("\"hut\"", deep), HasSubstr("levels deep; at most 64 are read"));
    EXPECT_THAT(changed("35000", deep.substr(200'000 - 20, 40)), HasSubstr("(it was read)"));
    // Bytes changed at random: read or refused, never more than that.
    std::mt19937 random(12);
    const std::string whole = container(gltf_house(""), box());
    for (int round = 0; round < 2000; ++round) {
        std::string bytes = whole;
        for (int k = 0; k < 3; ++k) bytes[random() % bytes.size()] = static_cast<char>(random() % 256);
        EXPECT_THAT(refusal("a.glb", bytes), AnyOf("(it was read)", HasSubstr("a.glb")));
    }
}

}  // namespace
}  // namespace talus::geo
