#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "params/fields.hpp"
#include "products/products.hpp"
#include "products/report_colour.hpp"
#include "products/report_fixture.hpp"
#include "products/report_map.hpp"
#include "products/report_plot.hpp"
#include "products/report_relief.hpp"
#include "products/report_sections.hpp"
#include "products/report_text.hpp"

namespace talus {
namespace {

using ::testing::ElementsAre;

struct Sample {
    Scene scene = test::sample_scene();
    RunResult result = test::sample_result(scene);

    std::string html() const {
        auto rendered = render_report(scene, result);
        EXPECT_TRUE(rendered.ok());
        return rendered.ok() ? *rendered : "";
    }
};

/// Unlike a matcher, it does not print the page when it fails.
bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(Report, IsOneSmallPageThatNamesNoOtherFile) {
    const std::string html = Sample().html();
    EXPECT_LT(html.size(), 3'000'000U);
    EXPECT_FALSE(has(html, "http://"));
    EXPECT_FALSE(has(html, "https://"));
    EXPECT_FALSE(has(html, "@import"));
    EXPECT_FALSE(has(html, "{{"));
    for (std::size_t at = 0; (at = html.find("src=\"", at)) != std::string::npos; ++at) {
        EXPECT_EQ(html.compare(at + 5, 5, "data:"), 0) << html.substr(at, 60);
    }
    for (std::size_t at = 0; (at = html.find("href=\"", at)) != std::string::npos; ++at) {
        EXPECT_TRUE(html.compare(at + 6, 5, "data:") == 0 || html[at + 6] == '#') << html.substr(at, 60);
    }
}

TEST(Report, EscapesEveryTextOfTheScene) {
    Sample s;
    const std::string evil = "<script>alert('1')</script>\"&";
    s.scene.spec.scene.title = evil + "title";
    s.scene.spec.scene.description = evil + "description";
    s.scene.spec.scene.assumptions = {evil + "assumption"};
    s.scene.spec.scene.sources = {evil + "source"};
    s.scene.spec.observations[0].name = evil;
    s.scene.spec.observations[0].source = evil;
    s.scene.spec.releases[0].name = evil;
    s.scene.spec.terrain.file = evil;
    s.scene.releases[0].name = evil;
    s.scene.notes = {evil + "note"};
    s.scene.inputs[0] = {evil, evil, 1, evil};
    s.scene.crs.name = evil;
    s.scene.vertical_unit = evil;
    s.result.status = RunStatus::fault;
    s.result.stop_reason = evil;
    for (std::size_t i = 0; i < s.scene.buildings.size(); ++i) {
        s.scene.buildings[i].name = s.result.observation.buildings[i].name = evil;
    }
    const std::string html = s.html();
    EXPECT_FALSE(has(html, "<script>alert"));
    EXPECT_FALSE(has(html, "\"&title"));
    EXPECT_TRUE(has(html, "&lt;script&gt;alert(&#39;1&#39;)&lt;/script&gt;&quot;&amp;title"));
    for (const char* place : {"description", "assumption", "source", "note"}) {
        EXPECT_TRUE(has(html, std::string("&quot;&amp;") + place));
    }
}

TEST(Report, ABraceInATitleIsNotTakenForATemplate) {
    Sample s;
    s.scene.spec.scene.title = "{{style}}";
    EXPECT_TRUE(has(s.html(), "<h1>{{style}}</h1>"));
}

TEST(Report, SaysReconstructionOnThePageAndOnEveryMap) {
    Sample s;
    const std::string with = s.html();
    EXPECT_TRUE(has(with, "banner reconstruction"));
    EXPECT_TRUE(has(with, ">RECONSTRUCTION</text>"));
    EXPECT_TRUE(has(with, "\"Reconstruction, not surveyed\""));
    s.scene.spec.scene.reconstruction = false;
    const std::string without = s.html();
    EXPECT_FALSE(has(without, "banner reconstruction"));
    EXPECT_FALSE(has(without, "RECONSTRUCTION"));
}

TEST(Report, SaysPartialWithItsReason) {
    Sample s;
    EXPECT_FALSE(has(report::banners(s.scene, s.result), "banner partial"));
    s.result.status = RunStatus::fault;
    s.result.stop_reason = "compression 0.6 above compression_limit 0.5 at 12.3 s";
    const std::string html = report::banners(s.scene, s.result);
    EXPECT_TRUE(has(html, "banner partial"));
    EXPECT_TRUE(has(html, "compression 0.6 above compression_limit 0.5 at 12.3 s"));
    s.result.status = RunStatus::interrupted;
    EXPECT_TRUE(has(report::banners(s.scene, s.result), "was interrupted"));
}

TEST(Report, WarnsOfCompressionAboveEitherLimit) {
    Sample s;
    EXPECT_FALSE(has(report::banners(s.scene, s.result), "banner unconverged"));
    s.result.observation.worst_max_compression = 0.031;
    s.result.observation.worst_max_time = 12.3;
    s.result.observation.compressed_time_share = 0.25;
    const std::string html = report::banners(s.scene, s.result);
    EXPECT_TRUE(has(html, "banner unconverged"));
    for (const char* part :
         {"3.1&nbsp;% at a single particle (at 12.3 s; limit 3&nbsp;%)", "during 25&nbsp;% of the simulated time",
          "<code>solver.iteration_count</code> (now 4)", "solver.displacement_limit"}) {
        EXPECT_TRUE(has(html, part)) << part;
    }
    s.scene.spec.solver.time_step = 0.01;
    EXPECT_TRUE(has(report::banners(s.scene, s.result), "lower <code>solver.time_step_s</code>"));
    s.result.observation.worst_max_compression = 0.02;
    s.result.observation.worst_mean_compression = 0.011;
    EXPECT_TRUE(has(report::banners(s.scene, s.result), "Not converged"));
}

TEST(Report, MissingVolumeIsNotCalledClosed) {
    Sample s;
    EXPECT_TRUE(has(report::key_results(s.scene, s.result), "<strong>closed</strong>"));
    s.result.observation.timeseries.back().volume_deposited -= 0.25;
    const std::string html = report::key_results(s.scene, s.result);
    EXPECT_FALSE(has(html, "<strong>closed</strong>"));
    EXPECT_TRUE(has(html, "0.250"));
}

TEST(Report, ComparesTheFrontWithEachObservation) {
    Sample s;
    s.result.observation.front = {{120, 14, 10, 9}, {122, 14.2, 12, 10}};
    const std::string html = report::observation_table(s.scene, s.result);
    EXPECT_TRUE(has(html, "<b>11.0</b>"));         // between the two samples
    EXPECT_TRUE(has(html, "<b>not reached</b>"));  // 217 m lies beyond
}

TEST(Report, ListsBuildingsByPressureAndMarksAssumedHeights) {
    Sample s;
    const std::string html = report::building_table(s.scene, s.result);
    EXPECT_LT(html.find("House 38"), html.find("House 12"));
    EXPECT_LT(html.find("House 12"), html.find("House 21A"));
    EXPECT_TRUE(has(html, "6.0<sup>a</sup>"));
    EXPECT_FALSE(has(html, "Temple"));  // not hit
}

TEST(Report, SaysWhenNoBuildingWasHit) {
    Sample s;
    for (BuildingImpact& b : s.result.observation.buildings) b.hit = false;
    EXPECT_TRUE(has(report::building_table(s.scene, s.result), "No building was hit."));
}

TEST(Report, ShowsThirtyOfManyBuildingsAndCountsTheRest) {
    Sample s;
    s.scene.buildings.clear();
    s.result.observation.buildings.clear();
    for (int i = 0; i < 45; ++i) {
        BuildingImpact b;
        b.name = "house number " + std::to_string(i);
        b.hit = true;
        b.peak_pressure = 1000.0 * i;
        s.result.observation.buildings.push_back(b);
    }
    const std::string html = report::building_table(s.scene, s.result);
    EXPECT_TRUE(has(html, "first 30 of 45 buildings"));
    EXPECT_TRUE(has(html, "house number 15"));
    EXPECT_FALSE(has(html, "house number 14<"));
}

TEST(Report, PrintsEveryParameterWithItsUnit) {
    Sample s;
    const std::string html = report::parameter_table(s.scene);
    for (const Section& section : scene_sections()) {
        // Observations have a table of their own; of kinds that the scene lacks there is nothing to print.
        if (section.name == "scene" || section.name == "observation" || section.count(s.scene.spec) == 0) continue;
        for (const Parameter& parameter : section.parameters) {
            EXPECT_TRUE(has(html, "<code>" + parameter.key + "</code>"));
        }
    }
    const std::string chosen = report::chosen_values(s.scene, s.result);
    EXPECT_TRUE(has(chosen, "0.1 per 1/60 s"));
    EXPECT_TRUE(has(chosen, "0.310 m²/s"));
}

/// Whether the page's figures are numbered from 1 up, none twice.
void expect_numbered_figures(const std::string& html) {
    int count = 0;
    for (std::size_t at = 0; (at = html.find("<b>Figure ", at)) != std::string::npos; ++at) {
        EXPECT_EQ(std::atoi(html.c_str() + at + 10), ++count);
    }
    EXPECT_GT(count, 5);
}

TEST(Report, DrawsZonesAndBedWithTheirValuesWhereThereAreSome) {
    Sample sample;
    const std::string without = sample.html();
    EXPECT_FALSE(has(without, "id=\"zones\""));
    expect_numbered_figures(without);
    ZoneSpec rough, forest;
    rough.name = "rough <gully>";
    rough.friction_coefficient = 0.37;
    rough.turbulent_friction = 450;
    forest.name = "forest";
    forest.stem_density = 0.08;
    forest.stem_diameter = 0.35;
    sample.scene.spec.zones = {rough, forest};
    BedSpec bed;
    bed.name = "colluvium";
    bed.depth = 1.5;
    bed.growth_rate = 0.006;
    sample.scene.spec.beds = {bed};
    const std::size_t cells = sample.scene.terrain.elevation().values.size();
    sample.scene.zone_at.assign(cells, 1);
    std::fill(sample.scene.zone_at.begin(), sample.scene.zone_at.begin() + static_cast<std::ptrdiff_t>(cells / 2), 2);
    sample.scene.bed.materials.resize(1);
    sample.scene.bed.material_at.assign(cells, 1);
    const std::string html = sample.html();
    for (const char* part : {"id=\"zones\"", "rough &lt;gully&gt;", "friction 0.37", "ξ 450 m/s²", "0.08 stems/m²",
                             "0.35 m thick", "colluvium", "1.5 m deep", "growth 0.006 per m",
                             "Petryk &amp; Bosmajian 1975", "Zones of the ground and bed.</b>"}) {
        EXPECT_TRUE(has(html, part)) << part;
    }
    expect_numbered_figures(html);
}

TEST(Report, DrawsTheDensityOfAnInflowWhereItHasOne) {
    Sample sample;
    sample.scene.inflows.push_back({"torrent", {0, 0}, {3, 0}, {{0, 5, 2}, {10, 5, 2}}});
    std::string html = sample.html();
    EXPECT_TRUE(has(html, "torrent, across a line: 50.0 m³"));
    EXPECT_FALSE(has(html, "density, kg/m³"));
    expect_numbered_figures(html);
    Inflow rain{"scarp", {}, {}, {{0, 5, 2, 1500}, {10, 5, 2, 1700}}};
    rain.area.push_back({{{0, 0}, {20, 0}, {20, 10}, {0, 10}}, {}});
    sample.scene.inflows.push_back(rain);
    html = sample.html();
    EXPECT_TRUE(has(html, "scarp, over 200 m², down the slope: 50.0 m³"));
    EXPECT_TRUE(has(html, "80.0 t, ") && has(html, "600 kg/m³ on average"));
    EXPECT_TRUE(has(html, "density, kg/m³"));
    EXPECT_TRUE(has(html, "Their motion does not depend on it."));
}

TEST(Report, MarksInflowsOnItsMapsWithAnArrowWhereDebrisGoes) {
    Sample sample;
    const Extent ground = sample.scene.terrain.elevation().geometry.extent();
    const double x = (ground.x_min + ground.x_max) / 2, y = (ground.y_min + ground.y_max) / 2;
    EXPECT_FALSE(has(sample.html(), R"(class="inflow")"));
    // Northwards: to its right is the east, to the right on the page.
    sample.scene.inflows.push_back({"torrent", {x, y}, {x, y + 2}, {{0, 5, 2}, {10, 5, 2}}});
    const std::string html = sample.html();
    const std::regex mark(
        R"re(class="inflow" d="M([\d.]+) ([\d.]+)L([\d.]+) ([\d.]+)M\S+ \S+?L([\d.]+) ([\d.]+)M.*?<title>torrent)re");
    std::smatch found;
    ASSERT_TRUE(std::regex_search(html, found, mark));
    const auto number = [&](std::size_t k) { return std::stod(found[k]); };
    EXPECT_NEAR(number(1), number(3), 0.11);
    EXPECT_GT(number(2), number(4)) << "north is up";
    EXPECT_NEAR(number(5), number(1) + 16, 0.21) << "the tip";
    EXPECT_TRUE(has(html, ">Inflow</text>"));
}

TEST(Report, RendersARunInWhichNothingMoved) {
    Sample s;
    s.scene.buildings.clear();
    s.scene.spec.observations.clear();
    s.scene.flow_path = FlowPath();
    s.result.observation = Observation();
    s.result.status = RunStatus::interrupted;
    const std::string html = s.html();
    EXPECT_TRUE(has(html, "No debris reached the flow path"));
    EXPECT_TRUE(has(html, "no debris mapped"));
    for (const char* nan : {">nan", " nan", "\"nan", "Lnan", "Mnan"}) EXPECT_FALSE(has(html, nan)) << nan;
}

TEST(ReportMap, ShowsWhereDebrisCameTheReleaseAndTheBuildingsHit) {
    const Sample s;
    const report::MapFrame frame = report::map_frame(s.scene, report::map_content(s.scene, s.result));
    const Extent terrain = s.scene.terrain.elevation().geometry.extent();
    EXPECT_GE(frame.area.x_min, terrain.x_min);
    EXPECT_LE(frame.area.y_max, terrain.y_max);
    const Extent release = s.scene.releases[0].extent();
    EXPECT_TRUE(frame.area.contains({release.x_min, release.y_min}));
    EXPECT_TRUE(frame.area.contains(s.scene.flow_path.point_at(test::SampleValley::toe)));
    EXPECT_NEAR(frame.x(frame.area.x_max) - frame.x(frame.area.x_min), frame.width(), 1e-9);
    EXPECT_LT(frame.y(frame.area.y_max), frame.y(frame.area.y_min));  // north is up
}

TEST(ReportMap, AWideTerrainIsCroppedToTheEvent) {
    Sample s;
    Grid<float> wide(GridGeometry{test::SampleValley::east - 2000, test::SampleValley::north - 2000, 20, 220, 220},
                     50.0F);
    for (std::size_t i = 0; i < wide.values.size(); ++i) wide.values[i] += static_cast<float>(i % 220);
    s.scene.terrain = Terrain(wide);
    const report::MapFrame frame = report::map_frame(s.scene, report::map_content(s.scene, s.result));
    EXPECT_LT(frame.area.width(), 600);
    EXPECT_LT(frame.area.height(), 400);
}

TEST(ReportMap, CallsImpactsByTheirPressure) {
    BuildingImpact b;
    b.peak_pressure = 50e3;
    EXPECT_EQ(report::impact_class(b), 0);  // not hit
    b.hit = true;
    EXPECT_EQ(report::impact_class(b), 3);
    b.peak_pressure = 29e3;
    EXPECT_EQ(report::impact_class(b), 2);
    b.peak_pressure = 14e3;
    EXPECT_EQ(report::impact_class(b), 1);
}

TEST(ReportRelief, ContoursOfAPlaneAreStraightEvenlySpacedAndWhole) {
    Grid<float> plane(GridGeometry{1000, 2000, 2, 40, 30});
    for (int r = 0; r < 30; ++r) {
        for (int c = 0; c < 40; ++c) plane.at(c, r) = static_cast<float>(0.5 * plane.geometry.centre(c, r).x);
    }
    const auto lines = report::contours(plane, 5);  // x = 1010, 1020, ... 1070
    ASSERT_EQ(lines.size(), 7U);
    for (const auto& line : lines) {
        EXPECT_EQ(line.points.size(), 30U);
        for (const PlanPoint& p : line.points) EXPECT_NEAR(p.x, 2 * line.elevation, 1e-3);
    }
}

TEST(ReportRelief, AHillHasClosedContours) {
    Grid<float> hill(GridGeometry{0, 0, 1, 41, 41});
    for (int r = 0; r < 41; ++r) {
        for (int c = 0; c < 41; ++c) hill.at(c, r) = static_cast<float>(20 - std::hypot(c - 20, r - 20));
    }
    const auto lines = report::contours(hill, 5);
    double length = 0;
    int at_ten = 0;
    for (const auto& line : lines) {
        if (line.elevation != 10) continue;
        ++at_ten;
        EXPECT_EQ(line.points.front().x, line.points.back().x);
        EXPECT_EQ(line.points.front().y, line.points.back().y);
        for (std::size_t i = 1; i < line.points.size(); ++i) {
            length += std::hypot(line.points[i].x - line.points[i - 1].x, line.points[i].y - line.points[i - 1].y);
        }
    }
    EXPECT_EQ(at_ten, 1);
    EXPECT_NEAR(length, 2 * 3.14159 * 10, 0.5);
}

TEST(ReportRelief, SlopesFacingNorthWestAreBrighterThanThoseFacingSouthEast) {
    Grid<float> ridge(GridGeometry{0, 0, 1, 40, 40});
    for (int r = 0; r < 40; ++r) {
        for (int c = 0; c < 40; ++c) ridge.at(c, r) = static_cast<float>(20 - 0.5 * std::abs(c - r));
    }
    const report::GreyImage image = report::hillshade(ridge, ridge.geometry.extent(), 1);
    const auto grey = [&](int x, int y) { return image.pixels[2 * static_cast<std::size_t>(y * image.width + x)]; };
    EXPECT_GT(grey(10, 10), grey(30, 30) + 40);  // picture rows run from north to south
}

TEST(ReportRelief, NothingIsInterpolatedFarFromData) {
    Grid<float> grid(GridGeometry{0, 0, 1, 4, 4}, std::numeric_limits<float>::quiet_NaN());
    grid.at(1, 1) = 3;
    EXPECT_NEAR(report::interpolate(grid, {1.6, 1.6}), 3, 1e-6);
    EXPECT_TRUE(std::isnan(report::interpolate(grid, {2.1, 2.1})));
    EXPECT_TRUE(std::isnan(report::interpolate(grid, {-50, 2})));
}

TEST(ReportColour, RampsFallEvenlyInLightness) {
    const report::Ramp ramp{205, 0.05, 268, 0.15, 0.90, 0.28};
    for (int k = 0; k <= 10; ++k) {
        EXPECT_NEAR(report::lightness(ramp.at(k / 10.0)), 0.90 - 0.062 * k, 0.01) << k;
    }
}

TEST(ReportColour, ClassesEndAboveTheLargestValue) {
    const report::Ramp ramp{205, 0.05, 268, 0.15};
    EXPECT_THAT(report::fixed_classes({0, 0.5, 1, 2, 5}, 1.5, ramp).breaks, ElementsAre(0, 0.5, 1));
    EXPECT_THAT(report::even_classes(38, ramp).breaks, ElementsAre(0, 5, 10, 15, 20, 25, 30, 35));
    const report::Classes classes = report::fixed_classes({0.05, 0.5, 1}, 3, ramp);
    EXPECT_EQ(classes.of(0.01), -1);
    EXPECT_EQ(classes.of(0.5), 1);
    EXPECT_EQ(classes.of(99), 2);
    EXPECT_EQ(classes.of(std::numeric_limits<double>::quiet_NaN()), -1);
}

TEST(ReportText, NumbersReadAsAnEngineerPrintsThem) {
    EXPECT_EQ(report::fixed(824262.04, 1), "824\u202f262.0");
    EXPECT_EQ(report::fixed(1999, 0), "1999");
    EXPECT_EQ(report::fixed(-0.26, 1), "−0.3");
    EXPECT_EQ(report::fixed(-0.001, 1), "0.0");
    EXPECT_EQ(report::fixed(never, 1), "–");
    EXPECT_EQ(report::significant(38.44, 3), "38.4");
    EXPECT_EQ(report::significant(0.0123, 2), "0.012");
    EXPECT_EQ(report::coordinate(12.50), "12.5");
}

TEST(ReportText, ShortenedNamesKeepWholeCharacters) {
    EXPECT_EQ(report::shortened("Zürich", 9), "Zürich");
    EXPECT_EQ(report::shortened("Zürich", 2), "Z…");
}

TEST(ReportPlot, LinesLeaveGapsWhereThereIsNoValue) {
    report::Plot plot(0, 0, 100, 100, {0, 4}, {0, 1});
    const std::vector<double> x = {0, 1, 2, 3, 4}, y = {0, 1, never, 1, 0};
    plot.line(x, y, "series");
    EXPECT_TRUE(has(plot.svg(), "d=\"M0 100L25 0M75 0L100 100\""));
}

TEST(ReportPlot, TicksAreRound) {
    const report::Ticks ticks = report::round_ticks({0, 12.2}, 5);
    EXPECT_THAT(ticks.values, ElementsAre(0, 2.5, 5, 7.5, 10));
    EXPECT_EQ(ticks.digits, 1);
}

}  // namespace
}  // namespace talus
