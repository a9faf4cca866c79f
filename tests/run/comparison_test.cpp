#include "run/comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace talus::run {
namespace {

using testing::HasSubstr;

/// A base that passes 100 m at 10 m/s, hits a house at 12 s and runs out 200 m, and variants of it.
class Compare : public testing::Test {
  protected:
    Compare() {
        scene.spec.observations = {{"bend", 100, 9, {}, ""}};
        scene.flow_path = terrain::FlowPath({{0, 0}, {300, 0}}, 40);
        base.observation = observed(10, 12, 200);
    }

    static observe::Observation observed(double velocity, double hit, double run_out) {
        observe::Observation o;
        o.front = {{99, 8, velocity, velocity}, {101, 8.2, velocity, velocity}, {190, 20, 3, 3}};
        o.run_out.front_chainage = 210;
        o.run_out.along_flow = run_out;
        o.buildings.resize(2);
        o.buildings[1].hit = std::isfinite(hit);
        o.buildings[1].first_hit_time = hit;
        if (o.buildings[1].hit) {
            o.buildings[1].name = "mill";
            o.buildings[1].peak_force = 4e5;
            o.buildings[1].peak_impact_pressure = 3e4;
        }
        o.deposit = {500, 1.5};
        return o;
    }
    void add(const std::string& name, const observe::Observation& o) {
        VariantRun run{{.name = name, .overrides = {}}, RunResult{}, ""};
        run.result->observation = o;
        runs.push_back(run);
    }
    void add_missing() { runs.push_back({{.name = "gone", .overrides = {}}, std::nullopt, "interrupted"}); }
    Comparison compared(ComparisonKind kind = ComparisonKind::convergence) { return compare(kind, scene, base, runs); }

