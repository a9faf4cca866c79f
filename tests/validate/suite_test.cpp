#include "validate/suite.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "case_folder.hpp"
#include "validate/page.hpp"

namespace talus::validate {
namespace {

using testing::HasSubstr;

Expectation expect(const std::string& quantity, double expected, double tolerance) {
    Expectation e;
    e.quantity = quantity;
    e.expected = expected;
    e.tolerance = tolerance;
    e.source = "somebody";
    return e;
}

Case case_with(std::vector<Expectation> expectations) {
    Case c;
    c.name = "a case";
    c.kind = "sliding_slab";
    c.expectations = std::move(expectations);
    return c;
}

Row judged(const Expectation& e, double computed, std::optional<double> law = {}) {
    const auto rows = judge(case_with({e}), {{e.quantity, "", computed, law}});
    EXPECT_EQ(rows.size(), 1U);
    return rows.at(0);
}

TEST(Judge, compares_within_the_tolerance) {
    EXPECT_EQ(judged(expect("acceleration", 10, 0.05), 10.4).verdict, Verdict::pass);
    EXPECT_NEAR(judged(expect("acceleration", 10, 0.05), 10.4).relative_error, 0.04, 1e-12);
    EXPECT_NEAR(judged(expect("acceleration", -10, 0.05), -9).relative_error, 0.1, 1e-12);
    EXPECT_EQ(judged(expect("acceleration", 10, 0.05), 9.4).verdict, Verdict::fail);
    EXPECT_EQ(judged(expect("drift", 0, 0.001), -0.002).verdict, Verdict::fail);
    EXPECT_EQ(judged(expect("drift", 0, 0.001), -0.0005).verdict, Verdict::pass);
}

TEST(Judge, takes_the_law_where_the_entry_names_no_value) {
    Expectation e = expect("acceleration", 0, 0.01);
    e.expected.reset();
    const Row row = judged(e, 1.51, 1.5);
    EXPECT_EQ(row.expected, 1.5);
    EXPECT_EQ(row.verdict, Verdict::pass);
}

TEST(Judge, what_was_not_computed_fails) {
    for (const Comparison comparison : {Comparison::near, Comparison::at_most, Comparison::at_least}) {
        Expectation e = expect("drift", 1, 0.5);
        e.comparison = comparison;
        constexpr double infinity = std::numeric_limits<double>::infinity();
        for (const double computed : {not_computed, infinity, -infinity}) {
            EXPECT_EQ(judged(e, computed).verdict, Verdict::fail) << computed;
        }
    }
    const auto rows = judge(case_with({expect("drift", 0, 1)}), {});
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].verdict, Verdict::fail);
    EXPECT_TRUE(std::isnan(rows[0].computed));
}

TEST(Judge, bounds_fail_on_their_far_side_only) {
    Expectation most = expect("drift", 0.01, 0), least = expect("drift", 0.05, 0);
    most.comparison = Comparison::at_most;
    least.comparison = Comparison::at_least;
    most.tolerance.reset();
    least.tolerance.reset();
    EXPECT_EQ(judged(most, 0.009).verdict, Verdict::pass);
    EXPECT_EQ(judged(most, 0.009).relative_error, 0);
    EXPECT_EQ(judged(most, 0.012).verdict, Verdict::fail);
    EXPECT_NEAR(judged(most, 0.012).relative_error, 0.2, 1e-12);
    EXPECT_EQ(judged(least, 0.4).verdict, Verdict::pass);
    EXPECT_EQ(judged(least, 0.04).verdict, Verdict::fail);
    EXPECT_NEAR(judged(least, 0.04).relative_error, -0.2, 1e-12);
}

TEST(Judge, an_announced_failure_is_a_failure_until_it_passes) {
    Expectation e = expect("drift", 1, 0.1);
    e.known_failure = "creeps";
    EXPECT_EQ(judged(e, 2).verdict, Verdict::known_failure);
    EXPECT_EQ(judged(e, 1).verdict, Verdict::pass);
    CaseResult result;
    result.rows = {judged(e, 1)};
    EXPECT_THAT(table_text({result}), HasSubstr("passes now"));
}

