#include "run/variants.hpp"

#include <atomic>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "params/time_step.hpp"
#include "scene/particle_spacing.hpp"
#include "scene/scene_folder.hpp"

namespace talus::run {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> names(const std::vector<Variant>& variants) {
    std::vector<std::string> all;
    for (const Variant& variant : variants) all.push_back(variant.name);
    return all;
}

TEST(Variations, are_one_per_value) {
    const auto variants = variations("material.friction_coefficient=0.3,0.5");
    ASSERT_TRUE(variants);
    EXPECT_THAT(names(*variants),
                ElementsAre("material.friction_coefficient = 0.3", "material.friction_coefficient = 0.5"));
    EXPECT_THAT((*variants)[1].overrides, ElementsAre("material.friction_coefficient=0.5"));
}

TEST(Variations, commas_in_brackets_and_quotes_do_not_separate) {
    const auto variants = variations(R"(terrain.extent_m=[0,0,1,1],none)");
    ASSERT_TRUE(variants);
    EXPECT_THAT(names(*variants), ElementsAre("terrain.extent_m = [0,0,1,1]", "terrain.extent_m = none"));
    EXPECT_EQ(variations(R"(release[0].file="a,b.geojson",'c,d.geojson')")->size(), 2U);
}

TEST(Variations, without_key_or_value_are_refused) {
    for (const char* text : {"", "=1", "material.viscosity", "material.viscosity=", "material.viscosity=0.1,,0.2",
                             "material.viscosity=0.1,"}) {
        EXPECT_FALSE(variations(text)) << text;
    }
}

class Variants : public scene::SceneFolder {
  protected:
    void SetUp() override {
        write_valley("[solver]\nparticle_spacing_m = 2\nend_time_s = 0.5\n");
        source.file = folder / "scene.toml";
    }
    [[nodiscard]] scene::Scene base() const { return *scene::load_scene(source.file, source.overrides); }
    [[nodiscard]] scene::Scene with(const Variant& variant) const {
        std::vector<std::string> overrides = source.overrides;
        overrides.insert(overrides.end(), variant.overrides.begin(), variant.overrides.end());
        return loaded(overrides);
    }
    SceneSource source;
};

TEST_F(Variants, refinements_halve_the_step_double_the_iterations_and_triple_the_particles) {
    const scene::Scene scene = base();
    const auto refined = refinements(scene);
    ASSERT_THAT(names(refined),
                ElementsAre("half the time step", "double the iterations", "three times the particles"));
    const params::SolverSpec& given = scene.spec.solver;
    const params::SolverSpec half = with(refined[0]).spec.solver;
    EXPECT_EQ(half.largest_time_step, params::largest_time_step(given, 2) / 2);
    EXPECT_EQ(half.smallest_time_step, given.smallest_time_step / 2);
    EXPECT_EQ(half.displacement_limit, given.displacement_limit / 2);
    EXPECT_EQ(half.iteration_count, given.iteration_count);
    EXPECT_EQ(with(refined[1]).spec.solver.iteration_count, 2 * given.iteration_count);
    const double spacing = *with(refined[2]).spec.solver.particle_spacing;
    EXPECT_NEAR(std::pow(2 / spacing, 3), 3, 1e-9);
    EXPECT_EQ(with(refined[2]).spec.solver.displacement_limit, given.displacement_limit);
}

TEST_F(Variants, a_fixed_time_step_is_halved_itself) {
    source.overrides = {"solver.time_step_s=0.01"};
    const auto refined = refinements(base());
    EXPECT_EQ(with(refined[0]).spec.solver.time_step, 0.005);
    EXPECT_EQ(with(refined[0]).spec.solver.displacement_limit, base().spec.solver.displacement_limit);
}

TEST_F(Variants, three_times_the_particles_also_where_their_number_is_given) {
    source.overrides = {"solver.target_particle_count=100"};
    const scene::Scene scene = base(), finer = with(refinements(scene)[2]);
    EXPECT_NEAR(std::pow(particle_spacing(scene) / *finer.spec.solver.particle_spacing, 3), 3, 1e-9);
}

TEST_F(Variants, are_refused_before_anything_ran_with_the_message_of_the_parser) {
    const auto refusal = [&](const std::string& text) {
        const auto prepared = prepare_variants(source, base(), *variations(text));
        return prepared ? "(accepted)" : prepared.error().message;
    };
    EXPECT_THAT(refusal("material.friction=0.3"), HasSubstr("unknown key \"friction\" in [material]"));
    EXPECT_THAT(refusal("material.viscosity=0.1,2"), HasSubstr("material.viscosity = 2 is refused; it must be"));
    EXPECT_THAT(refusal("release.file=nowhere.geojson"), HasSubstr("nowhere.geojson: no such file"));
    EXPECT_THAT(refusal("solver.particle_limit=1"), HasSubstr("more than solver.particle_limit = 1"));
}

TEST_F(Variants, effort_follows_particles_iterations_and_steps) {
    const auto prepared = prepare_variants(source, base(), refinements(base()));
    ASSERT_TRUE(prepared) << prepared.error().message;
    EXPECT_NEAR((*prepared)[0].effort, 2, 1e-9);
    EXPECT_GT((*prepared)[1].effort, 1.2);
    EXPECT_LT((*prepared)[1].effort, 2);
    EXPECT_GE((*prepared)[2].effort, 3 - 1e-9);
}

TEST_F(Variants, run_with_their_own_values) {
    const auto run = run_variant(source, (*variations("solver.end_time_s=0.2"))[0], {});
    ASSERT_TRUE(run.result) << run.missing;
    EXPECT_NEAR(run.result->simulated_time, 0.2, 0.02);
    EXPECT_TRUE(run.result->observation.maps.peak_depth.values.empty())
        << "maps of every variant would fill the memory";
}

TEST_F(Variants, an_interrupted_one_has_no_result) {
    const Variant variant = (*variations("solver.end_time_s=100"))[0];
    std::atomic<bool> stop{false};
    RunOptions options;
    options.stop_requested = &stop;
    options.on_progress = [&](const Progress&) { stop = true; };
    const auto during = run_variant(source, variant, options);
    EXPECT_FALSE(during.result);
    EXPECT_THAT(during.missing, HasSubstr("interrupted at t = "));
    const auto after = run_variant(source, variant, options);
    EXPECT_FALSE(after.result);
    EXPECT_EQ(after.missing, "interrupted before it began");
}

TEST_F(Variants, a_fault_is_no_result_either) {
    const Variant variant{
        .name = "coarse",
        .overrides = {"solver.largest_time_step_s=0.5", "solver.smallest_time_step_s=0.5", "material.viscosity=0"}};
    const auto run = run_variant(source, variant, {});
    EXPECT_FALSE(run.result);
    EXPECT_THAT(run.missing, HasSubstr("solver.smallest_time_step_s"));
}

Progress progress_at(double time, double end, double real_time_factor) {
    Progress now{};
    now.time = time;
    now.real_time_factor = real_time_factor;
    now.wall_remaining = (end - time) / real_time_factor;
    return now;
}

TEST(SeriesClock, adds_up_all_runs) {
    SeriesClock clock({{.name = "a", .overrides = {}, .effort = 2}, {.name = "b", .overrides = {}, .effort = 3}});
    const SeriesProgress first = clock.at(progress_at(5, 20, 0.5));
    EXPECT_EQ(first.run, 1U);
    EXPECT_EQ(first.count, 3U);
    EXPECT_EQ(first.name, "as given");
    EXPECT_DOUBLE_EQ(first.wall_remaining, 30 + 40 * (2 + 3));
    EXPECT_DOUBLE_EQ(first.share_done, 10.0 / (40 * 6));

    RunResult base;  // debris came to rest at 10 s
    base.wall_time = 20;
    base.simulated_time = 10;
    clock.base_ended(base);
    const SeriesProgress second = clock.at(progress_at(5, 20, 0.25));
    EXPECT_EQ(second.name, "a");
    // 20 s of this run have passed, 60 s are left of it as it says itself: so two runs of effort 1 + 2 take 100 s.
    EXPECT_DOUBLE_EQ(second.wall_remaining, 60 + 3 * 100. / 3);
    EXPECT_DOUBLE_EQ(second.share_done, 40.0 / 200);

    clock.variant_ended();
    const SeriesProgress third = clock.at(progress_at(12, 20, 0.2));
    EXPECT_EQ(third.run, 3U);
    EXPECT_DOUBLE_EQ(third.wall_remaining, 40) << "a variant may go on for longer than the base";
    EXPECT_DOUBLE_EQ(third.share_done, 100.0 / 140);
}

}  // namespace
}  // namespace talus::run
