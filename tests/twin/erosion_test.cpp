#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "products/products.hpp"
#include "run/run_scene.hpp"
#include "support/fixtures.hpp"
#include "twin/erosion_history.hpp"
#include "twin/live_run.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// The channel with half a metre of gravel on its floor, from 20 m on.
scene::Scene gravel_scene() {
    scene::Scene scene = channel_scene();
    scene::BedLayer gravel;
    gravel.spec.growth_rate = 0.05;
    gravel.parts = {{rectangle(west + 20, south + 24, west + 120, south + 36), 0.5}};
    scene.bed_layers = {gravel};
    return scene;
}

bool holds_nothing(const Grid<float>& grid) {
    return std::all_of(grid.values.begin(), grid.values.end(), [](float v) { return std::isnan(v); });
}

TEST(ErosionLayer, is_what_the_bed_has_lost_in_every_cell_of_the_terrain) {
    const scene::Scene scene = gravel_scene();
    NextNumbers next;
    const twin::Setup setup = setup_of(scene, next);
    auto run = LiveRun::start(scene, setup, *scene.spec.solver.particle_spacing, {});
    ASSERT_TRUE(run);
    const auto scenario = open(gravel_scene());
    run_until(*scenario, 4);
    while ((*run)->state().step < scenario->step()) (*run)->advance();
    ASSERT_EQ(hash(*scenario), hash_state((*run)->state()));
    ASSERT_GT(scenario->run().summary().entrained, 0);

    const Grid<float> eroded = layer(*scenario, "erosion_depth");
    const terrain::Bed& bed = (*run)->ground().bed;
    const GridGeometry& g = scene.terrain.elevation().geometry;
    int cells = 0;
    double volume = 0;
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const float here = value_at(eroded, g.centre(column, row)), lost = bed.eroded[g.index(column, row)];
            if (lost == 0) {
                ASSERT_TRUE(std::isnan(here)) << column << " " << row;
                continue;
            }
            ASSERT_EQ(here, lost) << column << " " << row;
            volume += here * g.cell * g.cell;
            ++cells;
        }
    }
    EXPECT_GT(cells, 20);
    EXPECT_NEAR(volume, number(*scenario, "volume_entrained_m3"), 1e-4 * volume);
}

TEST(ErosionLayer, is_told_as_it_was_at_a_time_of_the_recording) {
    const auto scenario = open(gravel_scene());
    std::vector<std::pair<double, Grid<float>>> told;
    while (scenario->time() < 4) {
        const std::size_t frames = recording_json(*scenario)["times_s"].size();
        scenario->advance();
        if (recording_json(*scenario)["times_s"].size() == frames) continue;
        told.emplace_back(scenario->time(), layer(*scenario, "erosion_depth"));
    }
    EXPECT_TRUE(holds_nothing(told.front().second));
    ASSERT_FALSE(holds_nothing(told.back().second));
    for (const auto& [time, then] : told) {
        const Grid<float> again = (*layer_of(*scenario, "erosion_depth", time + 1e-3))();
        ASSERT_EQ(again.geometry, then.geometry) << time;
        for (std::size_t k = 0; k < then.values.size(); ++k) {
            if (!std::isnan(then.values[k]) || !std::isnan(again.values[k])) {
                ASSERT_EQ(again.values[k], then.values[k]) << time;
            }
        }
    }
    EXPECT_TRUE(holds_nothing((*layer_of(*scenario, "erosion_depth", 0.0))()));
    EXPECT_THAT(layer_of(*scenario, "erosion_depth", -1).error().message, HasSubstr("nothing is recorded"));
}

TEST(ErosionLayer, is_one_empty_cell_where_nothing_was_picked_up) {
    const auto plain = open(channel_scene());
    run_until(*plain, 3);
    EXPECT_EQ(plain->run().summary().entrained, 0);
    EXPECT_TRUE(holds_nothing(layer(*plain, "erosion_depth")));
    EXPECT_TRUE(holds_nothing((*layer_of(*plain, "erosion_depth", 1.0))()));

    const auto scenario = open(gravel_scene());
    run_until(*scenario, 4);
    ASSERT_FALSE(holds_nothing(layer(*scenario, "erosion_depth")));
    const auto copy = scenario->copying()({});
    ASSERT_TRUE(copy);
    EXPECT_TRUE(holds_nothing(layer(**copy, "erosion_depth")));
    act(*scenario, {{"action", "restart"}});
    EXPECT_EQ(scenario->run().summary().entrained, 0);
    EXPECT_TRUE(holds_nothing(layer(*scenario, "erosion_depth")));
    EXPECT_TRUE(holds_nothing((*layer_of(*scenario, "erosion_depth", 4.0))())) << "the recording began anew";
}

TEST(Export, of_a_run_on_a_bed_is_counted_as_the_run_of_the_scene) {
    scene::Scene scene = gravel_scene();
    scene.bed = lay_bed(scene.bed_layers, scene.terrain);
    scene.spec.solver.end_time = 4;
    const auto run = run::run_scene(scene, {});
    ASSERT_TRUE(run);
    const auto scenario = open(scene);
    run_until(*scenario, 100);
    ASSERT_GT(scenario->run().summary().entrained, 0);
    const talus::test::TemporaryFolder folder, exported;
    ASSERT_TRUE(products::write_products(scene, *run, folder.path()));
    ASSERT_TRUE(products_of(*scenario)(exported.path()));
    const auto manifest_in = [](const talus::test::TemporaryFolder& written) {
        return json::parse(talus::test::read_text(written.file("manifest.json")));
    };
    const json plain = manifest_in(folder), live = manifest_in(exported);
    EXPECT_EQ(live["resolved"]["particle_count"], plain["resolved"]["particle_count"]);
    EXPECT_EQ(live["resolved"]["particle_count"].get<double>(),
              std::round(scene.releases[0].volume / std::pow(run->particle_spacing, 3)));
    EXPECT_EQ(live["result_hash"], plain["result_hash"]);
}

TEST(ErosionHistory, holds_each_cell_as_it_was_last) {
    ErosionHistory history;
    EXPECT_TRUE(history.at(1).empty());
    history.add(0, 0, {0, 0, 0});
    history.add(1, 1, {0, 0.5F, 0});
    history.add(2, 1, {9, 9, 9});  // nothing was entrained since: not looked at
    history.add(3, 3, {0.25F, 0.75F, 0});
    EXPECT_THAT(history.at(0.9), ElementsAre(0, 0, 0));
    EXPECT_THAT(history.at(1), ElementsAre(0, 0.5F, 0));
    EXPECT_THAT(history.at(2.9), ElementsAre(0, 0.5F, 0));
    EXPECT_THAT(history.at(30), ElementsAre(0.25F, 0.75F, 0));
}

}  // namespace
}  // namespace talus::twin::test
