#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/grid.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"

/// The files of a run that need no library and no disk, so that a page without a server can make them.
namespace talus::products {

/// A file and a sentence about it.
struct FileName {
    const char *name, *what;
};
inline constexpr FileName front_csv{"front.csv", "Front: chainage, first arrival, velocity"};
inline constexpr FileName run_out_csv{"run_out.csv", "Run-out, drop, run-out angle and travel angle"};
inline constexpr FileName buildings_csv{"buildings.csv", "Impact per building"};
inline constexpr FileName structures_csv{"structures_over_time.csv", "Impact per structure that was hit, over time"};
inline constexpr FileName timeseries_csv{"timeseries.csv", "Front, volumes, energy and compression over time"};
inline constexpr FileName erosion_csv{"erosion.csv", "Volume entrained from the bed against chainage"};
inline constexpr FileName gauges_csv{"gauges.csv", "Depth and speed over time at every gauge"};
inline constexpr FileName discharge_csv{"discharge.csv", "Discharge over time through every cross-section"};

/// A file of a run, made when it is asked for.
struct PageFile {
    std::string name, type, what;
    std::function<std::string(const scene::Scene& scene, const run::RunResult& result)> bytes;
};

/// The tables that write_tables() writes. `changed`: as for write_products.
[[nodiscard]] std::vector<PageFile> tables_of(const run::RunResult& result, const std::string& changed);

/// peak_depth.tif, ..., as add_maps() has them, uncompressed.
[[nodiscard]] std::vector<PageFile> plain_maps_of(const scene::Scene& scene, const run::RunResult& result);

/// A GeoTIFF of one strip, not compressed (TIFF 6.0; GeoTIFF 1.1, OGC 19-008r4). `epsg`: of a projected reference
/// system; 0: it says none. `metadata`: XML as in GDAL's tag 42112.
[[nodiscard]] std::string plain_geotiff(const Grid<float>& grid, int epsg, const std::string& metadata);

}  // namespace talus::products
