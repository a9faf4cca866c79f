#include "pack/pack.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/hash.hpp"
#include "pack/inflate.hpp"
#include "pack/write.hpp"
#include "scene/scene.hpp"
#include "support/value_of.hpp"

namespace talus::pack {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

/// A scene with releases, a building, a barrier and more, on a small plane.
const scene::Scene& small_scene() {
    static const scene::Scene scene =
        test::value_of(scene::load_scene(TALUS_SOURCE_DIR "/tests/golden/scenes/barrier_and_houses.toml"));
    return scene;
}

Result<Packed> read_text(const std::string& bytes) {
    return read(std::as_bytes(std::span(bytes)), "twin.talus");
}

std::string error_of(const Result<Packed>& result) {
    return result ? "accepted" : result.error().message;
}

/// The file around other content, with a hash that is right.
std::string with_hash(std::string bytes) {
    bytes.resize(bytes.size() - sizeof(std::uint64_t));
    StateHash hash;
    hash.add(bytes.data(), bytes.size());
    const std::uint64_t value = hash.value();
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    return bytes;
}

Packed full() {
    Packed packed{.scene = small_scene()};
    packed.overrides = {"material.viscosity=0.2"};
    packed.latitude = 22.5;
    packed.orthophoto = {"image/jpeg", std::string("\xff\xd8\0\xff", 4)};
    packed.recording = {{0, std::string("a\0b", 3)}, {0.5, "c"}};
    return packed;
}

TEST(Pack, gives_back_what_was_written) {
    const std::string bytes = write(full());
    const auto packed = read_text(bytes);
    ASSERT_TRUE(packed) << packed.error().message;
    EXPECT_EQ(write(*packed), bytes);
    EXPECT_EQ(packed->overrides, full().overrides);
    EXPECT_EQ(packed->latitude, 22.5);
    EXPECT_EQ(packed->orthophoto->bytes, full().orthophoto->bytes);
    EXPECT_EQ(packed->recording[0].message, full().recording[0].message);
    EXPECT_EQ(packed->scene.buildings.size(), small_scene().buildings.size());
    EXPECT_EQ(packed->scene.terrain.elevation().geometry, small_scene().terrain.elevation().geometry);
    EXPECT_EQ(packed->scene.inputs.front().hash, small_scene().inputs.front().hash);
}

TEST(Pack, keeps_members_of_derived_structs) {
    Packed packed = full();
    params::BuildingsSpec& wanted = packed.scene.spec.buildings;
    wanted.height = 7;
    wanted.height_attribute = "h";
    wanted.name_attribute = "n";
    wanted.resistance_attribute = "r";
    wanted.resistance = 5e3;
    terrain::Building& house = packed.scene.buildings.front();
    house.height = 8;
    house.height_assumed = true;
    house.resistance = {2e3, 4e3};
    const auto read = read_text(write(packed));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->scene.spec.buildings.height, 7);
    EXPECT_EQ(read->scene.spec.buildings.height_attribute, "h");
    EXPECT_EQ(read->scene.spec.buildings.name_attribute, "n");
    EXPECT_EQ(read->scene.spec.buildings.resistance_attribute, "r");
    EXPECT_EQ(read->scene.spec.buildings.resistance, 5e3);
    EXPECT_EQ(read->scene.buildings.front().height, 8);
    EXPECT_TRUE(read->scene.buildings.front().height_assumed);
    EXPECT_EQ(read->scene.buildings.front().resistance, house.resistance);
    EXPECT_EQ(read->scene.buildings.front().name, house.name);
    EXPECT_EQ(read->scene.buildings.front().roof_elevation, house.roof_elevation);
}

TEST(Pack, does_not_say_where_files_lay) {
    const std::string content = write_content(full());
    EXPECT_EQ(content.find(TALUS_SOURCE_DIR), std::string::npos);
    EXPECT_NE(content.find("barrier_and_houses.toml"), std::string::npos);
}

TEST(Pack, is_refused_when_cut_short_anywhere) {
    const std::string bytes = write(full());
    for (std::size_t size = 0; size < bytes.size(); size += size < 64 ? 1 : 997) {
        EXPECT_THAT(error_of(read_text(bytes.substr(0, size))), AllOf(StartsWith("twin.talus is "), HasSubstr(" ")))
            << size;
    }
}

TEST(Pack, content_is_refused_when_cut_short_anywhere) {
    const std::string content = write_content(full());
    for (std::size_t size = 0; size < content.size(); size += size < 4000 ? 7 : 997) {
        EXPECT_THAT(error_of(read_content(std::string_view(content).substr(0, size), "twin.talus")),
                    StartsWith("twin.talus is damaged"))
            << size;
    }
}

TEST(Pack, is_refused_when_a_byte_is_flipped) {
    const std::string bytes = write(full());
    for (std::size_t at = 0; at < bytes.size(); at += at < 64 ? 1 : 1009) {
        std::string flipped = bytes;
        flipped[at] = static_cast<char>(flipped[at] ^ 0x41);
        EXPECT_THAT(error_of(read_text(flipped)), StartsWith("twin.talus is ")) << at;
    }
}

