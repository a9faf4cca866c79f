#include "ensemble/ensemble.hpp"

#include <atomic>
#include <optional>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ensemble/ensemble_products.hpp"
#include "geo/raster.hpp"
#include "geo/vector.hpp"
#include "scene/scene_folder.hpp"
#include "support/fixtures.hpp"

namespace talus::ensemble {
namespace {

using testing::HasSubstr;

class EnsembleTest : public scene::SceneFolder {
  protected:
    EnsembleTest() {
        write_valley(
            "[solver]\nparticle_spacing_m = 3\nend_time_s = 2\nstop_moving_share = 0\n[[observation]]\n"
            "chainage_m = 20\nfront_velocity_mps = 5\n");
        source.file = folder / "scene.toml";
        plan.runs = 6;
        plan.factors.clear();
        EXPECT_TRUE(add_factor(plan, "material.friction_coefficient=0.1:0.4"));
        EXPECT_TRUE(add_factor(plan, "release.volume_m3=600:1200"));
        scene.emplace(*scene::load_scene(source.file));
    }

    [[nodiscard]] PlannedRuns planned() const {
        auto runs = PlannedRuns::make(plan, source, *scene);
        EXPECT_TRUE(runs) << (runs ? "" : runs.error().message);
        return *std::move(runs);
    }
    [[nodiscard]] Result<EnsembleFolder> opened(const std::string& name) const {
        return EnsembleFolder::open(folder / name, ensemble_definition(planned(), source, *scene, "valley"));
    }
    [[nodiscard]] std::string identity() const {
        return plan_identity(ensemble_definition(planned(), source, *scene, "valley"));
    }
    EnsembleOutcome run(const std::string& name, const EnsembleOptions& options) const {
        auto made = opened(name);
        EXPECT_TRUE(made) << (made ? "" : made.error().message);
        const auto outcome = run_ensemble(planned(), source, *made, options);
        EXPECT_TRUE(outcome) << (outcome ? "" : outcome.error().message);
        return *outcome;
    }
    [[nodiscard]] std::vector<std::string> hashes(const std::vector<std::string>& names) const {
        std::vector<std::filesystem::path> folders;
        for (const auto& name : names) folders.push_back(folder / name);
        const auto reduction = reduce(folders, plan.runs, identity(), plan.thresholds);
        EXPECT_TRUE(reduction) << (reduction ? "" : reduction.error().message);
        std::vector<std::string> list;
        for (const RunRecord& r : reduction->runs) list.push_back(r.hash + r.fault);
        return list;
    }

