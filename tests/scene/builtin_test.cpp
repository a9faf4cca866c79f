#include "scene/builtin.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <unistd.h>

#include <gtest/gtest.h>

#include "scene/scene.hpp"

namespace talus::scene {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

class BuiltinScene : public testing::Test {
  protected:
    BuiltinScene() : folder_(fs::path(testing::TempDir()) / ("builtin-" + std::to_string(getpid()))) {}
    ~BuiltinScene() override { fs::remove_all(folder_); }
    fs::path folder_;
};

TEST_F(BuiltinScene, unpacks_the_files_of_the_sources_byte_for_byte) {
    const auto scene_file = unpack_builtin_scene(folder_);
    ASSERT_TRUE(scene_file) << scene_file.error().message;
    EXPECT_EQ(*scene_file, folder_ / "scene.toml");
    const fs::path sources = fs::path(TALUS_SOURCE_DIR) / "scenes" / builtin_scene_name;
    int count = 0;
    for (const auto& entry : fs::directory_iterator(folder_)) {
        EXPECT_EQ(bytes_of(entry.path()), bytes_of(sources / entry.path().filename())) << entry.path();
        ++count;
    }
    EXPECT_GE(count, 3) << "a scene file, a terrain and a release at least";
}

TEST_F(BuiltinScene, loads_away_from_the_sources) {
    const auto scene_file = unpack_builtin_scene(folder_);
    ASSERT_TRUE(scene_file) << scene_file.error().message;
    const auto scene = load_scene(*scene_file);
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_TRUE(scene->spec.scene.reconstruction);
    EXPECT_NEAR(scene->releases.at(0).volume, 600, 6);
}

TEST_F(BuiltinScene, names_the_folder_it_cannot_make) {
    const auto below_a_file = fs::path("/dev/null") / "folder";
    const auto scene_file = unpack_builtin_scene(below_a_file);
    ASSERT_FALSE(scene_file);
    EXPECT_NE(scene_file.error().message.find("/dev/null/folder"), std::string::npos) << scene_file.error().message;
}

}  // namespace
}  // namespace talus::scene