TEST(Judge, what_is_only_shown_never_fails) {
    Expectation e = expect("drift", 1, 0.1);
    e.gate = false;
    EXPECT_EQ(judged(e, 7).verdict, Verdict::shown);
    EXPECT_EQ(judged(e, not_computed).verdict, Verdict::shown);
}

TEST(Judge, coarser_resolutions_only_show_the_trend_unless_named) {
    const std::vector<Measurement> measured = {{"drift", "coarse", 7, {}, true}, {"drift", "fine", 7, {}, false}};
    auto rows = judge(case_with({expect("drift", 1, 0.1)}), measured);
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0].verdict, Verdict::shown);
    EXPECT_EQ(rows[1].verdict, Verdict::fail);
    Expectation named = expect("drift", 1, 0.1);
    named.where = "coarse";
    rows = judge(case_with({named}), measured);
    EXPECT_EQ(rows.at(0).verdict, Verdict::fail);
}

TEST(Judge, an_entry_for_a_variant_goes_before_the_one_for_all) {
    Expectation all = expect("drift", 0, 1), one = expect("drift", 0, 1);
    one.where = "steep";
    one.known_failure = "creeps";
    const auto rows = judge(case_with({all, one}), {{"drift", "flat", 5, {}}, {"drift", "steep", 5, {}}});
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0].quantity, "drift, flat");
    EXPECT_EQ(rows[0].verdict, Verdict::fail);
    EXPECT_EQ(rows[1].quantity, "drift, steep");
    EXPECT_EQ(rows[1].verdict, Verdict::known_failure);
}

TEST(Judge, an_entry_for_a_variant_that_does_not_exist_fails) {
    Expectation one = expect("drift", 0, 1);
    one.where = "stepe";
    const auto rows = judge(case_with({one}), {{"drift", "steep", 0, {}}});
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].verdict, Verdict::fail);
    EXPECT_EQ(rows[0].quantity, "drift, stepe");
}

CaseResult sample_result() {
    Expectation shown = expect("clearance", 0, 0.1);
    shown.gate = false;
    CaseResult result;
    result.validation_case = case_with({expect("acceleration", 10, 0.05), expect("drift", 0, 0.1), shown});
    result.validation_case.title = "A <title> | with *marks*";
    result.rows = judge(result.validation_case,
                        {{"acceleration", "", 10.1, {}}, {"drift", "", not_computed, {}}, {"clearance", "", 3, {}}});
    result.charts = {{"profile",
                      "What & where",
                      "x, m",
                      "y, m",
                      {{"law", Series::Style::dashed, {0, 1}, {0, 1}},
                       {"computed <b>", Series::Style::line, {0, 1}, {0, 2}},
                       {"marks", Series::Style::marks, {0.5}, {not_computed}}}}};
    return result;
}

TEST(TableJson, has_the_agreed_keys_in_order_and_null_for_what_does_not_exist) {
    const auto list = nlohmann::ordered_json::parse(table_json({sample_result()}));
    ASSERT_EQ(list.size(), 3U);
    const std::vector<std::string> keys = {"case",           "quantity",  "expected", "computed",
                                           "relative_error", "tolerance", "pass",     "source"};
    for (const auto& object : list) {
        std::vector<std::string> found;
        for (const auto& [key, value] : object.items()) found.push_back(key);
        found.resize(keys.size());
        EXPECT_EQ(found, keys);
    }
    EXPECT_EQ(list[0]["pass"], true);
    EXPECT_EQ(list[0]["tolerance"], 0.05);
    EXPECT_NEAR(list[0]["relative_error"].get<double>(), 0.01, 1e-12);
    EXPECT_EQ(list[1]["pass"], false);
    EXPECT_TRUE(list[1]["computed"].is_null());
    EXPECT_TRUE(list[1]["relative_error"].is_null());
    EXPECT_TRUE(list[2]["pass"].is_null());
    EXPECT_EQ(list[2]["verdict"], "shown");
}

TEST(TableText, shows_failures_and_counts_them) {
    const std::string text = table_text({sample_result()});
    EXPECT_THAT(text, HasSubstr("FAIL"));
    EXPECT_THAT(text, HasSubstr("+1.0 %"));
    EXPECT_THAT(text, HasSubstr("1 passed, 1 failed, 0 of them known, 1 shown, 0 skipped"));
}