    run::SceneSource source;
    EnsemblePlan plan;
    std::optional<scene::Scene> scene;
};

TEST_F(EnsembleTest, is_the_same_side_by_side_one_after_the_other_and_in_shards) {
    run("one", {.runs_at_once = 1});
    run("two", {.runs_at_once = 2});
    run("first", {.runs_at_once = 1, .shard = 0, .shard_count = 2});
    run("second", {.runs_at_once = 2, .shard = 1, .shard_count = 2});
    const auto expected = hashes({"one"});
    ASSERT_EQ(expected.size(), 6u);
    EXPECT_NE(expected[0], expected[1]);
    EXPECT_EQ(hashes({"two"}), expected);
    EXPECT_EQ(hashes({"first"}).size(), 3u);
    EXPECT_EQ(hashes({"first", "second"}), expected);
}

TEST_F(EnsembleTest, goes_on_where_it_stopped) {
    std::atomic<bool> stop = false;
    EnsembleOptions options;
    options.stop_requested = &stop;
    options.on_progress = [&](const EnsembleProgress& p) { stop = p.done >= 2; };
    const EnsembleOutcome first = run("part", options);
    EXPECT_TRUE(first.interrupted);
    EXPECT_EQ(first.done, 2u);
    const EnsembleOutcome rest = run("part", {});
    EXPECT_FALSE(rest.interrupted);
    EXPECT_EQ(rest.resumed, 2u);
    EXPECT_EQ(rest.done, 6u);
    run("whole", {});
    EXPECT_EQ(hashes({"part"}), hashes({"whole"}));
}

TEST_F(EnsembleTest, damaged_runs_and_those_of_others_are_made_again) {
    run("mended", {});
    const auto expected = hashes({"mended"});
    const auto file = [&](const std::string& name, int number) {
        return folder / name / "runs" / fmt::format("{:06}.run", number);
    };
    std::string text = test::read_text(file("mended", 0));
    text.back() = static_cast<char>(text.back() ^ 1);
    write("mended/runs/000000.run", text);
    std::filesystem::copy_file(file("mended", 1), file("mended", 2), std::filesystem::copy_options::overwrite_existing);
    plan.seed = 2;
    run("other", {});
    std::filesystem::copy_file(file("other", 3), file("mended", 3), std::filesystem::copy_options::overwrite_existing);
    plan.seed = 1;
    write("mended/runs/.000004.run.unfinished-1", "left by a process that was killed");
    std::vector<std::string> notes;
    EnsembleOptions options;
    options.on_refused = [&](const std::string& why) { notes.push_back(why); };
    EXPECT_EQ(run("mended", options).resumed, 3u);
    ASSERT_EQ(notes.size(), 3u);
    EXPECT_THAT(notes[0], HasSubstr("000000.run: is damaged"));
    EXPECT_THAT(notes[1], HasSubstr("000002.run: is run 1, not run 2; the run is made again"));
    EXPECT_THAT(notes[2], HasSubstr("000003.run: is a run of another plan"));
    EXPECT_EQ(hashes({"mended"}), expected);
    EXPECT_FALSE(std::filesystem::exists(folder / "mended/runs/.000004.run.unfinished-1"));
}

TEST_F(EnsembleTest, a_run_that_fails_is_recorded_and_the_rest_go_on) {
    plan.factors.clear();
    ASSERT_TRUE(add_factor(plan, "solver.particle_limit=10,100000"));
    const EnsembleOutcome outcome = run("some", {});
    EXPECT_EQ(outcome.done + outcome.failed, 6u);
    EXPECT_EQ(outcome.failed, 3u);
    const auto reduction = reduce({folder / "some"}, 6, identity(), plan.thresholds);
    ASSERT_TRUE(reduction);
    for (const RunRecord& r : reduction->runs) {
        EXPECT_EQ(r.complete(), r.values[0] == "100000");
        if (!r.complete()) {
            EXPECT_THAT(r.fault, HasSubstr("particle_limit"));
        }
    }
    EXPECT_EQ(run("some", {}).resumed, 6u);  // it would fail again
    const EnsembleOutcome again = run("some", {.retry_failed = true});
    EXPECT_EQ(again.resumed, 3u);
}

TEST_F(EnsembleTest, a_fault_of_a_run_is_kept) {
    plan.factors.clear();
    source.overrides = {"solver.largest_time_step_s=0.25", "material.viscosity=0", "solver.end_time_s=8"};
    ASSERT_TRUE(add_factor(plan, "solver.smallest_time_step_s=0.25,0.001"));
    EXPECT_EQ(run("some", {}).failed, 3u);
    const auto reduction = reduce({folder / "some"}, 6, identity(), plan.thresholds);
    ASSERT_TRUE(reduction);
    for (const RunRecord& r : reduction->runs) {
        const auto kept = folder / "some" / "faults" / fmt::format("run_{}", r.run);
        EXPECT_EQ(std::filesystem::exists(kept / "fault.json"), !r.complete());
        EXPECT_EQ(std::filesystem::exists(kept / "last_good_state.csv"), !r.complete());
        if (!r.complete()) {
            EXPECT_THAT(r.fault, HasSubstr("; particle "));
        }
    }
}

TEST_F(EnsembleTest, a_folder_belongs_to_one_ensemble_and_one_process) {
    {
        const auto held = opened("mine");
        ASSERT_TRUE(held);
        const auto second = opened("mine");
        ASSERT_FALSE(second);
        EXPECT_THAT(second.error().message, HasSubstr("another process computes this ensemble"));
    }
    EXPECT_TRUE(opened("mine"));
    plan.seed = 2;
    const auto other = opened("mine");
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().message, HasSubstr("holds another ensemble (seed: 1, not 2)"));
    write("notes.txt", "mine");
    std::filesystem::create_directories(folder / "full");
    write("full/notes.txt", "mine");
    EXPECT_FALSE(opened("full"));
    EXPECT_FALSE(opened("notes.txt"));
}

TEST_F(EnsembleTest, all_runs_have_the_spacing_and_the_map_of_the_scene) {
    const PlannedRun planned_run = planned().at(0);
    const auto loaded = scene::load_scene(source.file, planned_run.overrides);
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_DOUBLE_EQ(*loaded->spec.solver.particle_spacing, 3);
    EXPECT_TRUE(loaded->spec.outputs.map_cell);
    EXPECT_FALSE(loaded->spec.releases[0].thickness);  // the factor takes the place of the scene's thickness
    EXPECT_EQ(fmt::format("{:.9g}", *loaded->spec.releases[0].volume), planned_run.values[1]);
}

TEST_F(EnsembleTest, a_return_period_makes_hazard_zones) {
    run("zoned", {.runs_at_once = 2});
    const auto written = [&] {
        const PlannedRuns runs = planned();
        auto reduction = reduce({folder / "zoned"}, 6, identity(), plan.thresholds);
        const EnsembleResult result = summarise(*scene, runs, *std::move(reduction));
        const Status status = write_ensemble(result, folder / "zoned");
        EXPECT_TRUE(status) << status.error().message;
        return nlohmann::ordered_json::parse(test::read_text(folder / "zoned/results.json"));
    };
    const auto without = written();
    EXPECT_TRUE(without["zones"].is_null());
    EXPECT_EQ(without["intensity"]["table"]["rows"].size(), 2u);
    EXPECT_TRUE(std::filesystem::exists(folder / "zoned/probability_intensity_high.tif"));
    EXPECT_FALSE(std::filesystem::exists(folder / "zoned/hazard_zones.tif"));
    plan.return_period = 30;
    const auto with = written();
    EXPECT_EQ(with["zones"]["return_period_years"], 30);
    const auto raster = read_value_raster(path("zoned/hazard_zones.tif"), scene->crs);
    ASSERT_TRUE(raster) << raster.error().message;
    const auto red = std::count(raster->grid.values.begin(), raster->grid.values.end(), 4.0F);
    EXPECT_GT(red, 0) << "what every run covers comes every 30 years";
    const double width = raster->grid.geometry.cell;
    EXPECT_NEAR(with["zones"]["areas"]["rows"][0]["area_m2"].get<double>(), static_cast<double>(red) * width * width,
                1e-6);
    const auto polygons = read_polygons(path("zoned/hazard_zones.gpkg"), "hazard_zones", scene->crs);
    ASSERT_TRUE(polygons) << polygons.error().message;
    EXPECT_GE(polygons->features.size(), 1u);
    EXPECT_TRUE(opened("zoned")) << "another return period is no other ensemble";
    plan.return_period.reset();
    written();
    EXPECT_FALSE(std::filesystem::exists(folder / "zoned/hazard_zones.tif")) << "of an earlier plan";
}

TEST_F(EnsembleTest, a_plan_states_its_return_period) {
    write("plan.toml", "[ensemble]\nreturn_period_years = 100\n");
    const auto read = read_plan(path("plan.toml"));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->return_period, 100);
    for (const char* wrong : {"0", "-5", "nan", "\"100\""}) {
        write("plan.toml", std::string("[ensemble]\nreturn_period_years = ") + wrong + "\n");
        const auto refused = read_plan(path("plan.toml"));
        ASSERT_FALSE(refused) << wrong;
        EXPECT_THAT(refused.error().message, HasSubstr("plan.toml:2: ensemble.return_period_years = "));
        EXPECT_THAT(refused.error().message, HasSubstr("must be a number above 0 (years)"));
    }
    plan.return_period = 100;
    const auto restored = plan_of(ensemble_definition(planned(), source, *scene, "valley"));
    ASSERT_TRUE(restored);
    EXPECT_EQ(restored->return_period, 100);
}

