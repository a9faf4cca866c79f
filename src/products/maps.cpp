#include <algorithm>
#include <cctype>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/hash.hpp"
#include "core/try.hpp"
#include "geo/raster.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"
#include "report/hazard_map.hpp"
#include "report/intensity.hpp"

namespace talus::products {
namespace {

Status write_map(const report::HazardMap& map, const Grid<float>& si, const scene::Scene& scene,
                 const run::RunResult& result, const std::filesystem::path& folder, LayerDefinition& layers) {
    const Grid<float> grid = report::in_unit(si, map.factor);
    const geo::RasterBand band{&grid, map.description + caveat(scene, result), map.unit, origin_of(scene, result)};
    const std::string stem = (folder / map.file).string();
    TALUS_TRY(write_cog(stem + ".tif", band, scene.crs));
    const std::string style = qgis_style(map, report::greatest(grid));
    layers.add_raster(map.title, map.file + ".tif", style, map.file == "peak_depth");
    return write_text_file(stem + ".qml", style);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> origin_of(const scene::Scene& scene, const run::RunResult& result) {
    return {{"TIFFTAG_SOFTWARE", std::string("talus ") + TALUS_VERSION},
            {"TITLE", scene.spec.scene.title},
            {"SCENE_HASH", scene_hash(scene)},
            {"RESULT_HASH", to_hex(result.hash)},
            {"SIMULATED_TIME_S", fmt::format("{}", result.simulated_time)},
            {"STATUS", status_text(result.status)}};
}

std::vector<std::pair<std::string, std::string>> plain_origin_of(const scene::Scene& scene,
                                                                 const run::RunResult& result) {
    auto all = origin_of(scene, result);
    for (auto& [key, value] : all) {
        if (key == "TIFFTAG_SOFTWARE") key = "source";
        std::transform(key.begin(), key.end(), key.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    }
    return all;
}

Status write_maps(const scene::Scene& scene, const run::RunResult& result, const std::filesystem::path& folder,
                  LayerDefinition& layers) {
    for (const report::HazardMap& map : report::hazard_maps()) {
        TALUS_TRY(write_map(map, result.observation.maps.*map.grid, scene, result, folder, layers));
    }
    const report::IntensityGuideline& guideline = report::intensity_guideline(scene.spec.outputs.intensity_guideline);
    TALUS_TRY(write_map(intensity_style(guideline), intensity_map(guideline, result.observation.maps), scene, result,
                        folder, layers));
    if (scene.spec.outputs.peak_thickness) {
        const Grid<float> thickness = observe::normal_to_slope(result.observation.maps.peak_depth, scene.terrain);
        TALUS_TRY(write_map(report::thickness_map(), thickness, scene, result, folder, layers));
    }
    const Grid<float>& erosion = result.observation.erosion.depth;
    return erosion.values.empty() ? Status() : write_map(report::erosion_map(), erosion, scene, result, folder, layers);
}

}  // namespace talus::products
