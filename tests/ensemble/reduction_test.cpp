#include "ensemble/reduction.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/scene_folder.hpp"

namespace talus::ensemble {
namespace {

using testing::HasSubstr;

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();

class ReductionTest : public scene::SceneFolder {
  protected:
    ReductionTest() { std::filesystem::create_directories(folder / "runs"); }

    /// A run whose maps have one row of cells from `first_column` on: depths; speeds twice, pressures 1000 times,
    /// arrivals 10 times as much; deposits half.
    void write_run(std::size_t run, int first_column, const std::vector<float>& depths, double pressure = 0) const {
        const GridGeometry g{100 + 2.0 * first_column, 50, 2, static_cast<int>(depths.size()), 1};
        HazardMaps maps;
        for (const NamedMap& map : recorded_maps) maps.*map.grid = Grid<float>(g, nan_value);
        for (std::size_t i = 0; i < depths.size(); ++i) {
            maps.peak_depth.values[i] = depths[i];
            maps.peak_speed.values[i] = 2 * depths[i];
            maps.peak_pressure.values[i] = 1000 * depths[i];
            maps.arrival_time.values[i] = 10 * depths[i];
            maps.deposit_depth.values[i] = depths[i] / 2;
        }
        RunRecord record;
        record.run = run;
        record.values = {"0.3"};
        record.results = {10.0 * static_cast<double>(run), observe::never};
        record.buildings = {{"shed", pressure > 0, pressure > 0 ? 4.0 : observe::never, 1, pressure, 0.5, 0}};
        record.geometry = g;
        ASSERT_TRUE(write_run_record(file(run), plan, record, maps));
    }
    void write_failed(std::size_t run) const {
        RunRecord record;
        record.run = run;
        record.fault = "time step too small";
        record.values = {"0.9"};
        ASSERT_TRUE(write_run_record(file(run), plan, record, {}));
    }
    const std::string plan = "of this plan";
    [[nodiscard]] std::filesystem::path file(std::size_t run) const {
        return folder / "runs" / fmt::format("{:06}.run", run);
    }
    static const EnsembleMap& find(const Reduction& r, EnsembleMap::Kind kind, std::size_t map, double level) {
        for (const EnsembleMap& m : r.maps) {
            if (m.kind == kind && m.map == map && m.level == level) return m;
        }
        ADD_FAILURE() << "no such map";
        return r.maps.front();
    }
};

TEST_F(ReductionTest, counts_runs_above_thresholds_wherever_their_maps_lie) {
    write_run(0, 0, {1, 2, nan_value});
    write_run(1, 1, {3, 0.4F});
    write_run(2, -1, {0.2F, 0.5F});
    write_failed(3);
    const auto r = reduce({folder}, 5, plan, {{0.5}, {1}, {1.5}});
    ASSERT_TRUE(r) << r.error().message;
    EXPECT_EQ(r->complete, 3u);
    EXPECT_EQ(r->failed, 1u);
    EXPECT_EQ(r->missing, std::vector<std::size_t>{4});
    const Grid<float>& depth = find(*r, EnsembleMap::Kind::probability, 0, 0.5).grid;
    EXPECT_EQ(depth.geometry, (GridGeometry{98, 50, 2, 4, 1}));
    // Columns from x = 98 m: run 2; runs 0 and 2; runs 0 and 1; run 1. Equal to the threshold is not above it.
    const float third = 1.0F / 3;
    EXPECT_EQ(depth.values, (std::vector<float>{0, third, 2 * third, 0}));
    const Grid<float>& pressure = find(*r, EnsembleMap::Kind::probability, 2, 1.5).grid;  // kPa
    EXPECT_EQ(pressure.values, (std::vector<float>{0, 0, 2 * third, 0}));
}

TEST_F(ReductionTest, counts_runs_of_an_intensity_or_a_higher_one) {
    write_run(0, 0, {0.4F, 2, nan_value});  // speeds are twice the depths
    write_run(1, 1, {0.3F});
    write_run(2, -1, {0.2F, 1.5F});
    write_failed(3);
    const auto r = reduce({folder}, 4, plan, {});
    ASSERT_TRUE(r) << r.error().message;
    ASSERT_EQ(r->intensity.size(), 2u);
    const float third = 1.0F / 3;
    // Columns from x = 98 m: run 2; runs 0 and 2; runs 0 and 1; nobody.
    EXPECT_EQ(r->intensity[0].values[0], third);
    EXPECT_EQ(r->intensity[0].values[1], 2 * third);
    EXPECT_EQ(r->intensity[0].values[2], 2 * third);
    EXPECT_TRUE(std::isnan(r->intensity[0].values[3]));
    EXPECT_EQ(r->intensity[1].values[0], 0);
    EXPECT_EQ(r->intensity[1].values[1], third) << "high in run 2 alone";
    EXPECT_EQ(r->intensity[1].values[2], third);
    const auto flood = reduce({folder}, 4, plan, {}, report::intensity_guideline(params::GuidelineChoice::swiss_flood));
    ASSERT_TRUE(flood);
    ASSERT_EQ(flood->intensity.size(), 3u);
    EXPECT_EQ(flood->intensity[2].values[2], third) << "2 m at 4 m/s, and 0.3 m at 0.6 m/s";
}

TEST_F(ReductionTest, percentiles_count_runs_that_never_came_as_nothing_and_in_arrival_as_never) {
    write_run(0, 0, {1});
    write_run(1, 0, {3});
    write_run(2, 0, {2});
    write_run(3, 5, {9});
    const auto r = reduce({folder}, 4, plan, {});
    ASSERT_TRUE(r);
    const auto at = [&](std::size_t map, double level, int column) {
        return find(*r, EnsembleMap::Kind::percentile, map, level).grid.at(column, 0);
    };
    EXPECT_EQ(at(0, 50, 0), 1);  // of 0, 1, 2, 3
    EXPECT_EQ(at(0, 95, 0), 3);
    EXPECT_TRUE(std::isnan(at(0, 5, 0)));
    EXPECT_EQ(at(3, 5, 0), 10);  // of 10, 20, 30, never
    EXPECT_EQ(at(3, 50, 0), 20);
    EXPECT_TRUE(std::isnan(at(3, 95, 0)));
    EXPECT_EQ(at(0, 95, 5), 9);  // the only run there
    EXPECT_TRUE(std::isnan(at(0, 50, 5)));
    EXPECT_TRUE(std::isnan(at(0, 95, 3)));  // nobody came there
}

TEST_F(ReductionTest, hangs_neither_on_the_memory_nor_on_the_folders_of_the_runs) {
    for (std::size_t run = 0; run < 20; ++run) {
        write_run(run, static_cast<int>(run % 5),
                  {0.1F * static_cast<float>(run), 2.0F - 0.1F * static_cast<float>(run)});
    }
    const auto one = reduce({folder}, 20, plan, {});
    const auto other = folder / "other";
    std::filesystem::create_directories(other / "runs");
    for (std::size_t run = 1; run < 20; run += 2)
        std::filesystem::rename(file(run), other / "runs" / file(run).filename());
    const auto two =
        reduce({folder, other}, 20, plan, {}, report::intensity_guideline({}), 1);  // a byte: one row at a time
    ASSERT_TRUE(one && two);
    ASSERT_EQ(one->maps.size(), two->maps.size());
    for (std::size_t m = 0; m < one->maps.size(); ++m) {
        const auto &a = one->maps[m].grid.values, &b = two->maps[m].grid.values;
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i])));
    }
}

