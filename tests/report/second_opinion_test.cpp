#include "report/second_opinion.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/hazard_map.hpp"
#include "report_fixture.hpp"

namespace talus::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

void scale(Grid<float>& map, float by) {
    for (float& value : map.values) value *= by;
}

/// The sample twice: the second is the depth-averaged model's, to be changed before it is compared.
struct TwoModels {
    scene::Scene scene = sample_scene();
    run::RunResult particles = sample_result(scene), grid = particles;

    TwoModels() {
        grid.grid_cell = 1;
        HazardMaps& maps = grid.observation.maps;
        maps.arrival_speed = particles.observation.maps.arrival_speed = maps.peak_speed;
    }
    [[nodiscard]] run::SecondOpinion opinion() const { return second_opinion(scene, particles, grid); }
    [[nodiscard]] report::BothModels models() const { return {scene, particles, scene, grid}; }
    [[nodiscard]] std::vector<std::string> differences() const { return report::differences(models(), opinion()); }
    [[nodiscard]] std::string page() const {
        const auto page = second_opinion_report(models(), opinion(), second_opinion_results(models(), opinion()));
        return page ? *page : "";
    }
};

TEST(Differences, the_largest_is_named_first) {
    TwoModels two;
    scale(two.grid.observation.maps.peak_speed, 2.65F);
    scale(two.grid.observation.maps.peak_pressure, 2.65F * 2.65F);
    scale(two.grid.observation.maps.peak_depth, 1.2F);
    EXPECT_THAT(two.differences().at(0),
                AllOf(StartsWith("Peak speed: "), HasSubstr("+165 %"), HasSubstr("Peak dynamic pressure: "),
                      HasSubstr("+602 %"), HasSubstr("at chainage")));
    EXPECT_THAT(two.differences().at(1), AllOf(StartsWith("Peak depth: "), HasSubstr("+20 %")));

    scale(two.grid.observation.maps.peak_depth, 1 / 12.0F);
    EXPECT_THAT(two.differences().at(0), AllOf(StartsWith("Peak depth: "), HasSubstr("−90 %")));
}

TEST(Differences, a_structure_hit_in_one_model_only_stands_before_all_else) {
    TwoModels two;
    scale(two.grid.observation.maps.peak_speed, 2.65F);
    two.grid.observation.buildings[2].hit = false;
    EXPECT_THAT(two.differences().at(0), AllOf(StartsWith("Of 5 structures, 2 are hit in both models"),
                                               HasSubstr("House 12 only with particles")));
}

TEST(Differences, a_spike_of_one_cell_changes_the_peak_and_not_the_median) {
    TwoModels two;
    HazardMaps& maps = two.grid.observation.maps;
    *std::find_if(maps.peak_speed.values.begin(), maps.peak_speed.values.end(), [](float v) { return v > 0; }) = 120;
    const std::string first = two.differences().at(0);
    EXPECT_THAT(first, HasSubstr("120.0\u00a0m/s depth-averaged"));
    EXPECT_THAT(first.substr(first.find("the median")), HasSubstr(", 0 %"));
}

TEST(Differences, a_front_at_the_end_of_the_scenes_path_may_have_gone_farther) {
    TwoModels two;
    const auto run_out = [&] {
        const auto all = two.differences();
        const auto at = std::find_if(all.begin(), all.end(), [](const auto& s) { return s.starts_with("Run-out"); });
        return at == all.end() ? "" : *at;
    };
    EXPECT_THAT(run_out(), AllOf(HasSubstr("chainage 262\u00a0m with particles"), Not(HasSubstr("path ends"))));
    two.grid.observation.run_out.front_chainage = two.scene.flow_path.length();
    EXPECT_THAT(run_out(), HasSubstr("which the front of the depth-averaged model reached: it may have gone farther"));
    // The path that the debris itself made ends where that does.
    two.scene.flow_path_origin = scene::PathOrigin::followed;
    EXPECT_THAT(run_out(), Not(HasSubstr("path ends")));
    two.particles.observation.run_out.toe = {SampleValley::east + 290, SampleValley::north + 190};
    EXPECT_THAT(run_out(), HasSubstr("the farthest deposit with particles lies beside the path"));
}

