#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "products/writers.hpp"
#include "products_fixture.hpp"
#include "report/intensity.hpp"

namespace talus::products {
namespace {

using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// Rows of a CSV without quoted fields; the first is the header.
std::vector<std::vector<std::string>> rows_of(const std::string& text) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        std::vector<std::string> row(1);
        for (const char c : line) {
            if (c == ',') {
                row.emplace_back();
            } else {
                row.back() += c;
            }
        }
        rows.push_back(row);
    }
    return rows;
}

TEST_F(Products, front_table_leaves_unknown_velocities_empty) {
    const auto rows = rows_of(test::read_text(folder_->path() / "front.csv"));
    const auto& front = result_->observation.front;
    ASSERT_EQ(rows.size(), front.size() + 1);
    EXPECT_THAT(rows[0],
                ElementsAre("chainage_m", "first_arrival_time_s", "front_velocity_mps", "front_particle_speed_mps"));
    EXPECT_EQ(rows[1][2], "") << "no window there yet";
    const observe::FrontSample& sample = front[50];
    EXPECT_DOUBLE_EQ(std::stod(rows[51][0]), sample.chainage);
    EXPECT_NEAR(std::stod(rows[51][1]), sample.arrival_time, 1e-6);
    EXPECT_NEAR(std::stod(rows[51][2]), sample.front_velocity, 1e-6);
    EXPECT_NEAR(std::stod(rows[51][3]), sample.particle_speed, 1e-6);
}

TEST_F(Products, run_out_table_gives_angles_in_degrees) {
    const auto rows = rows_of(test::read_text(folder_->path() / "run_out.csv"));
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_THAT(rows[0], ElementsAre("run_out_along_flow_m", "run_out_straight_m", "at_least", "toe_x_m", "toe_y_m",
                                     "drop_m", "runout_angle_deg", "travel_angle_deg", "front_chainage_m"));
    EXPECT_NEAR(std::tan(std::stod(rows[1][6]) * M_PI / 180), std::stod(rows[1][5]) / std::stod(rows[1][0]), 1e-6);
    EXPECT_EQ(rows[1][2], "no");
}

TEST_F(Products, building_table_uses_kilonewton_and_kilopascal) {
    const auto rows = rows_of(test::read_text(folder_->path() / "buildings.csv"));
    ASSERT_EQ(rows.size(), 6U);
    EXPECT_THAT(rows[0], ElementsAre("name", "hit", "first_hit_time_s", "peak_force_kN", "peak_impact_pressure_kPa",
                                     "peak_dynamic_pressure_kPa", "peak_depth_m", "filter_window_s", "patch_edge_m",
                                     "height_m", "height_assumed", "kind", "impulse_kNs", "failed_s", "overtopped_m3",
                                     "first_overtopped_s", "passed_m3", "retained_m3", "peak_retained_m3",
                                     "peak_filling_height_m", "removed_time_s", "peak_speed_mps", "intensity"));
    EXPECT_EQ(rows[1][0], "House 38");
    EXPECT_EQ(rows[1][1], "yes");
    EXPECT_EQ(rows[1][3], "412");
    EXPECT_EQ(rows[1][4], "38.4");
    EXPECT_EQ(rows[1][5], "61");
    EXPECT_EQ(rows[1][7], "0.2");
    EXPECT_EQ(rows[1][8], "1");
    EXPECT_EQ(rows[2][10], "yes");
    EXPECT_EQ(rows[1][20], "") << "it stands";
    EXPECT_EQ(rows[1].back(), "medium");
    EXPECT_EQ(rows[5][1], "no");
    EXPECT_EQ(rows[5][2], "") << "never hit: no time";
    EXPECT_EQ(rows[5].back(), "") << "never hit: no intensity";
}

