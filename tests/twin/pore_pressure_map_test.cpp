#include "twin/pore_pressure_map.hpp"

#include <algorithm>
#include <cmath>

#include "twin/frame.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

constexpr const char* ratio = "pore_pressure_ratio";

/// Least and greatest value, and in how many cells there is one.
struct Spread {
    float least = 2, greatest = -1;
    int cells = 0;
};
Spread spread_of(const Grid<float>& grid) {
    Spread spread;
    for (const float value : grid.values) {
        if (std::isnan(value)) continue;
        spread.least = std::min(spread.least, value);
        spread.greatest = std::max(spread.greatest, value);
        ++spread.cells;
    }
    return spread;
}

TEST(PorePressureMap, is_that_of_the_debris_now_and_then) {
    scene::Scene scene = channel_scene();
    scene.spec.material.pore_pressure_ratio = 0.4;
    const auto scenario = open(std::move(scene));
    run_until(*scenario, 2);
    const Spread now = spread_of(layer(*scenario, ratio));
    EXPECT_NEAR(now.least, 0.4, 0.003);
    EXPECT_NEAR(now.greatest, 0.4, 0.003);
    EXPECT_GE(now.cells, 0.9 * spread_of(layer(*scenario, "depth")).cells) << "but for a rim thinner than 0.1 mm";

    act(*scenario, {{"action", "set_parameter"}, {"key", "material.pore_pressure_ratio"}, {"value", 0.6}});
    run_until(*scenario, 3);
    EXPECT_NEAR(spread_of(layer(*scenario, ratio)).greatest, 0.6, 0.003);
    const Spread then = spread_of((*layer_of(*scenario, ratio, 1.5))());
    EXPECT_NEAR(then.greatest, 0.4, 0.003);
    EXPECT_GT(then.cells, 20);
    EXPECT_EQ(state_json(*scenario)["pore_pressure"], true);
}

TEST(PorePressureMap, has_the_state_of_soil_whose_pressure_evolves) {
    scene::Scene scene = channel_scene();
    params::MaterialSpec& material = scene.spec.material;
    material.pore_pressure = params::PorePressure::dilatancy;
    material.permeability = 1e-9;
    material.solid_fraction = 0.5;
    material.critical_solid_fraction = 0.58;
    material.grain_density = 2700;
    material.rest_density = 1100 + 1600 * 0.5;
    const auto scenario = open(std::move(scene));
    run_until(*scenario, 2);
    const Spread now = spread_of(layer(*scenario, ratio));
    EXPECT_GT(now.greatest, 0.8) << "loose soil liquefies";
    EXPECT_LE(now.greatest, 1.2);
    EXPECT_GT(now.cells, 20);

    const Grid<float> depth = layer(*scenario, "depth");
    const auto deepest =
        static_cast<std::size_t>(std::max_element(depth.values.begin(), depth.values.end(),
                                                  [](float a, float b) { return !(b <= a) && !std::isnan(b); }) -
                                 depth.values.begin());
    const int columns = depth.geometry.columns;
    const PlanPoint there =
        depth.geometry.centre(static_cast<int>(deepest) % columns, static_cast<int>(deepest) / columns);
    const json series = probe_at(*scenario, there)();
    ASSERT_EQ(series[ratio].size(), series["time_s"].size());
    EXPECT_NEAR(series[ratio].back().get<double>(), now.greatest, 0.4);
    EXPECT_TRUE(json(probe_at(*scenario, {west + 1, south + 1})())[ratio].back().is_null())
        << "no debris has been there";
}

TEST(PorePressureMap, of_debris_without_pore_pressure_is_empty) {
    const auto scenario = open(channel_scene());
    run_until(*scenario, 1);
    EXPECT_EQ(spread_of(layer(*scenario, ratio)).cells, 0);
    EXPECT_EQ(state_json(*scenario)["pore_pressure"], false);
    EXPECT_TRUE(json(probe_at(*scenario, {west + 12, south + 30})())[ratio].back().is_null());
}

}  // namespace
}  // namespace talus::twin::test
