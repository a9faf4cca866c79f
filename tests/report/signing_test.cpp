#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/map.hpp"
#include "report/number_text.hpp"
#include "report/report_fixture.hpp"

// What a report says to whoever signs it: title block, assumptions, counts, scale.
namespace talus::report {
namespace {

using test::has;
using test::Sample;
using testing::Contains;
using testing::Not;

std::vector<std::string> keys_of(const report::Json& table) {
    std::vector<std::string> keys;
    for (const auto& row : table["rows"]) keys.push_back(row["key"]);
    return keys;
}

TEST(TitleBlock, is_there_where_the_scene_states_any_of_it_and_escaped) {
    Sample s;
    EXPECT_FALSE(has(s.html(), "class=\"title-block\""));
    const std::string evil = "<script>alert('1')</script>{{title}}\"&";
    s.scene.spec.report = {evil + "client", evil + "author",     evil + "checker", evil + "revision",
                           evil + "no",     evil + "2026-11-23", evil + "limits"};
    const std::string html = s.html();
    EXPECT_TRUE(has(html, "class=\"title-block\""));
    EXPECT_FALSE(has(html, "<script>alert"));
    for (const char* part : {"client", "author", "checker", "revision", "no", "2026-11-23", "limits"}) {
        EXPECT_TRUE(has(html, std::string("{{title}}&quot;&amp;") + part)) << part;
    }
}

TEST(TitleBlock, leaves_out_what_is_not_stated_and_is_part_of_the_results) {
    Sample s;
    s.scene.spec.report.client = "Village of Lower Talus";
    s.scene.spec.report.date = "2026-11-23";
    const std::string html = s.html();
    EXPECT_TRUE(has(html, "<dt>Client</dt><dd>Village of Lower Talus</dd>"));
    EXPECT_TRUE(has(html, "<dt>Date</dt><dd>2026-11-23</dd>"));
    EXPECT_FALSE(has(html, "<dt>Checked by</dt>"));
    EXPECT_FALSE(has(html, "Limits of use."));
    const report::Json head = report::results_head("talus results", s.scene);
    EXPECT_EQ(head["report"]["client"], "Village of Lower Talus");
    EXPECT_TRUE(head["report"]["checker"].is_null());
    EXPECT_TRUE(report::results_head("talus results", Sample().scene)["report"].is_null());
}

TEST(NotSet, lists_defaults_that_carry_the_result_until_the_scene_sets_them) {
    Sample s;
    const auto listed = [&] { return keys_of(report::not_set(s.scene, s.result)["table"]); };
    for (const char* key :
         {"material.friction_coefficient", "material.internal_friction_coefficient", "material.rest_density_kgpm3",
          "material.viscosity", "material.turbulent_friction_mps2", "material.pore_pressure_ratio",
          "buildings.resistance_Pa", "outputs.impact_patch_edge_m", "bed"}) {
        EXPECT_THAT(listed(), Contains(key));
    }
    EXPECT_TRUE(has(s.html(), "Not set in the scene"));
    EXPECT_TRUE(has(s.html(), "<code>material.friction_coefficient</code>"));
    s.scene.given_keys = {"material.friction_coefficient"};  // to what the default is
    EXPECT_THAT(listed(), Not(Contains("material.friction_coefficient")));
    s.scene.spec.material.rest_density = 1900;  // changed while the run went on
    EXPECT_THAT(listed(), Not(Contains("material.rest_density_kgpm3")));
    s.scene.spec.beds.emplace_back();
    EXPECT_THAT(listed(), Not(Contains("bed")));
    EXPECT_THAT(listed(), Contains("bed[0].law"));
    EXPECT_THAT(listed(), Not(Contains("bed[0].erosion_rate_mps"))) << "of the other law";
}

TEST(NotSet, lists_the_thickness_that_follows_from_a_volume) {
    Sample s;
    s.scene.releases[0].spec = s.scene.spec.releases[0];
    const report::Json listed = report::not_set(s.scene, s.result)["table"];
    EXPECT_THAT(keys_of(listed), Contains("release[0].thickness_m"));
    EXPECT_TRUE(has(listed.dump(), "Thickness of head scarp, the same everywhere, from its volume"));
}

TEST(NotSet, leaves_buildings_out_where_none_was_hit) {
    Sample s;
    for (observe::BuildingImpact& b : s.result.observation.buildings) b.hit = false;
    const auto listed = keys_of(report::not_set(s.scene, s.result)["table"]);
    EXPECT_THAT(listed, Not(Contains("buildings.resistance_Pa")));
    EXPECT_THAT(listed, Not(Contains("outputs.impact_patch_edge_m")));
}

TEST(Defaults, are_folded_away_and_counted) {
    Sample s;
    s.scene.given_keys = {"material.viscosity"};
    const report::Json results = report::run_results(s.scene, s.result, {});
    const auto set = keys_of(results["parameters"]), folded = keys_of(results["defaults"]["table"]);
    EXPECT_THAT(set, Contains("viscosity"));
    EXPECT_THAT(set, Contains("volume_m3"));
    EXPECT_THAT(folded, Not(Contains("viscosity")));
    EXPECT_THAT(folded, Contains("friction_coefficient"));
    EXPECT_EQ(results["defaults"]["count"], folded.size());
    EXPECT_TRUE(has(s.html(), "<summary>" + std::to_string(folded.size()) + " keys at their defaults"));
}

TEST(Barriers, are_no_buildings_in_the_counts) {
    Sample s;
    observe::BuildingImpact wall;
    wall.name = "check dam";
    wall.hit = wall.is_barrier = true;
    wall.peak_impact_pressure = 500e3;
    s.result.observation.buildings.push_back(wall);
    const report::Json results = report::run_results(s.scene, s.result, {});
    for (const auto& figure : results["key_figures"]) {
        if (figure["key"] != "buildings_hit") continue;
        EXPECT_EQ(figure["value"], 3);
        EXPECT_EQ(figure["unit"], "of 5");
        EXPECT_EQ(figure["note"], "highest impact pressure 38.4 kPa, House 38; 1 of 1 barrier hit");
    }
    EXPECT_EQ(results["buildings"]["count"], "5 buildings");
    EXPECT_EQ(results["buildings"]["hit"], 3);
    EXPECT_FALSE(has(results["buildings"].dump(), "check dam"));
    EXPECT_EQ(results["barriers"]["table"]["rows"][0]["peak_impact_pressure_kPa"], 500);
}

TEST(MapScale, is_a_round_ratio_that_holds_for_the_printed_width) {
    for (const double metres : {37.0, 160.0, 410.0, 2900.0, 64000.0}) {
        report::MapFrame frame;
        frame.area = {0, 0, metres, 0.7 * metres};
        frame.scale = std::min(750 / metres, 700 / (0.7 * metres));
        const double ratio = report::print_ratio(frame), width = report::print_width(frame);
        const double whole = frame.right() + 20 + report::MapFrame::key_width;
        EXPECT_NEAR(frame.width() * width / whole / 1000 * ratio, metres, 1e-6 * metres) << "the map on paper";
        EXPECT_LE(width, 182.001);
        EXPECT_LE((frame.bottom() + 30) * width / whole, 108.001);
        EXPECT_GE(width, 0.6 * std::min(182.0, 108 * whole / (frame.bottom() + 30))) << "not needlessly small";
        const double leading = ratio / std::pow(10, std::floor(std::log10(ratio)));
        EXPECT_NEAR(leading * 4, std::round(leading * 4), 1e-9) << ratio;
    }
    const Sample s;
    const double ratio = report::print_ratio(report::map_frame(s.scene, report::map_content(s.scene, s.result)));
    EXPECT_TRUE(has(s.html(), ">1 : " + report::fixed(ratio, 0) + " printed on A4</text>"));
}

TEST(LocationMap, shows_the_area_of_the_maps_in_a_wider_terrain) {
    Sample s;
    EXPECT_FALSE(has(s.html(), ">Location</h3>")) << "the maps show all of it";
    using V = test::SampleValley;
    Grid<float> wide(GridGeometry{V::east - 2000, V::north - 2000, 20, 220, 220}, 50.0F);
    for (std::size_t i = 0; i < wide.values.size(); ++i) wide.values[i] += static_cast<float>(i % 220);
    s.scene.terrain = terrain::Terrain(wide);
    const std::string html = s.html();
    EXPECT_TRUE(has(html, ">Location</h3>"));
    EXPECT_TRUE(has(html, "class=\"location\""));
    EXPECT_TRUE(has(html, ". Location.</b>"));
}

}  // namespace
}  // namespace talus::report
