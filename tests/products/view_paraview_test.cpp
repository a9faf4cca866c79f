#include <cstdint>
#include <cstdlib>
#include <regex>

#include "products/view_fixture.hpp"

namespace talus::products {
namespace {

using testing::HasSubstr;

std::size_t number_in(const std::string& text, const std::string& attribute) {
    std::smatch match;
    return std::regex_search(text, match, std::regex(attribute + "=\"(\\d+)\"")) ? std::stoul(match[1]) : 0;
}

TEST_F(ViewOfARun, paraview_has_ground_houses_and_the_surface_in_one_frame) {
    const Status status = write({"paraview"});
    ASSERT_TRUE(status.ok()) << status.error().message;
    std::set<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(file("paraview"))) {
        files.insert(entry.path().filename().string());
    }
    EXPECT_EQ(files,
              (std::set<std::string>{"particles.pvd", "particles_000000.vtp", "particles_000001.vtp",
                                     "particles_000002.vtp", "run.py", "structures.vtp", "surface.pvd",
                                     "surface_000000.vtp", "surface_000001.vtp", "surface_000002.vtp", "terrain.vtp"}));
    const WorldPoint origin = scene.terrain.frame().origin;
    for (const char* name : {"terrain.vtp", "structures.vtp", "surface_000001.vtp", "particles_000001.vtp"}) {
        const std::string text = test::read_text(file(std::string("paraview/") + name));
        std::smatch match;
        ASSERT_TRUE(std::regex_search(text, match, std::regex("Name=\"origin_m\"[^>]*>([0-9.]+) ([0-9.]+) "))) << name;
        EXPECT_DOUBLE_EQ(std::stod(match[1]), origin.x) << name;
        EXPECT_DOUBLE_EQ(std::stod(match[2]), origin.y) << name;
    }
    const std::string structures = test::read_text(file("paraview/structures.vtp"));
    EXPECT_EQ(number_in(structures, "NumberOfPolys"), 5U * 10);
    EXPECT_THAT(structures, HasSubstr("peak_impact_pressure_kPa"));
    const std::string first = test::read_text(file("paraview/surface_000000.vtp"));
    EXPECT_EQ(number_in(first, "NumberOfPoints"), 16U + 4 * 4 + 2) << "debris, its edges, and two corners";
    EXPECT_THAT(test::read_text(file("paraview/surface.pvd")), HasSubstr("timestep=\"2.5\""));
}

TEST_F(ViewOfARun, paraview_script_is_python_with_the_range_of_the_whole_run) {
    ASSERT_TRUE(write({"paraview"}).ok());
    const std::string script = test::read_text(file("paraview/run.py"));
    EXPECT_THAT(script, HasSubstr("WRITTEN_TO = \"/home/somebody's \\\"runs\\\"/series/paraview\""));
    std::smatch match;
    ASSERT_TRUE(std::regex_search(script, match, std::regex("GREATEST_SPEED = ([0-9.]+)")));
    double greatest = 0;
    for (const float speed : result.observation.maps.peak_speed.values) greatest = std::fmax(greatest, speed);
    EXPECT_NEAR(std::stod(match[1]), greatest, 0.01);
    const std::string command =
        "/usr/bin/python3 -c 'import ast, sys; ast.parse(open(sys.argv[1]).read())' " + file("paraview/run.py");
    EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST_F(ViewOfARun, needs_no_debris) {
    Grid<float>& peak = result.observation.maps.peak_depth;
    std::fill(peak.values.begin(), peak.values.end(), std::numeric_limits<float>::quiet_NaN());
    scene.spec.outputs.series = {"gltf", "3dtiles", "usd", "paraview"};
    Series series(scene, folder.path() / "series");
    run::Frame frame;
    frame.debris.depth = frame.debris.speed =
        Grid<float>({peak.geometry.x_min, peak.geometry.y_min, peak.geometry.cell, 0, 0});
    ASSERT_TRUE(series.add(frame).ok());
    EXPECT_EQ(series.finish(result), std::vector<std::string>{});
}

}  // namespace
}  // namespace talus::products
