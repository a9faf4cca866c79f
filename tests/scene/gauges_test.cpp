#include <gmock/gmock.h>

#include "scene/scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::HasSubstr;

class GaugesOfScene : public SceneFolder {
  protected:
    [[nodiscard]] std::string error_of(const std::string& gauge) const {
        write_valley("[[gauge]]\n" + gauge + "\n");
        return load_error();
    }
};

TEST_F(GaugesOfScene, stand_at_places_and_chainages) {
    write_valley(fmt::format("[[gauge]]\nname = \"mill\"\nx_m = {}\ny_m = {}\n[[gauge]]\nchainage_m = 30\n", west + 50,
                             south + 60));
    const Scene scene = loaded();
    ASSERT_EQ(scene.gauges.size(), 2U);
    EXPECT_EQ(scene.gauges[0].name, "mill");
    EXPECT_EQ(scene.gauges[0].at.y, south + 60);
    EXPECT_EQ(scene.gauges[1].name, "gauge 2");
    const PlanPoint on_path = scene.flow_path.point_at(30);
    EXPECT_EQ(scene.gauges[1].at.x, on_path.x);
    EXPECT_FALSE(follows_debris(scene)) << "the chainage is along the traced path";
}

TEST_F(GaugesOfScene, are_refused_where_they_cannot_stand) {
    EXPECT_THAT(error_of("name = \"mill\""), HasSubstr("exactly one of x_m, chainage_m must be given"));
    EXPECT_THAT(error_of("x_m = 824050"), HasSubstr("gauge[0].y_m: missing; x_m needs it"));
    EXPECT_THAT(error_of("chainage_m = 20\ny_m = 825050"), HasSubstr("gauge[0].y_m: is refused without x_m"));
    EXPECT_THAT(error_of("x_m = 0\ny_m = 0"), HasSubstr("gauge[0].x_m: (0.0, 0.0) is not on the terrain"));
    EXPECT_THAT(error_of("chainage_m = 5000"), HasSubstr("gauge[0].chainage_m = 5000 lies beyond the flow path"));
    EXPECT_THAT(error_of("name = \"a\"\nchainage_m = 20\n[[gauge]]\nname = \"a\"\nchainage_m = 30"),
                HasSubstr("gauge[1].name = \"a\" is the name of another gauge too"));
}

}  // namespace
}  // namespace talus::scene
