#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "run/run_scene.hpp"
#include "scene/scene_folder.hpp"

/// Runs that save a state and start from one, and whether two have the same results.
namespace talus::run {

/// The state of the scene at a time; at the end without one.
inline std::string state_at(const scene::Scene& scene, std::optional<double> time) {
    std::string state;
    RunOptions options;
    options.save_time = time;
    options.on_state = [&](const std::string& saved, double) { state = saved; };
    (void)test::value_of(run_scene(scene, options));
    return state;
}

inline Result<RunResult> run_from(const scene::Scene& scene, const std::string& state) {
    RunOptions options;
    options.start_from = state;
    options.start_from_file = "run.state";
    return run_scene(scene, options);
}

/// Down a slope and out on level ground: release.geojson near the top and flow.csv, for an inflow below it.
class SavedRuns : public scene::SceneFolder {
  protected:
    /// `always`: values of every run.
    explicit SavedRuns(std::vector<std::string> always = {}) : always_(std::move(always)) {}

    void write_inputs() const {
        write_terrain("dem.tif", [](double x, double y) {
            return 200 - 0.5 * std::min(x - west, 70.0) + 0.1 * std::abs(y - (south + 100));
        });
        write_features("release.geojson", {rectangle(20, 90, 40, 110)});
        write("flow.csv", "time_s,discharge_m3ps,velocity_mps\n0,30,4\n7,30,4\n");
    }
    [[nodiscard]] scene::Scene loaded(std::vector<std::string> overrides = {}) const {
        overrides.insert(overrides.begin(), always_.begin(), always_.end());
        return SceneFolder::loaded(overrides);
    }
    [[nodiscard]] std::string refusal(const std::string& state, const std::vector<std::string>& overrides) const {
        const auto result = run_from(loaded(overrides), state);
        return result ? "(it ran)" : result.error().message;
    }

  private:
    std::vector<std::string> always_;
};

inline void expect_same_map(const Grid<float>& a, const Grid<float>& b, const char* name) {
    ASSERT_EQ(a.values.size(), b.values.size()) << name;
    EXPECT_EQ(std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(float)), 0) << name;
}

inline void expect_same(const RunResult& a, const RunResult& b) {
    EXPECT_EQ(a.hash, b.hash);
    EXPECT_EQ(a.steps, b.steps);
    EXPECT_EQ(a.stop_reason, b.stop_reason);
    EXPECT_EQ(a.smallest_time_step, b.smallest_time_step);
    const observe::Observation &o = a.observation, &p = b.observation;
    expect_same_map(o.maps.peak_depth, p.maps.peak_depth, "peak depth");
    expect_same_map(o.maps.peak_speed, p.maps.peak_speed, "peak speed");
    expect_same_map(o.maps.arrival_time, p.maps.arrival_time, "arrival time");
    expect_same_map(o.maps.deposit_depth, p.maps.deposit_depth, "deposit depth");
    expect_same_map(o.erosion.depth, p.erosion.depth, "erosion");
    ASSERT_EQ(o.timeseries.size(), p.timeseries.size());
    for (std::size_t k = 0; k < o.timeseries.size(); ++k) {
        EXPECT_EQ(o.timeseries[k].time, p.timeseries[k].time);
        EXPECT_EQ(o.timeseries[k].kinetic_energy, p.timeseries[k].kinetic_energy);
        EXPECT_EQ(o.timeseries[k].volume_entrained, p.timeseries[k].volume_entrained);
    }
    ASSERT_EQ(o.front.size(), p.front.size());
    for (std::size_t k = 0; k < o.front.size(); ++k) EXPECT_EQ(o.front[k].arrival_time, p.front[k].arrival_time);
    ASSERT_EQ(o.buildings.size(), p.buildings.size());
    for (std::size_t k = 0; k < o.buildings.size(); ++k) {
        EXPECT_EQ(o.buildings[k].impulse, p.buildings[k].impulse);
        EXPECT_EQ(o.buildings[k].peak_force, p.buildings[k].peak_force);
        EXPECT_EQ(o.buildings[k].overtopped_volume, p.buildings[k].overtopped_volume);
        EXPECT_EQ(o.buildings[k].history.size(), p.buildings[k].history.size());
    }
    ASSERT_EQ(o.cross_sections.size(), p.cross_sections.size());
    for (std::size_t k = 0; k < o.cross_sections.size(); ++k) {
        EXPECT_EQ(o.cross_sections[k].passed, p.cross_sections[k].passed);
        EXPECT_EQ(o.cross_sections[k].peak_discharge, p.cross_sections[k].peak_discharge);
        EXPECT_EQ(o.cross_sections[k].rows.size(), p.cross_sections[k].rows.size());
    }
    ASSERT_EQ(o.gauges.size(), 1U);
    EXPECT_EQ(o.gauges[0].peak_depth, p.gauges[0].peak_depth);
    EXPECT_EQ(o.gauges[0].rows.size(), p.gauges[0].rows.size());
    EXPECT_EQ(o.run_out.along_flow, p.run_out.along_flow);
    EXPECT_EQ(o.energy.gained, p.energy.gained);
    EXPECT_EQ(o.compression.mean_iterations, p.compression.mean_iterations);
}

}  // namespace talus::run
