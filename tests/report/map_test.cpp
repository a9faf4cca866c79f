#include "report/map.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "report/relief.hpp"
#include "report/report_fixture.hpp"

namespace talus::report {
namespace {

using test::Sample;

TEST(ReportMap, shows_where_debris_came_the_release_and_the_buildings_hit) {
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

TEST(ReportMap, a_wide_terrain_is_cropped_to_the_event) {
    Sample s;
    Grid<float> wide(GridGeometry{test::SampleValley::east - 2000, test::SampleValley::north - 2000, 20, 220, 220},
                     50.0F);
    for (std::size_t i = 0; i < wide.values.size(); ++i) wide.values[i] += static_cast<float>(i % 220);
    s.scene.terrain = terrain::Terrain(wide);
    const report::MapFrame frame = report::map_frame(s.scene, report::map_content(s.scene, s.result));
    EXPECT_LT(frame.area.width(), 600);
    EXPECT_LT(frame.area.height(), 400);
}

TEST(ReportMap, of_a_zoom_shows_its_area_and_boundary) {
    Sample s;
    const Extent whole = map_frame(s.scene, map_content(s.scene, s.result)).area;
    run::ZoomRecord zoom;
    zoom.area = {{{824100, 825500}, {824140, 825500}, {824140, 825530}, {824100, 825530}}, {}};
    s.result.zoom = zoom;
    const MapContent content = map_content(s.scene, s.result);
    const Extent area = map_frame(s.scene, content).area;
    EXPECT_LT(area.width(), whole.width() / 2);
    EXPECT_TRUE(area.contains({824100, 825500}) && area.contains({824140, 825530}));
    const auto figures = map_figures(s.scene, content);
    ASSERT_TRUE(figures.ok()) << figures.error().message;
    const std::string drawn = (*figures)["definitions"];
    EXPECT_NE(drawn.find("class=\"zoom-boundary\""), std::string::npos);
    EXPECT_NE(drawn.find("Boundary of the zoom"), std::string::npos);
}

TEST(ReportMap, shows_gauges_and_without_a_path_no_observations) {
    Sample s;
    const auto drawn = [&] {
        const auto figures = map_figures(s.scene, map_content(s.scene, s.result));
        return figures.ok() ? (*figures)["definitions"].get<std::string>() : figures.error().message;
    };
    EXPECT_EQ(drawn().find(">Gauge<"), std::string::npos);
    EXPECT_NE(drawn().find("Field observation"), std::string::npos);
    s.scene.gauges = {{"at the bend", s.scene.flow_path.point_at(60), 60}, {"far away", {900000, 900000}}};
    EXPECT_NE(drawn().find(">Gauge<"), std::string::npos);
    EXPECT_NE(drawn().find("at the bend"), std::string::npos);
    EXPECT_EQ(drawn().find("far away"), std::string::npos);
    s.scene.flow_path = terrain::FlowPath();
    EXPECT_EQ(drawn().find("Field observation"), std::string::npos);
}

TEST(ReportMap, shows_cross_sections_with_their_names) {
    Sample s;
    const auto drawn = [&] {
        const auto figures = map_figures(s.scene, map_content(s.scene, s.result));
        return figures.ok() ? (*figures)["definitions"].get<std::string>() : figures.error().message;
    };
    EXPECT_EQ(drawn().find(">Cross-section<"), std::string::npos);
    const PlanPoint at = s.scene.flow_path.point_at(60);
    s.scene.cross_sections = {{"at the bridge", {{at.x, at.y - 10}, {at.x, at.y + 10}}},
                              {"far away", {{900000, 900000}, {900010, 900000}}}};
    const std::string map = drawn();
    EXPECT_NE(map.find(">Cross-section<"), std::string::npos);
    EXPECT_NE(map.find("class=\"cross-section\""), std::string::npos);
    EXPECT_NE(map.find("class=\"section-name\""), std::string::npos);
    EXPECT_NE(map.find(">at the bridge</text>"), std::string::npos);
    EXPECT_EQ(map.find(">far away</text>"), std::string::npos) << "its middle is not on the map";
}

TEST(ReportMap, calls_impacts_by_their_pressure) {
    observe::BuildingImpact b;
    b.peak_impact_pressure = 50e3;
    EXPECT_EQ(report::impact_class(b), 0);  // not hit
    b.hit = true;
    EXPECT_EQ(report::impact_class(b), 3);
    b.peak_impact_pressure = 29e3;
    EXPECT_EQ(report::impact_class(b), 2);
    b.peak_impact_pressure = 14e3;
    EXPECT_EQ(report::impact_class(b), 1);
}

TEST(ReportRelief, slopes_facing_north_west_are_brighter_than_those_facing_south_east) {
    Grid<float> ridge(GridGeometry{0, 0, 1, 40, 40});
    for (int r = 0; r < 40; ++r) {
        for (int c = 0; c < 40; ++c) ridge.at(c, r) = static_cast<float>(20 - 0.5 * std::abs(c - r));
    }
    const report::GreyImage image = report::hillshade(ridge, ridge.geometry.extent(), 1);
    const auto grey = [&](int x, int y) { return image.pixels[2 * static_cast<std::size_t>(y * image.width + x)]; };
    EXPECT_GT(grey(10, 10), grey(30, 30) + 40);  // picture rows run from north to south
}

TEST(ReportRelief, nothing_is_interpolated_far_from_data) {
    Grid<float> grid(GridGeometry{0, 0, 1, 4, 4}, std::numeric_limits<float>::quiet_NaN());
    grid.at(1, 1) = 3;
    EXPECT_NEAR(report::interpolate(grid, {1.6, 1.6}), 3, 1e-6);
    EXPECT_TRUE(std::isnan(report::interpolate(grid, {2.1, 2.1})));
    EXPECT_TRUE(std::isnan(report::interpolate(grid, {-50, 2})));
}

}  // namespace
}  // namespace talus::report
