#include "twin/past_maps.hpp"

#include <gmock/gmock.h>

#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

using ::testing::HasSubstr;

/// Calls `look(then, rebuilt)` for all cells of the whole map in which either has a value.
template <class Look>
void compare(const Scenario& scenario, const Grid<float>& then, const Grid<float>& rebuilt, const Look& look) {
    const json map = scene_json(scenario)["map"];
    for (int row = 0; row < map["rows"].get<int>(); ++row) {
        for (int column = 0; column < map["columns"].get<int>(); ++column) {
            const PlanPoint p{map["x_min_m"].get<double>() + (column + 0.5) * map["cell_m"].get<double>(),
                              map["y_min_m"].get<double>() + (row + 0.5) * map["cell_m"].get<double>()};
            const float a = value_at(then, p), b = value_at(rebuilt, p);
            if (!std::isnan(a) || !std::isnan(b)) look(a, b);
        }
    }
}

TEST(PastMaps, are_what_was_told_then_but_for_what_no_recorded_frame_saw) {
    const auto scenario = open(channel_scene());
    run_until(*scenario, 3);
    const std::size_t frames = recording_json(*scenario)["times_s"].size();
    while (recording_json(*scenario)["times_s"].size() == frames) scenario->advance();
    const double time = scenario->time();
    const char* names[] = {"depth", "peak_depth", "peak_speed", "peak_pressure", "arrival_time", "deposit_depth"};
    std::map<std::string, Grid<float>> then;
    for (const char* name : names) then[name] = layer(*scenario, name);
    run_until(*scenario, 8);
    for (const std::string name : names) {
        const Grid<float> rebuilt = (*layer_of(*scenario, name, time + 0.01))();
        int cells = 0, alike = 0, missed = 0, more = 0, worse = 0;
        compare(*scenario, then[name], rebuilt, [&](float a, float b) {
            ++cells;
            missed += std::isnan(b);
            more += std::isnan(a);
            if (std::isnan(a) || std::isnan(b)) return;
            // Steps of the frames' whole numbers.
            const float step = name == "peak_pressure" ? 0.02F * a + 20 : name == "peak_speed" ? 0.06F : 1e-3F;
            alike += std::abs(a - b) <= step;
            worse += b > a + step;
        });
        EXPECT_GT(cells, 80) << name;
        EXPECT_EQ(worse, 0) << name << ": a peak that never was";
        // Debris can pass the rim of a cell between two frames; cells as thin as what counts may fall to either side.
        EXPECT_LE(missed, cells / 10) << name;
        EXPECT_LE(more, cells / 50) << name;
        const bool exact = name == "depth" || name == "arrival_time" || name == "deposit_depth";
        EXPECT_GE(alike, exact ? cells - missed - more : cells / 2) << name;
    }
    const Grid<float> last = layer(*scenario, "peak_depth"), early = (*layer_of(*scenario, "peak_depth", time))();
    int later = 0;
    compare(*scenario, last, early, [&](float, float b) { later += std::isnan(b); });
    EXPECT_GT(later, 50) << "cells that debris reached after that time";
}

TEST(PastMaps, before_the_recording_are_refused_and_unknown_ones_too) {
    const auto scenario = open(channel_scene());
    scenario->advance();
    EXPECT_TRUE(layer_of(*scenario, "peak_depth", 0.0));
    EXPECT_THAT(layer_of(*scenario, "peak_depth", -1).error().message, HasSubstr("nothing is recorded"));
    EXPECT_THAT(layer_of(*scenario, "height", 0.0).error().message, HasSubstr("must be one of depth, peak_depth"));
}

}  // namespace
}  // namespace talus::twin::test
