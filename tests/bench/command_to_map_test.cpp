#include "bench/command_to_map.hpp"

#include <gtest/gtest.h>

#include "scene/builtin.hpp"
#include "support/fixtures.hpp"

namespace talus::bench {
namespace {

TEST(CommandToMap, is_the_time_of_everything_but_the_steps) {
    const test::TemporaryFolder folder;
    Calibration calibration;
    const auto measured = measure_command_to_map(*scene::unpack_builtin_scene(folder.path()), 1, calibration);
    ASSERT_TRUE(measured) << measured.error().message;
    EXPECT_GT(measured->seconds, 0.01);  // some ten files and a report
    EXPECT_GT(measured->relative_rate, 0);
    EXPECT_GT(measured->steps_rate, 0);
}

TEST(CommandToMap, says_which_scene_cannot_be_read) {
    Calibration calibration;
    const auto measured = measure_command_to_map("nowhere.toml", 1, calibration);
    ASSERT_FALSE(measured);
    EXPECT_NE(measured.error().message.find("nowhere.toml"), std::string::npos) << measured.error().message;
}

}  // namespace
}  // namespace talus::bench