TEST_F(ReductionTest, buildings_have_odds) {
    for (std::size_t run = 0; run < 10; ++run)
        write_run(run, 0, {1}, run < 4 ? 10e3 * static_cast<double>(run + 1) : 0);
    const auto r = reduce({folder}, 10, plan, {{1}, {1}, {15, 30}});
    ASSERT_TRUE(r);
    ASSERT_EQ(r->buildings.size(), 1u);
    const BuildingOdds& b = r->buildings[0];
    EXPECT_EQ(b.name, "shed");
    EXPECT_DOUBLE_EQ(b.hit, 0.4);
    ASSERT_EQ(b.over_pressure.size(), 2u);
    EXPECT_DOUBLE_EQ(b.over_pressure[0], 0.3);
    EXPECT_DOUBLE_EQ(b.over_pressure[1], 0.1);
    EXPECT_EQ(b.median_pressure, 0);
    EXPECT_EQ(b.high_pressure, 40e3);
    EXPECT_EQ(b.early_hit, 4);
    EXPECT_TRUE(std::isnan(b.median_hit));
}

TEST_F(ReductionTest, a_record_comes_back_as_it_was_and_a_cut_one_is_refused) {
    write_run(2, 3, {1, nan_value, 5});
    const auto record = read_run_record(file(2), plan, 2);
    ASSERT_TRUE(record) << record.error().message;
    EXPECT_EQ(record->run, 2u);
    EXPECT_EQ(record->results[0], 20);
    EXPECT_TRUE(std::isnan(record->results[1]));
    const auto row = read_map_rows(file(2), *record, 4, 0, 1);
    ASSERT_TRUE(row);
    EXPECT_EQ((*row)[2], 2.5F);
    EXPECT_TRUE(std::isnan((*row)[1]));

    std::filesystem::resize_file(file(2), std::filesystem::file_size(file(2)) - 1);
    const auto cut = reduce({folder}, 3, plan, {});
    ASSERT_FALSE(cut);
    EXPECT_THAT(cut.error().message, HasSubstr("000002.run: is damaged: its checksum is not that of its contents"));
}

