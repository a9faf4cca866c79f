#include "scene/depth_averaged_keys.hpp"

#include <set>

#include <gmock/gmock.h>

#include "params/fields.hpp"
#include "scene/scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(DepthAveragedKeys, hold_every_key_of_the_schema_once) {
    std::multiset<std::string_view> used;
    for (const params::Section& section : params::scene_sections()) {
        for (const params::Parameter& parameter : section.parameters) {
            const DepthAveragedKey* entry = depth_averaged_key(section.name + "." + parameter.key);
            ASSERT_NE(entry, nullptr) << section.name << "." << parameter.key
                                      << ": say in depth_averaged_keys.cpp whether that model uses it";
            used.insert(entry->key);
        }
    }
    for (const DepthAveragedKey& entry : depth_averaged_keys()) {
        EXPECT_EQ(used.count(entry.key) > 0, true) << entry.key << " is no key of the schema";
        EXPECT_TRUE(entry.key.ends_with(".*") || used.count(entry.key) == 1) << entry.key;
        EXPECT_EQ(entry.use == KeyUse::refused, !entry.why.empty()) << entry.key;
    }
}

/// A value that a key takes and that is not its default.
std::string another_value(const params::Section& section, const params::Parameter& parameter) {
    const params::ParameterValue usual = default_value(section, parameter);
    switch (parameter.kind) {
        case params::ParameterKind::choice:
            return parameter.choices.back() == params::plain_text(usual) ? parameter.choices.front()
                                                                         : parameter.choices.back();
        case params::ParameterKind::boolean:
            return std::get<bool>(usual) ? "false" : "true";
        case params::ParameterKind::integer:
            return params::plain_text(usual) == "3" ? "4" : "3";
        case params::ParameterKind::number: {
            if (const double* number = std::get_if<double>(&usual); number != nullptr && *number > 0) {
                return fmt::format("{}", 0.9 * *number);
            }
            const double high = std::min(parameter.range.high, 4.0), low = std::max(parameter.range.low, 0.0);
            return fmt::format("{}", low + 0.437 * (high - low));
        }
        default:
            return "dam";
    }
}

class DepthAveragedScene : public SceneFolder {};

TEST_F(DepthAveragedScene, notes_every_key_that_means_something_to_particles_only) {
    write_valley("[buildings]\n");
    std::vector<std::string> tried;
    for (const DepthAveragedKey& entry : depth_averaged_keys()) {
        if (entry.use != KeyUse::noted || entry.key.starts_with("zoom.")) continue;  // those need each other
        const std::string key(entry.key);
        const std::size_t dot = key.find('.');
        const params::Section& section = *params::find_section(key.substr(0, dot));
        const auto scene = load_scene(
            folder / "scene.toml",
            {"solver.model=depth_averaged", key + "=" + another_value(section, *section.find(key.substr(dot + 1)))});
        ASSERT_TRUE(scene) << scene.error().message;
        EXPECT_THAT(scene->notes,
                    Contains(testing::AllOf(HasSubstr("the depth-averaged model does not use"), HasSubstr(key))));
        tried.push_back(key);
    }
    EXPECT_GT(tried.size(), 20U);
}

TEST_F(DepthAveragedScene, notes_every_key_that_means_nothing_to_particles) {
    const std::string keys = "[solver]\nflight = true\ngrid_cell_m = 2\n";
    write_valley(keys);
    const auto scene = load_scene(folder / "scene.toml"),
               grid = load_scene(folder / "scene.toml", {"solver.model=depth_averaged"});
    ASSERT_TRUE(scene && grid);
    for (const DepthAveragedKey& entry : depth_averaged_keys()) {
        if (entry.use != KeyUse::own) continue;
        EXPECT_TRUE(for_depth_averaged_only(entry.key));
        EXPECT_THAT(scene->notes,
                    Contains(testing::AllOf(HasSubstr("particles do not use"), HasSubstr(std::string(entry.key)))));
    }
    EXPECT_THAT(grid->notes, testing::Each(Not(HasSubstr("not use "))));
    EXPECT_THAT(grid->notes, testing::Each(Not(HasSubstr("no falls"))));
    write_valley("");
    const Scene without = loaded();
    EXPECT_THAT(without.notes, testing::Each(Not(HasSubstr("not use "))));
    // The depth-averaged run that feeds a zoom has a use for them.
    write_valley(keys + fmt::format("[[barrier]]\nname = \"dam\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nheight_m = 5\n"
                                    "[zoom]\nstructure = \"dam\"\n",
                                    west + 150, south + 60, south + 140));
    const Scene zoom = loaded();
    EXPECT_THAT(zoom.notes, testing::Each(Not(HasSubstr("not use "))));
}

TEST_F(DepthAveragedScene, takes_pore_pressure_that_evolves) {
    write_valley(
        "[material]\npore_pressure = \"dilatancy\"\npermeability_m2 = 1e-10\nsolid_fraction = 0.58\n"
        "critical_solid_fraction = 0.62\n");
    const Scene scene = loaded({"solver.model=depth_averaged"});
    EXPECT_THAT(scene.notes, testing::Each(Not(HasSubstr("the depth-averaged model does not use"))));
}

TEST_F(DepthAveragedScene, refuses_what_the_model_lacks) {
    const std::string dam =
        fmt::format("[[barrier]]\nname = \"dam\"\nline_m = [[{0}, {1}], [{0}, {2}]]\nheight_m = 5\n", west + 150,
                    south + 60, south + 140);
    write_features("houses.geojson", {rectangle(150, 60, 160, 70, R"("strength": 20000, "name": "mill")")});
    write("water.csv", "time_s,pore_pressure_ratio\n0,0.2\n60,0.5\n");
    const std::string houses = "[buildings]\nfile = \"houses.geojson\"\n";
    const std::map<std::string, std::string> scenes = {
        {"buildings.resistance_attribute", houses + "resistance_attribute = \"strength\"\n"},
        {"buildings.resistance_Pa", houses + "resistance_Pa = 20000\n"},
        {"release.pore_pressure_hydrograph", "pore_pressure_hydrograph = \"water.csv\"\n"},
        {"barrier.passing_share", dam + "passing_share = 0.5\n"},
        {"barrier.clearance_m", dam + "clearance_m = 0.5\n"},
        {"barrier.resistance_Npm", dam + "resistance_Npm = 20000\n"},
        {"barrier.resistance_Pa", dam + "resistance_Pa = 20000\n"},
    };
    for (const DepthAveragedKey& entry : depth_averaged_keys()) {
        if (entry.use != KeyUse::refused) continue;
        ASSERT_TRUE(scenes.contains(std::string(entry.key))) << entry.key << " has no scene here";
        write_valley(scenes.at(std::string(entry.key)));
        // Releases and barriers are lists.
        std::string key(entry.key);
        if (!key.starts_with("buildings.")) key.insert(key.find('.'), "[0]");
        EXPECT_THAT(load_error({"solver.model=depth_averaged"}),
                    testing::AllOf(testing::ContainsRegex(":[0-9]+: "), HasSubstr(key),
                                   HasSubstr("the depth-averaged model " + std::string(entry.why)),
                                   HasSubstr("remove it, or use solver.model = \"particles\"")))
            << entry.key;
        EXPECT_EQ(load_error(), "(it loaded)") << entry.key;
    }
}

}  // namespace
}  // namespace talus::scene
