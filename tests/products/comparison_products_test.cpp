#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "products/products.hpp"
#include "products/writers.hpp"
#include "report/report_fixture.hpp"
#include "support/fixtures.hpp"

namespace talus::products {
namespace {

using nlohmann::json;
using test::read_text;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class ComparisonProducts : public testing::Test {
  protected:
    scene::Scene scene = test::sample_scene();
    run::RunResult result = test::sample_result(scene);
    std::vector<run::Comparison> comparisons = test::sample_comparisons(scene, result);
    test::TemporaryFolder folder;

    [[nodiscard]] std::vector<std::vector<std::string>> rows(const std::string& name) const {
        std::vector<std::vector<std::string>> all;
        std::istringstream in(read_text(folder.path() / name));
        for (std::string line; std::getline(in, line);) {
            std::vector<std::string> cells;
            std::istringstream fields(line + ",");
            for (std::string field; std::getline(fields, field, ',');) cells.push_back(field);
            all.push_back(cells);
        }
        return all;
    }
    [[nodiscard]] std::string page() const { return test::report_page(scene, result, comparisons); }
    /// What the report says of comparisons alone.
    [[nodiscard]] std::string sections() const {
        const std::string all = page();
        const std::size_t start =
            std::min(all.find("<section id=\"convergence\">"), all.find("<section id=\"sensitivity\">"));
        const std::size_t end = all.find("<section id=\"method\">");
        return start < end ? all.substr(start, end - start) : "";
    }
};

TEST_F(ComparisonProducts, tables_have_a_row_per_run_and_two_columns_per_quantity) {
    ASSERT_TRUE(write_comparisons(comparisons, result, folder.path()).ok());
    const auto table = rows("convergence.csv");
    ASSERT_EQ(table.size(), 5U) << "header, as given, three refinements";
    for (const auto& row : table) EXPECT_EQ(row.size(), table[0].size()) << row[0];
    EXPECT_THAT(std::vector(table[0].begin(), table[0].begin() + 5),
                ElementsAre("variant", "overrides", "outcome", "front_velocity_at_121_m_mps",
                            "front_velocity_at_121_m_change_percent"));
    EXPECT_EQ(table[1][0], "as given");
    EXPECT_EQ(table[1][4], "");
    EXPECT_EQ(table[2][1], "solver.displacement_limit=0.25");
    EXPECT_EQ(table[2][2], "pass");
    EXPECT_NEAR(std::stod(table[2][4]), 2, 1e-6);
    EXPECT_EQ(table[3][2], "fail");
    EXPECT_EQ(table[4][2], "missing: interrupted at t = 12.3 s");
    EXPECT_EQ(table[4][3], "");

    const auto varied = rows("variants.csv");
    ASSERT_EQ(varied.size(), 12U);
    EXPECT_EQ(varied[2][2], "complete") << "a sensitivity passes no judgement";
}

TEST_F(ComparisonProducts, stand_in_the_folder_and_in_the_manifest) {
    ASSERT_TRUE(write_products(scene, result, folder.path(), comparisons).ok());
    const json manifest = json::parse(read_text(folder.path() / "manifest.json"));
    EXPECT_THAT(manifest.at("files"), testing::IsSupersetOf({"convergence.csv", "variants.csv"}));
    const json& convergence = manifest.at("comparisons").at("convergence");
    EXPECT_EQ(convergence.at("converged"), false);
    EXPECT_EQ(convergence.at("quantities").at(0).at("limit_percent"), 5);
    EXPECT_EQ(convergence.at("variants").at(0).at("verdict"), "pass");
    EXPECT_NEAR(convergence.at("variants").at(1).at("values").at("front_velocity_at_121_m").at("change_percent"), -7,
                1e-9);
    EXPECT_EQ(convergence.at("variants").at(2).at("missing"), "interrupted at t = 12.3 s");
    EXPECT_EQ(manifest.at("comparisons").at("sensitivity").at("variants").size(), 10U);
    EXPECT_THAT(read_text(folder.path() / "report.html"), HasSubstr("<section id=\"convergence\">"));
}

TEST_F(ComparisonProducts, nothing_is_said_of_them_without_variants) {
    const std::string html = test::report_page(scene, result);
    EXPECT_THAT(html, Not(HasSubstr("<section id=\"convergence\">")));
    EXPECT_THAT(html, Not(HasSubstr("<section id=\"sensitivity\">")));
}

TEST_F(ComparisonProducts, convergence_unknown_is_not_called_converged) {
    EXPECT_THAT(page(), HasSubstr("<dd class=\"beyond\"><b>Convergence.</b> Not converged: 3 of 22 changes above their "
                                  "limit, 1 of 3 runs missing"));
    EXPECT_THAT(sections(), HasSubstr("Not converged: 3 of 22 changes above their limit, 1 of 3 runs missing"));

    comparisons[0].rows.erase(comparisons[0].rows.begin() + 1);
    EXPECT_THAT(page(), HasSubstr("<dd class=\"not-measured\"><b>Convergence.</b> Convergence not known: "));
    comparisons[0].rows.pop_back();
    EXPECT_THAT(page(), HasSubstr("<b>Convergence.</b> Converged: none of 11 changes above its limit"));
    EXPECT_THAT(sections(), HasSubstr("<b class=\"good\">Converged: none of 11 changes above its limit.</b>"));
}

TEST_F(ComparisonProducts, report_says_what_is_missing_and_what_was_not_measured) {
    scene.spec.observations.clear();
    result.observation.front.clear();
    result.observation.run_out.front_chainage = observe::never;
    for (observe::BuildingImpact& building : result.observation.buildings) building.hit = false;
    comparisons = {compare(run::ComparisonKind::convergence, scene, result,
                           {test::sample_variant(result, "double the iterations", "solver.iteration_count=8", 1),
                            {{.name = "gone", .overrides = {}}, std::nullopt, "interrupted before it began"}})};
    const std::string html = sections();
    EXPECT_THAT(html, HasSubstr("gone is missing: interrupted before it began"));
    EXPECT_THAT(html, HasSubstr("The scene has no observation"));
    EXPECT_THAT(html, HasSubstr("Not measured in the run as given: first building hit"));
    EXPECT_THAT(html, Not(HasSubstr("<figure>"))) << "no front, nothing to draw";
}

TEST_F(ComparisonProducts, texts_of_users_are_escaped) {
    const std::string evil = "<script>alert(1)</script>";
    comparisons = {
        compare(run::ComparisonKind::sensitivity, scene, result,
                {test::sample_variant(result, evil, evil, 1), {{.name = evil, .overrides = {}}, std::nullopt, evil}})};
    EXPECT_THAT(sections(), Not(HasSubstr("<script>")));
    EXPECT_THAT(sections(), HasSubstr("&lt;script&gt;"));
}

}  // namespace
}  // namespace talus::products
