#include "core/try.hpp"
#include "geo/raster.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"
#include "report/hazard_map.hpp"
#include "report/intensity.hpp"

namespace talus::products {
namespace {

Status write_map(const report::HazardMap& map, const Grid<float>& si, const std::string& caveat, const geo::Crs& crs,
                 const std::filesystem::path& folder) {
    const Grid<float> grid = report::in_unit(si, map.factor);
    const geo::RasterBand band{&grid, map.description + caveat, map.unit};
    const std::string stem = (folder / map.file).string();
    TALUS_TRY(write_cog(stem + ".tif", band, crs));
    return write_text_file(stem + ".qml", qgis_style(map, report::greatest(grid)));
}

}  // namespace

Status write_maps(const scene::Scene& scene, const run::RunResult& result, const std::filesystem::path& folder) {
    const std::string said = caveat(scene, result);
    for (const report::HazardMap& map : report::hazard_maps()) {
        TALUS_TRY(write_map(map, result.observation.maps.*map.grid, said, scene.crs, folder));
    }
    const report::IntensityGuideline& guideline = report::intensity_guideline(scene.spec.outputs.intensity_guideline);
    TALUS_TRY(write_map(intensity_style(guideline), intensity_map(guideline, result.observation.maps), said, scene.crs,
                        folder));
    if (scene.spec.outputs.peak_thickness) {
        const Grid<float> thickness = observe::normal_to_slope(result.observation.maps.peak_depth, scene.terrain);
        TALUS_TRY(write_map(report::thickness_map(), thickness, said, scene.crs, folder));
    }
    const Grid<float>& erosion = result.observation.erosion.depth;
    return erosion.values.empty() ? Status() : write_map(report::erosion_map(), erosion, said, scene.crs, folder);
}

}  // namespace talus::products
