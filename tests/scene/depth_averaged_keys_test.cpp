#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "params/fields.hpp"
#include "scene/scene_folder.hpp"

namespace talus::scene {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// The keys of a section that both models use; any: all, however many they are.
constexpr std::ptrdiff_t any = -1;
const std::map<std::string, std::ptrdiff_t> used_by_both = {
    {"scene", any},
    {"report", any},
    {"terrain", any},
    {"release", 13},
    {"inflow", 9},
    {"bed", 11},
    {"buildings", 5},
    {"barrier", 7},
    {"barrier_opening", 4},
    {"flow_path", any},
    {"material", 24},
    {"zone", 14},
    {"solver", 7},
    {"outputs", 13},
    {"gauge", any},
    {"cross_section", any},
    {"zoom", 0},
    {"observation", any},
    {"superelevation", any},
    {"arrival", any},
    {"run_up", any},
    {"deposit_depth", any},
    {"damage", any},
    {"observed_run_out", any},
    {"deposit_outline", any},
    {"affected_area", any},
    {"elevation_change", any},
    {"variant", any},
    // Of the live twin, whose runs are of particles; a run takes no notice of them, whatever its model.
    {"trigger", any},
    {"alarm", any},
    {"option", any},
    {"risk", any},
    {"risk_scenario", any},
    {"exposure", any},
};

TEST(DepthAveragedKeys, are_decided_for_every_key_of_the_schema) {
    for (const params::Section& section : params::scene_sections()) {
        ASSERT_TRUE(used_by_both.contains(section.name)) << section.name << ": say here which of its keys both use";
        const auto both = std::count_if(section.parameters.begin(), section.parameters.end(),
                                        [](const auto& key) { return key.use == params::KeyUse::both; });
        const std::ptrdiff_t decided = used_by_both.at(section.name);
        EXPECT_EQ(both, decided == any ? std::ssize(section.parameters) : decided)
            << section.name << ": say of a new key in its declaration if the depth-averaged model does not use it, "
            << "and count it here if it does";
        for (const params::Parameter& parameter : section.parameters) {
            EXPECT_EQ(parameter.use == params::KeyUse::refused, !parameter.lacking.empty()) << parameter.key;
        }
    }
}

struct Key {
    const params::Section& section;
    const params::Parameter& parameter;
    std::string path;
};

std::vector<Key> keys_of(params::KeyUse use) {
    std::vector<Key> keys;
    for (const params::Section& section : params::scene_sections()) {
        for (const params::Parameter& parameter : section.parameters) {
            if (parameter.use == use) keys.push_back({section, parameter, section.name + "." + parameter.key});
        }
    }
    return keys;
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
    for (const auto& [section, parameter, key] : keys_of(params::KeyUse::particles)) {
        if (section.name == "zoom") continue;  // those need each other
        const auto scene = load_scene(folder / "scene.toml",
                                      {"solver.model=depth_averaged", key + "=" + another_value(section, parameter)});
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
    for (const Key& key : keys_of(params::KeyUse::depth_averaged)) {
        EXPECT_THAT(scene->notes, Contains(testing::AllOf(HasSubstr("particles do not use"), HasSubstr(key.path))));
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
    for (const Key& refused : keys_of(params::KeyUse::refused)) {
        ASSERT_TRUE(scenes.contains(refused.path)) << refused.path << " has no scene here";
        write_valley(scenes.at(refused.path));
        const std::string key = params::key_path(refused.section, 0, refused.parameter);
        EXPECT_THAT(load_error({"solver.model=depth_averaged"}),
                    testing::AllOf(testing::ContainsRegex(":[0-9]+: "), HasSubstr(key),
                                   HasSubstr("the depth-averaged model " + refused.parameter.lacking),
                                   HasSubstr("remove it, or use solver.model = \"particles\"")))
            << key;
        EXPECT_EQ(load_error(), "(it loaded)") << key;
    }
}

}  // namespace
}  // namespace talus::scene
