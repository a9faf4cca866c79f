#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/program.hpp"
#include "cli/small_scene.hpp"

// Whatever is wrong with the input, the program says so in exactly one line, returns 2 and leaves nothing behind.
namespace talus::test {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

struct BadInput {
    const char* name;
    std::function<void(const SmallScene&)> spoil;
    std::vector<std::string> said;  ///< what the line must name
    std::vector<std::string> arguments = {"run", "slope.toml", "-o", "result"};
    std::vector<std::string> environment = {};
};

void PrintTo(const BadInput& input, std::ostream* stream) {
    *stream << input.name;
}

class BadInputTest : public testing::TestWithParam<BadInput> {};

TEST_P(BadInputTest, is_said_in_one_line_and_nothing_is_left) {
    const SmallScene scene;
    GetParam().spoil(scene);
    const auto before = scene.files();
    const auto outcome =
        run_program(GetParam().arguments, {.folder = scene.folder(), .environment = GetParam().environment});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.out, "");
    const auto lines = lines_of(outcome.error);
    ASSERT_EQ(lines.size(), 1u) << outcome.error;
    EXPECT_THAT(lines[0], testing::StartsWith("talus: error: "));
    for (const std::string& part : GetParam().said) EXPECT_THAT(lines[0], testing::HasSubstr(part));
    EXPECT_EQ(scene.files(), before);
}

void nothing_spoiled(const SmallScene&) {}

void terrain_with(const SmallScene& scene, const std::function<void(RasterOptions&)>& change) {
    RasterOptions options = SmallScene::terrain();
    change(options);
    write_plane(scene.input("terrain.tif"), options);
}

void release_polygon(const SmallScene& scene, const std::string& wkt) {
    write_vector(scene.input("release.geojson"), {}, {{wkt, {}}});
}

/// Changes every seventh byte from one on.
void garble(const std::string& file, std::size_t from) {
    std::string bytes = read_text(file);
    for (std::size_t k = from; k < bytes.size(); k += 7) bytes[k] = static_cast<char>(bytes[k] ^ 0x5a);
    write_text(file, bytes);
}