TEST_F(EnsembleTest, weights_of_scenarios_are_those_of_the_runs) {
    write(
        "plan.toml",
        "[ensemble]\nruns = 10\n[[factor]]\nkey = \"release.volume_m3\"\nvalues = [400, 900]\nweights = [0.7, 0.3]\n");
    auto read = read_plan(path("plan.toml"));
    ASSERT_TRUE(read) << read.error().message;
    plan = *read;
    std::size_t small = 0;
    for (std::size_t run = 0; run < 10; ++run) small += planned().at(run).values[0] == "400" ? 1 : 0;
    EXPECT_EQ(small, 7u);
    const auto restored = plan_of(ensemble_definition(planned(), source, *scene, "valley"));
    ASSERT_TRUE(restored);
    EXPECT_EQ(restored->factors[0].distribution.weights, (std::vector<double>{0.7, 0.3}));
    plan.design = stats::DesignKind::grid;
    EXPECT_FALSE(PlannedRuns::make(plan, source, *scene));
    write("plan.toml", "[[factor]]\nkey = \"release.volume_m3\"\nvalues = [400, 900]\nweights = [1]\n");
    read = read_plan(path("plan.toml"));
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().message, HasSubstr("1 weights are given for 2 values"));
}

TEST_F(EnsembleTest, writes_the_odds_of_each_building_with_its_footprint) {
    run("done", {.runs_at_once = 2});
    const PlannedRuns runs = planned();
    auto reduction = reduce({folder / "done"}, 6, identity(), plan.thresholds);
    ASSERT_TRUE(reduction);
    const Extent ground = scene->terrain.elevation().geometry.extent();
    const std::vector<std::pair<double, std::string>> wanted = {
        {1, "80 % and more"}, {1.0 / 3, "20 to 50 %"}, {0, "below 1 %"}};
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        terrain::Building house;
        house.name = fmt::format("house {}", k);
        const double x = ground.x_min + 10 * static_cast<double>(k), y = ground.y_min;
        house.footprint = {{{{x, y}, {x + 5, y}, {x + 5, y + 5}, {x, y + 5}}, {}}};
        scene->buildings.push_back(house);
        BuildingOdds odds;
        odds.name = house.name;
        odds.hit = wanted[k].first;
        odds.over_pressure.assign(plan.thresholds.pressure.size(), 0.25);
        odds.high_depth = 1.5;
        reduction->buildings.push_back(odds);
    }
    const EnsembleResult result = summarise(*scene, runs, *std::move(reduction));
    ASSERT_TRUE(write_ensemble(result, folder / "done"));
    EXPECT_THAT(test::read_text(folder / "done/results.qlr"), HasSubstr("./buildings.gpkg|layername=buildings"));
    const auto polygons = geo::read_polygons(path("done/buildings.gpkg"), "buildings", scene->crs);
    ASSERT_TRUE(polygons) << polygons.error().message;
    ASSERT_EQ(polygons->features.size(), wanted.size());
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        const auto& attributes = polygons->features[k].attributes;
        EXPECT_EQ(std::get<std::string>(attributes.at("name")), fmt::format("house {}", k));
        EXPECT_DOUBLE_EQ(std::get<double>(attributes.at("probability_hit")), wanted[k].first);
        EXPECT_DOUBLE_EQ(std::get<double>(attributes.at("peak_depth_p95_m")), 1.5);
        EXPECT_EQ(std::get<std::string>(attributes.at("probability_class")), wanted[k].second);
    }
}

