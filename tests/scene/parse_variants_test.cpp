#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "params/scene_text.hpp"
#include "scene/scene.hpp"
#include "scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::HasSubstr;

class ParseVariants : public SceneFolder {
  protected:
    /// Of a scene with `text` from its line 6 on.
    [[nodiscard]] Result<params::SceneSpec> parsed(const std::string& text,
                                                   const std::vector<std::string>& overrides = {}) {
        write("scene.toml",
              "[terrain]\nfile = \"dem.tif\"\n[[release]]\nfile = \"release.geojson\"\nthickness_m = 2\n" + text);
        return parse_scene(path("scene.toml"), overrides);
    }
    [[nodiscard]] std::string error_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
        const auto spec = parsed(text, overrides);
        return spec ? "(it parsed)" : spec.error().message;
    }
    static constexpr const char* two = R"([[variant]]
name = "wet"
set = ["material.friction_coefficient=0.1", "release.thickness_m=none", "release.volume_m3=50"]
[[variant]]
name = "dry"
set = ["material.friction_coefficient=0.5"]
)";
};

TEST_F(ParseVariants, change_nothing_until_they_are_taken) {
    const auto given = parsed(two);
    ASSERT_TRUE(given) << given.error().message;
    EXPECT_EQ(given->variants.size(), 2U);
    EXPECT_EQ(given->material.friction_coefficient, params::MaterialSpec{}.friction_coefficient);
    const auto wet = parsed(two, {"variant=wet"});
    ASSERT_TRUE(wet) << wet.error().message;
    EXPECT_EQ(wet->material.friction_coefficient, 0.1);
    EXPECT_EQ(wet->releases[0].volume, 50);
    EXPECT_FALSE(wet->releases[0].thickness);
}

TEST_F(ParseVariants, come_in_the_order_of_overrides) {
    EXPECT_EQ(parsed(two, {"variant=wet", "material.friction_coefficient=0.2"})->material.friction_coefficient, 0.2);
    EXPECT_EQ(parsed(two, {"material.friction_coefficient=0.2", "variant=wet"})->material.friction_coefficient, 0.1);
    EXPECT_EQ(parsed(two, {"variant=wet", "variant=dry"})->releases[0].volume, 50);
}

TEST_F(ParseVariants, are_refused_with_their_line_also_where_they_are_not_taken) {
    const auto of = [&](const std::string& setting) {
        return error_of("[[variant]]\nname = \"wet\"\nset = [\"" + setting + "\"]\n");
    };
    EXPECT_THAT(of("material.friction=0.1"),
                HasSubstr("scene.toml:8: variant[0].set \"wet\": unknown key \"friction\""));
    EXPECT_THAT(of("material.viscosity=2"), HasSubstr("material.viscosity = 2 is refused; it must be"));
    EXPECT_THAT(of("variant=dry"), HasSubstr("must read section.key=value"));
    EXPECT_THAT(error_of("[[variant]]\nset = []\n"), HasSubstr("variant[0].name is missing"));
    EXPECT_THAT(error_of("[[variant]]\nname = \"wet\"\n"), HasSubstr("variant[0].set is missing"));
    EXPECT_THAT(error_of(std::string(two) + two),
                HasSubstr("variant[0].name = \"wet\" is refused; 2 variants have that name"));
}

TEST_F(ParseVariants, are_written_with_the_scene) {
    const auto given = parsed(two);
    ASSERT_TRUE(given) << given.error().message;
    write("scene.toml", write_scene(*given));
    const auto again = parse_scene(path("scene.toml"), {"variant=wet"});
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->releases[0].volume, 50);
}

}  // namespace
}  // namespace talus::scene