const std::vector<BadInput> bad_inputs = {
    // The command line
    {"UnknownCommand", nothing_spoiled, {"fly"}, {"fly"}},
    {"UnknownOption", nothing_spoiled, {"--treads", "talus run --help"}, {"run", "slope.toml", "--treads", "2"}},
    {"OptionWithoutItsValue", nothing_spoiled, {"--output"}, {"run", "slope.toml", "-o"}},
    {"ThreadsNotANumber", nothing_spoiled, {"--threads", "many"}, {"run", "slope.toml", "--threads", "many"}},
    {"NegativeThreads", nothing_spoiled, {"thread_count", "-2"}, {"run", "slope.toml", "--threads", "-2"}},
    {"OverrideOfUnknownKey",
     nothing_spoiled,
     {"friction_coeficient", "friction_coefficient"},
     {"run", "slope.toml", "--set", "material.friction_coeficient=0.3"}},
    {"OverrideOutOfRange",
     nothing_spoiled,
     {"rest_density_kgpm3", "-5", "1 to 30000"},
     {"run", "slope.toml", "--set", "material.rest_density_kgpm3=-5"}},
    {"DayOfTheReportInAnotherOrder",
     nothing_spoiled,
     {"report.date", "23.11.2026", "YYYY-MM-DD"},
     {"run", "slope.toml", "--set", "report.date=23.11.2026"}},
    {"OverrideWithoutValue", nothing_spoiled, {"end_time_s"}, {"run", "slope.toml", "--set", "solver.end_time_s"}},
    {"VariationOfUnknownKey",
     nothing_spoiled,
     {"variant material.friction_coeficient=0.3", "friction_coefficient"},
     {"run", "slope.toml", "-o", "result", "--vary", "material.friction_coeficient=0.3"}},
    {"VariationOutOfRange",
     nothing_spoiled,
     {"material.viscosity = 2", "0 to below 1"},
     {"run", "slope.toml", "-o", "result", "--vary", "material.viscosity=0.1,2"}},
    {"VariationWithoutValue",
     nothing_spoiled,
     {"material.viscosity", "section.key=value,value"},
     {"run", "slope.toml", "-o", "result", "--vary", "material.viscosity"}},
    {"VariationToAMissingFile",
     nothing_spoiled,
     {"release.file=nowhere.geojson", "no such file"},
     {"run", "slope.toml", "-o", "result", "--vary", "release.file=nowhere.geojson"}},
    {"RefinementOverTheParticleLimit",
     [](const SmallScene& s) { s.replace("spacing_m = 0.8", "spacing_m = 0.8\nparticle_limit = 500"); },
     {"three times the particles", "solver.particle_limit = 500"},
     {"run", "slope.toml", "-o", "result", "--convergence"}},
    {"QuietAndJson", nothing_spoiled, {"--quiet", "--json"}, {"run", "slope.toml", "--quiet", "--json"}},

    // The scene file
    {"MissingScene", nothing_spoiled, {"nowhere.toml"}, {"run", "nowhere.toml"}},
    {"FolderInsteadOfScene",
     [](const SmallScene& s) { std::filesystem::create_directory(s.input("folder.toml")); },
     {"folder.toml"},
     {"run", "folder.toml"}},
    {"EmptyScene", [](const SmallScene& s) { s.write(""); }, {"slope.toml", "terrain"}},
    {"BrokenToml", [](const SmallScene& s) { s.replace("[solver]", "[solver"); }, {"slope.toml", "11"}},
    {"UnknownKey",
     [](const SmallScene& s) { s.replace("thickness_m", "thicknes_m"); },
     {"slope.toml", "8", "thicknes_m", "thickness_m"}},
    {"WrongType",
     [](const SmallScene& s) { s.replace("end_time_s = 1", "end_time_s = \"long\""); },
     {"slope.toml", "13", "end_time_s", "long"}},
    {"OutOfRange",
     [](const SmallScene& s) { s.replace("end_time_s = 1", "end_time_s = -1"); },
     {"slope.toml", "13", "end_time_s", "-1", "greater than 0"}},

    // Terrain
    {"MissingTerrain", [](const SmallScene& s) { std::filesystem::remove(s.input("terrain.tif")); }, {"terrain.tif"}},
    {"FolderInsteadOfTerrain",
     [](const SmallScene& s) {
         std::filesystem::remove(s.input("terrain.tif"));
         std::filesystem::create_directory(s.input("terrain.tif"));
     },
     {"terrain.tif"}},
    {"EmptyTerrainFile", [](const SmallScene& s) { write_text(s.input("terrain.tif"), ""); }, {"terrain.tif"}},
    {"TruncatedTerrain",
     [](const SmallScene& s) { std::filesystem::resize_file(s.input("terrain.tif"), 2000); },
     {"terrain.tif: the file is damaged or cut short"}},
    {"TerrainWithoutData",
     [](const SmallScene& s) {
         write_raster(s.input("terrain.tif"), SmallScene::terrain(), [](int, int) { return nothing; });
     },
     {"terrain.tif", "no"}},
    {"NoSuchBand",
     [](const SmallScene& s) { s.replace("\"terrain.tif\"", "\"terrain.tif\"\nband = 3"); },
     {"terrain.tif", "3"}},
    {"GeographicTerrain",
     [](const SmallScene& s) {
         terrain_with(s, [](RasterOptions& o) {
             o.epsg = 4326;
             o.x_min = 114.06;
             o.y_min = 22.37;
             o.cell = 0.00005;
         });
     },
     {"terrain.tif", "gdalwarp"}},
    {"TerrainInFeet",
     [](const SmallScene& s) { terrain_with(s, [](RasterOptions& o) { o.epsg = 2277; }); },
     {"terrain.tif", "gdalwarp"}},
    {"TerrainWithoutReferenceSystem",
     [](const SmallScene& s) { terrain_with(s, [](RasterOptions& o) { o.epsg = 0; }); },
     {"terrain.tif", "gdal"}},
    {"RotatedTerrain",
     [](const SmallScene& s) { terrain_with(s, [](RasterOptions& o) { o.rotation = 1; }); },
     {"terrain.tif", "gdalwarp"}},

    // Release
    {"MissingRelease",
     [](const SmallScene& s) { std::filesystem::remove(s.input("release.geojson")); },
     {"release.geojson"}},
    {"ReleaseOutsideTheTerrain",
     [](const SmallScene& s) { release_polygon(s, rectangle_wkt(834200, 825090, 834220, 825110)); },
     {"scar", "outside"}},
    {"ReleaseOverNodata",
     [](const SmallScene& s) {
         write_raster(s.input("terrain.tif"), SmallScene::terrain(),
                      [](int column, int) { return column > 39 && column < 45 ? nothing : 100 + 2.5 * column; });
     },
     {"scar", "nodata"}},
    {"SelfIntersectingRelease",
     [](const SmallScene& s) {
         release_polygon(s, "POLYGON ((824200 825090, 824220 825110, 824220 825090, 824200 825110, 824200 825090))");
     },
     {"release.geojson", "intersect"}},
    {"EmptyReleaseLayer",
     [](const SmallScene& s) { write_vector(s.input("release.geojson"), {}, {}); },
     {"release.geojson"}},
    {"ZeroThickness",
     [](const SmallScene& s) { s.replace("thickness_m = 0.3", "thickness_m = 0"); },
     {"slope.toml", "thickness_m", "0.001 to 1000"}},
    {"NegativeThickness",
     [](const SmallScene& s) { s.replace("thickness_m = 0.3", "thickness_m = -2"); },
     {"slope.toml", "thickness_m", "-2"}},
    {"NoThickness",
     [](const SmallScene& s) { s.replace("thickness_m = 0.3\n", ""); },
     {"slope.toml", "thickness_m", "volume_m3"}},
    {"OverlappingReleases",
     [](const SmallScene& s) {
         write_vector(s.input("other.geojson"), {}, {{rectangle_wkt(824210, 825100, 824230, 825120), {}}});
         s.replace("[buildings]",
                   "[[release]]\nname = \"second\"\nfile = \"other.geojson\"\nvolume_m3 = 50\n[buildings]");
     },
     {"scar", "second", "overlap"}},
    {"MoreParticlesThanTheLimit",
     [](const SmallScene& s) { s.replace("spacing_m = 0.8", "spacing_m = 0.1\nparticle_limit = 1000"); },
     {"particle_limit", "1000", "spacing"}},

    // Buildings
    {"BuildingsOutsideTheTerrain",
     [](const SmallScene& s) {
         write_vector(s.input("buildings.geojson"), {}, {{rectangle_wkt(924200, 825090, 924220, 825110), {}}});
     },
     {"buildings.geojson", "outside"}},

    // What a library says of a file stands behind a sentence of ours.
    {"CutGeoJson",
     [](const SmallScene& s) { std::filesystem::resize_file(s.input("buildings.geojson"), 300); },
     {"buildings.geojson: cannot be read as a vector file: "}},
    {"GarbledGeoPackage",
     [](const SmallScene& s) {
         write_vector(s.input("buildings.gpkg"), {.driver = "GPKG"},
                      {{rectangle_wkt(824150, 825090, 824160, 825110), {}}});
         garble(s.input("buildings.gpkg"), 5000);
         s.replace("buildings.geojson", "buildings.gpkg");
     },
     {"buildings.gpkg: cannot be read as a vector file: "}},
    {"CutToml", [](const SmallScene& s) { s.replace("[scene]", "[scene"); }, {"slope.toml:1: not valid TOML: "}},

    // Result folder
    {"ResultAlreadyThere",
     [](const SmallScene& s) { std::filesystem::create_directory(s.input("result")); },
     {"result", "--force"}},
    {"ResultIsAFile", [](const SmallScene& s) { write_text(s.input("result"), "precious"); }, {"result"}},
    {"ResultBelowAFile", nothing_spoiled, {"terrain.tif/result"}, {"run", "slope.toml", "-o", "terrain.tif/result"}},
    {"ResultNotWritable", nothing_spoiled, {"/proc/result"}, {"run", "slope.toml", "-o", "/proc/result"}},
    {"UnknownInstructionSet",
     nothing_spoiled,
     {"TALUS_SIMD", "\"AVX9\"", "this processor and this build have"},
     {"run", "slope.toml", "-o", "result"},
     {"TALUS_SIMD=AVX9"}},
    {"UnknownBackend",
     nothing_spoiled,
     {"--backend", "\"abacus\"", "cpu, cuda, auto, host"},
     {"run", "slope.toml", "--backend", "abacus"}},
    {"BackendWithoutACard",
     nothing_spoiled,
     {"--backend", "\"cuda\" is refused", "take \"cpu\""},
     {"run", "slope.toml", "--backend", "cuda"},
     {"CUDA_VISIBLE_DEVICES=-1"}},
    {"BackendWithoutACardOfTheScene",
     nothing_spoiled,
     {"\"cuda\" is refused", "take \"cpu\""},
     {"run", "slope.toml", "--set", "solver.backend=cuda", "-o", "result"},
     {"CUDA_VISIBLE_DEVICES=-1"}},
    {"EnsembleWithoutACard",
     nothing_spoiled,
     {"--backend", "\"cuda\" is refused"},
     {"ensemble", "slope.toml", "--backend", "cuda", "--vary", "material.viscosity=uniform(0,1)"},
     {"CUDA_VISIBLE_DEVICES=-1"}},
    {"ContoursOfNoMap",
     nothing_spoiled,
     {"outputs.contours", "\"depth\" is no map with contours", "peak_depth, peak_speed"},
     {"run", "slope.toml", "--contours", "depth=1", "-o", "result"}},
    {"ContoursAtNoNumber",
     nothing_spoiled,
     {"outputs.contours", "\"low\" is no value of a contour"},
     {"run", "slope.toml", "--contours", "peak_depth=1,low", "-o", "result"}},
    {"MoreTracksThanFitIntoMemory",
     nothing_spoiled,
     {"outputs.tracks = 1", "outputs.series_interval_s = 0.001", "it must be at most 99900"},
     {"run", "slope.toml", "-o", "result", "--set", "outputs.series_interval_s=0.001", "--tracks", "1000000"}},
    {"TracksWithoutParticles",
     nothing_spoiled,
     {"--tracks", "depth_averaged"},
     {"run", "slope.toml", "--model", "depth_averaged", "-o", "result", "--tracks", "5"}},
    {"BackendOfADeviceWithoutParticles",
     nothing_spoiled,
     {"a backend other than the processor", "depth_averaged"},
     {"run", "slope.toml", "--backend", "host", "--model", "depth_averaged", "-o", "result"}},
};

INSTANTIATE_TEST_SUITE_P(Item, BadInputTest, testing::ValuesIn(bad_inputs),
                         [](const auto& bad) { return std::string(bad.param.name); });

TEST(FullDisk, is_said_in_one_line_and_nothing_is_left) {
    const SmallScene scene;
    const auto before = scene.files();
    const auto outcome =
        run_program({"run", "slope.toml", "-o", "result", "--json"}, {.folder = scene.folder(), .largest_file = 4096});
    EXPECT_EQ(outcome.exit_code, 1);
    const auto lines = lines_of(outcome.error);
    ASSERT_EQ(lines.size(), 1u) << outcome.error;
    EXPECT_THAT(lines[0], testing::StartsWith("talus: error: "));
    EXPECT_THAT(lines[0], testing::HasSubstr("result"));
    EXPECT_EQ(scene.files(), before);
}

}  // namespace
}  // namespace talus::test
