#include <gmock/gmock.h>

#include "scene/scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::HasSubstr;

class CrossSections : public SceneFolder {
  protected:
    /// The error where `text` follows the valley.
    [[nodiscard]] std::string error_of(const std::string& text) const {
        write_valley(text);
        return load_error();
    }
    static std::string line(const std::string& name, double x) {
        return fmt::format(R"({{"type": "Feature", "properties": {{"name": {}}}, "geometry": {{"type": "LineString", )"
                           R"("coordinates": [[{}, {}], [{}, {}]]}}}})",
                           name, west + x, south + 50, west + x, south + 150);
    }
};

TEST_F(CrossSections, are_lines_of_the_scene_or_of_a_file) {
    write_features("lines.geojson", {line("\"bridge\"", 100), line("null", 200)});
    write_valley(
        "[[cross_section]]\nline_m = [[824050, 825050], [824060, 825100], [824050, 825150]]\ninterval_s = 0.5\n"
        "[[cross_section]]\nname = \"road\"\nfile = \"lines.geojson\"\n");
    const Scene scene = loaded();
    ASSERT_EQ(scene.cross_sections.size(), 3U);
    EXPECT_EQ(scene.cross_sections[0].name, "section 1");
    EXPECT_EQ(scene.cross_sections[0].line.size(), 3U);
    EXPECT_EQ(scene.cross_sections[0].interval, 0.5);
    EXPECT_EQ(scene.cross_sections[1].name, "bridge");
    EXPECT_EQ(scene.cross_sections[2].name, "road 2");
    EXPECT_EQ(scene.cross_sections[2].line.front().x, west + 200);
}

TEST_F(CrossSections, that_cannot_be_are_refused) {
    EXPECT_THAT(error_of("[[cross_section]]\nname = \"x\"\n"), HasSubstr("line_m"));
    EXPECT_THAT(error_of("[[cross_section]]\nline_m = [[824050, 825050]]\n"), HasSubstr("has 1 places"));
    EXPECT_THAT(error_of("[[cross_section]]\nline_m = [[824050, 825050], [1, 2]]\n"),
                HasSubstr("cross_section[0].line_m: (1.00, 2.00) is not on the terrain"));
    EXPECT_THAT(error_of("[[cross_section]]\nline_m = [[824050, 825050], [824050, 825050]]\n"),
                HasSubstr("twice in a row"));
    const std::string one = "[[cross_section]]\nname = \"bridge\"\nline_m = [[824050, 825050], [824060, 825100]]\n";
    EXPECT_THAT(error_of(one + one), HasSubstr("\"bridge\" is the name of another cross-section too"));
    EXPECT_THAT(error_of("[[cross_section]]\nfile = \"none.geojson\"\n"), HasSubstr("cross_section[0].file: "));
    EXPECT_THAT(error_of(one + "interval_s = 0\n"), HasSubstr("interval_s"));
}

}  // namespace
}  // namespace talus::scene