    scene::Scene scene;
    RunResult base;
    std::vector<VariantRun> runs;
};

TEST_F(Compare, changes_are_percent_of_the_base) {
    add("finer", observed(10.4, 11.7, 209));
    const Comparison c = compared();
    ASSERT_EQ(c.quantities.size(), 8U);
    EXPECT_EQ(c.quantities[0].name, "front velocity at 100 m");
    EXPECT_EQ(c.quantities[1].name, "first building hit");
    EXPECT_EQ(c.quantities[2].name, "run-out");
    EXPECT_EQ(c.quantities[3].name, "deposit area");
    EXPECT_EQ(c.quantities[4].name, "deposit depth");
    EXPECT_EQ(c.quantities[5].name, "buildings hit");
    EXPECT_EQ(c.quantities[6].name, "force on mill");
    EXPECT_EQ(c.quantities[7].name, "impact pressure on mill");
    const Comparison varied = compared(ComparisonKind::sensitivity);
    ASSERT_EQ(varied.quantities.size(), 8U) << "no judgement on each house";
    EXPECT_EQ(varied.quantities[6].name, "peak speed");
    const auto& changes = c.rows.at(0).changes;
    EXPECT_NEAR(changes[0].percent, 4, 1e-9);
    EXPECT_NEAR(changes[1].percent, -2.5, 1e-9);
    EXPECT_NEAR(changes[2].percent, 4.5, 1e-9);
    EXPECT_EQ(c.converged(), Answer::yes);
    EXPECT_EQ(c.rows[0].verdict(), Verdict::pass);
}

TEST_F(Compare, varied_inputs_are_compared_by_their_peaks_too) {
    const auto maps = [](float depth, float speed, float pressure) {
        HazardMaps all;
        for (auto [map, value] :
             {std::pair{&all.peak_depth, depth}, {&all.peak_speed, speed}, {&all.peak_pressure, pressure}}) {
            *map = Grid<float>({0, 0, 1, 2, 1}, value / 2);
            map->values[1] = value;
        }
        return all;
    };
    base.observation.maps = maps(2, 10, 200e3F);
    add("wet", observed(10, 12, 200));
    runs.back().peaks = observe::measure_peaks(maps(3, 26.5F, 400e3F));
    const Comparison c = compared(ComparisonKind::sensitivity);
    const auto& changes = c.rows.at(0).changes;
    EXPECT_NEAR(changes[5].percent, 50, 1e-6);
    EXPECT_NEAR(changes[6].value, 26.5, 1e-6);
    EXPECT_NEAR(changes[6].percent, 165, 1e-6);
    EXPECT_NEAR(changes[7].value, 400, 1e-6) << "kPa";
    EXPECT_NEAR(changes[7].percent, 100, 1e-6);
}

TEST_F(Compare, a_change_above_the_limit_either_way_fails) {
    add("faster", observed(10.51, 12, 200));
    add("slower", observed(9.49, 12, 200));
    add("same", observed(10, 12, 200));
    const Comparison c = compared();
    EXPECT_EQ(c.rows[0].verdict(), Verdict::fail);
    EXPECT_EQ(c.rows[1].verdict(), Verdict::fail);
    EXPECT_EQ(c.rows[2].verdict(), Verdict::pass);
    EXPECT_EQ(c.converged(), Answer::no);
    EXPECT_EQ(c.verdict_text(), "not converged: 2 of 24 changes above their limit");
}

TEST_F(Compare, what_only_one_of_the_two_reaches_fails) {
    observe::Observation stopped = observed(10, observe::never, 200);
    stopped.front.clear();
    add("stops before", stopped);
    const Comparison c = compared();
    const auto& changes = c.rows.at(0).changes;
    EXPECT_EQ(changes[0].verdict, Verdict::fail);
    EXPECT_EQ(changes[1].verdict, Verdict::fail);
    EXPECT_EQ(changes[2].verdict, Verdict::pass);

    base.observation = stopped;
    runs.clear();
    add("gets there", observed(10, 12, 200));
    EXPECT_EQ(compared().rows.at(0).changes[0].verdict, Verdict::fail);
}

TEST_F(Compare, what_neither_reaches_is_not_judged) {
    scene.spec.observations[0].chainage = 280;
    add("finer", observed(10, 12, 200));
    const Comparison c = compared();
    EXPECT_EQ(c.rows[0].changes[0].verdict, Verdict::not_measured);
    EXPECT_EQ(c.quantities[0].not_measured, "the front did not get there, or jumped along the path");
    EXPECT_EQ(c.converged(), Answer::yes);
}

TEST_F(Compare, without_a_building_hit_the_fronts_arrival_late_on_its_way_counts) {
    base.observation = observed(10, observe::never, 200);
    observe::Observation late = observed(10, observe::never, 200);
    late.front.back().arrival_time = 22;
    add("late", late);
    const Comparison c = compared();
    EXPECT_EQ(c.quantities[1].name, "front arrival at 189 m") << "90 % of 210 m";
    EXPECT_GT(c.rows[0].changes[1].percent, 5);
}

TEST_F(Compare, without_flow_path_observation_and_hit_only_run_out_is_measured) {
    scene.flow_path = {};
    scene.spec.observations.clear();
    observe::Observation bare = observed(10, observe::never, 200);
    bare.front.clear();
    bare.run_out.front_chainage = observe::never;
    bare.deposit = {};
    base.observation = bare;
    add("finer", bare);
    const Comparison c = compared();
    ASSERT_EQ(c.quantities.size(), 5U);
    EXPECT_THAT(c.quantities[0].not_measured, HasSubstr("no building was hit"));
    EXPECT_EQ(c.converged(), Answer::yes);
    base.observation.run_out.along_flow = observe::never;
    runs.clear();
    bare.run_out.along_flow = observe::never;
    add("finer", bare);
    EXPECT_EQ(compared().converged(), Answer::unknown);
    EXPECT_THAT(compared().verdict_text(), HasSubstr("nothing could be measured"));
}

TEST_F(Compare, a_missing_run_leaves_convergence_open_unless_a_change_is_too_large) {
    add("finer", observed(10, 12, 200));
    add_missing();
    EXPECT_EQ(compared().converged(), Answer::unknown);
    EXPECT_FALSE(compared().all_ran());
    EXPECT_EQ(compared().verdict_text(), "convergence not known: 1 of 2 runs missing");
    add("far off", observed(20, 12, 200));
    EXPECT_EQ(compared().converged(), Answer::no);
    EXPECT_EQ(compared().verdict_text(), "not converged: 1 of 16 changes above its limit, 1 of 3 runs missing");
}

TEST_F(Compare, each_result_has_its_own_limit) {
    observe::Observation finer = observed(10, 12, 200);
    finer.deposit = {549, 1.36};
    finer.buildings[1].peak_force *= 1.14;
    finer.buildings[1].peak_impact_pressure *= 0.86;
    add("finer", finer);
    EXPECT_EQ(compared().converged(), Answer::yes);
    const auto fails = [&](const auto& change) {
        observe::Observation off = finer;
        change(off);
        runs.clear();
        add("off", off);
        return compared().converged() == Answer::no;
    };
    EXPECT_TRUE(fails([](observe::Observation& o) { o.deposit.area = 551; }));
    EXPECT_TRUE(fails([](observe::Observation& o) { o.deposit.depth = 1.34; }));
    EXPECT_TRUE(fails([](observe::Observation& o) { o.buildings[1].peak_force = 4.61e5; }));
    EXPECT_TRUE(fails([](observe::Observation& o) { o.buildings[1].peak_impact_pressure = 2.54e4; }));
}

TEST_F(Compare, buildings_hit_must_be_the_same_but_for_a_touch) {
    observe::Observation other = observed(10, 12, 200);
    other.buildings[0].hit = true;
    other.buildings[0].first_hit_time = 13;
    other.buildings[0].peak_force = 1.9e4;  // under a twentieth of the largest
    add("touched", other);
    EXPECT_EQ(compared().converged(), Answer::yes);
    other.buildings[0].peak_force = 2.1e4;
    runs.clear();
    add("hit", other);
    EXPECT_EQ(compared().converged(), Answer::no);
}

TEST_F(Compare, two_observations_at_one_place_are_one_quantity) {
    scene.spec.observations.push_back({"again", 100, 8, {}, ""});
    add("finer", observed(10, 12, 200));
    EXPECT_EQ(compared().quantities.size(), 8U);
}

}  // namespace
}  // namespace talus::run