TEST(Differences, the_same_twice_has_none) {
    for (const std::string& sentence : TwoModels().differences()) {
        EXPECT_THAT(sentence, AllOf(Not(HasSubstr("differ most")), Not(HasSubstr("farthest apart")))) << sentence;
        EXPECT_EQ(sentence.find(" +"), std::string::npos) << sentence;
    }
}

TEST(SecondOpinionPage, has_speed_and_pressure_of_both_and_their_differences) {
    TwoModels two;
    scale(two.grid.observation.maps.peak_depth, 8);  // flows of up to 27 m
    const std::string page = two.page();
    for (const char* measure : {"peak_depth", "peak_speed", "peak_pressure"}) {
        for (const char* of : {"particles", "depth_averaged", "difference"}) {
            EXPECT_THAT(page, HasSubstr(fmt::format("data-layer=\"{}_{}\"", measure, of)));
        }
    }
    EXPECT_EQ(page.find("{{"), std::string::npos);
    const auto rows = second_opinion_results(two.models(), two.opinion())["quantities"]["rows"];
    const auto row =
        std::find_if(rows.begin(), rows.end(), [](const auto& r) { return r["quantity"] == "Peak dynamic pressure"; });
    ASSERT_NE(row, rows.end());
    EXPECT_NEAR((*row)["difference_percent"].template get<double>(), 0, 1e-9);
    EXPECT_NEAR((*row)["particles"]["value"].template get<double>(),
                report::greatest(two.particles.observation.maps.peak_pressure) / 1e3, 1e-6);
}

TEST(SecondOpinionPage, warnings_of_either_run_stand_on_it) {
    TwoModels two;
    EXPECT_EQ(two.page().find("verdict-box beyond"), std::string::npos);
    two.grid.observation.energy.speed = 131;
    two.grid.observation.energy.share = 4;
    two.grid.observation.energy.cells = 10;
    two.particles.observation.thickness.median = 0.5 * two.particles.particle_spacing;
    const std::string page = two.page();
    EXPECT_THAT(page, HasSubstr("faster than its fall explains"));
    EXPECT_THAT(page, HasSubstr("particles thick in the median of its trail, fewer than 2"));
    EXPECT_EQ(page.find("status complete"), std::string::npos) << "not in green";
}

TEST(SecondOpinionPage, the_scale_of_a_difference_follows_the_data) {
    const auto limits = [](float factor) {
        TwoModels two;
        scale(two.grid.observation.maps.peak_depth, factor);
        const std::string page = two.page();
        const std::size_t map = page.find("data-layer=\"peak_depth_difference\"");
        const std::size_t from = page.find(">over ", map) + 6;
        return page.substr(from, page.find('<', from) - from);
    };
    EXPECT_EQ(limits(1.1F), "0.5");
    EXPECT_EQ(limits(8), "20");
}

TEST(DifferenceClasses, are_as_wide_below_as_above_and_grey_around_none) {
    const report::Classes classes = report::difference_classes(12);
    EXPECT_DOUBLE_EQ(classes.breaks.back(), 20);
    EXPECT_DOUBLE_EQ(classes.breaks[1], -20);
    ASSERT_EQ(classes.colours.size(), classes.breaks.size());
    EXPECT_EQ(classes.of(-1e9), 0);
    EXPECT_EQ(classes.of(0), 4);
    EXPECT_EQ(classes.of(1.9), 4);
    EXPECT_EQ(classes.of(-1.9), 4);
    EXPECT_EQ(classes.of(25), 8);
    const report::Colour grey = classes.colours[4];
    EXPECT_TRUE(grey.red == grey.green && grey.green == grey.blue);
    for (const auto& [usual, outer] : {std::pair{1.0, 1.0}, {0.04, 0.05}, {350, 500}, {0, 1}}) {
        EXPECT_DOUBLE_EQ(report::difference_classes(usual).breaks.back(), outer) << usual;
    }
}

}  // namespace
}  // namespace talus::test
