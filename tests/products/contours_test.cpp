#include "params/contours.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <gmock/gmock.h>

#include "products_fixture.hpp"
#include "report/hazard_map.hpp"

namespace talus::products {
namespace {

using test::TemporaryFolder;

TEST(ContoursOfMaps, can_be_asked_for_of_every_map_of_a_run) {
    std::set<std::string> maps = {report::thickness_map().file, report::erosion_map().file};
    for (const report::HazardMap& map : report::hazard_maps()) maps.insert(map.file);
    EXPECT_EQ(maps, std::set<std::string>(params::contour_maps.begin(), params::contour_maps.end()));
}

TEST(ContoursOfMaps, are_lines_with_value_and_unit) {
    const TemporaryFolder folder;
    scene::Scene scene = test::sample_scene();
    const run::RunResult result = test::sample_result(scene);
    scene.spec.outputs.contours = {"peak_depth=0.5,1,50", "peak_pressure=20", "peak_thickness=1"};
    const Status written = write_products(scene, result, folder.path());
    ASSERT_TRUE(written) << written.error().message;
    const GDALDatasetUniquePtr data(GDALDataset::Open(folder.file("results.gpkg").c_str(), GDAL_OF_VECTOR));
    ASSERT_TRUE(data);
    std::set<double> values;
    const auto depths = read_layer(*data, "contours_peak_depth");
    for (const auto& feature : depths) {
        values.insert(feature->GetFieldAsDouble("value"));
        EXPECT_EQ(std::string(feature->GetFieldAsString("map")), "peak_depth");
        EXPECT_EQ(std::string(feature->GetFieldAsString("unit")), "m");
        const OGRLineString* line = feature->GetGeometryRef()->toLineString();
        const int last = line->getNumPoints() - 1;
        EXPECT_NEAR(line->getX(0), line->getX(last), 1e-6) << "closed around the debris";
    }
    EXPECT_EQ(values, (std::set<double>{0.5, 1})) << "nothing is 50 m deep";
    const auto pressures = read_layer(*data, "contours_peak_pressure");
    ASSERT_FALSE(pressures.empty());
    EXPECT_EQ(std::string(pressures.front()->GetFieldAsString("unit")), "kPa");
    EXPECT_FALSE(read_layer(*data, "contours_peak_thickness").empty());
    EXPECT_THAT(test::read_text(folder.path() / "results.qlr"), testing::HasSubstr("contours_peak_depth"));
}

}  // namespace
}  // namespace talus::products