TEST_F(Products, barriers_have_their_volumes_and_their_history) {
    const TemporaryFolder folder;
    run::RunResult result = *result_;
    observe::BuildingImpact& dam = result.observation.buildings[0];
    dam.is_barrier = true;
    dam.impulse = 81000;
    dam.failure_time = 12.5;
    dam.overtopped_volume = 7.25;
    dam.history = {{11, 2000, 900, 0.75, 600, 3000, 1, 0.5, 40, 1.5}, {12, 5000, 1100, 1.5, 0, 7000, 7.25, 0.5, 44, 2}};
    ASSERT_TRUE(write_tables(*scene_, result, folder.path()).ok());
    const auto rows = rows_of(test::read_text(folder.path() / "buildings.csv"));
    EXPECT_EQ(rows[1][11], "barrier");
    EXPECT_EQ(rows[1][12], "81");
    EXPECT_EQ(rows[1][13], "12.5");
    EXPECT_EQ(rows[1][14], "7.25");
    EXPECT_EQ(rows[2][11], "building");
    EXPECT_EQ(rows[2][14], "") << "no barrier: nothing goes over it";
    EXPECT_EQ(
        test::read_text(folder.path() / "structures_over_time.csv"),
        "name,time_s,force_kN,impact_pressure_kPa,depth_m,dynamic_pressure_kPa,impulse_kNs,overtopped_m3,passed_m3,"
        "retained_m3,filling_height_m\n"
        "House 38,11,2,0.9,0.75,0.6,3,1,0.5,40,1.5\nHouse 38,12,5,1.1,1.5,0,7,7.25,0.5,44,2\n");
    const std::string report = test::report_page(*scene_, result);
    EXPECT_THAT(report, HasSubstr("House 38 failed at 12.50 s"));
    EXPECT_THAT(report, HasSubstr("Force on structures over time."));
    EXPECT_THAT(report, HasSubstr("<h3>Barriers</h3>"));
    EXPECT_THAT(report, testing::Not(HasSubstr("What nets retained and let through.")));
    dam.passing_share = 0.4;
    dam.hit = true;
    dam.retained_volume = 44;
    dam.passed_volume = 8.75;
    ASSERT_TRUE(write_tables(*scene_, result, folder.path()).ok());
    EXPECT_EQ(rows_of(test::read_text(folder.path() / "buildings.csv"))[1][11], "net");
    const std::string of_net = test::report_page(*scene_, result);
    EXPECT_THAT(of_net, HasSubstr("What nets retained and let through."));
    EXPECT_THAT(of_net, HasSubstr("its meshes let 40 % of the grains through"));
    EXPECT_THAT(of_net, HasSubstr("Of 60.0 m³ that came to it, 44.0 m³ lie behind it (73 %), 8.8 m³ went through"));
    const std::string without = test::report_page(*scene_, *result_);
    EXPECT_THAT(without, testing::Not(HasSubstr("Force on structures over time.")));
}

TEST_F(Products, names_with_commas_and_quotes_are_quoted) {
    const TemporaryFolder folder;
    run::RunResult result = *result_;
    result.observation.buildings[0].name = "Block \"A\", 沙田";
    ASSERT_TRUE(write_tables(*scene_, result, folder.path()).ok());
    EXPECT_THAT(test::read_text(folder.path() / "buildings.csv"), HasSubstr("\n\"Block \"\"A\"\", 沙田\",yes,"));
}

TEST_F(Products, tables_of_a_run_that_was_changed_on_the_way_say_so_in_every_row) {
    const TemporaryFolder folder;
    run::RunResult result = *result_;
    result.observation.buildings[0].history = {{11, 2000, 900, 0.75, 600, 3000, 1, 0.5, 40, 1.5}};
    ASSERT_TRUE(write_tables(*scene_, result, folder.path(), "friction 0.4 -> 0.27 at 3.0 s, \"trial\"").ok());
    for (const char* name : {"front", "run_out", "buildings", "structures_over_time", "timeseries"}) {
        SCOPED_TRACE(name);
        const auto rows = rows_of(test::read_text(folder.path() / (std::string(name) + ".csv")));
        ASSERT_GE(rows.size(), 2U);
        EXPECT_EQ(rows[0].back(), "changed_on_the_way");
        for (std::size_t i = 1; i < rows.size(); ++i) EXPECT_THAT(rows[i].back(), HasSubstr("trial"));
    }
    ASSERT_TRUE(write_tables(*scene_, result, folder.path()).ok());
    EXPECT_THAT(test::read_text(folder.path() / "front.csv"), testing::Not(HasSubstr("changed")));
}

TEST_F(Products, tables_have_the_columns_that_other_programs_read) {
    const auto header = [](const char* name) {
        const std::string text = test::read_text(folder_->path() / name);
        return text.substr(0, text.find('\n'));
    };
    EXPECT_EQ(header("run_out.csv"),
              "run_out_along_flow_m,run_out_straight_m,at_least,toe_x_m,toe_y_m,drop_m,runout_angle_deg,"
              "travel_angle_deg,front_chainage_m");
    EXPECT_EQ(header("buildings.csv"),
              "name,hit,first_hit_time_s,peak_force_kN,peak_impact_pressure_kPa,peak_dynamic_pressure_kPa,peak_depth_m,"
              "filter_window_s,patch_edge_m,height_m,height_assumed,kind,impulse_kNs,failed_s,overtopped_m3,"
              "first_overtopped_s,passed_m3,retained_m3,peak_retained_m3,peak_filling_height_m,removed_time_s,"
              "peak_speed_mps,intensity");
}

TEST_F(Products, time_series_balances_its_volumes) {
    const auto rows = rows_of(test::read_text(folder_->path() / "timeseries.csv"));
    ASSERT_EQ(rows.size(), result_->observation.timeseries.size() + 1);
    ASSERT_EQ(rows[0][7], "volume_balance_m3");
    for (std::size_t i = 1; i < rows.size(); ++i) {
        ASSERT_EQ(rows[i].size(), rows[0].size());
        EXPECT_NEAR(std::stod(rows[i][7]), 0, 1e-9);
    }
    EXPECT_THAT(rows[0], testing::IsSupersetOf({"time_s", "front_chainage_m", "volume_moving_m3", "kinetic_energy_J",
                                                "steps_per_second"}));
}

}  // namespace
}  // namespace talus::products
