#include "products/tracks.hpp"

#include <cmath>
#include <set>

#include <gmock/gmock.h>

#include "products_fixture.hpp"
#include "scene/particle_spacing.hpp"

namespace talus::products {
namespace {

using test::TemporaryFolder;

TEST(TracksOfARun, are_lines_of_some_particles_with_elevation_and_time) {
    const TemporaryFolder folder;
    scene::Scene scene = test::sample_scene();
    scene.spec.outputs.tracks = 5;
    Tracks tracks(scene);
    sim::State state;
    state.count = state.seeded =
        static_cast<std::uint32_t>(scene::total_volume(scene) / std::pow(scene::particle_spacing(scene), 3));
    state.resize(state.count);
    for (std::uint32_t i = 0; i < state.count; ++i) state.id[i] = state.count - 1 - i;
    for (const float time : {0.0F, 1.0F, 2.5F}) {
        for (std::uint32_t i = 0; i < state.count; ++i) {
            state.position.set(i, {2 * time, static_cast<float>(state.id[i]), 10 - time});
            state.velocity.set(i, {2, 0, 0});
        }
        tracks.add({time, {}, 0, &scene.terrain.frame(), &state});
    }
    const Status written = tracks.write(folder.path());
    ASSERT_TRUE(written) << written.error().message;

    const GDALDatasetUniquePtr data(GDALDataset::Open(folder.file("tracks.gpkg").c_str(), GDAL_OF_VECTOR));
    ASSERT_TRUE(data);
    EXPECT_EQ(data->GetLayerByName("tracks")->GetGeomType(), wkbLineStringZM);
    std::set<double> particles;
    const WorldPoint& origin = scene.terrain.frame().origin;
    for (const auto& feature : read_layer(*data, "tracks")) {
        particles.insert(feature->GetFieldAsDouble("particle"));
        EXPECT_EQ(feature->GetFieldAsDouble("begin_s"), 0);
        EXPECT_EQ(feature->GetFieldAsDouble("end_s"), 2.5);
        EXPECT_NEAR(feature->GetFieldAsDouble("length_m"), 5, 1e-5);
        EXPECT_NEAR(feature->GetFieldAsDouble("greatest_speed_mps"), 2, 1e-6);
        const OGRLineString* line = feature->GetGeometryRef()->toLineString();
        ASSERT_EQ(line->getNumPoints(), 3);
        EXPECT_NEAR(line->getX(2), origin.x + 5, 1e-5);
        EXPECT_NEAR(line->getZ(2), origin.z + 7.5, 1e-5);
        EXPECT_EQ(line->getM(2), 2.5);
    }
    EXPECT_GE(particles.size(), 5U);
    EXPECT_LE(particles.size(), 7U);
    const std::string table = test::read_text(folder.path() / "tracks.csv");
    EXPECT_THAT(table, testing::StartsWith("particle,time_s,x_m,y_m,z_m,speed_mps\n"));
    EXPECT_EQ(static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')), 1 + 3 * particles.size());
}

}  // namespace
}  // namespace talus::products
