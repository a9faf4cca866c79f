#include "risk/study.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ensemble/ensemble.hpp"
#include "ensemble/ensemble_folder.hpp"
#include "geo/raster.hpp"
#include "geo/vector.hpp"
#include "risk/risk_products.hpp"
#include "scene/scene_folder.hpp"

namespace talus::risk {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class StudyTest : public scene::SceneFolder {
  protected:
    /// The valley with two houses, of which debris reaches the first, a wall above it and two classes of events.
    void write_scene(const std::string& exposure = homes, const std::string& more = "") const {
        write_features("houses.geojson", {rectangle(90, 95, 100, 105, R"("name": "near", "people": 3, "worth": -5)"),
                                          rectangle(200, 170, 210, 180, R"("name": "far", "people": 2, "worth": 1)")});
        write_valley(fmt::format("[buildings]\nfile = \"houses.geojson\"\nname_attribute = \"name\"\n"
                                 "[solver]\nmodel = \"depth_averaged\"\nend_time_s = 8\n"
                                 "[[barrier]]\nname = \"wall\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nheight_m = 8\n"
                                 "thickness_m = 5\n[risk]\ncurrency = \"HKD\"\nmap_death_curve = \"finlay_1999_open\"\n"
                                 "[[risk_scenario]]\nname = \"small\"\nreturn_period_years = 10\n"
                                 "[[risk_scenario]]\nname = \"large\"\nannual_frequency = 0.01\n"
                                 "set = [\"release.thickness_m=3\"]\n",
                                 west + 65, south + 60, south + 140) +
                     option + exposure + more);
    }
    static constexpr const char* option =
        "[[option]]\nname = \"build it\"\nbarriers = [\"wall\"]\ncost = 1e6\nlife_years = 50\ninterest_rate = 0.03\n"
        "upkeep_per_year = 1000\n[[option]]\nname = \"move\"\nremoved_buildings = [\"near\"]\ncost = 2e6\n"
        "life_years = 80\ninterest_rate = 0\nupkeep_per_year = 0\n";
    static constexpr const char* homes =
        "[[exposure]]\nname = \"homes\"\nvalue = 5e6\npersons_attribute = \"people\"\npresence = 0.6\n"
        "damage_curve = \"jakob_2012_intensity\"\ndeath_curve = \"finlay_1999_building\"\n";

