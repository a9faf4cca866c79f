#include "validate/flume.hpp"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "case_folder.hpp"
#include "core/angle.hpp"
#include "validate/suite.hpp"

namespace talus::validate {
namespace {

FlumeShape usgs_flume() {
    FlumeShape shape;
    shape.slope = 31 * radians_per_degree;
    shape.pad_slope = 2.4 * radians_per_degree;
    shape.bend_start = 74;
    shape.bend_end = 84;
    shape.width = 2;
    shape.volume = 10;
    shape.gate_height = 1.9;
    shape.top_length = 3.3;
    shape.top_slope = 17 * radians_per_degree;
    return shape;
}

TEST(FlumeFill, has_its_volume_below_a_surface_of_that_slope_behind_a_vertical_gate) {
    const FlumeShape shape = usgs_flume();
    const FlumeBed bed(shape);
    const FlumeFill fill(shape, bed);
    ASSERT_TRUE(fill.holds_volume());
    const double gate = bed.at(0).x;
    EXPECT_NEAR(fill.top(gate) - bed.at(0).y, 1.9, 1e-9);
    EXPECT_NEAR(fill.top(gate - 2) - fill.top(gate), 2 * std::tan(shape.top_slope), 1e-9);
    EXPECT_NEAR(fill.top(gate + 0.1), bed.at(bed.along(gate + 0.1)).y, 1e-9) << "nothing before the gate";
    EXPECT_NEAR(fill.top(bed.at(fill.back()).x - 0.1), bed.at(fill.back()).y + 0.1 * std::tan(shape.slope), 1e-6);
    double area = 0;
    constexpr double step = 1e-3;
    for (double x = gate - 8 + step / 2; x < gate; x += step) area += step * (fill.top(x) - bed.at(bed.along(x)).y);
    EXPECT_NEAR(area * shape.width, shape.volume, 0.01);
}

TEST(FlumeFill, does_not_hold_less_than_stands_below_its_surface_nor_more_than_the_bed_takes) {
    FlumeShape shape = usgs_flume();
    for (const double volume : {9.0, 25.0}) {
        shape.volume = volume;
        EXPECT_FALSE(FlumeFill(shape, FlumeBed(shape)).holds_volume()) << volume;
    }
}

TEST(FlumeBed, is_found_again_from_the_plan) {
    const FlumeBed bed(usgs_flume()), ramp(usgs_flume(), FlumeRamp{91, 30 * radians_per_degree});
    for (const double s : {-4.0, 0.0, 66.0, 79.0, 95.0}) EXPECT_NEAR(bed.along(bed.at(s).x), s, 1e-6);
    EXPECT_NEAR(bed.at(10).y - bed.at(20).y, 10 * std::sin(31 * radians_per_degree), 1e-6);
    EXPECT_NEAR(ramp.at(95).y - ramp.at(93).y, 2 * std::sin(30 * radians_per_degree), 1e-6);
}

/// Arrivals of both models 2 m below the gate.
std::vector<double> arrivals(double opening) {
    const Result<Case> loaded = CaseFolder(fmt::format(R"([case]
title = "A coarse flume"
kind = "debris_flume"
description = "For tests."

[parameters]
spacings_m = [0.3]
grid_cell_m = 0.25
stations_m = [2]
gate_opening_s = {}
end_s = 1.5

[material]
friction_coefficient = 0.86
building_friction_coefficient = 0
pore_pressure_ratio = 0.8

[[expect]]
quantity = "arrival_time"
where = "2 m, spacing 0.3 m"
expected = 0.5
gate = false
source = "none"

[[expect]]
quantity = "arrival_time"
where = "2 m, depth-averaged"
expected = 0.5
gate = false
source = "none"
)",
                                                       opening))
                                    .load();
    EXPECT_TRUE(loaded) << (loaded ? "" : loaded.error().message);
    Watch watch;
    watch.thread_count = 1;
    std::vector<double> found;
    for (const Row& row : run_case(*loaded, watch).rows) found.push_back(row.computed);
    return found;
}

TEST(DebrisFlume, lets_debris_through_while_its_gate_still_opens) {
    const std::vector<double> at_once = arrivals(0), slowly = arrivals(0.85);
    ASSERT_EQ(at_once.size(), 2);
    for (std::size_t model = 0; model < 2; ++model) {
        EXPECT_GT(at_once[model], 0.3);
        EXPECT_LT(at_once[model], 0.8);
        EXPECT_GT(slowly[model], at_once[model] + 0.04);
        EXPECT_LT(slowly[model], at_once[model] + 0.425) << "half of its opening";
    }
}

}  // namespace
}  // namespace talus::validate
