#include <gmock/gmock.h>

#include "scene/scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::HasSubstr;

class ZoomOfScene : public SceneFolder {
  protected:
    /// A scene with a dam 150 m down the valley, and these keys of [zoom].
    void write_zoom(const std::string& keys, const std::string& more = "") const {
        write_valley(
            fmt::format("[[barrier]]\nname = \"dam\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nheight_m = 5\n{3}\n"
                        "[zoom]\n{4}\n",
                        west + 150, south + 60, south + 140, more, keys));
    }
    [[nodiscard]] std::string error_of(const std::string& keys, const std::string& more = "") const {
        write_zoom(keys, more);
        return load_error();
    }
};

TEST_F(ZoomOfScene, is_the_rectangle_around_a_structure) {
    write_zoom("structure = \"dam\"\nmargin_m = 10");
    const auto scene = loaded();
    ASSERT_TRUE(scene.zoom);
    const Extent e = extent_of(*scene.zoom);
    EXPECT_NEAR(e.x_min, west + 150 - 0.5 - 10, 1e-6);
    EXPECT_NEAR(e.y_max, south + 140 + 10, 0.6);
}

TEST_F(ZoomOfScene, is_a_polygon_here_or_in_a_file) {
    write_features("area.geojson", {rectangle(100, 60, 160, 140)});
    write_zoom("polygon_file = \"area.geojson\"");
    const auto from_file = loaded();
    ASSERT_TRUE(from_file.zoom);
    EXPECT_NEAR(plan_area(*from_file.zoom), 60 * 80, 1e-3);
    // What is set in place of it replaces it.
    const auto set = loaded({fmt::format("zoom.polygon_m=[[{0}, {2}], [{1}, {2}], [{1}, {3}]]", west + 100, west + 160,
                                         south + 60, south + 140)});
    EXPECT_NEAR(plan_area(*set.zoom), 60 * 80 / 2.0, 1e-3);
    EXPECT_FALSE(loaded({"zoom.polygon_file=none"}).zoom);
    EXPECT_TRUE(loaded({"zoom.structure=dam"}).zoom);
}

TEST_F(ZoomOfScene, is_refused_where_it_cannot_be) {
    EXPECT_THAT(error_of("structure = \"dan\""),
                HasSubstr("zoom.structure = \"dan\" is no building and no barrier of the "
                          "scene; nearest name: dam"));
    EXPECT_THAT(error_of("structure = \"dam\"\nmargin_m = 500"), HasSubstr("release \"scarp\" lies in the area"));
    EXPECT_THAT(error_of("structure = \"dam\"\nmargin_m = 60"), Not(HasSubstr("lies in the area")));
    EXPECT_THAT(error_of("polygon_m = [[0, 0], [10, 0], [10, 10]]"), HasSubstr("where the ground is not known"));
    EXPECT_THAT(error_of("polygon_m = [[0, 0], [10, 0]]"), HasSubstr("zoom.polygon_m: has 2 corners"));
    const auto over_release = fmt::format("polygon_m = [[{0}, {2}], [{1}, {2}], [{1}, {3}], [{0}, {3}]]", west + 30,
                                          west + 80, south + 80, south + 120);
    EXPECT_THAT(error_of(over_release), HasSubstr("release \"scarp\" lies in the area of the zoom"));
    EXPECT_THAT(error_of("structure = \"dam\"", "[[bed]]\ndepth_m = 1\ngrowth_rate_per_m = 0.01"),
                HasSubstr("a zoom is refused where debris entrains its bed"));
    EXPECT_THAT(error_of("structure = \"dam\"", "passing_share = 0.5"),
                HasSubstr("has no nets, and \"dam\" is one; remove it, or leave out the zoom"));
    write_zoom("structure = \"dam\"");
    const auto evolving =
        load_scene(folder / "scene.toml", {"material.pore_pressure=dilatancy", "material.permeability_m2=1e-11",
                                           "material.solid_fraction=0.6", "material.critical_solid_fraction=0.62",
                                           "material.grain_density_kgpm3=2650", "material.rest_density_kgpm3=2030"});
    ASSERT_FALSE(evolving);
    EXPECT_THAT(evolving.error().message, HasSubstr("a zoom is refused beside material.pore_pressure"));
}

TEST_F(ZoomOfScene, has_rules_between_its_keys) {
    EXPECT_THAT(error_of("margin_m = 10"), HasSubstr("zoom.margin_m: needs structure"));
    EXPECT_THAT(error_of("target_layers = 4"), HasSubstr("zoom.target_layers: needs an area"));
    EXPECT_THAT(error_of("structure = \"dam\"\ntarget_layers = 4\nparticle_spacing_m = 0.2"),
                HasSubstr("at most one of particle_spacing_m, target_layers may be given"));
    EXPECT_THAT(error_of("structure = \"dam\"\npolygon_file = \"release.geojson\""),
                HasSubstr("at most one of structure, polygon_m, polygon_file may be given"));
}

TEST_F(ZoomOfScene, is_named_in_a_note_where_it_is_not_used) {
    write_zoom("structure = \"dam\"");
    const auto grid = loaded({"solver.model=depth_averaged"});
    EXPECT_FALSE(grid.zoom);
    EXPECT_THAT(grid.notes, testing::Contains(HasSubstr("not use zoom.structure")));
    auto scene = loaded();
    leave_out_zoom(scene, "the live twin");
    EXPECT_FALSE(scene.zoom);
    EXPECT_THAT(scene.notes.back(), HasSubstr("the live twin runs the whole event"));
}

}  // namespace
}  // namespace talus::scene
