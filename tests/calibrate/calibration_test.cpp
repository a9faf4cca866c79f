#include "calibrate/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrate/calibration_products.hpp"
#include "scene/scene_folder.hpp"

namespace talus::calibrate {
namespace {

using testing::Contains;
using testing::HasSubstr;

TEST(Calibration, a_shares_value_has_that_share_below_it) {
    for (const char* text : {"0.1:0.6", "log:0.01:1", "normal:3:0.5", "triangular:0:0.2:1"}) {
        const auto distribution = stats::parse_distribution(text);
        ASSERT_TRUE(distribution);
        for (const double share : {0.02, 0.5, 0.9})
            EXPECT_NEAR(share_below(*distribution, distribution->quantile(share)), share, 1e-6) << text;
    }
}

/// Runs of the valley that are made up instead of simulated.
class CalibrationTest : public scene::SceneFolder {
  protected:
    CalibrationTest() {
        write_valley(
            "[solver]\nparticle_spacing_m = 3\nend_time_s = 30\n[[observation]]\nchainage_m = 50\n"
            "front_velocity_mps = 8\nuncertainty_mps = 1\n[[arrival]]\nchainage_m = 60\ntime_s = 12\n");
        scene.emplace(*scene::load_scene(folder / "scene.toml"));
        made.scene = &*scene;
        made.factors = {{"material.friction_coefficient", *stats::parse_distribution("0.1:0.5")},
                        {"material.viscosity", *stats::parse_distribution("0:0.4")}};
        made.observed = ensemble::observed_values(*scene);
    }

    void search_with(const std::function<std::vector<double>(const std::vector<double>&)>& run) {
        const ForwardModel model = [&](const stats::Points& points,
                                       SearchPhase) -> Result<std::optional<stats::Points>> {
            stats::Points all;
            for (const auto& p : points) all.push_back(run(p));
            return std::optional(all);
        };
        const auto found =
            search({made.factors[0].distribution, made.factors[1].distribution}, made.observed, model, {.runs = 40});
        ASSERT_TRUE(found);
        made.result = *found;
        made.records.resize(made.result.runs.size());
    }

