#include <cmath>

#include <gmock/gmock.h>

#include "scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::StartsWith;

class Zones : public SceneFolder {
  protected:
    Scene loaded(const std::string& zones) {
        write_valley(zones);
        return SceneFolder::loaded();
    }
    /// What holds at a place relative to the terrain's south-west corner.
    static auto at(const Scene& scene, double x, double y) {
        return scene.cover.at(x - columns * cell / 2, y - rows * cell / 2);
    }
    std::string refusal(const std::string& zones) {
        write_valley(zones);
        return load_error();
    }
};

TEST_F(Zones, a_scene_without_any_has_no_cover) {
    write_valley();
    EXPECT_TRUE(load_scene(folder / "scene.toml")->cover.empty());
}

TEST_F(Zones, a_polygon_holds_on_the_cells_whose_centres_it_covers) {
    const Scene scene = loaded(
        "[[zone]]\nname = \"fan\"\npolygon = \"824100 825050, 824150 825050, 824150 825100, 824100 825100\"\n"
        "friction_coefficient = 0.7\nturbulent_friction_mps2 = 250\n");
    EXPECT_THAT(scene.notes, Contains(HasSubstr("zone \"fan\": 100 cells of the terrain, 2500 m2")));
    EXPECT_FLOAT_EQ(static_cast<float>(at(scene, 102, 52).x), 0.7F);
    EXPECT_FLOAT_EQ(static_cast<float>(at(scene, 148, 98).y), 1.0F / 250);
    EXPECT_TRUE(std::isnan(at(scene, 148, 98).z)) << "cohesion as elsewhere";
    for (const auto& [x, y] : {std::pair{98, 52}, {152, 52}, {102, 48}, {102, 102}}) {
        EXPECT_TRUE(std::isnan(at(scene, x, y).x)) << x << ", " << y;
    }
}

TEST_F(Zones, a_laminar_viscosity_is_that_of_the_ground) {
    const Scene scene = loaded(
        "[[zone]]\npolygon = \"824100 825050, 824150 825050, 824150 825100, 824100 825100\"\n"
        "laminar_viscosity_m2ps = 0.07\n");
    ASSERT_TRUE(scene.cover.has_viscosities());
    const auto viscosity = [&](double x, double y) {
        return scene.cover.viscosity_at(x - columns * cell / 2, y - rows * cell / 2);
    };
    EXPECT_FLOAT_EQ(static_cast<float>(viscosity(120, 70)), 0.07F);
    EXPECT_TRUE(std::isnan(viscosity(160, 70)));
}

TEST_F(Zones, viscosity_is_given_once_only) {
    EXPECT_THAT(refusal("[material]\nlaminar_viscosity_m2ps = 0.04\nlaminar_viscosity_Pas = 80\n"),
                HasSubstr("leave one of them out"));
    EXPECT_THAT(refusal("[material]\nlaminar_viscosity_m2ps = 0.04\nviscosity_on_ground = true\n"),
                HasSubstr("viscosity_on_ground = true is refused"));
    EXPECT_THAT(refusal("[material]\nviscosity_on_ground = true\n[[zone]]\nlaminar_viscosity_m2ps = 0.04\npolygon = "
                        "\"824100 825050, 824150 825050, 824150 825100\"\n"),
                HasSubstr("zone[0].laminar_viscosity_m2ps = 0.04 is refused"));
}

TEST_F(Zones, samosat_has_no_other_drag_beside_it) {
    const std::string snow = "[material]\nsamosat = true\n", zone =
                                                                 "[[zone]]\npolygon = \"824100 825050, 824150 825050, "
                                                                 "824150 825100\"\n";
    loaded(snow + "samosat_roughness_m = 0.1\ncohesion_Pa = 20\n" + zone + "friction_coefficient = 0.2\n");
    for (const char* other : {"turbulent_friction_mps2 = 1000", "laminar_viscosity_m2ps = 0.1",
                              "laminar_viscosity_Pas = 100", "viscosity_on_ground = true"}) {
        const std::string key(other, std::string(other).find(' '));
        EXPECT_THAT(refusal(snow + other + "\n"),
                    HasSubstr("material." + key + ": is given beside material.samosat = true"));
    }
    EXPECT_THAT(refusal(snow + zone + "turbulent_friction_mps2 = 1000\n"),
                HasSubstr("zone[0].turbulent_friction_mps2: is given beside material.samosat = true"));
    EXPECT_THAT(refusal(snow + zone + "laminar_viscosity_m2ps = 0.1\n"),
                HasSubstr("zone[0].laminar_viscosity_m2ps: is given beside material.samosat = true"));
    EXPECT_THAT(refusal(snow + "[[zone]]\nraster = \"xi.tif\"\nraster_holds = \"turbulent_friction_mps2\"\n"),
                HasSubstr("is refused beside material.samosat = true"));
    EXPECT_THAT(refusal("[material]\nsamosat_roughness_m = 0.1\n"),
                HasSubstr("samosat_roughness_m = 0.1 has no effect while samosat = false"));
    EXPECT_THAT(refusal(snow + "samosat_karman = 0\n"), HasSubstr("0.01 to 10"));
}

