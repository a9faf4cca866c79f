#include "run/verdict.hpp"

#include <gmock/gmock.h>

namespace talus::run {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;

/// A run of particles that keeps every limit.
RunResult good_run() {
    RunResult run;
    run.particle_spacing = 0.5;
    run.observation.thickness = {1.5, 0.8};
    run.observation.energy.share = 0.64;
    run.observation.energy.gained = -0.2;
    observe::TimeSample end;
    end.time = 60;
    end.volume_moving = 0.5;
    end.volume_deposited = 99.5;
    run.observation.timeseries = {end};
    return run;
}

CheckState state_of(const RunResult& run, std::string_view key) {
    return judge(run).check(key).state;
}

TEST(RunVerdict, of_a_good_run_is_within_limits) {
    const RunVerdict verdict = judge(good_run());
    EXPECT_TRUE(verdict.within_limits());
    EXPECT_EQ(verdict.text(), "Within limits");
    EXPECT_EQ(verdict.keys(), "");
    EXPECT_TRUE(verdict.warnings().empty());
    EXPECT_EQ(verdict.check("resolution").value, 3);
    EXPECT_EQ(verdict.check("resolution").limit, 2);
    EXPECT_THAT(verdict.check("energy").text, HasSubstr("80 % of free fall"));
    EXPECT_EQ(verdict.check("convergence").state, CheckState::not_measured);
}

TEST(RunVerdict, says_which_limit_is_exceeded_and_what_that_means) {
    RunResult run = good_run();
    run.observation.thickness.median = 0.45;
    EXPECT_EQ(judge(run).text(), "Beyond limits: resolution");
    EXPECT_THAT(judge(run).check("resolution").text, HasSubstr("0.9 particles thick"));
    EXPECT_THAT(judge(run).check("resolution").text, HasSubstr("mean little"));

    run.observation.compression.time_share_above = 0.2;
    EXPECT_THAT(judge(run).check("compression").text, HasSubstr("Debris too compressed during 20 %"));

    observe::Energy& energy = run.observation.energy;
    energy.share = 8;
    energy.speed = 280;
    energy.fall = 480;
    energy.allowed_speed = 99;
    energy.at = {1234.4, 5678.6};
    energy.cells_above = 17;
    energy.cells = 400;
    EXPECT_THAT(judge(run).check("energy").text, HasSubstr("280 m/s at (1234, 5679)"));
    EXPECT_THAT(judge(run).check("energy").text, HasSubstr("a fall of 480 m allows 99 m/s, and so in 17 of 400"));

    run.observation.timeseries.back().volume_moving = 30;
    run.observation.timeseries.back().volume_deposited = 70;
    EXPECT_THAT(judge(run).check("still_moving").text, HasSubstr("30 % of the debris (30 m3) still moved"));

    run.observation.timeseries.back().volume_moving = 1510;
    run.observation.timeseries.back().volume_deposited = 0.1;
    EXPECT_THAT(judge(run).check("still_moving").text, StartsWith("100 % of the debris (1510 m3) still moved"));

    const RunVerdict verdict = judge(run);
    EXPECT_FALSE(verdict.within_limits());
    EXPECT_EQ(verdict.text(), "Beyond limits: resolution, compression, energy, still moving");
    EXPECT_EQ(verdict.keys(), "resolution compression energy still_moving");
    EXPECT_EQ(verdict.warnings().size(), 4);
}

TEST(RunVerdict, is_in_sentences_that_begin_with_a_capital_where_they_stand_alone) {
    RunResult thin = good_run(), grid = good_run(), empty, unfinished = good_run();
    thin.observation.thickness.median = 0.45;
    thin.observation.compression.time_share_above = 0.2;
    grid.grid_cell = 2;
    unfinished.status = RunStatus::interrupted;
    for (const RunResult& run : {good_run(), thin, grid, empty, unfinished}) {
        for (const Check& check : judge(run).checks) EXPECT_THAT(check.text, MatchesRegex("[A-Z0-9].*[^.]"));
    }
    EXPECT_THAT(judge(thin).warnings().at(0), StartsWith("Resolution: the flow is 0.9"));
    EXPECT_THAT(judge_together({judge(thin)}).warnings().at(0), StartsWith("Resolution: beyond its limit in 1 of 1"));
}

TEST(RunVerdict, counts_energy_that_was_gained_at_any_speed) {
    RunResult run = good_run();
    run.observation.energy.gained = 0.08;
    run.observation.energy.gained_time = 12;
    EXPECT_EQ(state_of(run, "energy"), CheckState::beyond);
    EXPECT_THAT(judge(run).check("energy").text, HasSubstr("gained 8 % of the energy of its whole fall by t = 12 s"));
}

TEST(RunVerdict, does_not_judge_what_a_model_does_not_measure) {
    RunResult run = good_run();
    run.grid_cell = 2;
    run.particle_spacing = 0;
    for (const char* key : {"resolution", "compression"}) {
        EXPECT_EQ(state_of(run, key), CheckState::not_measured);
        EXPECT_TRUE(std::isnan(judge(run).check(key).value));
        EXPECT_THAT(judge(run).check(key).text, HasSubstr("Not measured"));
    }
    EXPECT_EQ(state_of(run, "energy"), CheckState::within);

    run.observation.energy = {};
    EXPECT_EQ(state_of(run, "energy"), CheckState::not_measured);
    run.status = RunStatus::interrupted;
    run.observation.timeseries.back().volume_moving = 90;
    EXPECT_EQ(state_of(run, "still_moving"), CheckState::not_measured) << "it did not come to its end";
}

TEST(RunVerdict, of_a_zoom_has_the_energy_of_what_feeds_it) {
    RunResult run = good_run();
    run.zoom.emplace();
    run.zoom->energy.share = 0.9;
    EXPECT_EQ(state_of(run, "energy"), CheckState::within);
    run.zoom->energy.share = 4;
    EXPECT_EQ(state_of(run, "energy"), CheckState::beyond);
    EXPECT_THAT(judge(run).check("energy").text, HasSubstr("In the depth-averaged run that feeds the zoom, the flow"));
}

TEST(RunVerdict, of_many_runs_has_the_worst_and_how_many_there_are) {
    RunResult thin = good_run(), thinner = good_run();
    thin.observation.thickness.median = 0.8;
    thinner.observation.thickness.median = 0.45;
    const RunVerdict all = judge_together({judge(good_run()), judge(thinner), judge(thin)});
    EXPECT_EQ(all.check("resolution").value, 0.9);
    EXPECT_THAT(all.check("resolution").text,
                HasSubstr("Beyond its limit in 2 of 3 runs; in the worst, the flow is 0.9"));
    EXPECT_EQ(all.check("energy").state, CheckState::within);
    EXPECT_EQ(all.text(), "Beyond limits: resolution");
    EXPECT_TRUE(judge_together({}).within_limits());
}

TEST(RunVerdict, is_read_as_it_was_written) {
    RunResult run = good_run();
    run.observation.thickness.median = 0.45;
    const RunVerdict verdict = judge(run);
    const auto json = verdict_json(verdict);
    EXPECT_EQ(json["within_limits"], false);
    EXPECT_EQ(json["text"], "Beyond limits: resolution");
    EXPECT_THAT(json["warnings"][0].get<std::string>(), HasSubstr("Resolution: the flow is 0.9"));
    EXPECT_EQ(json["checks"][0]["state"], "beyond");
    EXPECT_EQ(json["checks"][0]["value"], 0.9);
    EXPECT_TRUE(json["checks"][4]["value"].is_null());
    EXPECT_EQ(verdict_json(verdict_of(json["checks"])), json);
    auto later = json["checks"];
    later.push_back({{"key", "of a later version"}, {"state", "beyond"}});
    EXPECT_EQ(verdict_of(later).checks.size(), 5);
}

TEST(RunVerdict, is_that_of_convergence_where_it_was_tested) {
    Comparison tested;
    tested.quantities = {{"run_out", "m", "run-out", "m"}};
    Comparison::Row row;
    row.run.result = good_run();
    Change change;
    change.verdict = Verdict::fail;
    row.changes = {change};
    tested.rows = {row};
    const RunVerdict verdict = judge(good_run(), {tested});
    EXPECT_EQ(verdict.text(), "Beyond limits: convergence");
    EXPECT_THAT(verdict.check("convergence").text, HasSubstr("Not converged: 1 of 1 changes above its limit"));
    tested.rows[0].changes[0].verdict = Verdict::pass;
    EXPECT_EQ(judge(good_run(), {tested}).check("convergence").state, CheckState::within);
    tested.kind = ComparisonKind::sensitivity;
    EXPECT_EQ(judge(good_run(), {tested}).check("convergence").state, CheckState::not_measured);
}

}  // namespace
}  // namespace talus::run
