#include "scene/particle_spacing.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

class ParticleSpacing : public SceneFolder {
  protected:
    [[nodiscard]] double spacing(const std::vector<std::string>& overrides = {}) const {
        return particle_spacing(loaded(overrides));
    }
    /// Across the valley, 10 m wide.
    static std::string inflow() {
        return fmt::format(
            "[[inflow]]\nname = \"gully\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nhydrograph = \"surge.csv\"\n", west + 145,
            south + 95, south + 105);
    }
    static std::string rain() {
        return fmt::format("[[inflow]]\npolygon_m = [[{0}, {2}], [{1}, {2}], [{1}, {3}]]\nhydrograph = \"surge.csv\"\n",
                           west + 40, west + 60, south + 60, south + 80);
    }
};

TEST_F(ParticleSpacing, is_that_of_ten_thousand_particles_where_nothing_is_named) {
    write_valley();
    EXPECT_NEAR(total_volume(loaded()) / std::pow(spacing(), 3), 10000, 1e-6);
    EXPECT_NEAR(total_volume(loaded()) / std::pow(spacing({"solver.target_particle_count=800"}), 3), 800, 1e-6);
    EXPECT_EQ(spacing({"solver.particle_spacing_m=0.7"}), 0.7);
}

TEST_F(ParticleSpacing, of_layers_is_the_thickness_normal_to_the_slope_over_their_number) {
    write_valley();
    EXPECT_EQ(spacing({"solver.target_layers=4"}), 0.5) << "the release is 2 m thick";
    EXPECT_EQ(spacing({"solver.target_layers=3"}), 0.6667) << "to four digits, so that what is printed repeats the run";
    EXPECT_THAT(loaded({"solver.target_layers=4"}).notes,
                Contains(AllOf(StartsWith("solver.target_layers = 4 over release \"scarp\" (2 m thick)"),
                               HasSubstr("solver.particle_spacing_m = 0.5"))));
    write_valley("", "thickness_m = 2\nthickness_direction = \"vertical\"");
    EXPECT_LT(spacing({"solver.target_layers=4"}), 0.46);
}

TEST_F(ParticleSpacing, of_layers_follows_the_thinnest_release_or_inflow) {
    const std::string second = "[[release]]\nname = \"patch\"\nfile = \"patch.geojson\"\nthickness_m = 0.8\n";
    write_features("patch.geojson", {rectangle(60, 90, 70, 100)});
    write_valley(second);
    EXPECT_EQ(spacing({"solver.target_layers=2"}), 0.4);
    EXPECT_EQ(loaded({"solver.target_layers=2"}).thinnest->name, "release \"patch\"");
    write("surge.csv", "time_s,discharge_m3ps,velocity_mps\n0,10,2\n3,10,2\n");
    write_valley(second + inflow());
    EXPECT_EQ(spacing({"solver.target_layers=2"}), 0.25) << "10 m3/s across 10 m at 2 m/s";
    write_valley(second + rain());
    EXPECT_EQ(spacing({"solver.target_layers=2"}), 0.4) << "of rain the thickness is not known";
}

TEST_F(ParticleSpacing, of_layers_needs_a_thickness) {
    write("surge.csv", "time_s,discharge_m3ps,velocity_mps\n0,10,2\n3,10,2\n");
    write_valley();
    write("scene.toml", "[terrain]\nfile = \"dem.tif\"\n" + rain() + "[solver]\ntarget_layers = 3\n");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("scene.toml:7: solver.target_layers: needs a release or an inflow"),
                                    EndsWith("give solver.particle_spacing_m")));
}

TEST_F(ParticleSpacing, layers_beyond_the_particle_limit_are_refused_with_their_range) {
    write_valley("[solver]\nparticle_limit = 8000\n");
    const double volume = total_volume(loaded({"solver.target_layers=1"})), most = 2 * std::cbrt(8000 / volume);
    ASSERT_GT(most, 4);
    EXPECT_EQ(load_error({fmt::format("solver.target_layers={}", most - 0.01)}), "(it loaded)");
    EXPECT_THAT(load_error({fmt::format("solver.target_layers={}", most + 0.01)}), HasSubstr("is refused"));
    EXPECT_THAT(load_error({"solver.target_layers=40"}),
                AllOf(StartsWith("--set solver.target_layers=40: solver.target_layers = 40 is refused; over release "
                                 "\"scarp\" (2 m thick) it needs 7.25e+06 particles, more than "
                                 "solver.particle_limit = 8000"),
                      EndsWith(fmt::format("it must be from 1 to {:.6g}", std::floor(100 * most) / 100))));
    EXPECT_THAT(load_error({"solver.target_layers=1", "solver.particle_limit=10"}), HasSubstr("raise that, or give"));
    EXPECT_THAT(load_error({"solver.target_layers=0.5"}), HasSubstr("a number from 1 to 1000"));
}

TEST_F(ParticleSpacing, is_chosen_by_one_key_of_a_file) {
    write_valley("[solver]\ntarget_particle_count = 800\ntarget_layers = 3\n");
    EXPECT_THAT(load_error(), AllOf(HasSubstr("scene.toml:8: solver.target_particle_count: at most one of "
                                              "particle_spacing_m, target_layers, target_particle_count may be given; "
                                              "given are target_layers, target_particle_count"),
                                    StartsWith(path("scene.toml"))));
    write_valley("[solver]\nparticle_spacing_m = 1\ntarget_layers = 3\n");
    EXPECT_THAT(load_error(), HasSubstr("at most one of"));
    write_valley("[[variant]]\nname = \"fine\"\nset = [\"solver.target_layers=4\", \"solver.particle_spacing_m=1\"]\n");
    EXPECT_THAT(load_error({"variant=fine"}), HasSubstr("at most one of"));
}

TEST_F(ParticleSpacing, of_an_override_replaces_that_of_the_file) {
    write_valley(
        "[solver]\ntarget_particle_count = 800\n[[variant]]\nname = \"fine\"\nset = [\"solver.target_layers=4\"]\n");
    EXPECT_EQ(spacing({"solver.target_layers=2"}), 1);
    EXPECT_EQ(spacing({"variant=fine"}), 0.5);
    EXPECT_EQ(spacing({"variant=fine", "solver.particle_spacing_m=0.7"}), 0.7);
    const Scene last = loaded({"solver.target_layers=2", "solver.particle_spacing_m=0.7"});
    EXPECT_EQ(particle_spacing(last), 0.7);
    EXPECT_FALSE(last.spec.solver.target_layers);
    EXPECT_FALSE(last.thinnest);
    EXPECT_EQ(last.given_keys.count("solver.target_particle_count"), 0U);
}

}  // namespace
}  // namespace talus::scene