    [[nodiscard]] StudyRequest request(const std::vector<std::string>& options = {""}) const {
        StudyRequest wanted;
        wanted.plan.runs = 3;
        wanted.plan.factors.clear();
        EXPECT_TRUE(add_factor(wanted.plan, "material.friction_coefficient=0.1:0.3"));
        wanted.source.file = folder / "scene.toml";
        wanted.scene_name = "valley";
        wanted.options = options;
        wanted.folder = folder / "out";
        return wanted;
    }
    [[nodiscard]] Study planned(const std::vector<std::string>& options = {""}) const {
        return test::value_of(plan_study(request(options)));
    }
    [[nodiscard]] std::string error_of(const std::string& exposure, const std::string& more = "") const {
        write_scene(exposure, more);
        const auto study = plan_study(request());
        return study ? "(it was planned)" : study.error().message;
    }
    static void run(const Study& study, std::size_t shards) {
        for (const Part& part : study.parts) {
            const auto opened = ensemble::EnsembleFolder::open(part.folder, *part.definition);
            ASSERT_TRUE(opened) << opened.error().message;
            for (std::size_t shard = 0; shard < shards; ++shard) {
                ensemble::EnsembleOptions options;
                options.shard = shard;
                options.shard_count = shards;
                const auto outcome = run_ensemble(*part.runs, part.source, *opened, options);
                ASSERT_TRUE(outcome) << outcome.error().message;
            }
        }
    }
};

TEST_F(StudyTest, draws_the_same_for_every_option_and_anew_for_every_class_of_events) {
    write_scene();
    const Study study = planned({"", "build it"});
    ASSERT_EQ(study.parts.size(), 4U);
    EXPECT_EQ(study.parts[0].runs->points(), study.parts[2].runs->points());
    EXPECT_EQ(study.parts[1].runs->points(), study.parts[3].runs->points());
    EXPECT_NE(study.parts[0].runs->points(), study.parts[1].runs->points());
    EXPECT_EQ(study.parts[0].scene->buildings.size(), 2U);  // the wall is only there with its option
    EXPECT_EQ(study.parts[2].scene->buildings.size(), 3U);
    EXPECT_EQ(study.frequency(0), 0.1);
    EXPECT_EQ(study.frequency(1), 0.01);
}

TEST_F(StudyTest, finds_that_measures_lower_the_risk_and_writes_all_of_it) {
    write_scene();
    const Study study = planned({"", "build it", "move"});
    run(study, 1);
    const auto result = summarise(study);
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_NEAR(result->risks[0].total.impact.value, 0.11, 1e-12);  // every run comes to the house
    EXPECT_GT(result->risks[0].total.deaths.value, 0);
    EXPECT_LT(result->differences[1].total.loss.value, 0);
    EXPECT_EQ(result->risks[2].total.impact.value, 0);  // it is gone
    EXPECT_EQ(result->risks[2].total.deaths.value, 0);
    const Status written = risk::write_study(*result, folder / "out");
    ASSERT_TRUE(written) << written.error().message;
    for (const char* file : {"risk.csv", "fn.csv", "options.csv", "differences.csv", "results.json", "report.html",
                             "results.qlr", "individual_risk.tif", "individual_risk.qml",
                             "individual_risk_option_2.tif", "debris_frequency_option_1.tif"}) {
        EXPECT_TRUE(std::filesystem::is_regular_file(folder / "out" / file)) << file;
    }
    const auto layer = geo::read_polygons(path("out/risk.gpkg"), "buildings_option_2", {"", "", 2326});
    ASSERT_TRUE(layer) << layer.error().message;
    EXPECT_EQ(layer->features.size(), 2U);
    const auto json = risk_results(*result);
    EXPECT_EQ(json["options"][1]["name"], "build it");
    EXPECT_EQ(json["per"], "year");
    EXPECT_NE(json["limits"].back().get<std::string>().find("licensed engineer"), std::string::npos);
}

TEST_F(StudyTest, is_the_same_however_the_runs_are_split) {
    write_scene();
    const auto of = [&](std::size_t shards) {
        std::filesystem::remove_all(folder / "out");
        const Study study = planned({"", "build it"});
        run(study, shards);
        const auto result = test::value_of(summarise(study));
        const auto json = risk_results(result);
        return std::pair(json["options"].dump(), result.outcomes[0].individual.values);
    };
    const auto one = of(1), three = of(3);
    EXPECT_EQ(one.first, three.first);
    ASSERT_EQ(one.second.size(), three.second.size());
    EXPECT_TRUE(std::equal(one.second.begin(), one.second.end(), three.second.begin(),
                           [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }));
}

TEST_F(StudyTest, without_frequencies_is_per_event_and_only_where_that_was_asked_for) {
    write_scene("");
    StudyRequest wanted = request({"", "build it"});
    EXPECT_THAT(plan_study(wanted).error().message, HasSubstr("[[exposure]] is missing"));
    wanted.needs_risk = false;
    const auto study = plan_study(wanted);
    ASSERT_TRUE(study) << study.error().message;
    EXPECT_FALSE(study->per_event);
    EXPECT_TRUE(study->exposures.empty());
}

TEST_F(StudyTest, reads_roads_by_their_length) {
    write_scene(
        fmt::format("[[exposure]]\nname = \"road\"\nkind = \"road\"\nline_m = [[{0}, {1}], [{0}, {2}], [{3}, {2}]]\n"
                    "vehicles_per_day = 8640\nspeed_mps = 10\npersons_per_vehicle = 2\n"
                    "death_curve = \"finlay_1999_vehicle\"\n",
                    west + 80, south + 50, south + 150, west + 120));
    const Study study = planned();
    ASSERT_EQ(study.exposures.roads.size(), 1U);
    const ExposedRoad& road = study.exposures.roads.front();
    EXPECT_NEAR(road.length(), 140, 1e-9);
    EXPECT_LE(road.step, 2.5);
    EXPECT_NEAR(road.persons_per_metre, 0.02, 1e-12);
    EXPECT_NEAR(road.places.back().x, west + 120 - road.step / 2, 1e-6);
}

TEST_F(StudyTest, refuses_hostile_exposures_in_one_sentence) {
    const std::string head = "[[exposure]]\nname = \"homes\"\n";
    EXPECT_THAT(error_of(head + "persons = 3\npresence = 1.2\ndeath_curve = \"finlay_1999_building\"\n"),
                AllOf(HasSubstr("exposure[0].presence = 1.2 is refused; it must be a number from 0 to 1"),
                      Not(HasSubstr("\n"))));
    EXPECT_THAT(error_of(head + "persons = 3\npresence = 1\ndeath_curve = \"nobody_1900\"\n"),
                HasSubstr("exposure[0].death_curve = \"nobody_1900\": there is no such vulnerability curve of death; "
                          "curves: finlay_1999_building"));
    EXPECT_THAT(error_of(head + "buildings = [\"palace\"]\nvalue = 1\ndamage_curve = \"jakob_2012_intensity\"\n"),
                HasSubstr("exposure[0].buildings: there is no building \"palace\"; buildings: near, far"));
    EXPECT_THAT(error_of(head + "value = -3\ndamage_curve = \"jakob_2012_intensity\"\n"),
                HasSubstr("exposure[0].value = -3 is refused; it must be a number at least 0"));
    EXPECT_THAT(error_of(head + "value_attribute = \"worth\"\ndamage_curve = \"jakob_2012_intensity\"\n"),
                HasSubstr("building \"near\" has worth = -5; it must be a number of at least 0"));
    EXPECT_THAT(error_of(head + "value_attribute = \"price\"\ndamage_curve = \"jakob_2012_intensity\"\n"),
                HasSubstr("has no such attribute; attributes: name, people, worth"));
    EXPECT_THAT(error_of(head + "persons = 3\ndeath_curve = \"finlay_1999_building\"\n"),
                HasSubstr("exposure[0].presence is missing"));
    EXPECT_THAT(error_of(head + "vehicles_per_day = 3\n"), HasSubstr("exposure[0].vehicles_per_day: is not for kind"));
    EXPECT_THAT(error_of(std::string(homes) + "[[exposure]]\nname = \"again\"\nvalue = 1\nbuildings = [\"far\"]\n"
                                              "damage_curve = \"jakob_2012_intensity\"\n"),
                HasSubstr("building \"far\" is in the exposure \"homes\" already"));
}

TEST_F(StudyTest, refuses_hostile_options_and_classes_of_events_in_one_sentence) {
    const std::string other =
        "[[option]]\nname = \"other\"\nbarriers = [\"wall\"]\nlife_years = 5\ninterest_rate = 0\n";
    EXPECT_THAT(error_of(homes, other + "cost = -1\nupkeep_per_year = 0\n"),
                HasSubstr("option[2].cost = -1 is refused; it must be a number at least 0"));
    EXPECT_THAT(error_of(homes, other + "cost = 1\n"), HasSubstr("option[2].upkeep_per_year is missing"));
    EXPECT_THAT(error_of(homes, "[[risk_scenario]]\nname = \"none\"\n"),
                HasSubstr("risk_scenario[2].annual_frequency: exactly one of annual_frequency, return_period_years"));
    EXPECT_THAT(
        error_of(homes, "[[risk_scenario]]\nname = \"odd\"\nannual_frequency = 1\nset = [\"release.colour=1\"]\n"),
        HasSubstr("risk_scenario \"odd\": --set release.colour=1"));
}

}  // namespace
}  // namespace talus::risk
