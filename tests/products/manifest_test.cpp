#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "params/fields.hpp"
#include "products/writers.hpp"
#include "products_fixture.hpp"

namespace talus::products {
namespace {

using nlohmann::json;
using test::TemporaryFolder;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

TEST_F(Products, manifest_counts_barriers_apart) {
    const TemporaryFolder folder;
    run::RunResult result = *result_;
    result.observation.buildings[0].is_barrier = true;
    ASSERT_TRUE(write_manifest(*scene_, result, {}, folder.path()).ok());
    const json m = json::parse(test::read_text(folder.path() / "manifest.json"));
    EXPECT_EQ(m["results"]["buildings"], 4);
    EXPECT_EQ(m["results"]["buildings_hit"], 2);
    EXPECT_EQ(m["results"]["barriers"], 1);
    EXPECT_EQ(m["results"]["barriers_hit"], 1);
}

TEST_F(Products, manifest_holds_every_parameter_of_the_field_table) {
    const json parameters = manifest()["parameters"];
    int count = 0;
    for_each_value(scene_->spec, [&](const params::Section& section, std::size_t index,
                                     const params::Parameter& parameter, const params::ParameterValue& value) {
        const json& table = section.repeats ? parameters[section.name][index] : parameters[section.name];
        ASSERT_TRUE(table.contains(parameter.key)) << key_path(section, index, parameter);
        EXPECT_EQ(table[parameter.key].is_null(), std::holds_alternative<std::monostate>(value))
            << key_path(section, index, parameter);
        ++count;
    });
    EXPECT_GT(count, 40);
    EXPECT_EQ(parameters["material"]["rest_density_kgpm3"], 2000);
    EXPECT_EQ(parameters["release"][0]["volume_m3"], 600);
    EXPECT_EQ(parameters["observation"].size(), 2U);
}

TEST_F(Products, manifest_says_what_ran_where_and_how_fast) {
    const json m = manifest();
    EXPECT_EQ(m["program"], "talus");
    EXPECT_EQ(m["status"], "complete");
    EXPECT_EQ(m["partial"], false);
    EXPECT_EQ(m["reconstruction"], true);
    EXPECT_EQ(m["result_hash"], "8c1f00d2a4b39e57");
    EXPECT_EQ(m["inputs"][0]["fnv1a_64"], "9f1c22ab74d10e55");
    EXPECT_EQ(m["inputs"][0]["bytes"], 61234);
    EXPECT_THAT(m["versions"]["gdal"].get<std::string>(), StartsWith("3."));
    for (const char* key : {"talus", "proj", "tbb", "compiler"}) {
        EXPECT_THAT(m["versions"][key].get<std::string>(), Not(IsEmpty())) << key;
    }
    EXPECT_GT(m["hardware"]["logical_cores"], 0);
    EXPECT_GT(m["hardware"]["memory_GiB"], 0);
    EXPECT_NEAR(m["performance"]["real_time_factor"], 41.2 / result_->wall_time, 1e-9);
    double share = 0, step = 0;
    for (const json& stage : m["performance"]["stages"]) {
        share += stage["share"].get<double>();
        step += stage["per_step_ms"].get<double>();
    }
    EXPECT_NEAR(share, 1, 1e-9) << "with what is not in a stage";
    EXPECT_NEAR(step, m["performance"]["step_ms"], 1e-9);
    EXPECT_EQ(m["performance"]["stages"][2]["stage"], sim::step_stages[2].name);
    EXPECT_NEAR(m["performance"]["stages"][2]["total_s"], 1.5, 1e-9);
    EXPECT_NEAR(m["performance"]["stages"][2]["share"], 1.5 / result_->wall_time, 1e-9);
    std::vector<std::string> phases;
    for (const json& phase : m["performance"]["phases"]) {
        phases.push_back(phase["phase"]);
        EXPECT_GE(phase["wall_s"], 0) << phases.back();
    }
    EXPECT_THAT(phases, testing::IsSupersetOf({"load", "seed", "steps", "finish", "maps", "terrain", "tables",
                                               "vectors", "kml", "report"}));
    EXPECT_NEAR(m["performance"]["phases"][2]["wall_s"], result_->wall_time, 1e-9);
    EXPECT_EQ(m["resolved"]["particle_spacing_m"], 0.42);
    EXPECT_EQ(m["results"]["buildings_hit"], 3);
    EXPECT_NEAR(m["results"]["greatest"]["peak_pressure_kPa"],
                2 * std::pow(m["results"]["greatest"]["peak_speed_mps"].get<double>(), 2), 0.01);
    EXPECT_EQ(m["results"]["volumes"]["released_m3"], 600);
    EXPECT_EQ(m["assumptions"].size(), 3U);
    EXPECT_THAT(m["files"].get<std::vector<std::string>>(), testing::Contains("report.html"));
}

TEST_F(Products, manifest_writes_null_for_what_does_not_exist) {
    const TemporaryFolder folder;
    run::RunResult result = *result_;
    result.observation.run_out = {};
    ASSERT_TRUE(write_manifest(*scene_, result, {}, folder.path()).ok());
    const json m = json::parse(test::read_text(folder.path() / "manifest.json"));
    EXPECT_TRUE(m["results"]["runout_angle_deg"].is_null());
}

TEST_F(Products, manifest_survives_names_that_are_not_utf8) {
    const TemporaryFolder folder;
    scene::Scene scene = *scene_;
    scene.releases[0].name = "Gr\xfcn";
    ASSERT_TRUE(write_manifest(scene, *result_, {}, folder.path()).ok());
    EXPECT_TRUE(json::accept(test::read_text(folder.path() / "manifest.json")));
}

}  // namespace
}  // namespace talus::products
