#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/chart.hpp"
#include "report/colour.hpp"
#include "report/number_text.hpp"
#include "report/report_fixture.hpp"

namespace talus::report {
namespace {

using ::testing::ElementsAre;

using test::has;

TEST(ReportColour, ramps_fall_evenly_in_lightness) {
    const Ramp ramp{205, 0.05, 268, 0.15, 0.90, 0.28};
    for (int k = 0; k <= 10; ++k) {
        EXPECT_NEAR(report::lightness(report::colour_at(ramp, k / 10.0)), 0.90 - 0.062 * k, 0.01) << k;
    }
}

TEST(ReportColour, classes_end_above_the_largest_value) {
    const Ramp ramp{205, 0.05, 268, 0.15};
    EXPECT_THAT(report::fixed_classes({0, 0.5, 1, 2, 5}, 1.5, ramp).breaks, ElementsAre(0, 0.5, 1));
    EXPECT_THAT(report::even_classes(38, ramp).breaks, ElementsAre(0, 5, 10, 15, 20, 25, 30, 35));
    const report::Classes classes = report::fixed_classes({0.05, 0.5, 1}, 3, ramp);
    EXPECT_EQ(classes.of(0.01), -1);
    EXPECT_EQ(classes.of(0.5), 1);
    EXPECT_EQ(classes.of(99), 2);
    EXPECT_EQ(classes.of(std::numeric_limits<double>::quiet_NaN()), -1);
}

TEST(ReportText, numbers_read_as_an_engineer_prints_them) {
    EXPECT_EQ(report::fixed(824262.04, 1), "824\u202f262.0");
    EXPECT_EQ(report::fixed(1999, 0), "1999");
    EXPECT_EQ(report::fixed(-0.26, 1), "−0.3");
    EXPECT_EQ(report::fixed(-0.001, 1), "0.0");
    EXPECT_EQ(report::fixed(observe::never, 1), "–");
    EXPECT_EQ(report::significant(38.44, 3), "38.4");
    EXPECT_EQ(report::significant(0.0123, 2), "0.012");
    EXPECT_EQ(report::coordinate(12.50), "12.5");
}

TEST(ReportText, shortened_names_keep_whole_characters) {
    EXPECT_EQ(report::shortened("Zürich", 9), "Zürich");
    EXPECT_EQ(report::shortened("Zürich", 2), "Z…");
}

TEST(ReportPlot, lines_leave_gaps_where_there_is_no_value) {
    report::Plot plot(0, 0, 100, 100, {0, 4}, {0, 1});
    const std::vector<double> x = {0, 1, 2, 3, 4}, y = {0, 1, observe::never, 1, 0};
    plot.line(x, y, "series");
    report::Svg svg;
    plot.draw(svg);
    EXPECT_TRUE(has(svg.str(), "d=\"M0 100l25-100M75 0l25 100\""));
}

TEST(ReportPath, has_points_from_the_one_before_and_none_on_a_straight_line) {
    report::PathData path;
    EXPECT_TRUE(path.empty());
    path.move_to(1, 2.5);
    path.line_to(2, 2.5);
    path.line_to(4, 2.5);    // straight on
    path.line_to(4, 2.52);   // less than a tenth
    path.line_to(3.5, 2.5);  // back
    path.line_to(3.5, -10);
    path.line_to(3.6, -9.5);
    path.line_to(3.8, -8.5);  // straight on
    path.line_to(3.75, -8.25);
    path.close();
    path.move_to(0, -0.04);
    path.line_to(0.3, 0);
    path.move_to(7, 7);
    EXPECT_EQ(path.take(), "M1 2.5h3-.5v-12.5l.3 1.5v.2ZM0 0h.3M7 7");
}

TEST(ReportChart, is_the_same_after_it_was_written_and_read) {
    report::Plot plot(66, 20, 400, 200, {0, 4}, {-1, 1});
    plot.axes("time, s", "height <m>");
    const std::vector<double> x = {0, 1, 2, 3, 4}, y = {0, 1, observe::never, 1, 0}, zero(5, 0);
    plot.band(x, zero, y, "area", "a & b");
    plot.dots(x, y, 2.5, "run-dot", "runs");
    plot.mark(1, 0.5, "observation");
    plot.horizontal(0.1, "limit", "limit");
    plot.label(1, 1, 4, -2, "end", "note", "here");
    plot.cells = {{0, 2, 4}, {-1, 1}, {0.5, 7}, {0, 1}, {"#fff", "#000"}, "misfit"};
    plot.key = report::Plot::Key::beside;
    const report::Chart chart{"A \"chart\"", 640, 300, {plot, plot}};
    const std::string written = report::chart_json(chart).dump();
    const report::Chart read = report::chart_from(report::Json::parse(written));
    EXPECT_EQ(report::chart_svg(read), report::chart_svg(chart));
    EXPECT_EQ(report::chart_json(read).dump(), written);
    EXPECT_TRUE(has(report::chart_svg(read), "height &lt;m&gt;"));
}

/// Every kind of object that the report shows, by its "kind".
void expect_documented(const report::Json& json, int& tables, int& charts) {
    if (json.is_array()) {
        for (const auto& entry : json) expect_documented(entry, tables, charts);
    }
    if (!json.is_object()) return;
    const std::string kind = json.value("kind", "");
    if (kind == "chart") ++charts;
    if (kind == "table") {
        ++tables;
        for (const auto& row : json["rows"]) {
            for (const auto& column : json["columns"]) {
                EXPECT_TRUE(row.contains(column["key"]) || row.contains("fills")) << column << row;
            }
        }
    }
    for (const auto& entry : json) expect_documented(entry, tables, charts);
}

TEST(Page, fills_templates_with_text_numbers_and_figures) {
    const report::Json data = {{"name", "<a & b>"},  {"width", 1234.5678}, {"none", nullptr},      {"empty", ""},
                               {"list", {"x", "y"}}, {"large", 12345.6},   {"nan", observe::never}};
    EXPECT_EQ(report::render("{{name}}|{{{name}}}", data), "&lt;a &amp; b&gt;|<a & b>");
    EXPECT_EQ(report::render("{{width|f1}} {{width|s2}} {{width|p}} {{none|f1}} {{nan|f1}}{{nan}} {{large|d0}}", data),
              "1234.6 1235 1234.57 – – +12\u202f346");
    EXPECT_EQ(report::render("{{#list}}{{.}},{{/list}}{{#none}}no{{/none}}{{^empty}}empty{{/empty}}", data),
              "x,y,empty");
    EXPECT_EQ(report::render("{{figure}} {{figure}}", data), "1 2");
}

TEST(Page, draws_tables_with_their_marks_and_gaps) {
    report::Json rows = report::table({{"name", "Name <b>", ""}, {"depth_m", "Depth", "m", "f2", "", "none"}}, "odds");
    rows["rows"].push_back(
        {{"name", {{"value", "a&b"}, {"mark", "hit-2"}, {"note", "until 3 s"}}}, {"depth_m", 1.234}});
    rows["rows"].push_back({{"name", "c"}, {"depth_m", nullptr}, {"heading", "[part]"}, {"heading_note", "two"}});
    rows["rows"].push_back({{"name", "d"}, {"depth_m", "missing"}, {"fills", "depth_m"}});
    const std::string html = report::render("{{#t}}{{> table}}{{/t}}", {{"t", rows}});
    for (const char* part :
         {"<table class=\"data odds\">", "<th>Name &lt;b&gt;</th>", "<th class=\"n\">Depth<br><small>m</small></th>",
          "<td><i class=\"dot hit-2\"></i>a&amp;b<br><small>until 3 s</small></td><td class=\"n\">1.23</td>",
          "<td class=\"n\">none</td>", "<th colspan=\"2\" scope=\"colgroup\">[part] <small>two</small></th>",
          "<td class=\"missing\" colspan=\"1\">missing</td>"}) {
        EXPECT_TRUE(has(html, part)) << part << "\n" << html;
    }
}

TEST(ReportPlot, ticks_are_round) {
    const report::Ticks ticks = report::round_ticks({0, 12.2}, 5);
    EXPECT_THAT(ticks.values, ElementsAre(0, 2.5, 5, 7.5, 10));
    EXPECT_EQ(ticks.digits, 1);
}

}  // namespace
}  // namespace talus::report
