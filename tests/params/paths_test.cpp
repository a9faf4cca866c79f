#include "params/paths.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace talus::params {
namespace {

TEST(Paths, of_every_section_are_visited_and_replaced_and_other_texts_stay) {
    SceneSpec spec;
    spec.scene.title = "dem.tif";
    spec.terrain.file = "dem.tif";
    spec.inflows.resize(2);
    spec.inflows[1].polygon_file = "areas.gpkg";
    std::vector<std::string> found;
    for_each_path(spec,
                  [&](const Section& section, std::size_t index, const Parameter& parameter, const std::string& path) {
                      found.push_back(key_path(section, index, parameter) + " " + path);
                  });
    EXPECT_EQ(found, (std::vector<std::string>{"terrain.file dem.tif", "inflow[1].polygon_file areas.gpkg"}));
    replace_paths(spec, [](const std::string& path) { return "data/" + path; });
    EXPECT_EQ(spec.terrain.file, "data/dem.tif");
    EXPECT_EQ(spec.inflows[1].polygon_file, "data/areas.gpkg");
    EXPECT_EQ(spec.inflows[0].polygon_file, "");
    EXPECT_EQ(spec.scene.title, "dem.tif");
}

}  // namespace
}  // namespace talus::params
