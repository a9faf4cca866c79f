#include "report/intensity.hpp"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "params/fields.hpp"
#include "report/report_fixture.hpp"

namespace talus::report {
namespace {

TEST(Intensity, swiss_debris_flows_are_high_where_deep_and_fast_and_else_medium) {
    const IntensityGuideline& g = intensity_guideline(params::GuidelineChoice::swiss_debris_flow);
    EXPECT_EQ(g.class_of(1.01, 1.01), 2);
    EXPECT_EQ(g.class_of(1, 9), 1) << "not deep enough";
    EXPECT_EQ(g.class_of(9, 1), 1) << "not fast enough";
    EXPECT_EQ(g.class_of(0.2, 0), 1);
    EXPECT_EQ(g.class_of(0, 0), 0);
    ASSERT_EQ(g.classes.size(), 2u) << "the recommendation has no low class";
    EXPECT_EQ(g.classes.back().name, "high");
}

TEST(Intensity, swiss_floods_go_by_depth_or_its_product_with_speed) {
    const IntensityGuideline& g = intensity_guideline(params::GuidelineChoice::swiss_flood);
    EXPECT_EQ(g.class_of(0.5, 1), 1);
    EXPECT_EQ(g.class_of(0.51, 0), 2);
    EXPECT_EQ(g.class_of(0.4, 1.3), 2);
    EXPECT_EQ(g.class_of(2.01, 0), 3);
    EXPECT_EQ(g.class_of(0.4, 5.1), 3);
}

TEST(Intensity, the_venezuelan_classes_leave_thin_debris_out) {
    const IntensityGuideline& g = intensity_guideline(params::GuidelineChoice::garcia_2003);
    EXPECT_EQ(g.class_of(0.2, 3), 0);
    EXPECT_EQ(g.class_of(0.3, 0.6), 1);
    EXPECT_EQ(g.class_of(0.3, 0.7), 2);
    EXPECT_EQ(g.class_of(0.3, 3.4), 3);
    EXPECT_EQ(g.class_of(1.1, 0), 3);
}

TEST(Intensity, every_guideline_says_where_it_is_from_and_gets_darker_with_severity) {
    const params::Parameter& key = params::parameter_of("outputs", "intensity_guideline");
    for (std::size_t k = 0; k < key.choices.size(); ++k) {
        const IntensityGuideline& g = intensity_guideline(static_cast<params::GuidelineChoice>(k));
        EXPECT_THAT(g.citation, testing::ContainsRegex("(19|20)[0-9][0-9]")) << key.choices[k];
        EXPECT_FALSE(g.remark.empty());
        for (std::size_t c = 1; c < g.classes.size(); ++c) {
            EXPECT_LT(report::lightness(g.classes[c].colour), report::lightness(g.classes[c - 1].colour) - 0.1);
        }
    }
}

TEST(Intensity, is_mapped_where_debris_arrived_and_only_there) {
    const float none = std::nanf("");
    const GridGeometry cells{0, 0, 2, 4, 1};
    HazardMaps maps;
    maps.peak_depth = maps.peak_speed = maps.arrival_time = Grid<float>(cells, none);
    maps.peak_depth.values = {1.5F, 0.5F, 0.05F, none};
    maps.peak_speed.values = {4, 4, 4, none};
    maps.arrival_time.values = {3, 4, none, none};
    const Grid<float> map = intensity_map(intensity_guideline(params::GuidelineChoice::swiss_debris_flow), maps);
    EXPECT_EQ(map.values[0], 2);
    EXPECT_EQ(map.values[1], 1);
    EXPECT_TRUE(std::isnan(map.values[2])) << "a film that is no arrival";
    EXPECT_TRUE(std::isnan(map.values[3]));
}

TEST(Intensity, is_a_layer_of_the_report_with_its_classes_in_words) {
    scene::Scene scene = test::sample_scene();
    const run::RunResult result = test::sample_result(scene);
    const report::Json data = report::intensity(scene, result);
    double area = 0, reached = 0;
    for (const auto& row : data["table"]["rows"]) area += row["area_m2"].get<double>();
    for (const float t : result.observation.maps.arrival_time.values) reached += std::isnan(t) ? 0 : 1;
    EXPECT_DOUBLE_EQ(area, reached) << "cells of 1 m2, each in one class";
    EXPECT_GT(data["table"]["rows"][0]["area_m2"], 100);
    EXPECT_EQ(data["table"]["rows"][0]["name"], "high");
    const std::string page = test::report_page(scene, result);
    EXPECT_TRUE(test::has(page, "data-layer=\"intensity\""));
    EXPECT_TRUE(test::has(page, ">Swiss debris-flow classes</text>"));
    EXPECT_TRUE(test::has(page, ">medium</text>"));
    EXPECT_TRUE(test::has(page, "\"classes\":[\"medium\",\"high\"]"));
    EXPECT_TRUE(test::has(page, "BWW, BRP &amp; BUWAL (1997)"));
    scene.spec.outputs.intensity_guideline = params::GuidelineChoice::swiss_flood;
    EXPECT_EQ(report::intensity(scene, result)["guideline"], "Swiss flood classes");
}

}  // namespace
}  // namespace talus::report
