#include "core/hazard_maps.hpp"

#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "report/hazard_map.hpp"

/// The table of maps, and the lists of other languages that cannot read it: a map that is added to the table and not
/// to them is named here.
namespace talus {
namespace {

using ::testing::HasSubstr;

std::string source(const char* path) {
    std::ifstream file(std::string(TALUS_SOURCE_DIR) + "/" + path);
    std::stringstream text;
    text << file.rdbuf();
    EXPECT_FALSE(text.str().empty()) << path;
    return text.str();
}

/// Values that other programs get are in SI units.
std::string si_unit(const NamedMap& map) {
    if (map.factor == 1) return map.unit;
    EXPECT_STREQ(map.unit, "kPa");
    EXPECT_EQ(map.factor, 1e-3);
    return "Pa";
}

TEST(HazardMapTable, every_map_has_a_key_of_its_own_and_is_found_by_it) {
    std::set<std::string_view> keys;
    for (const NamedMap& map : named_maps) {
        EXPECT_TRUE(keys.insert(map.key).second) << map.key;
        EXPECT_EQ(find_map(map.key), &map);
        EXPECT_NE(map.grid, nullptr) << map.key;
        EXPECT_EQ(map.value == nullptr, map.kind == MapKind::arrival) << map.key;
        for (const std::string_view text : {map.title, map.unit, map.description, map.caption, map.help}) {
            EXPECT_FALSE(text.empty()) << map.key;
        }
    }
    EXPECT_EQ(find_map("depth"), nullptr);
    EXPECT_EQ(find_map(""), nullptr);
    EXPECT_EQ(map_keys("depth", "erosion_depth").size(), named_maps.size() + 2);
    EXPECT_EQ(map_keys("depth").back(), named_maps.back().key);
}

TEST(HazardMapTable, reports_and_files_have_every_map_in_its_order) {
    const std::vector<report::HazardMap>& maps = report::hazard_maps();
    ASSERT_EQ(maps.size(), named_maps.size());
    for (std::size_t k = 0; k < maps.size(); ++k) {
        EXPECT_EQ(maps[k].file, named_maps[k].key);
        EXPECT_EQ(maps[k].grid, named_maps[k].grid);
    }
}

TEST(HazardMapTable, the_list_of_the_c_interface_has_them) {
    const std::string header = source("apps/embed/talus.h");
    for (const NamedMap& map : named_maps) {
        EXPECT_THAT(header, HasSubstr(fmt::format("\"{}\"", map.key)));
    }
}

TEST(HazardMapTable, the_list_of_the_python_module_has_them_with_their_si_units) {
    const std::string module = source("python/talus/maps.py");
    for (const NamedMap& map : named_maps) {
        EXPECT_THAT(module, HasSubstr(fmt::format("    \"{}\": \"{}\",\n", map.key, si_unit(map))));
    }
}

TEST(HazardMapTable, the_list_of_the_qgis_plugin_has_them) {
    const std::string plugin = source("qgis/talus_processing/algorithms.py");
    std::string quoted;
    for (const NamedMap& map : named_maps) quoted += fmt::format("{}\"{}\"", quoted.empty() ? "" : ", ", map.key);
    EXPECT_THAT(plugin, HasSubstr("\nMAPS = [" + quoted + "]\n"));
}

}  // namespace
}  // namespace talus