TEST_F(EnsembleTest, writes_maps_tables_and_a_report) {
    run("done", {.runs_at_once = 2});
    const PlannedRuns runs = planned();
    auto reduction = reduce({folder / "done"}, 6, identity(), plan.thresholds);
    ASSERT_TRUE(reduction);
    const EnsembleResult result = summarise(*scene, runs, *std::move(reduction));
    const Status written = write_ensemble(result, folder / "done");
    ASSERT_TRUE(written) << written.error().message;
    const auto raster = read_value_raster(path("done/probability_depth_0.5m.tif"), scene->crs);
    ASSERT_TRUE(raster) << raster.error().message;
    float most = 0;
    for (const float v : raster->grid.values) most = std::max(most, v);
    EXPECT_EQ(most, 100);  // in percent; all runs cover the release
    for (const char* file :
         {"peak_depth_p95.tif", "peak_depth_p95.qml", "probability_pressure_15kPa.qml", "runs.csv", "buildings.csv",
          "distributions.csv", "sensitivity.csv", "statistics.json", "report.html", "results.qlr"}) {
        EXPECT_TRUE(std::filesystem::exists(folder / "done" / file)) << file;
    }
    const auto results = nlohmann::ordered_json::parse(test::read_text(folder / "done/results.json"));
    EXPECT_EQ(results["format"], "talus ensemble");
    EXPECT_EQ(results["complete"], 6);
    EXPECT_EQ(results["run_out"]["kind"], "chart");
    const auto page = ensemble_report(result, results);
    ASSERT_TRUE(page) << page.error().message;
    EXPECT_TRUE(*page == test::read_text(folder / "done/report.html")) << "the page shows what results.json holds";
    for (const char* part :
         {"6</strong> <span class=\"unit\">of 6", "material.friction_coefficient", "Latin hypercube",
          "Run-out along the flow of all runs", "Share of the complete runs", "Front velocity at 20 m"}) {
        EXPECT_THAT(*page, HasSubstr(part));
    }
    EXPECT_EQ(page->find("{{"), std::string::npos);
    EXPECT_EQ(page->find("nan"), std::string::npos);
}