TEST(Page, holds_table_and_plots_and_escapes_what_it_is_given) {
    const std::string html = page_html(page_data({sample_result()}));
    EXPECT_THAT(html, HasSubstr("A &lt;title&gt; | with *marks*"));
    EXPECT_THAT(html, HasSubstr("computed &lt;b&gt;"));
    EXPECT_THAT(html, HasSubstr("<span class=\"verdict fail\">FAIL</span>"));
    EXPECT_THAT(html, HasSubstr("<a href=\"#case-")) << "the overview leads to the cases";
    EXPECT_THAT(html, HasSubstr("<svg class=\"figure\""));
    EXPECT_EQ(html.find("{{"), std::string::npos);
    EXPECT_EQ(html.find("http://www.w3.org/2000/svg"), std::string::npos) << "inline, nothing from the network";
    EXPECT_EQ(html.find("nan"), std::string::npos);
}

TEST(Page, shows_what_its_data_hold_also_after_they_were_written_and_read) {
    const report::Json data = page_data({sample_result()});
    EXPECT_EQ(data["format"], "talus validation");
    EXPECT_EQ(data["cases"][0]["charts"][0]["kind"], "chart");
    EXPECT_TRUE(page_html(data) == page_html(report::Json::parse(data.dump())));
}

TEST(Markdown, has_its_plots_beside_it) {
    const test::TemporaryFolder folder;
    const Status written = write_markdown({sample_result()}, folder.path() / "validation.md");
    ASSERT_TRUE(written) << written.error().message;
    const std::string text = test::read_text(folder.path() / "validation.md");
    EXPECT_THAT(text, HasSubstr("| a case | drift | 0 | - | - | 0.1 | somebody | **FAIL** |"));
    EXPECT_THAT(text, HasSubstr("## A \\<title> \\| with \\*marks\\*"));
    EXPECT_THAT(text, HasSubstr("(validation/a case_profile.svg)"));
    const std::string svg = test::read_text(folder.path() / "validation" / "a case_profile.svg");
    EXPECT_THAT(svg, HasSubstr("xmlns=\"http://www.w3.org/2000/svg\""));
    EXPECT_THAT(svg, HasSubstr("class=\"panel\""));
    EXPECT_FALSE(write_markdown({sample_result()}, "/dev/null/no/validation.md"));
}

TEST(RunCase, computes_a_small_slab) {
    const Result<Case> loaded = CaseFolder(small_case).load();
    ASSERT_TRUE(loaded) << loaded.error().message;
    Watch watch;
    watch.thread_count = 1;
    const CaseResult result = run_case(*loaded, watch);
    ASSERT_EQ(result.rows.size(), 1U);
    EXPECT_EQ(result.rows[0].verdict, Verdict::pass);
    EXPECT_EQ(result.rows[0].quantity, "clearance, slope 30 degrees, f = 0.4");
}

TEST(RunCase, without_its_data_is_skipped_by_name) {
    const Result<Case> loaded =
        CaseFolder(changed_case("description", "needs_data = \"no/such/raster.tif\"\ndescription")).load();
    ASSERT_TRUE(loaded) << loaded.error().message;
    const CaseResult result = run_case(*loaded, {});
    ASSERT_EQ(result.rows.size(), 1U);
    EXPECT_EQ(result.rows[0].verdict, Verdict::skipped);
    EXPECT_THAT(result.skipped, HasSubstr("no/such/raster.tif"));
    EXPECT_THAT(table_text({result}), HasSubstr("skipped: "));
    EXPECT_EQ(count({result}).passed, 0);
    EXPECT_TRUE(nlohmann::json::parse(table_json({result}))[0]["pass"].is_null());
}

TEST(RunCase, when_asked_to_stop_does_so) {
    const Result<Case> loaded = CaseFolder(small_case).load();
    ASSERT_TRUE(loaded);
    const std::atomic<bool> stop = true;
    Watch watch;
    watch.stop_requested = &stop;
    const CaseResult result = run_case(*loaded, watch);
    EXPECT_EQ(result.rows.at(0).verdict, Verdict::fail);
    ASSERT_EQ(result.notes.size(), 1U);
    EXPECT_THAT(result.notes[0], HasSubstr("stopped by the user"));
}

}  // namespace
}  // namespace talus::validate