TEST_F(Zones, later_ones_go_before_earlier_ones_where_they_say_something) {
    write_features("forest.geojson", {rectangle(100, 50, 200, 150)});
    const Scene scene = loaded(
        "[[zone]]\nfile = \"forest.geojson\"\nfriction_coefficient = 0.5\nstem_density_pm2 = 0.08\n"
        "stem_diameter_m = 0.25\nstem_drag_coefficient = 1.5\n"
        "[[zone]]\npolygon = \"824150 825000, 824300 825000, 824300 825200, 824150 825200\"\n"
        "friction_coefficient = 0.2\n");
    EXPECT_FLOAT_EQ(static_cast<float>(at(scene, 120, 100).x), 0.5F);
    EXPECT_FLOAT_EQ(static_cast<float>(at(scene, 180, 100).x), 0.2F);
    EXPECT_FLOAT_EQ(static_cast<float>(at(scene, 180, 100).w), 0.5F * 1.5F * 0.08F * 0.25F) << "the stems stay";
    EXPECT_EQ(at(scene, 250, 100).w, 0);
}

TEST_F(Zones, a_raster_holds_numbers_of_zones_or_the_coefficient_itself) {
    write_terrain("cover.tif", [](double x, double) { return x < west + 150 ? 3.0 : 8.0; });
    const Scene classes = loaded("[[zone]]\nraster = \"cover.tif\"\nraster_value = 3\nfriction_coefficient = 0.9\n");
    EXPECT_FLOAT_EQ(static_cast<float>(at(classes, 100, 100).x), 0.9F);
    EXPECT_TRUE(std::isnan(at(classes, 200, 100).x));
    const Scene values = loaded("[[zone]]\nraster = \"cover.tif\"\nraster_holds = \"friction_coefficient\"\n");
    EXPECT_EQ(at(values, 100, 100).x, 3);
    EXPECT_EQ(at(values, 200, 100).x, 8);
    write_terrain("cover.tif", [](double x, double) { return x < west + 150 ? 3.0 : 80.0; });
    EXPECT_THAT(refusal("[[zone]]\nraster = \"cover.tif\"\nraster_holds = \"friction_coefficient\"\n"),
                AllOf(HasSubstr("zone[0].raster"), HasSubstr("holds 80"), HasSubstr("from 0 to 10")));
}

TEST_F(Zones, what_cannot_be_used_is_refused_with_its_place) {
    EXPECT_THAT(refusal("[[zone]]\npolygon = \"824100 825050, 824150\"\nfriction_coefficient = 1\n"),
                AllOf(HasSubstr("scene.toml:8"), HasSubstr("zone[0].polygon"), HasSubstr("three corners")));
    EXPECT_THAT(refusal("[[zone]]\npolygon = \"0 0, 1 0, 1 1\"\nfriction_coefficient = 1\n"),
                HasSubstr("covers the centre of no cell"));
    EXPECT_THAT(refusal("[[zone]]\nfriction_coefficient = 1\n"), HasSubstr("exactly one of file, polygon, raster"));
    EXPECT_THAT(refusal("[[zone]]\npolygon = \"0 0, 1 0, 1 1\"\nraster = \"a.tif\"\nfriction_coefficient = 1\n"),
                HasSubstr("given are polygon, raster"));
    EXPECT_THAT(refusal("[[zone]]\npolygon = \"0 0, 1 0, 1 1\"\n"), HasSubstr("the zone says nothing"));
    EXPECT_THAT(refusal("[[zone]]\npolygon = \"0 0, 1 0, 1 1\"\nfriction_coefficient = 11\n"),
                HasSubstr("from 0 to 10"));
}

TEST_F(Zones, a_material_that_friction_by_pairs_cannot_follow_is_refused) {
    const std::string pair = "[solver]\ninternal_friction = \"pair\"\n";
    for (const std::string key :
         {"cohesion_Pa = 10", "pore_pressure_ratio = 0.5", "inertial_friction_coefficient = 1"}) {
        EXPECT_THAT(refusal("[material]\n" + key + "\n" + pair), HasSubstr("solver.internal_friction = \"stress\""));
    }
    EXPECT_THAT(refusal("[material]\ninertial_friction_coefficient = 0.3\n"), HasSubstr("at least"));
    write_valley(pair, "thickness_m = 2\npore_pressure_ratio = 0.5");
    EXPECT_THAT(load_error(), HasSubstr("release[0].pore_pressure_ratio"));
    EXPECT_EQ(refusal("[material]\nturbulent_friction_mps2 = 500\n" + pair), "(it loaded)");
}

}  // namespace
}  // namespace talus::scene
