#include "products/particle_series.hpp"

#include <cstdint>
#include <cstring>
#include <regex>

#include <cpl_minixml.h>
#include <gtest/gtest.h>

#include "support/fixtures.hpp"
#include "terrain/terrain.hpp"

namespace talus::products {
namespace {

using test::TemporaryFolder;

LocalFrame far_frame() {
    return terrain::Terrain(Grid<float>({824000, 825000, 2, 50, 40}, 100)).frame();
}

sim::State three_particles() {
    sim::State state;
    state.time = 2.5;
    state.count = 3;
    for (sim::VectorArray* array : {&state.position, &state.velocity}) array->resize(4);  // one more than count
    state.id = {7, 4, 9, 1};
    state.held = {0, 1, 0, 0};
    for (std::size_t i = 0; i < 4; ++i) {
        const auto f = static_cast<float>(i);
        state.position.set(i, {f, 10 + f, 20 + f});
        state.velocity.set(i, {3 * f, 4 * f, 0});
    }
    return state;
}

/// The array of a name, found by the offset that its element declares.
template <class T>
std::vector<T> array_of(const std::string& file, const std::string& name) {
    std::smatch match;
    const std::regex pattern("Name=\"" + name + "\" NumberOfComponents=\"\\d+\" format=\"appended\" offset=\"(\\d+)\"");
    if (!std::regex_search(file, match, pattern)) return {};
    const std::size_t start = file.find("<AppendedData encoding=\"raw\">\n_") + 31 + std::stoul(match[1]);
    std::uint64_t bytes = 0;
    if (start + 8 > file.size()) return {};
    std::memcpy(&bytes, file.data() + start, 8);
    std::vector<T> values(bytes / sizeof(T));
    if (start + 8 + bytes > file.size()) return {};
    std::memcpy(values.data(), file.data() + start + 8, bytes);
    return values;
}

bool is_xml(const std::string& text) {
    CPLXMLNode* tree = CPLParseXMLString(text.c_str());
    const bool parsed = tree != nullptr;
    CPLDestroyXMLNode(tree);
    return parsed;
}

TEST(ParticleSeries, frames_hold_every_particle_at_the_declared_offsets) {
    const TemporaryFolder folder;
    ParticleSeries series(folder.path() / "particles");
    const LocalFrame frame = far_frame();
    ASSERT_TRUE(series.write_frame(frame, three_particles()).ok());

    const std::string file = test::read_text(folder.path() / "particles" / "particles_000000.vtp");
    EXPECT_EQ(array_of<float>(file, "position"), (std::vector<float>{0, 10, 20, 1, 11, 21, 2, 12, 22}));
    EXPECT_EQ(array_of<float>(file, "velocity_mps"), (std::vector<float>{0, 0, 0, 3, 4, 0, 6, 8, 0}));
    EXPECT_EQ(array_of<float>(file, "speed_mps"), (std::vector<float>{0, 5, 10}));
    EXPECT_EQ(array_of<std::uint32_t>(file, "id"), (std::vector<std::uint32_t>{7, 4, 9}));
    EXPECT_EQ(array_of<std::uint8_t>(file, "held"), (std::vector<std::uint8_t>{0, 1, 0}));
    EXPECT_EQ(array_of<std::int64_t>(file, "connectivity"), (std::vector<std::int64_t>{0, 1, 2}));
    EXPECT_EQ(array_of<std::int64_t>(file, "offsets"), (std::vector<std::int64_t>{1, 2, 3}));
    EXPECT_NE(file.find("NumberOfPoints=\"3\""), std::string::npos);

    const WorldPoint origin = frame.origin;
    std::smatch match;
    ASSERT_TRUE(std::regex_search(file, match, std::regex("Name=\"origin_m\"[^>]*>([0-9.]+) ([0-9.]+) ([0-9.]+)<")));
    EXPECT_DOUBLE_EQ(std::stod(match[1]), origin.x);
    EXPECT_DOUBLE_EQ(std::stod(match[2]), origin.y);
    EXPECT_DOUBLE_EQ(std::stod(match[3]), origin.z);

    // Raw data is no XML; with it cut out, the rest must be.
    const std::size_t start = file.find("\n_") + 2, end = file.find("\n</AppendedData>");
    EXPECT_TRUE(is_xml(file.substr(0, start) + file.substr(end)));
}

TEST(ParticleSeries, collection_lists_the_frames_with_their_times) {
    const TemporaryFolder folder;
    ParticleSeries series(folder.path());
    sim::State state = three_particles();
    ASSERT_TRUE(series.write_frame(far_frame(), state).ok());
    state.time = 3;
    state.count = 0;
    ASSERT_TRUE(series.write_frame(far_frame(), state).ok()) << "all debris may have left";
    ASSERT_TRUE(series.finish().ok());
    const std::string text = test::read_text(folder.path() / "particles.pvd");
    EXPECT_TRUE(is_xml(text));
    EXPECT_NE(text.find(R"(timestep="2.5" group="" part="0" file="particles_000000.vtp")"), std::string::npos);
    EXPECT_NE(text.find(R"(timestep="3" group="" part="0" file="particles_000001.vtp")"), std::string::npos);
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "particles_000001.vtp"));
}

TEST(ParticleSeries, failure_names_the_file) {
    const Status status = ParticleSeries("/proc/talus").write_frame(far_frame(), three_particles());
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().message.rfind("/proc/talus: cannot be made: ", 0), 0U) << status.error().message;
}

}  // namespace
}  // namespace talus::products
