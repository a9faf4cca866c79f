#include "geo/raster.hpp"
#include "products/hazard_map.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"

namespace talus {

Status write_maps(const Scene& scene, const RunResult& result, const std::filesystem::path& folder) {
    for (const HazardMap& map : hazard_maps()) {
        const Grid<float> grid = in_unit(result.observation.maps.*map.grid, map.factor);
        const RasterBand band{&grid, map.description + caveat(scene, result), map.unit};
        const std::string stem = (folder / map.file).string();
        if (Status s = write_cog(stem + ".tif", band, scene.crs); !s) return s;
        if (Status s = write_text_file(stem + ".qml", qgis_style(map, greatest(grid))); !s) return s;
    }
    return {};
}

}  // namespace talus
