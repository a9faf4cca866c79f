#include <cmath>

#include <gmock/gmock.h>

#include "run/run_scene.hpp"
#include "scene/scene_folder.hpp"

namespace talus::run {
namespace {

class Gauges : public scene::SceneFolder {
  protected:
    [[nodiscard]] RunResult run(std::vector<std::string> overrides) const {
        write_valley(
            fmt::format("[[gauge]]\nname = \"in the valley\"\nx_m = {}\ny_m = {}\n"
                        "[[gauge]]\nchainage_m = 40\n"
                        "[[gauge]]\nname = \"on the bank\"\nx_m = {}\ny_m = {}\n",
                        west + 57.5, south + 102.5, west + 92.5, south + 12.5));
        overrides.insert(overrides.begin(), {"solver.end_time_s=8", "solver.target_particle_count=1000"});
        return test::value_of(run_scene(loaded(overrides), {}));
    }
};

/// Peaks are those of the map in the cell; rows are the time series'.
void expect_that_of_the_maps(const RunResult& result) {
    const observe::Observation& o = result.observation;
    ASSERT_EQ(o.gauges.size(), 3U);
    for (const observe::GaugeRecord& record : {o.gauges[0], o.gauges[1]}) {
        const PlanPoint& at = record.gauge.at;
        EXPECT_NEAR(record.peak_depth, value_at(o.maps.peak_depth, at), 1e-5) << record.gauge.name;
        EXPECT_NEAR(record.peak_speed, value_at(o.maps.peak_speed, at), 1e-4) << record.gauge.name;
        EXPECT_NEAR(record.arrival_time, value_at(o.maps.arrival_time, at), 1e-5) << record.gauge.name;
        ASSERT_EQ(record.rows.size(), o.timeseries.size());
        double deepest = 0;
        for (std::size_t k = 0; k < record.rows.size(); ++k) {
            EXPECT_EQ(record.rows[k].time, o.timeseries[k].time);
            deepest = std::max(deepest, record.rows[k].depth);
        }
        EXPECT_GT(deepest, 0.5 * record.peak_depth);
        EXPECT_LE(deepest, record.peak_depth);
        EXPECT_EQ(record.rows.front().depth, 0) << "nothing has come yet";
    }
    const observe::GaugeRecord& dry = o.gauges[2];
    EXPECT_EQ(dry.peak_depth, 0);
    EXPECT_TRUE(std::isnan(dry.arrival_time) && std::isnan(dry.peak_depth_time));
    EXPECT_EQ(o.gauges[1].gauge.name, "gauge 2");
    EXPECT_EQ(o.gauges[1].gauge.chainage, 40);
}

TEST_F(Gauges, record_particles) {
    expect_that_of_the_maps(run({}));
}

TEST_F(Gauges, record_the_depth_averaged_model) {
    expect_that_of_the_maps(run({"solver.model=depth_averaged"}));
}

}  // namespace
}  // namespace talus::run
