#include "ensemble/predict.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/scene_folder.hpp"

namespace talus::ensemble {
namespace {

using testing::HasSubstr;

/// A plane that rises by 0.5 per metre towards the east from z = 0 at x = 0; maps with cells of 2 m on 20 m x 20 m.
class PredictTest : public testing::Test {
  protected:
    PredictTest() {
        Grid<float> ground(GridGeometry{0, 0, 2, 10, 10});
        const Grid<float> dry(ground.geometry, std::numeric_limits<float>::quiet_NaN());
        for (int row = 0; row < 10; ++row) {
            for (int column = 0; column < 10; ++column) {
                ground.at(column, row) = static_cast<float>(0.5 * ground.geometry.centre(column, row).x);
            }
        }
        terrain = terrain::Terrain(ground);
        run.maps = {dry, dry, dry, dry, dry};
    }

    terrain::Terrain terrain;
    observe::Observation run;
};

TEST_F(PredictTest, front_and_arrival_are_those_of_the_front) {
    run.front = {{10, 2, 5, 8}, {12, 3, 7, 9}};
    params::ObservationSpec front, debris;
    front.chainage = debris.chainage = 11;
    front.front_velocity = debris.debris_speed = 6;
    EXPECT_DOUBLE_EQ(computed_for(front, run), 6);
    EXPECT_DOUBLE_EQ(computed_for(debris, run), 8.5);
    EXPECT_DOUBLE_EQ(predict_debris_speed(run, 11), 8.5);
    EXPECT_DOUBLE_EQ(predict_arrival_time(run, 11), 2.5);
    EXPECT_TRUE(std::isnan(predict_debris_speed(run, 30)));
    EXPECT_TRUE(std::isnan(predict_arrival_time(run, 30)));
    run.run_out.front_chainage = 12.5;
    EXPECT_DOUBLE_EQ(predict_front_chainage(run), 12.5);
}

TEST_F(PredictTest, run_up_is_the_depth_at_the_mark_or_the_height_that_is_missing) {
    run.maps.peak_depth.at(2, 5) = 1.5F;  // centre (5, 11), ground 2.5 m, surface 4 m
    EXPECT_NEAR(predict_run_up(run, terrain, {5.5, 11.5}), 1.5, 1e-6);
    EXPECT_NEAR(predict_run_up(run, terrain, {11, 11}), 4 - 5.5, 1e-5);  // 1.5 m higher than debris came
    EXPECT_NEAR(predict_run_up(run, terrain, {3, 11}), 0, 1e-6);         // below debris that did not come there
    EXPECT_TRUE(std::isnan(predict_run_up(run, terrain, {11, 11}, 5)));  // nothing so near
}

TEST_F(PredictTest, deposit_depth_is_that_of_the_cell) {
    run.maps.deposit_depth.at(3, 4) = 0.75F;
    EXPECT_DOUBLE_EQ(predict_deposit_depth(run, {7.9, 8.1}), 0.75);
    EXPECT_DOUBLE_EQ(predict_deposit_depth(run, {8.1, 8.1}), 0);
    EXPECT_DOUBLE_EQ(predict_deposit_depth(run, {-500, 8.1}), 0);  // beyond the map
}

TEST_F(PredictTest, pressure_is_that_of_the_named_building) {
    run.buildings = {{"shed", true, 3, 1, 20e3, 1, 0}, {"house", false, observe::never, 0, 0, 0, 0}};
    EXPECT_DOUBLE_EQ(predict_building_pressure(run, "shed"), 20e3);
    EXPECT_DOUBLE_EQ(predict_building_pressure(run, "house"), 0);
    EXPECT_TRUE(std::isnan(predict_building_pressure(run, "barn")));
}

TEST_F(PredictTest, overlap_is_shared_over_covered_area) {
    const std::vector<Polygon> outline = {{{{4, 4}, {12, 4}, {12, 8}, {4, 8}}, {}}};  // 4 x 2 cells, 32 m2
    EXPECT_DOUBLE_EQ(predict_outline_overlap(run.maps.deposit_depth, outline, 0.1), 0);
    for (int column = 2; column < 6; ++column) {
        run.maps.deposit_depth.at(column, 2) = 1;      // one row of the outline, 16 m2
        run.maps.deposit_depth.at(column, 6) = 1;      // and as much outside
        run.maps.deposit_depth.at(column, 7) = 0.05F;  // too thin to count
    }
    EXPECT_DOUBLE_EQ(predict_outline_overlap(run.maps.deposit_depth, outline, 0.1), 16.0 / (32 + 16));
    for (int column = 2; column < 6; ++column) {
        run.maps.deposit_depth.at(column, 3) = 1;
        run.maps.deposit_depth.at(column, 6) = 0;
    }
    EXPECT_DOUBLE_EQ(predict_outline_overlap(run.maps.deposit_depth, outline, 0.1), 1);
}

TEST_F(PredictTest, elevation_agreement_compares_deposit_minus_erosion_outside_releases) {
    Grid<float> observed(run.maps.deposit_depth.geometry, 0);
    observed.at(2, 2) = 1;
    observed.at(3, 2) = -1;
    observed.at(4, 2) = 0.1F;                                     // noise
    observed.at(5, 2) = std::numeric_limits<float>::quiet_NaN();  // not surveyed
    observed.at(6, 6) = -4;                                       // where it failed
    const GridGeometry& g = observed.geometry;
    const PlanPoint scar = g.centre(6, 6);
    terrain::Release release;
    release.patches.push_back({{{{scar.x - 0.5, scar.y - 0.5},
                                 {scar.x + 0.5, scar.y - 0.5},
                                 {scar.x + 0.5, scar.y + 0.5},
                                 {scar.x - 0.5, scar.y + 0.5}},
                                {}},
                               4});
    const auto agreement = [&] { return predict_elevation_agreement(run, observed, {release}, 0.2); };
    EXPECT_DOUBLE_EQ(agreement(), 0) << "nothing computed";
    run.maps.deposit_depth.at(2, 2) = 1;
    run.maps.deposit_depth.at(5, 2) = 7;
    EXPECT_DOUBLE_EQ(agreement(), 1 - 1.0 / 3) << "the erosion is missing";
    run.erosion.depth = Grid<float>(g, std::numeric_limits<float>::quiet_NaN());
    run.erosion.depth.at(3, 2) = 1;
    EXPECT_DOUBLE_EQ(agreement(), 1);
    run.maps.deposit_depth.at(2, 2) = 0.5F;
    EXPECT_DOUBLE_EQ(agreement(), 1 - 0.5 / 3.5);
}

TEST(Predict, superelevation_gives_the_velocity_of_a_forced_vortex) {
    params::SuperelevationSpec marks;
    marks.bend_radius = 20;
    marks.width = 10;
    marks.level_difference = 2;
    EXPECT_NEAR(superelevation_velocity(marks), std::sqrt(9.81 * 20 * 2 / 10), 1e-12);
    marks.correction_factor = 4;
    EXPECT_NEAR(superelevation_velocity(marks), std::sqrt(9.81 * 20 * 2 / 10) / 2, 1e-12);
}

TEST(Predict, damage_counts_only_on_the_wrong_side) {
    ObservedValue damaged{"", "", "Pa", 15e3, 5e3, ObservedValue::Kind::at_least};
    EXPECT_DOUBLE_EQ(deviation_of(damaged, 100e3), 0);
    EXPECT_DOUBLE_EQ(deviation_of(damaged, 0), -3);
    damaged.kind = ObservedValue::Kind::below;
    EXPECT_DOUBLE_EQ(deviation_of(damaged, 0), 0);
    EXPECT_DOUBLE_EQ(deviation_of(damaged, 25e3), 2);
    damaged.kind = ObservedValue::Kind::equal;
    EXPECT_DOUBLE_EQ(deviation_of(damaged, 10e3), -1);
}

class ObservedScene : public scene::SceneFolder {};

TEST_F(ObservedScene, has_a_value_and_a_prediction_for_every_observation) {
    write_features("outline.geojson", {rectangle(100, 80, 140, 120)});
    write_features("houses.geojson", {rectangle(150, 95, 160, 105, R"("name": "mill")")});
    write_valley(
        "[buildings]\nfile = \"houses.geojson\"\nname_attribute = \"name\"\n"
        "[[observation]]\nchainage_m = 20\nfront_velocity_mps = 5\n"
        "[[superelevation]]\nchainage_m = 30\nbend_radius_m = 20\nwidth_m = 10\nlevel_difference_m = 2\n"
        "[[arrival]]\nchainage_m = 40\ntime_s = 10\nuncertainty_s = 1\n"
        "[[run_up]]\nx_m = 824100\ny_m = 825100\nheight_m = 3\n"
        "[[deposit_depth]]\nx_m = 824120\ny_m = 825100\ndepth_m = 1.5\n"
        "[[damage]]\nbuilding = \"mill\"\ndamaged = false\n"
        "[[observed_run_out]]\nchainage_m = 90\n"
        "[[deposit_outline]]\nfile = \"outline.geojson\"\n"
        "[[affected_area]]\nfile = \"outline.geojson\"\n"
        "[[elevation_change]]\nfile = \"dem.tif\"\n");
    const scene::Scene scene = loaded();
    const auto observed = observed_values(scene);
    ASSERT_EQ(observed.size(), 10u);
    EXPECT_DOUBLE_EQ(observed[0].uncertainty, 1);  // a fifth of 5 m/s
    EXPECT_DOUBLE_EQ(observed[1].value, superelevation_velocity(scene.spec.superelevations[0]));
    EXPECT_DOUBLE_EQ(observed[2].uncertainty, 1);
    EXPECT_EQ(observed[5].kind, ObservedValue::Kind::below);
    for (const ObservedValue& o : observed) {
        const bool run_up = o.key.starts_with("run_up"), share = o.unit.empty();
        EXPECT_EQ(o.least, run_up ? -std::numeric_limits<double>::infinity() : 0) << o.key;
        EXPECT_EQ(o.most, share ? 1 : std::numeric_limits<double>::infinity()) << o.key;
    }
    EXPECT_EQ(observed[7].key, "deposit_outline[0].overlap");
    EXPECT_EQ(observed[8].key, "affected_area[0].overlap");
    EXPECT_EQ(observed[9].key, "elevation_change[0].agreement");
    EXPECT_EQ(predicted_values(scene, observe::Observation()).size(), observed.size());
}

TEST_F(ObservedScene, observations_that_cannot_be_are_refused) {
    write_valley("[[arrival]]\nchainage_m = 5000\ntime_s = 10\n");
    EXPECT_THAT(load_error(), HasSubstr("arrival[0].chainage_m = 5000 lies beyond the flow path"));
    write_valley("[[run_up]]\nx_m = 1\ny_m = 2\nheight_m = 3\n");
    EXPECT_THAT(load_error(), HasSubstr("run_up[0].x_m: (1.00, 2.00) is not on the terrain"));
    write_valley("[[damage]]\nbuilding = \"mill\"\n");
    EXPECT_THAT(load_error(), HasSubstr("damage[0].building = \"mill\" is no building of the scene"));
    write_valley("[[deposit_outline]]\nfile = \"nix.geojson\"\n");
    EXPECT_THAT(load_error(), HasSubstr("deposit_outline[0].file: "));
    write_valley("[[affected_area]]\nfile = \"nix.geojson\"\n");
    EXPECT_THAT(load_error(), HasSubstr("affected_area[0].file: "));
    write_valley("[[elevation_change]]\nfile = \"nix.tif\"\n");
    EXPECT_THAT(load_error(), HasSubstr("elevation_change[0].file: "));
    write_valley("[[elevation_change]]\nfile = \"dem.tif\"\ndetection_limit_m = 9000\n");
    EXPECT_THAT(load_error(), HasSubstr("holds no change of at least detection_limit_m = 9000"));
    write_valley("[[superelevation]]\nchainage_m = 3\nbend_radius_m = 0\nwidth_m = 1\nlevel_difference_m = 1\n");
    EXPECT_THAT(load_error(),
                HasSubstr("superelevation[0].bend_radius_m = 0 is refused; it must be a number from 0.01 to"));
}

}  // namespace
}  // namespace talus::ensemble
