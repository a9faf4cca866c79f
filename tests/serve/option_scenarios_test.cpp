#include "serve/option_scenarios.hpp"

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/scene_folder.hpp"
#include "session/scenarios.hpp"
#include "twin/scenario.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;
using testing::ElementsAre;

struct Nobody : session::Watcher {
    void frames(session::FrameSet) override {}
    void state(int, json) override {}
    void setup(int, json, const twin::Setup&) override {}
    void done(int, const std::string&, const std::string&) override {}
    void scenarios(std::vector<std::string>) override {}
    void alerts(int, session::RunAlerts) override {}
};

class OptionScenarios : public scene::SceneFolder {
  protected:
    OptionScenarios() {
        write_features("houses.geojson", {rectangle(200, 90, 210, 110, "\"name\": \"near\""),
                                          rectangle(200, 170, 210, 180, "\"name\": \"far\"")});
        write_valley(
            fmt::format(
                "[buildings]\nfile = \"houses.geojson\"\nname_attribute = \"name\"\n[solver]\nparticle_spacing_m = 3\n"
                "[risk]\ncurrency = \"HKD\"\n"
                "[[barrier]]\nname = \"wall\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nheight_m = 3\nthickness_m = 2\n"
                "[[barrier_opening]]\nbarrier = \"wall\"\nposition_m = 20\nwidth_m = 8\n"
                "[[zone]]\nname = \"forest\"\npolygon = \"{0} {1}, {3} {1}, {3} {2}\"\nfriction_coefficient = 0.6\n",
                west + 120, south + 80, south + 120, west + 160) +
            option("build", "barriers = [\"wall\"]") +
            option("plant and move", "zones = [\"forest\"]\nremoved_buildings = [\"near\"]"));
    }
    static std::string option(const std::string& name, const std::string& measures) {
        return fmt::format(
            "[[option]]\nname = \"{}\"\n{}\ncost = 1\nlife_years = 1\ninterest_rate = 0\n"
            "upkeep_per_year = 0\n",
            name, measures);
    }
};

TEST_F(OptionScenarios, are_offered_beside_the_ground_as_it_is) {
    scene::Scene scene = loaded();
    const std::vector<OptionScenario> options = option_scenarios(scene, {folder / "scene.toml", {}});
    ASSERT_EQ(options.size(), 2U);
    EXPECT_EQ(options[0].name, "build");

    auto first = twin::Scenario::open(std::make_shared<const scene::Scene>(std::move(scene)));
    ASSERT_TRUE(first) << first.error().message;
    Nobody nobody;
    std::vector<std::pair<session::Work, std::function<void()>>> prepared;
    session::Scenarios scenarios(*std::move(first), nobody, [&](session::Work work, std::function<void()> then) {
        prepared.emplace_back(std::move(work), std::move(then));
    });
    offer_options(scenarios, options);
    const std::atomic<bool> stop = false;
    while (!prepared.empty()) {
        const auto [work, then] = prepared.front();
        prepared.erase(prepared.begin());
        work(stop);
        then();
    }
    EXPECT_THAT(scenarios.names(), ElementsAre("A", "B", "C"));
    const json as_it_is = scenarios.setup(0), build = scenarios.setup(1), plant = scenarios.setup(2);
    EXPECT_EQ(build["name"], "build");
    EXPECT_EQ(plant["name"], "plant and move");
    EXPECT_TRUE(as_it_is["barriers"].empty());
    ASSERT_EQ(build["barriers"].size(), 1U);
    EXPECT_EQ(build["barriers"][0]["name"], "wall");
    EXPECT_EQ(build["barriers"][0]["thickness_m"], 2);
    EXPECT_EQ(build["barriers"][0]["openings"].size(), 1U);
    EXPECT_EQ(build["buildings"].size(), 2U);
    EXPECT_EQ(plant["buildings"].size(), 1U);
    EXPECT_EQ(plant["zones"].size(), 1U);
}

TEST_F(OptionScenarios, are_none_where_one_is_in_force) {
    const scene::Scene scene = loaded({"scene.option=build"});
    EXPECT_TRUE(option_scenarios(scene, {folder / "scene.toml", {}}).empty());
}

}  // namespace
}  // namespace talus::serve