/// With a hash that is right: what an attacker sends.
TEST(Pack, survives_any_byte_behind_a_right_hash) {
    const std::string bytes = write(full());
    for (std::size_t at = 20; at + 8 < bytes.size(); at += 211) {
        std::string flipped = bytes;
        flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
        const auto packed = read_text(with_hash(flipped));
        if (!packed) {
            EXPECT_THAT(packed.error().message, StartsWith("twin.talus "));
        }
    }
}

TEST(Pack, names_both_versions) {
    std::string bytes = write(full());
    bytes[8] = 99;
    EXPECT_EQ(error_of(read_text(bytes)),
              "twin.talus is of version 99 of packed scenes, and this program reads version "
              "3: publish the scene again");
}

TEST(Pack, refuses_claims_of_size_before_it_allocates) {
    std::string bytes = write(full());
    const std::uint64_t huge = std::numeric_limits<std::uint64_t>::max();
    std::memcpy(bytes.data() + 12, &huge, sizeof huge);
    EXPECT_THAT(error_of(read_text(with_hash(bytes))), HasSubstr("may have 256 MB"));
    // A list of 2^40 elements, a text of as many bytes.
    const std::string list("\x9b\0\0\1\0\0\0\0\0", 9), text("\x7b\0\0\1\0\0\0\0\0", 9);
    EXPECT_THAT(error_of(read_content(list, "twin.talus")), StartsWith("twin.talus is damaged"));
    EXPECT_THAT(error_of(read_content(text, "twin.talus")), StartsWith("twin.talus is damaged"));
}

TEST(Pack, is_no_other_file) {
    EXPECT_EQ(error_of(read_text("<html>")), "twin.talus is not a packed scene");
    EXPECT_THAT(error_of(read_text("")), StartsWith("twin.talus is cut short"));
}

TEST(Pack, refuses_values_out_of_range_by_key) {
    Packed packed = full();
    packed.scene.spec.material.friction_coefficient = -1;
    EXPECT_THAT(error_of(read_text(write(packed))), HasSubstr("material.friction_coefficient = -1 is refused; it"));
}

TEST(Pack, refuses_parts_that_do_not_fit_together) {
    Packed packed = full();
    packed.scene.barrier_sections.front() = 7;
    EXPECT_THAT(error_of(read_text(write(packed))), HasSubstr("a barrier has no section"));
    packed = full();
    packed.scene.releases.clear();
    EXPECT_THAT(error_of(read_text(write(packed))), HasSubstr("entries of release"));
    packed = full();
    packed.scene.releases.front().volume = std::numeric_limits<double>::infinity();
    EXPECT_THAT(error_of(read_text(write(packed))), HasSubstr("release[0] has no volume"));
    packed = full();
    packed.scene.buildings.front().footprint.front().outer.resize(2);
    EXPECT_THAT(error_of(read_text(write(packed))), HasSubstr("building[0] has no shape"));
    packed = full();
    packed.recording.back().time = -5;
    EXPECT_THAT(error_of(read_text(write(packed))), HasSubstr("goes back in time"));
}

TEST(Pack, refuses_a_scene_that_a_page_cannot_hold) {
    Packed packed = full();
    EXPECT_TRUE(check_size(packed));
    packed.scene.spec.solver.particle_spacing = 0.02;
    packed.scene.spec.solver.target_particle_count.reset();
    packed.scene.spec.solver.target_layers.reset();
    packed.scene.spec.outputs.map_cell = 1;
    EXPECT_THAT(check_size(packed).error().message, HasSubstr("a page has memory for 100000"));
    packed.scene.spec.outputs.map_cell = 0.001;
    EXPECT_THAT(check_size(packed).error().message, HasSubstr("outputs.map_cell_m makes fewer"));
}

TEST(Inflate, reads_all_kinds_of_blocks) {
    const auto read = [](std::string_view stream, std::size_t size) {
        return inflate(std::as_bytes(std::span(stream.data(), stream.size())), size);
    };
    using namespace std::string_view_literals;
    // Made with zlib at level 0, with a fixed code, and of nothing.
    EXPECT_EQ(*read("\x78\x01\x01\x05\x00\xfa\xff\x68\x65\x6c\x6c\x6f\x06\x2c\x02\x15"sv, 5), "hello");
    EXPECT_EQ(*read("\x78\x9c\xcb\x48\xcd\xc9\xc9\x07\x00\x06\x2c\x02\x15"sv, 5), "hello");
    EXPECT_EQ(*read("\x78\x9c\x03\x00\x00\x00\x00\x01"sv, 0), "");
    EXPECT_EQ(read("\x78\x9c\xcb\x48\xcd\xc9\xc9\x07\x00\x06\x2c\x02\x15"sv, 4).error().message,
              "is damaged: its compressed data make no sense");
    EXPECT_EQ(read("\x78\x9c\xcb\x48\xcd\xc9\xc9"sv, 5).error().message, "is cut short");
    EXPECT_FALSE(read("\x78\x9c\xcb\x48\xcd\xc9\xc9\x07\x00\x06\x2c\x02\x16"sv, 5)) << "its sum is another";
}

}  // namespace
}  // namespace talus::pack