    std::optional<scene::Scene> scene;
    Calibration made;
};

TEST_F(CalibrationTest, knows_what_stands_for_no_prediction) {
    ASSERT_EQ(made.observed.size(), 2u);
    EXPECT_EQ(made.observed[0].unreached, 0);   // no front, no velocity
    EXPECT_EQ(made.observed[1].unreached, 30);  // it had not come when the run ended
}

TEST_F(CalibrationTest, warns_of_what_is_not_known) {
    search_with([](const std::vector<double>& p) { return std::vector<double>{16 - 16 * p[0], 12}; });
    const CalibrationSummary summary = summarise(made);
    EXPECT_NEAR(summary.factors[0].median, 0.3, 0.03);
    EXPECT_LT(summary.factors[0].kept, 0.4);
    EXPECT_GT(summary.factors[1].kept, 0.8);
    EXPECT_THAT(summary.warnings, Contains(HasSubstr("material.viscosity is hardly constrained")));
    EXPECT_THAT(summary.warnings, testing::Not(Contains(HasSubstr("is not explained"))));
}

TEST_F(CalibrationTest, expects_nothing_that_cannot_be) {
    // Around a velocity of 0.2 m/s the normal error of the emulator reaches far below 0.
    made.observed[0].value = 0.2;
    made.observed[0].uncertainty = 0.1;
    search_with([](const std::vector<double>& p) {
        return std::vector<double>{std::max(0.0, 0.2 + std::sin(40 * p[0]) + std::sin(90 * p[1])), 12};
    });
    EXPECT_EQ(summarise(made).observations[0].low, 0);
    made.observed[0].least = -std::numeric_limits<double>::infinity();
    EXPECT_LT(summarise(made).observations[0].low, 0) << "else nothing was to be cut";
}

TEST_F(CalibrationTest, warns_where_nothing_fits) {
    search_with([](const std::vector<double>& p) { return std::vector<double>{30 - 10 * p[0], 12}; });
    const CalibrationSummary summary = summarise(made);
    EXPECT_GT(summary.observations[0].deviation, 10);
    EXPECT_THAT(summary.warnings,
                Contains(HasSubstr("Front velocity at 50 m is not explained: the best run gives 20")));
    EXPECT_THAT(summary.warnings, Contains(HasSubstr("material.friction_coefficient is pressed against the high end")));
}

TEST_F(CalibrationTest, sees_that_two_factors_stand_for_each_other) {
    search_with([](const std::vector<double>& p) { return std::vector<double>{16 - 8 * (p[0] + p[1]), 12}; });
    EXPECT_THAT(summarise(made).warnings, Contains(HasSubstr("are correlated by -0.")));
}

TEST_F(CalibrationTest, the_report_shows_what_results_hold_also_after_they_were_written_and_read) {
    search_with([](const std::vector<double>& p) { return std::vector<double>{16 - 16 * p[0], 12}; });
    const auto results = calibration_results(made, summarise(made), misfit_map(made));
    EXPECT_EQ(results["format"], "talus calibration");
    EXPECT_EQ(results["factors"]["rows"][0]["key"], "material.friction_coefficient");
    EXPECT_EQ(results["misfit"]["kind"], "chart");
    const std::string page = calibration_report(results);
    EXPECT_THAT(page, HasSubstr("material.viscosity is hardly constrained"));
    EXPECT_EQ(page.find("{{"), std::string::npos);
    EXPECT_EQ(page.find("nan"), std::string::npos);
    EXPECT_TRUE(page == calibration_report(nlohmann::ordered_json::parse(results.dump())));
}

TEST_F(CalibrationTest, the_map_is_low_where_the_runs_fit) {
    search_with([](const std::vector<double>& p) { return std::vector<double>{16 - 16 * p[0], 12}; });
    const MisfitMap map = misfit_map(made);
    ASSERT_EQ(map.misfit.size(), map.cells * map.cells);
    EXPECT_DOUBLE_EQ(map.x.front(), 0.1);
    EXPECT_DOUBLE_EQ(map.y.back(), 0.4);
    EXPECT_NEAR(map.misfit[map.cells / 2], 0, 0.3);  // friction 0.3
    EXPECT_GT(map.misfit[0], 30);
    EXPECT_GT(map.misfit[map.cells - 1], 30);
}

TEST_F(CalibrationTest, says_after_each_round_what_it_knows) {
    made.factors.push_back({"material.rest_density_kgpm3", *stats::parse_distribution("1500:2500")});
    const ForwardModel model = [](const stats::Points& points, SearchPhase) -> Result<std::optional<stats::Points>> {
        stats::Points all;
        for (const auto& p : points) all.push_back({16 - 16 * p[0], 12});
        return std::optional(all);
    };
    std::vector<stats::Distribution> priors;
    for (const ensemble::Factor& f : made.factors) priors.push_back(f.distribution);
    std::vector<std::size_t> runs;
    const auto found = search(priors, made.observed, model, {.runs = 40}, [&](const SearchResult& so_far) {
        runs.push_back(so_far.runs.size());
        EXPECT_TRUE(so_far.best);
        made.result = so_far;
        const MisfitMap map = misfit_map(made);  // without draws from a posterior
        EXPECT_EQ(map.misfit.size(), map.cells * map.cells);
        EXPECT_LT(map.misfit[map.cells / 2], 1);
    });
    ASSERT_TRUE(found);
    ASSERT_GE(runs.size(), 2u);
    EXPECT_LT(runs.front(), runs.back());
    EXPECT_EQ(runs.back(), found->runs.size());
}

}  // namespace
}  // namespace talus::calibrate
