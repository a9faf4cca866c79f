#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/try.hpp"
#include "geo/raster.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"
#include "report/hazard_map.hpp"
#include "report/intensity.hpp"

namespace talus::products {
namespace {

/// `si`: owned by the job where it is made for this map alone.
void add_map(const report::HazardMap& map, std::shared_ptr<const Grid<float>> si, const scene::Scene& scene,
             const run::RunResult& result, const std::filesystem::path& folder, LayerDefinition& layers,
             std::vector<WriteJob>& jobs) {
    const double greatest = report::greatest(report::in_unit(*si, map.factor));
    const std::string style = qgis_style(map, greatest);
    layers.add_raster(map.title, map.file + ".tif", style, map.file == "peak_depth");
    jobs.push_back({"maps", [map, si = std::move(si), &scene, &result, folder, style]() -> Status {
                        const Grid<float> grid = report::in_unit(*si, map.factor);
                        const geo::RasterBand band{&grid, map.description + caveat(scene, result), map.unit,
                                                   origin_of(scene, result)};
                        const std::string stem = (folder / map.file).string();
                        TALUS_TRY(write_cog(stem + ".tif", band, scene.crs));
                        return write_text_file(stem + ".qml", style);
                    }});
}

/// A grid that outlives all jobs.
std::shared_ptr<const Grid<float>> kept(const Grid<float>& grid) {
    return {std::shared_ptr<const void>(), &grid};
}

std::shared_ptr<const Grid<float>> made(Grid<float> grid) {
    return std::make_shared<const Grid<float>>(std::move(grid));
}

}  // namespace

void add_maps(const scene::Scene& scene, const run::RunResult& result, const std::filesystem::path& folder,
              LayerDefinition& layers, std::vector<WriteJob>& jobs) {
    const auto add = [&](const report::HazardMap& map, std::shared_ptr<const Grid<float>> grid) {
        add_map(map, std::move(grid), scene, result, folder, layers, jobs);
    };
    const HazardMaps& maps = result.observation.maps;
    for (const report::HazardMap& map : report::hazard_maps()) add(map, kept(maps.*map.grid));
    const report::IntensityGuideline& guideline = report::intensity_guideline(scene.spec.outputs.intensity_guideline);
    add(intensity_style(guideline), made(intensity_map(guideline, maps)));
    if (scene.spec.outputs.peak_thickness) {
        add(report::thickness_map(), made(observe::normal_to_slope(maps.peak_depth, scene.terrain)));
    }
    const Grid<float>& erosion = result.observation.erosion.depth;
    if (!erosion.values.empty()) add(report::erosion_map(), kept(erosion));
}

}  // namespace talus::products