TEST_F(ReductionTest, every_bit_of_a_record_counts) {
    write_run(2, 3, {1, nan_value, 5}, 20e3);
    const std::string good = test::read_text(file(2));
    ASSERT_TRUE(read_run_record(file(2), plan, 2));
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
        std::string bad = good;
        bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << bit % 8));
        write("runs/000002.run", bad);
        EXPECT_FALSE(read_run_record(file(2), plan, 2)) << "bit " << bit;
    }
    EXPECT_TRUE(read_run_record(file(2), plan, 2, Verify::header)) << "the last byte is the checksum's to find";
    write("runs/000002.run", good + "x");
    EXPECT_FALSE(read_run_record(file(2), plan, 2));
    write("runs/000002.run", "");
    EXPECT_FALSE(read_run_record(file(2), plan, 2));
}

TEST_F(ReductionTest, a_record_is_of_one_run_of_one_plan) {
    write_run(2, 3, {1});
    const auto why = [](const Result<RunRecord>& record) {
        return record ? std::string("(accepted)") : record.error().message;
    };
    EXPECT_THAT(why(read_run_record(file(2), "another", 2)), HasSubstr("000002.run: is a run of another plan"));
    for (const Verify verify : {Verify::bytes, Verify::header}) {
        EXPECT_THAT(why(read_run_record(file(2), plan, 1, verify)), HasSubstr("000002.run: is run 2, not run 1"));
    }
    write_run(0, 3, {1});
    std::filesystem::copy_file(file(2), file(1));
    const auto r = reduce({folder}, 3, plan, {});
    ASSERT_FALSE(r) << "run 2 would count twice";
    EXPECT_THAT(r.error().message, HasSubstr("000001.run: is run 2, not run 1; the command that made it makes"));
}

TEST_F(ReductionTest, percentiles_are_nearest_ranks) {
    std::vector<double> values = {40, 15, 50, 20, 35};
    EXPECT_EQ(percentile(values, 5), 15);
    EXPECT_EQ(percentile(values, 30), 20);
    EXPECT_EQ(percentile(values, 40), 20);
    EXPECT_EQ(percentile(values, 50), 35);
    EXPECT_EQ(percentile(values, 100), 50);
    values.clear();
    EXPECT_TRUE(std::isnan(percentile(values, 50)));
}

}  // namespace
}  // namespace talus::ensemble