TEST_F(EnsembleTest, bad_plans_are_refused_before_anything_runs) {
    const auto why = [&](const std::string& factor) {
        EnsemblePlan bad;
        EXPECT_TRUE(add_factor(bad, factor));
        const auto runs = PlannedRuns::make(bad, source, *scene);
        return runs ? std::string("(accepted)") : runs.error().message;
    };
    EXPECT_THAT(why("material.friction_coefficent=0:1"), HasSubstr("nearest known key: friction_coefficient"));
    EXPECT_THAT(why("material.friction_coefficient=0:11"), HasSubstr("from 0 to 10"));
    EXPECT_THAT(why("solver.kernel=0:1"), HasSubstr("is not a number; give a list"));
    EXPECT_THAT(why("solver.kernel=spiky,soft"), HasSubstr("must be one of"));
    EXPECT_EQ(why("material.friction_coefficient=normal:0.1:0.5"), "(accepted)");  // cut at 0
    EnsemblePlan none;
    EXPECT_FALSE(PlannedRuns::make(none, source, *scene));
    EXPECT_FALSE(parse_thresholds("1,0.5", "--depth-m"));
    EXPECT_FALSE(parse_thresholds("1,", "--depth-m"));
    EXPECT_EQ(*parse_thresholds("0.5,1", "--depth-m"), (std::vector<double>{0.5, 1}));
}

TEST_F(EnsembleTest, a_plan_file_says_the_same) {
    write("plan.toml",
          "[ensemble]\ndesign = \"saltelli\"\nruns = 40\nseed = 9\n[thresholds]\ndepth_m = [0.2, 2]\n[[factor]]\n"
          "key = \"material.friction_coefficient\"\nlow = 0.2\nhigh = 0.5\n[[factor]]\nkey = \"material.viscosity\"\n"
          "distribution = \"normal\"\nmean = 0.1\ndeviation = 0.02\n[[factor]]\nkey = \"solver.kernel\"\n"
          "values = [\"spiky\", \"cubic_spline\"]\n");
    const auto read = read_plan(folder / "plan.toml");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->design, stats::DesignKind::saltelli);
    EXPECT_EQ(read->seed, 9u);
    EXPECT_EQ(read->thresholds.depth, (std::vector<double>{0.2, 2}));
    ASSERT_EQ(read->factors.size(), 3u);
    EXPECT_EQ(read->factors[0].distribution.written(), "0.2:0.5");
    EXPECT_EQ(read->factors[1].distribution.written(), "normal:0.1:0.02");
    EXPECT_EQ(read->factors[2].distribution.written(), "spiky,cubic_spline");
    EXPECT_EQ(PlannedRuns::make(*read, source, *scene)->count(), 40u);  // 8 blocks of 5

    const auto why = [&](const std::string& text) {
        write("bad.toml", text);
        const auto bad = read_plan(folder / "bad.toml");
        return bad ? std::string("(accepted)") : bad.error().message;
    };
    EXPECT_THAT(why("[ensemble]\nrun = 3\n"), HasSubstr("bad.toml:2: unknown key \"run\"; nearest known key: runs"));
    EXPECT_THAT(why("[ensemble]\ndesign = \"lhs\"\n"), HasSubstr("must be one of monte_carlo"));
    EXPECT_THAT(why("[[factor]]\nkey = \"a.b\"\nlow = 2\nhigh = 1\n"), HasSubstr("the range is empty"));
    EXPECT_THAT(why("[[factor]]\nkey = \"a.b\"\nlow = 2\n"), HasSubstr("low and high must be given"));
    EXPECT_THAT(why("[thresholds]\ndepth_m = [1, 0.5]\n"), HasSubstr("must be ascending"));
    EXPECT_THAT(why("[factors]\n"), HasSubstr("is unknown"));
}

}  // namespace
}  // namespace talus::ensemble
