#include "scene/options.hpp"

#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class OptionsOfAScene : public SceneFolder {
  protected:
    /// Two houses, two walls of which one is always there, a forest, and three options.
    void write_with(const std::string& more = "") const {
        write_features("houses.geojson", {rectangle(200, 90, 210, 110, "\"name\": \"near\""),
                                          rectangle(200, 170, 210, 180, "\"name\": \"far\"")});
        write_valley(fmt::format("[buildings]\nfile = \"houses.geojson\"\nname_attribute = \"name\"\n"
                                 "[[barrier]]\nname = \"new\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nheight_m = 3\n"
                                 "[[barrier]]\nname = \"old\"\nline_m = [[{3}, {1}], [{3}, {2}]]\nheight_m = 2\n"
                                 "[[barrier_opening]]\nbarrier = \"new\"\nposition_m = 20\nwidth_m = 8\n"
                                 "[[zone]]\nname = \"forest\"\npolygon = \"{0} {1}, {3} {1}, {3} {2}\"\n"
                                 "friction_coefficient = 0.6\n",
                                 west + 120, south + 80, south + 120, west + 160) +
                     option("wall", "barriers = [\"new\"]") + option("trees", "zones = [\"forest\"]") +
                     option("both", "barriers = [\"new\"]\nzones = [\"forest\"]\nremoved_buildings = [\"far\"]") +
                     more);
    }
    static std::string option(const std::string& name, const std::string& measures) {
        return fmt::format(
            "[[option]]\nname = \"{}\"\n{}\ncost = 1\nlife_years = 1\ninterest_rate = 0\n"
            "upkeep_per_year = 0\n",
            name, measures);
    }
    [[nodiscard]] Scene with(const std::string& option) const {
        return loaded({"risk.currency=HKD", "scene.option=" + option});
    }
    static std::vector<std::string> structures(const Scene& scene) {
        std::vector<std::string> names;
        for (const terrain::Building& building : scene.buildings) names.push_back(building.name);
        return names;
    }
};

TEST_F(OptionsOfAScene, are_not_there_unless_chosen) {
    write_with();
    const Scene scene = with("none");
    EXPECT_THAT(structures(scene), ElementsAre("near", "far", "old"));
    EXPECT_THAT(scene.barrier_sections, ElementsAre(0U));
    ASSERT_EQ(scene.spec.barriers.size(), 1U);
    EXPECT_EQ(scene.spec.barriers.front().name, "old");
    EXPECT_TRUE(scene.spec.barrier_openings.empty());
    EXPECT_TRUE(scene.zones.empty());
    EXPECT_TRUE(scene.spec.zones.empty());
}

TEST_F(OptionsOfAScene, put_in_force_what_they_name) {
    write_with();
    const Scene wall = with("wall");
    EXPECT_THAT(structures(wall), ElementsAre("near", "far", "new", "old"));
    EXPECT_EQ(wall.spec.barrier_openings.size(), 1U);
    EXPECT_TRUE(wall.zones.empty());
    EXPECT_EQ(with("trees").zones.size(), 1U);
    const Scene both = with("both");
    EXPECT_THAT(structures(both), ElementsAre("near", "new", "old"));
    EXPECT_THAT(both.barrier_sections, ElementsAre(0U, 1U));
    EXPECT_EQ(both.zones.size(), 1U);
}

TEST_F(OptionsOfAScene, leave_a_scene_without_them_as_it_is) {
    write_valley();
    const Scene scene = loaded();
    for (const std::string& note : scene.notes) EXPECT_EQ(note.find("option"), std::string::npos) << note;
}

TEST_F(OptionsOfAScene, refuse_what_does_not_exist_in_one_sentence) {
    const std::string currency = "[risk]\ncurrency = \"HKD\"\n";
    write_with(currency);
    EXPECT_THAT(load_error({"scene.option=dam"}),
                HasSubstr("scene.option = \"dam\": there is no such option; options of the scene: wall, trees, both"));
    write_with(option("odd", "barriers = [\"dam\"]") + currency);
    EXPECT_THAT(load_error(),
                HasSubstr("option[3].barriers: there is no barrier \"dam\"; barriers of the scene: new, old"));
    write_with(option("odd", "removed_buildings = [\"palace\"]") + currency);
    EXPECT_THAT(load_error(),
                HasSubstr("option[3].removed_buildings: there is no building \"palace\"; buildings: near, far"));
    write_with(option("wall", "barriers = [\"new\"]") + currency);
    EXPECT_THAT(load_error(), HasSubstr("option[0].name = \"wall\" is refused; 2 entries have that name"));
    write_with(option("nothing", "") + currency);
    EXPECT_THAT(load_error(), HasSubstr("option[3].barriers is missing; an option needs barriers, zones or"));
    write_with();
    EXPECT_THAT(load_error(), HasSubstr("risk.currency is missing"));
}

}  // namespace
}  // namespace talus::scene
