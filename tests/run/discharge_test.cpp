#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "run/run_scene.hpp"
#include "scene/scene_folder.hpp"

namespace talus::run {
namespace {

/// With either model, on a plane 0.5 steep towards the east.
class Discharge : public scene::SceneFolder, public testing::WithParamInterface<const char*> {
  protected:
    /// A line across the plane, `x` m from its western edge; to the right of it is down the slope.
    static std::string section(const std::string& name, double x, const std::string& more = "") {
        return fmt::format("[[cross_section]]\nname = \"{}\"\nline_m = [[{}, {}], [{}, {}]]\n{}", name, west + x,
                           south + 20, west + x + 15, south + 180, more);
    }
    /// The debris that lies at the end above such a section, m3: a film of it stays behind.
    static double left_above(const observe::Observation& o, double x) {
        const Grid<float>& deposit = o.maps.deposit_depth;
        const GridGeometry& cells = deposit.geometry;
        double volume = 0;
        for (int row = 0; row < cells.rows; ++row) {
            for (int column = 0; column < cells.columns; ++column) {
                const PlanPoint centre = cells.centre(column, row);
                const float depth = deposit.values[cells.index(column, row)];
                const bool above = centre.x < west + x + 15 * (centre.y - south - 20) / 160;
                if (above && depth > 0) volume += depth * cells.cell * cells.cell;
            }
        }
        return volume;
    }
    [[nodiscard]] scene::Scene loaded(const std::string& text, std::vector<std::string> overrides = {}) const {
        write_terrain("dem.tif", [](double x, double) { return 200 - 0.5 * (x - west); });
        write("scene.toml", "[terrain]\nfile = \"dem.tif\"\n[material]\nfriction_coefficient = 0.2\n" + text);
        if (*GetParam() != '\0') overrides.emplace_back(GetParam());
        return SceneFolder::loaded(overrides);
    }
};

TEST_P(Discharge, is_the_volume_released_below_it_and_nothing_above_it) {
    write_features("release.geojson", {rectangle(40, 90, 60, 110)});
    const scene::Scene scene = loaded(
        "[[release]]\nfile = \"release.geojson\"\nthickness_m = 1\n" + section("below", 100) + section("above", 15) +
            fmt::format("[[cross_section]]\nname = \"back\"\nline_m = [[{0}, {1}], [{0}, {2}]]\n", west + 120,
                        south + 180, south + 20),
        {"solver.target_particle_count=800", "solver.end_time_s=25"});
    const auto result = run_scene(scene, {});
    ASSERT_TRUE(result) << result.error().message;
    const observe::Observation& o = result->observation;
    ASSERT_EQ(o.cross_sections.size(), 3U);
    const observe::DischargeRecord &below = o.cross_sections[0], &above = o.cross_sections[1],
                                   &back = o.cross_sections[2];
    EXPECT_NEAR(below.passed, o.volume_released - left_above(o, 100), 1e-3 * o.volume_released);
    EXPECT_NEAR(below.passed, -back.passed, 1e-3 * o.volume_released) << "the line is drawn the other way";
    EXPECT_NEAR(above.passed, 0, 1e-6 * o.volume_released);
    EXPECT_TRUE(std::isnan(above.peak_time));
    double sum = 0, before = 0;
    for (const observe::DischargeSample& row : below.rows) {
        sum += row.discharge * (row.time - before);
        before = row.time;
        EXPECT_NEAR(row.passed, sum, 1e-6 * o.volume_released);
        EXPECT_LE(std::abs(row.discharge), std::abs(below.peak_discharge) + 1e-9);
    }
    EXPECT_EQ(before, result->simulated_time);
    EXPECT_EQ(below.rows.size(), static_cast<std::size_t>(std::ceil(result->simulated_time))) << "one a second";
}

TEST_P(Discharge, of_a_steady_inflow_is_its_hydrograph) {
    write("flow.csv", "time_s,discharge_m3ps,velocity_mps\n0,20,5\n30,20,5\n");
    const scene::Scene scene =
        loaded(fmt::format("[[inflow]]\nline_m = [[{0}, {1}], [{0}, {2}]]\nhydrograph = \"flow.csv\"\n", west + 30,
                           south + 95, south + 105) +
                   section("below", 60, "interval_s = 2\n"),
               {"solver.particle_spacing_m=0.5", "solver.end_time_s=24", "material.friction_coefficient=0.3",
                "material.turbulent_friction_mps2=200"});
    const auto result = run_scene(scene, {});
    ASSERT_TRUE(result) << result.error().message;
    const observe::DischargeRecord& below = result->observation.cross_sections.at(0);
    double mean = 0;
    int steady = 0;
    for (const observe::DischargeSample& row : below.rows) {
        if (row.time <= 16) continue;
        mean += row.discharge;
        ++steady;
    }
    ASSERT_GT(steady, 2);
    EXPECT_NEAR(mean / steady, 20, 0.05 * 20);
}

INSTANTIATE_TEST_SUITE_P(Models, Discharge, testing::Values("", "solver.model=depth_averaged"),
                         [](const auto& model) { return *model.param == '\0' ? "particles" : "depth_averaged"; });

}  // namespace
}  // namespace talus::run
