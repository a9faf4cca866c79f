#include "scene/output_defaults.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class GeoidOfAScene : public SceneFolder {
  protected:
    [[nodiscard]] Scene loaded(const std::string& outputs) const {
        write_valley("[outputs]\n" + outputs);
        return SceneFolder::loaded();
    }
};

TEST_F(GeoidOfAScene, is_looked_up_or_missed_where_outputs_need_it) {
    const Scene scene = loaded("series = [\"3dtiles\"]\n");
    EXPECT_THAT(scene.notes, Contains(StartsWith("3dtiles: ")));
    if (scene.spec.outputs.geoid_height) {
        // EGM96 and EGM2008 differ by less than a metre: about -2.7 m in Hong Kong.
        EXPECT_NEAR(*scene.spec.outputs.geoid_height, -2.7, 1.0);
        EXPECT_THAT(scene.notes, Contains(HasSubstr(" by EGM")));
    } else {
        EXPECT_THAT(scene.notes, Contains(HasSubstr("set outputs.geoid_height_m")));
    }
}

TEST_F(GeoidOfAScene, is_the_one_that_it_gives) {
    const Scene scene = loaded("series = [\"3dtiles\"]\ngeoid_height_m = -1.5\n");
    EXPECT_EQ(scene.spec.outputs.geoid_height, -1.5);
    EXPECT_THAT(scene.notes, Not(Contains(StartsWith("3dtiles: "))));
}

TEST_F(GeoidOfAScene, is_not_spoken_of_where_no_output_needs_it) {
    const Scene scene = loaded("series = [\"gltf\"]\n");
    EXPECT_FALSE(scene.spec.outputs.geoid_height);
    EXPECT_THAT(scene.notes, Not(Contains(StartsWith("3dtiles: "))));
}

}  // namespace
}  // namespace talus::scene
