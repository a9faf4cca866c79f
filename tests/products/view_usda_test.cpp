#include "products/usda_reader.hpp"
#include "products/view_fixture.hpp"

namespace talus::products {
namespace {

using test::UsdaReader;

class UsdaOfARun : public ViewOfARun {
  protected:
    UsdaReader read(bool with_particles = true) {
        const Status status = write({"usd"}, with_particles);
        EXPECT_TRUE(status.ok()) << status.error().message;
        return UsdaReader(test::read_text(file("run.usda")));
    }
};

TEST_F(UsdaOfARun, is_in_metres_with_z_up_and_states_its_shift) {
    scene.spec.scene.title = "A \"quoted\" title,\nof two lines";
    const UsdaReader usd = read();
    auto layer = usd.layer_metadata;
    EXPECT_EQ(layer["upAxis"].text, "Z");
    EXPECT_EQ(layer["metersPerUnit"].number(), 1);
    EXPECT_EQ(layer["defaultPrim"].text, "Run");
    EXPECT_EQ(layer["endTimeCode"].number() / layer["timeCodesPerSecond"].number(), 2.5);
    EXPECT_EQ(layer["comment"].text, "A \"quoted\" title, of two lines (reconstruction)");
    EXPECT_NEAR(layer["customLayerData.origin_m"].entries.at(1).number(), scene.terrain.frame().origin.y, 1e-3);
    EXPECT_EQ(layer["customLayerData.reference_system"].text, scene.crs.label());
}

TEST_F(UsdaOfARun, has_every_house_by_its_name) {
    scene.buildings[1].name = "21 A/ü";
    scene.buildings[2].name = "House 38";
    const UsdaReader usd = read();
    auto all = usd.attributes;
    EXPECT_EQ(usd.types.at("/Run/Structures/House_38"), "Mesh");
    EXPECT_EQ(all["/Run/Structures/_21_A___.talus:name"].text, "21 A/ü");
    EXPECT_EQ(all["/Run/Structures/House_38_2.talus:name"].text, "House 38") << "prims of one name";
    EXPECT_EQ(all["/Run/Structures/House_38.talus:hit"].number(), 1);
    EXPECT_NEAR(all["/Run/Structures/House_38.talus:peak_impact_pressure_kPa"].number(), 38.4, 1e-6);
}

TEST_F(UsdaOfARun, meshes_name_their_own_points) {
    const UsdaReader usd = read();
    auto all = usd.attributes;
    for (const auto& [path, kind] : usd.types) {
        if (kind != "Mesh") continue;
        const auto& counts = all[path + ".faceVertexCounts"].entries;
        const auto& corners = all[path + ".faceVertexIndices"].entries;
        const double points = static_cast<double>(all[path + ".points"].entries.size());
        EXPECT_EQ(3 * counts.size(), corners.size()) << path;
        EXPECT_FALSE(counts.empty()) << path;
        for (const auto& count : counts) ASSERT_EQ(count.number(), 3);
        for (const auto& corner : corners) ASSERT_LT(corner.number(), points);
    }
}

TEST_F(UsdaOfARun, has_the_particles_over_time_in_the_order_of_their_numbers) {
    const UsdaReader usd = read();
    auto all = usd.attributes;
    const auto& points = all["/Run/Debris.points"].samples;
    std::vector<double> sampled;
    for (const auto& [time, sample] : points) sampled.push_back(time / 24);
    EXPECT_EQ(sampled, (std::vector<double>{0, 1, 2.5}));
    const auto& last = points.rbegin()->second.entries;
    ASSERT_EQ(last.size(), 4U);
    const auto& ids = all["/Run/Debris.ids"].samples.rbegin()->second.entries;
    EXPECT_EQ(ids[0].number(), 1);
    EXPECT_EQ(ids[3].number(), 9);
    EXPECT_NEAR(last[0].entries[0].number(), 3, 1e-9) << "particle 1 is the fourth of the state";
    EXPECT_NEAR(last[0].entries[2].number(), 23.13, 1e-9);
    EXPECT_EQ(usd.types.at("/Run/Debris.points"), "point3f[]");
    const auto& colours = all["/Run/Debris.primvars:displayColor"].samples.rbegin()->second.entries;
    ASSERT_EQ(colours.size(), 4U);
    EXPECT_GT(colours[1].entries[1].number(), colours[0].entries[1].number()) << "faster is darker";
}

TEST_F(UsdaOfARun, of_the_grid_has_points_on_the_surface) {
    const UsdaReader usd = read(false);
    auto all = usd.attributes;
    const auto& points = all["/Run/Debris.points"].samples;
    EXPECT_EQ(points.at(0).entries.size(), 16U);
    EXPECT_EQ(points.at(60).entries.size(), 64U);
    EXPECT_EQ(usd.types.count("/Run/Debris.ids"), 0U);
}

TEST(UsdaReader, is_strict) {
    EXPECT_NO_THROW(UsdaReader("#usda 1.0\ndef Mesh \"A\"\n{\n    int[] a = [1, 2]\n}\n"));
    for (const char* bad :
         {"#usda 1.0\ndef Mesh \"A\"\n{\n    int[] a = [1 2]\n}\n", "def Mesh \"A\" {}", "#usda 1.0\ndef Mesh \"A\" {",
          "#usda 1.0\ndef Mesh \"A\" { int a = nan }", "#usda 1.0\ndef Mesh \"A\" {}\ndef Mesh \"A\" {}"}) {
        EXPECT_ANY_THROW((void)UsdaReader(bad)) << bad;
    }
}

}  // namespace
}  // namespace talus::products
